"""What the programs of this folder share: how to be led by `graphdrl explore --live`.

We say in which state we are and which moves there are; it says which move comes next. Each message and each answer is a
JSON object on a line of its own. It runs the program in the folder GRAPHDRL_BIN, else the one built in build/release.
"""

import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = pathlib.Path(os.environ.get("GRAPHDRL_BIN", ROOT / "build/release/bin")) / "graphdrl"


class Guide:
    """One exploration, with options of `graphdrl explore --live`."""

    def __init__(self, *options):
        command = [PROGRAM, "explore", "--live", *options]
        try:
            self.program = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        except OSError as error:
            sys.exit(f"{PROGRAM}: {error.strerror}")

    def next_step(self, state, moves, failed=False):
        """Says where we are, and whether the last step failed. Gives {"move": …}, {"reset": true} or {"done": …}."""
        return self.answer({"state": state, "moves": list(moves), "failed": failed})

    def answer(self, message):
        """What it says to a message. Ends this program where that is an error."""
        try:
            print(json.dumps(message), file=self.program.stdin, flush=True)
            answer = json.loads(self.program.stdout.readline())
        except (BrokenPipeError, ValueError):
            answer = {"error": "graphdrl has ended"}
        if "done" in answer or "error" in answer:
            self.program.communicate()  # lets it end, and write its files; where it cannot it has said why
            if self.program.returncode:
                sys.exit(self.program.returncode)
        if "error" in answer:
            sys.exit(answer["error"])
        return answer


def print_faults(report):
    """The moves that failed, and those that did not lead where they had led before."""
    for one in report["failed"]:
        print(f"failed {one['failures']} times: '{one['move']}' of {one['state']}")
    for one in report["surprises"]:
        print(f"changed: '{one.get('move', 'reset')}' of {one['state']} led to {one['expected']}, then to {one['got']}")
