"""A state machine, explored as a black box: is every state and every transition seen?

The machine comes from a DOT file. Its edges are labelled "input/output", as tools that learn automata write them; an
edge from `__start0` names the first state, else it is the first one in the file. GraphDRL never sees that file. It is
told in which state the machine is and which inputs there are, and says which input comes next.

    python machine.py ../5-dot/login.dot
    python machine.py ../5-dot/login.dot --transcript login.log --out seen.dot

Other options go to `graphdrl explore --live`. To start the machine anew costs as much as an input. Ends with status 1
where something was not seen.
"""

import argparse
import itertools
import pathlib
import re
import sys

from client import Guide


def read_machine(file):
    """The first state, and for each state that can be reached the next one by input."""
    start, table = None, {}
    for line in file.read_text(encoding="utf-8").splitlines():
        edges, _, attributes = line.partition("[")
        label = re.search(r'label\s*=\s*"([^"]*)"', attributes)
        for state, target in itertools.pairwise(name.strip(' \t";') for name in edges.split("->")):
            if state.startswith("__start"):
                start = target
            else:  # an input without a name is called like the state that it leads to
                table.setdefault(state, {})[label[1].split("/")[0].strip() if label else target] = target
    if not table:
        sys.exit(f"{file}: no edges")
    reached = [start or next(iter(table))]
    for state in reached:
        reached += set(table.setdefault(state, {}).values()) - set(reached)
    return reached[0], {state: table[state] for state in reached}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=pathlib.Path, metavar="FILE.dot")
    arguments, options = parser.parse_known_args()
    try:
        start, table = read_machine(arguments.file)
    except (OSError, UnicodeDecodeError) as error:
        sys.exit(f"{arguments.file}: {error}")

    guide = Guide("--cover", "edges", "--reset-cost", "1", *options)
    state, states, transitions = start, {start}, set()
    while "done" not in (step := guide.next_step(state, table[state])):
        if "reset" in step:
            state = start
        else:
            transitions.add((state, step["move"]))
            state = table[state][step["move"]]
            states.add(state)

    count, report = sum(map(len, table.values())), step["report"]
    print(f"{step['done']} after {report['steps']} steps, of which {report['resets']} are resets")
    print(f"{len(states)} of {len(table)} states, {len(transitions)} of {count} transitions")
    return int(len(states) < len(table) or len(transitions) < count)


if __name__ == "__main__":
    sys.exit(main())
