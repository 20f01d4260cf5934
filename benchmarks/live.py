#!/usr/bin/env python3
"""Drives `graphdrl explore --live` through state machines in DOT files as black boxes.

For each machine, policy and seed: steps until all states and until all transitions were seen, and the share of states
seen after 10, 25 and 50 % of the steps that `nearest` takes to all of them. A reset costs 1 and counts as a step. The
order in which a state offers its inputs is random, by seed.

    benchmarks/live.py [--seeds K] [--policies novelty,nearest] [--json] FILE.dot ...
"""

import argparse
import json
import os
import pathlib
import random
import re
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
EDGE = re.compile(r'^\s*"?(\w+)"?\s*->\s*"?(\w+)"?\s*(?:\[(.*)\])?', re.MULTILINE)
LABEL = re.compile(r'label\s*=\s*(?:"([^"]*)"|<(.*)>)')


def read_machine(file: pathlib.Path) -> tuple[str, dict[str, dict[str, str]]]:
    """The first state, and the next one by state and input; labels read input/output."""
    start, table = None, {}
    for state, target, attributes in EDGE.findall(file.read_text(encoding="utf-8")):
        if state.startswith("__start"):
            start = target
            continue
        found = LABEL.search(attributes)
        label = re.sub("<[^>]*>", "", found.group(1) or found.group(2) or "") if found else ""
        table.setdefault(state, {})[label.split("/")[0].strip()] = target
        table.setdefault(target, {})
    return start or next(iter(table)), table


class Run:
    """One exploration: when each state and each transition was first seen, in steps."""

    def __init__(self, program: str, machine, cover: str, policy: str, seed: int):
        start, table = machine
        rng = random.Random(seed)
        offers = {state: rng.sample(sorted(inputs), len(inputs)) for state, inputs in table.items()}
        transitions = sum(map(len, table.values()))
        options = ["--cover", cover, "--policy", policy, "--reset-cost", "1", "--seed", str(seed)]
        client = subprocess.Popen([program, "explore", "--live", *options], stdin=subprocess.PIPE,
                                  stdout=subprocess.PIPE, text=True)
        self.states, self.transitions, done, steps, state = {}, {}, set(), 0, start
        while True:
            self.states.setdefault(state, steps)
            if len(done) == transitions and len(self.states) == len(table):
                break
            print(json.dumps({"id": steps, "state": state, "moves": offers[state]}), file=client.stdin, flush=True)
            answer = json.loads(client.stdout.readline())
            if "done" in answer:
                break
            steps += 1
            if "reset" in answer:
                state = start
                continue
            if (state, answer["move"]) not in done:
                done.add((state, answer["move"]))
                self.transitions[len(done)] = steps
            state = table[state][answer["move"]]
        client.stdin.close()
        client.wait()
        self.all_states = max(self.states.values()) if len(self.states) == len(table) else None
        self.all_transitions = self.transitions.get(transitions)

    def seen_after(self, steps: float) -> float:
        return sum(first <= steps for first in self.states.values()) / len(self.states)


def postman(machine) -> int:
    """Steps of the shortest walk from the first state over all transitions, resets allowed: a flow of least cost."""
    import networkx as nx  # noqa: PLC0415: only here

    start, table = machine
    graph = nx.MultiDiGraph()
    balance = dict.fromkeys(table, 0)
    for state, inputs in table.items():
        graph.add_edge(state, start, weight=1)
        for target in inputs.values():
            balance[state] -= 1
            balance[target] += 1
            graph.add_edge(state, target, weight=1)
    # The walk begins at the first state and may end anywhere: one more arrival there, one departure at the sink.
    balance[start] += 1
    balance["end"] = -1
    for state in table:
        graph.add_edge(state, "end", weight=0)
    simple = nx.DiGraph()
    for a, b, weight in graph.edges(data="weight"):
        if a != b:
            simple.add_edge(a, b, weight=weight)
    for node, extra in balance.items():
        simple.nodes[node]["demand"] = -extra
    return sum(map(len, table.values())) + nx.min_cost_flow_cost(simple)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", type=pathlib.Path, metavar="FILE.dot")
    parser.add_argument("--seeds", type=int, default=10, metavar="K")
    parser.add_argument("--policies", default="novelty,nearest")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    program = str(pathlib.Path(os.environ.get("GRAPHDRL_BIN", ROOT / "build/release/bin")) / "graphdrl")
    rows = []
    for file in arguments.files:
        machine = read_machine(file)
        row = {"machine": file.stem, "states": len(machine[1]), "transitions": sum(map(len, machine[1].values()))}
        row["postman"] = postman(machine)
        base = None
        for policy in [*arguments.policies.split(","), "nearest"]:
            if policy in row:
                continue
            runs = {cover: [Run(program, machine, cover, policy, seed) for seed in range(1, arguments.seeds + 1)]
                    for cover in ("nodes", "edges")}
            row[policy] = {"all_states": statistics.mean(run.all_states for run in runs["nodes"]),
                           "all_transitions": statistics.mean(run.all_transitions for run in runs["edges"])}
            row[policy]["runs"] = runs["nodes"]
        base = row["nearest"]["all_states"]
        for policy in arguments.policies.split(","):
            runs = row[policy].pop("runs")
            row[policy]["seen"] = [statistics.mean(run.seen_after(share * base) for run in runs)
                                   for share in (0.1, 0.25, 0.5)]
        row["nearest"].pop("runs", None)
        rows.append(row)
        if not arguments.json:
            print(f"{row['machine']}: {row['states']} states, {row['transitions']} transitions, postman "
                  f"{row['postman']}")
            for policy in arguments.policies.split(","):
                one = row[policy]
                ratio = one["all_transitions"] / row["postman"]
                print(f"  {policy:10} all states {one['all_states']:7.1f} ({one['all_states'] / base:.2f}), all "
                      f"transitions {one['all_transitions']:7.1f} ({ratio:.3f}), seen after "
                      + ", ".join(f"{100 * share:.0f} %" for share in one["seen"]), flush=True)
    if arguments.json:
        json.dump(rows, sys.stdout, indent=1)
        print()
    else:
        for policy in arguments.policies.split(","):
            states = [row[policy]["all_states"] / row["nearest"]["all_states"] for row in rows]
            edges = [row[policy]["all_transitions"] / row["postman"] for row in rows]
            print(f"{policy:10} all states {statistics.mean(states):.3f} of nearest's, at most {max(states):.2f}; all "
                  f"transitions {statistics.mean(edges):.3f} of the postman's")
    return 0


if __name__ == "__main__":
    sys.exit(main())
