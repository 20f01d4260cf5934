#!/usr/bin/env python3
"""Our policies on maps that are not known beforehand, beside figures of others on the same kinds of map.

city      A city's streets by the rules of Eberle et al. 2022 (code: github.com/Mountlex/graph-exploration). The file is
          OSMnx's GraphML. Nodes are numbered in file order; an edge counts where its source's number is below its
          target's (4,312 edges for Chisinau, 3,097 nodes), costs its length rounded up, and of parallel edges the last
          one counts. Chisinau's tour, all known, costs 558,528. Theirs start at the first node, and end there:
          cities/chisinau.csv has nearest neighbour 742,793, depth first 757,680, Blocking 994,016, hDFS 1,000,014.
noge      Six sets of graphs drawn as those of Chiotellis & Cremers 2020 (scripts/generate_datasets.py of
          github.com/johny-c/noge): the same parameters, chosen at random, and a random start. A figure is the new nodes
          over the moves, until all are visited or 500 are. Theirs: nearest neighbour 0.80 on grids, 0.61 on ladders
          (depth first 0.75), 0.57 in mazes, 0.81 on Barabasi-Albert graphs, 0.99 on cavemen's, 0.50 on trees.
          Differs from theirs: frontier nodes that a way passes count as visited, and not only the node chosen.
dungeons  Maps of ARiADNE (github.com/marmotlab/ARiADNE, DungeonMaps), a pixel a cell, by the rules of its env.py: the
          start is the 128th pixel of the start's colour, sight reaches 80 pixels, and a map is done when at most 250
          free pixels are unseen. Differs from theirs: pixels that cannot be reached from the start do not count, and
          sight is at work on the way, not only where a move ends. A step's seconds are the whole run's, the work of
          seeing included, over its steps; those of a processor say more on a busy machine.
families  17 families of graphs, and four more, of a program that prints them: PROGRAM export FAMILY I prints the I-th
          as node-link JSON. `graphdrl evaluate` starts at random nodes.

Tables show means and their 95 % intervals, by Student's t.
"""

import argparse
import json
import math
import pathlib
import random
import resource
import statistics
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import networkx
from PIL import Image

CHISINAU_TOUR = 558528
CHISINAU = {"nearest": 742793, "dfs": 757680, "blocking": 994016, "hdfs": 1000014}
NOGE = {
    "grid": {"nearest": 0.80},
    "ladder": {"nearest": 0.61, "dfs": 0.75},
    "maze": {"nearest": 0.57},
    "barabasi": {"nearest": 0.81},
    "caveman": {"nearest": 0.99},
    "tree": {"nearest": 0.50},
}
NOGE_PICKS = 500
WALL, START = bytes((127, 127, 127)), bytes((255, 216, 0))  # RGB of a dungeon's pixels
START_PIXEL = 127  # of those of the start's colour, from 0
UNSEEN_PIXELS = 250  # a dungeon is done at so many
SIGHT = 80  # pixels
FAMILIES = ["grid", "ladder", "maze", "mazeloop", "barabasi", "caveman", "tree", "er50", "er200", "geo50", "geo200"]
FAMILIES += ["ws50", "ws200", "obst11", "obst20", "rooms", "road"]
MORE_FAMILIES = ["hex", "tri", "plc", "torus"]


