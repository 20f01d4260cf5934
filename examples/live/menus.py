"""A program with text menus, explored choice by choice: which menus does it have, and does each choice work?

The program is `phone.py`. Nothing is known of it but what it prints: a line `== Title ==`, a line for each choice with
its key, a prompt. The title is the state, the choices are the moves. Where the program says "not available" the move
has failed; GraphDRL tries it again later, and gives it up after the third time. Where a choice leads elsewhere than
before GraphDRL notes that, too.

    python menus.py
    python menus.py --out phone.html

Other options go to `graphdrl explore --live`. The page `phone.html` shows step by step how the menus became known.
"""

import argparse
import pathlib
import re
import subprocess
import sys

from client import Guide, print_faults

PHONE = [sys.executable, pathlib.Path(__file__).resolve().parent / "phone.py"]


def read_screen(program):
    """What the program prints, up to its prompt."""
    text = ""
    while not text.endswith("\n> "):
        letter = program.stdout.read(1)
        if not letter:
            sys.exit("the program with the menus has ended")
        text += letter
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    _, options = parser.parse_known_args()
    guide = Guide("--cover", "edges", *options)
    menus, step = set(), {}
    with subprocess.Popen(PHONE, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as program:
        while "done" not in step:
            screen = read_screen(program)
            title = re.search("^== (.*) ==$", screen, re.MULTILINE)[1]
            choices = re.findall(r"^\w \w.*$", screen, re.MULTILINE)
            menus.add(title)
            step = guide.next_step(title, choices, failed="not available" in screen)
            if "move" in step:
                print(step["move"].split()[0], file=program.stdin, flush=True)
    print(f"{step['done']}: {len(menus)} menus, {step['report']['transitions']} choices that work")
    print("menus:", ", ".join(sorted(menus)))
    print_faults(step["report"])


if __name__ == "__main__":
    main()
