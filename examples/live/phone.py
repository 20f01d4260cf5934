"""A telephone of menus, for `menus.py` to explore: a program that prints a menu and reads a choice, over and over.

Try it by hand with `python phone.py`; Ctrl-D ends it. Two things are odd, and on purpose. The camera is never
available. The radio asks to be set up the first time, and not again.
"""

import sys

# By title: the choices, and the menu that each leads to. The last one goes back.
MENUS = {
    "Telephone": [
        ("Messages", "Messages"),
        ("Contacts", "Contacts"),
        ("Settings", "Settings"),
        ("Camera", None),
        ("Radio", "Radio"),
    ],
    "Messages": [("Inbox", "Inbox"), ("Write", "Contacts"), ("Back", "Telephone")],
    "Inbox": [("Delete all", "Inbox"), ("Back", "Messages")],
    "Contacts": [("Emergency", "Contacts"), ("Back", "Telephone")],
    "Settings": [("Sound", "Sound"), ("Clock", "Clock"), ("Back", "Telephone")],
    "Sound": [("Louder", "Sound"), ("Softer", "Sound"), ("Back", "Settings")],
    "Clock": [("Set the alarm", "Clock"), ("Back", "Settings")],
    "Radio setup": [("FM", "Telephone"), ("Digital", "Telephone"), ("Back", "Telephone")],
    "Radio": [("Next station", "Radio"), ("Set up again", "Radio setup"), ("Back", "Telephone")],
}


def main():
    title, radio_was_set_up = "Telephone", False
    while True:
        choices = {"q" if text == "Back" else str(i): (text, to) for i, (text, to) in enumerate(MENUS[title], 1)}
        print(f"\n== {title} ==")
        for key, (text, _) in choices.items():
            print(key, text)
        print("> ", end="", flush=True)
        line = sys.stdin.readline()
        if not line:
            return
        _, target = choices.get(line.strip(), ("", None))
        if target is None:
            print("not available")
        elif target == "Radio" and not radio_was_set_up:
            title, radio_was_set_up = "Radio setup", True
        else:
            title = target


if __name__ == "__main__":
    main()