def half_width(values):
    """Of the 95 % interval of the mean. Student's t by Abramowitz & Stegun, 26.7.5: 0.3 % short for five values."""
    if len(values) < 2:
        return None
    z, free = statistics.NormalDist().inv_cdf(0.975), len(values) - 1
    t = z + (z**3 + z) / (4 * free) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * free**2)
    t += (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / (384 * free**3)
    return t * statistics.stdev(values) / math.sqrt(len(values))


def shown(mean, half, digits):
    return f"{mean:.{digits}f}" + (f" ± {half:.{digits}f}" if half is not None else "")


def summary(values, digits):
    return shown(statistics.mean(values), half_width(values), digits) if values else "–"


def chosen(rows, key, **which):
    """The figures `key` of the rows that are so."""
    return [row[key] for row in rows if key in row and all(row[name] == value for name, value in which.items())]


def print_table(head, rows):
    widths = [max(len(line[at]) for line in [head, *rows]) for at in range(len(head))]
    for line in [head, *rows]:
        cells = [line[0].ljust(widths[0])] + [cell.rjust(width) for cell, width in zip(line[1:], widths[1:])]
        print("  ".join(cells).rstrip())


def run(command):
    """What a program prints; where it fails, what it says against it."""
    told = subprocess.run(command, capture_output=True, text=True, check=False)
    if told.returncode != 0:
        sys.exit(told.stderr)
    return told.stdout


def run_json(command):
    return json.loads(run(command))


def explore(arguments, path, policy, start, *options):
    command = [arguments.graphdrl, "explore", path, "--policy", policy, "--start", str(start), "--threads", "1"]
    return run_json([*command, "--seed", str(arguments.seed), "--json", *options])


def note(arguments, rows, row):
    rows.append(row)
    if arguments.json:
        print(json.dumps(row), flush=True)


def write_graph(graph, path):
    """The largest component, its nodes numbered from 0 in their order; returns how many there are."""
    largest = max(networkx.connected_components(graph), key=len)
    graph = networkx.convert_node_labels_to_integers(networkx.subgraph(graph, largest))
    path.write_text(json.dumps(networkx.node_link_data(graph, edges="links")))
    return len(graph)


def read_streets(path):
    """OSMnx's GraphML, by the rules of `city`."""
    root = xml.etree.ElementTree.parse(path).getroot()
    length_key = next(key.get("id") for key in root.iterfind("{*}key") if key.get("attr.name") == "length")
    numbers = {node.get("id"): number for number, node in enumerate(root.iterfind("{*}graph/{*}node"))}
    graph = networkx.Graph()
    graph.add_nodes_from(numbers.values())
    for edge in root.iterfind("{*}graph/{*}edge"):
        source, target = numbers[edge.get("source")], numbers[edge.get("target")]
        length = next((data.text for data in edge.iterfind("{*}data") if data.get("key") == length_key), None)
        if source < target and length is not None:
            graph.add_edge(source, target, weight=math.ceil(float(length)))
    return graph


def city(arguments, folder):
    graph, path, tour = read_streets(arguments.file), folder / "city.json", arguments.budget_of_tour
    count = write_graph(graph, path)
    starts = random.Random(arguments.seed).sample(range(count), min(count, arguments.starts))
    rows = []
    for policy in arguments.policies:
        for start in dict.fromkeys([0, *starts]):
            all_seen = explore(arguments, path, policy, start, "--until", "covered", "--end", "start")
            assert all_seen["visited"] == count, all_seen["visited"]
            row = {"policy": policy, "start": start, "tours": all_seen["cost"] / tour}
            for budget in (0.5, 1.0):
                row[f"{budget}x"] = explore(arguments, path, policy, start, "--budget", str(budget * tour))["coverage"]
            note(arguments, rows, row)
    if arguments.json:
        return
    print(f"{count} nodes, {graph.number_of_edges()} edges; {len(starts)} random starts; a tour costs {tour}")
    lines = []
    for policy in arguments.policies:
        first = chosen(rows, "tours", policy=policy, start=0)
        drawn = [row for row in rows if row["policy"] == policy and row["start"] in starts]
        lines.append([policy, summary(first, 3), summary(chosen(drawn, "tours"), 3)])
        lines[-1] += [summary(chosen(drawn, budget), 2) for budget in ("0.5x", "1.0x")]
    if tour == CHISINAU_TOUR:
        lines += [[f"theirs: {name}", f"{cost / tour:.3f}", "–", "–", "–"] for name, cost in CHISINAU.items()]
    print_table(["policy", "all and back, first node", "all and back, tours", "% at 0.5x", "% at 1.0x"], lines)


def maze_of_walls(draw, side):
    """The free cells of a maze whose walls grow from random posts: cells at even places, the border among them.

    A wall that grows goes on from a post to one two cells away that is free, and stays where the one drawn is not.
    """
    posts = side // 2
    walls = {(r, c) for r in range(side) for c in range(side) if r in (0, side - 1) or c in (0, side - 1)}
    for _ in range(int(0.75 * posts * posts)):
        row, column = 2 * draw.randint(0, posts), 2 * draw.randint(0, posts)
        walls.add((row, column))
        for _ in range(int(0.75 * 5 * 2 * side)):
            near = [(row + down, column + right) for down, right in ((0, -2), (0, 2), (-2, 0), (2, 0))]
            to_row, to_column = draw.choice([post for post in near if 0 <= min(post) and max(post) < side])
            if (to_row, to_column) not in walls:
                walls |= {(to_row, to_column), ((row + to_row) // 2, (column + to_column) // 2)}
                row, column = to_row, to_column
    graph = networkx.grid_2d_graph(side, side)
    graph.remove_nodes_from(walls)
    return graph


def noge_graph(name, draw):
    if name == "grid":
        return networkx.grid_2d_graph(draw.randint(8, 17), draw.randint(8, 17))
    if name == "ladder":
        return networkx.ladder_graph(draw.randint(100, 199))
    if name == "maze":
        return maze_of_walls(draw, draw.choice(range(15, 25, 2)))
    if name == "barabasi":
        return networkx.barabasi_albert_graph(draw.randint(100, 199), 4, seed=draw.randrange(2**31))
    if name == "caveman":
        return networkx.connected_caveman_graph(draw.randint(2, 4), draw.randint(30, 79))
    return networkx.balanced_tree(*draw.choice([(3, 4), (3, 5), (3, 6), (4, 4), (4, 5), (5, 4)]))


def new_nodes_a_move(walk):
    visited, moves = {walk[0]}, 1
    for step, node in enumerate(walk):
        if node not in visited:
            visited.add(node)
            moves = step
            if len(visited) > NOGE_PICKS:
                break
    return (len(visited) - 1) / moves


def noge(arguments, folder):
    rows, path = [], folder / "graph.json"
    for name in NOGE:
        draw = random.Random(f"{arguments.seed} {name}")
        for number in range(arguments.count):
            count = write_graph(noge_graph(name, draw), path)
            start = draw.randrange(count)
            for policy in arguments.policies:
                walk = explore(arguments, path, policy, start, "--until", "covered")["walk"]
                assert len(set(walk)) == count, len(set(walk))
                row = {"set": name, "graph": number, "nodes": count, "policy": policy, "rate": new_nodes_a_move(walk)}
                note(arguments, rows, row)
    if arguments.json:
        return
    print(f"New nodes a move, {arguments.count} graphs of each set")
    lines = []
    for name, figures in NOGE.items():
        cells = [summary(chosen(rows, "rate", set=name, policy=policy), 3) for policy in arguments.policies]
        lines.append([name, *cells, ", ".join(f"{who} {figure:.2f}" for who, figure in figures.items())])
    print_table(["set", *arguments.policies, "theirs"], lines)


class Dungeon:
    """The free pixels of a picture, the start, and what can be reached from it."""

    def __init__(self, path):
        image = Image.open(path).convert("RGB")
        self.width, size, data = image.width, image.width * image.height, image.tobytes()
        pixels = [data[3 * at : 3 * at + 3] for at in range(size)]
        self.free = bytes(pixel != WALL for pixel in pixels)
        self.start = [at for at, pixel in enumerate(pixels) if pixel == START][START_PIXEL]
        self.reachable, waiting = {self.start}, [self.start]
        # Diagonal steps pass no blocked cell, so that they reach nothing more than straight ones.
        while waiting:
            at = waiting.pop()
            left, right = at % self.width > 0, (at + 1) % self.width > 0
            for to in (at - self.width, at + self.width, at - 1 if left else -1, at + 1 if right else -1):
                if 0 <= to < size and self.free[to] and to not in self.reachable:
                    self.reachable.add(to)
                    waiting.append(to)

    def write(self, path):
        cells = "".join(".#"[not free] for free in self.free)
        rows = [cells[at : at + self.width] for at in range(0, len(cells), self.width)]
        path.write_text("\n".join(rows) + "\n")

    def lengths(self, walk):
        """Of the walk, up to each step."""
        lengths = [0.0]
        for last, node in zip(walk, walk[1:]):
            lengths.append(lengths[-1] + (1 if abs(node - last) in (1, self.width) else math.sqrt(2)))
        return lengths

    def done_at(self, told):
        """The first step after which few enough pixels are unseen, or none."""
        unseen, at = len(self.reachable), 0
        for step, seen in enumerate(told["seen_after_step"]):
            unseen -= sum(node in self.reachable for node in told["seen_nodes"][at:seen])
            at = seen
            if unseen <= UNSEEN_PIXELS:
                return step
        return None


def processor_s():
    """Seconds of a processor that programs took that were run and have ended; others' work does not count in it."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def dungeons(arguments, folder):
    of_kind = {}
    for path in sorted(arguments.folder.glob("*.png")):
        of_kind.setdefault(path.stem.split("-")[0], []).append(path)
    paths, rows = [path for paths in of_kind.values() for path in paths[: arguments.count]], []
    options = ["--connectivity", "8", "--reveal", f"sight:{SIGHT}", "--score", "seen", "--until", "covered"]
    for path in paths:
        dungeon, text = Dungeon(path), folder / f"{path.stem}.txt"
        dungeon.write(text)
        start = f"{dungeon.start // dungeon.width},{dungeon.start % dungeon.width}"
        for policy in arguments.policies:
            used = processor_s()
            told = explore(arguments, text, policy, start, *options)
            used = processor_s() - used
            lengths, step = dungeon.lengths(told["walk"]), dungeon.done_at(told)
            assert abs(lengths[-1] - told["cost"]) < 1e-3, (lengths[-1], told["cost"])
            row = {"map": path.stem, "kind": path.stem.split("-")[0], "policy": policy}
            row |= {"free": sum(dungeon.free), "reachable": len(dungeon.reachable), "done": step is not None}
            row |= {"length": lengths[step]} if step is not None else {}
            row |= {"whole_length": lengths[-1], "step_s": told["elapsed_s"] / max(1, len(lengths) - 1)}
            row["step_processor_s"] = used / max(1, len(lengths) - 1)
            note(arguments, rows, row)
    if arguments.json:
        return
    print(f"Pixels until at most {UNSEEN_PIXELS} free ones are unseen, {len(paths)} maps")
    lines = []
    for policy in arguments.policies:
        cells = [summary(chosen(rows, "length", policy=policy, kind=kind), 0) for kind in of_kind]
        lines.append([policy, *cells, summary(chosen(rows, "length", policy=policy), 0)])
        lines[-1] += [str(sum(chosen(rows, "done", policy=policy)))]
        lines[-1] += [summary(chosen(rows, key, policy=policy), 4) for key in ("step_s", "step_processor_s")]
    print_table(["policy", *of_kind, "all", "done", "seconds a step", "of a processor"], lines)


def families(arguments, folder):
    names, rows = FAMILIES + MORE_FAMILIES, []
    for name in names:
        (folder / name).mkdir()
        for number in range(arguments.count):
            graph = run([arguments.program, "export", name, str(number)])
            (folder / name / f"{number:04}.json").write_text(graph)
    command = [arguments.graphdrl, "evaluate", "--reveal", "edges", "--episodes", "1", "--seed", str(arguments.seed)]
    command += [word for policy in arguments.policies for word in ("--policy", policy)]
    command += [word for name in names for word in ("--maps", str(folder / name))]
    for budget in ("0.5x", "1.0x"):
        words = [*command, "--budget", budget, "--threads", str(arguments.threads), "--json"]
        for told in run_json(words)["families"]:
            mean, interval = told["coverage"]["mean"], told["coverage"]["ci95"]
            row = {"budget": budget, "family": pathlib.Path(told["family"]).name, "policy": told["policy"]}
            row |= {"maps": told["maps"], "mean": mean, "half_width": interval[1] - mean if interval else None}
            note(arguments, rows, row)
    if arguments.json:
        return
    for budget in ("0.5x", "1.0x"):
        print(f"\n% of the nodes at {budget}, {arguments.count} graphs of each family")
        found = {(row["family"], row["policy"]): row for row in rows if row["budget"] == budget}
        figures = lambda row: shown(row["mean"], row["half_width"], 1)  # noqa: E731
        lines = [[name, *(figures(found[name, policy]) for policy in arguments.policies)] for name in names]
        means = [f"mean of {len(FAMILIES)}"]
        for policy in arguments.policies:
            those = [found[name, policy] for name in FAMILIES]
            half = math.sqrt(sum((row["half_width"] or 0) ** 2 for row in those)) / len(those)
            means.append(shown(statistics.mean(row["mean"] for row in those), half if arguments.count > 1 else None, 2))
        lines.insert(len(FAMILIES), means)
        print_table(["family", *arguments.policies], lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("graphdrl")
    commands = parser.add_subparsers(dest="command", required=True)

    def command(work, policies, text):
        which = commands.add_parser(work.__name__, help=text)
        which.set_defaults(work=work)
        which.add_argument("--policies", nargs="+", default=policies, metavar="P", help="those of explore --policy")
        which.add_argument("--seed", type=int, default=1, help="of graphs, starts and random policies")
        which.add_argument("--json", action="store_true", help="instead of tables every figure, a line of JSON each")
        return which

    rules = ["nearest", "pocket", "open", "dfs"]
    which = command(city, rules, "the streets of a city, from random starts")
    which.add_argument("file", type=pathlib.Path, help="OSMnx's GraphML")
    which.add_argument("--budget-of-tour", type=int, default=CHISINAU_TOUR, metavar="COST", help="1.0x: a known tour's")
    which.add_argument("--starts", type=int, default=100)
    which = command(noge, rules, "grids, ladders, mazes, Barabasi-Albert graphs, cavemen and trees")
    which.add_argument("--count", type=int, default=50, help="graphs of each set")
    which = command(dungeons, ["nearest", "frontier", "tour:16"], "pictures of dungeons, seen by lines of sight")
    which.add_argument("folder", type=pathlib.Path, help="of PNG files, KIND-NAME.png")
    which.add_argument("--count", type=int, help="the first so many of each kind; the default is all")
    which = command(families, rules, "graphs that a program prints")
    which.add_argument("program")
    which.add_argument("--count", type=int, default=200, help="graphs of each family")
    which.add_argument("--threads", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        arguments.work(arguments, pathlib.Path(folder))


if __name__ == "__main__":
    main()
