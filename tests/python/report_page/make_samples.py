"""Sample data of the report page: what the program writes, and worlds larger than tests have time to plan on."""

import base64
import json
import math
import random
import re
import subprocess

DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)


def call(program, *arguments):
    """Gives what the program printed."""
    command = [program, *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=300).stdout


def data_of(program, folder, *arguments):
    """The data of the page that `report` writes."""
    page = folder / "page.html"
    call(program, "report", *arguments, "--out", page)
    return json.loads(DATA.search(page.read_text(encoding="utf-8"))[1])


def bitset(blocked):
    data = bytearray((len(blocked) + 7) // 8)
    for node, is_blocked in enumerate(blocked):
        data[node >> 3] |= is_blocked << (node & 7)
    return base64.b64encode(data).decode()


def grid_world(name, rows):
    blocked = [letter not in ".GS" for row in rows for letter in row]
    return {
        "name": name,
        "nodes": len(blocked),
        "valid": blocked.count(False),
        "kind": "grid",
        "rows": len(rows),
        "cols": len(rows[0]),
        "blocked": bitset(blocked),
        "directed": False,
        "labels": None,
        "prizes": None,
        "unit": "",
    }


def replay(program, folder, source, policies, budget, scored=False, reveal=None):
    """Plans on one world, which they explore where reveal says what visits show. scored: the first has the explorer's
    scores. Adds what the page computes or may miss."""
    files = []
    for policy in policies:
        files.append(folder / f"{policy.replace(':', '-')}.json")
        how = ["explore", source, "--reveal", reveal] if reveal else ["plan", source]
        call(program, *how, "--budget", budget, "--policy", policy, "--out", files[-1])
    (made,) = data_of(program, folder, *files, "--map", source)["replays"]
    if scored:
        (with_scores,) = data_of(program, folder, files[0], "--map", source, "--scores", "explorer")["replays"]
        made["plans"][0] = with_scores["plans"][0]
    made["world"] = {"prizes": None, "labels": None} | made["world"]
    for plan, file in zip(made["plans"], files):
        answer = json.loads(file.read_text())
        assert plan["walk"] == answer["walk"] and plan["budget"] == answer["budget"]
        plan.setdefault("costs", list(range(len(plan["walk"]))))
        plan |= {"coverage": answer["coverage"], "cost": answer["cost"], "prize": answer.get("prize")}
        plan.setdefault("scores", None)
    return made | {"budget": made["plans"][0]["budget"]}


def town(seed, count):
    """Places in a plane with names, prizes, and directed ways of some length between near ones."""
    chance = random.Random(seed)
    places = [(chance.uniform(0, 300), chance.uniform(0, 200)) for _ in range(count)]
    links = []
    for a, (x, y) in enumerate(places):
        near = sorted(range(count), key=lambda b: math.dist((x, y), places[b]))[1:5]
        links += [
            {"source": f"s{a}", "target": f"s{b}", "weight": round(math.dist((x, y), places[b]), 1)} for b in near
        ]
    return {
        "directed": True,
        "nodes": [{"id": f"s{i}", "x": x, "y": y, "prize": chance.randint(1, 9)} for i, (x, y) in enumerate(places)],
        "links": links,
    }


def orienteering(seed, count):
    """A file of OPLib: cities in a plane, each worth something."""
    chance = random.Random(seed)
    places = [f"{i + 1} {chance.randint(0, 99)} {chance.randint(0, 99)}" for i in range(count)]
    scores = [f"{i + 1} {chance.randint(1, 9)}" for i in range(count)]
    lines = ["NAME : cities", "TYPE : OP", f"DIMENSION : {count}", "EDGE_WEIGHT_TYPE : EUC_2D", "COST_LIMIT : 250"]
    lines += ["NODE_COORD_SECTION", *places, "NODE_SCORE_SECTION", *scores, "DEPOT_SECTION", "1", "-1", "EOF"]
    return "\n".join(lines) + "\n"


def curve(seed, episodes, every=10):
    """A run's metrics as the preset paper writes them, made up."""
    chance = random.Random(seed)
    lines = []
    for episode in range(every, episodes + 1, every):
        t = episode / episodes
        coverage = min(100, 40 + 52 * (1 - math.exp(-3 * t)) + chance.gauss(0, 4))
        lines.append(
            {
                "episode": episode,
                "steps": 25.0 * episode,
                "epsilon": 0.05 + 0.95 * math.exp(-6 * t),
                "loss": math.exp(-3.5 * t + chance.gauss(-1.5, 0.25)),
                "visited_nodes": coverage * 0.19,
                "coverage": coverage,
                "reward": -8 + 0.09 * coverage + chance.gauss(0, 0.5),
            }
        )
    return lines


def large_replay(side):
    """A walk of one step per free cell, row by row, on a map of side × side cells with a wall here and there."""
    chance = random.Random(7)
    rows = [["."] * side for _ in range(side)]
    for row in range(2, side - 2):
        for col in range(2, side - 2):
            if row % 2 == 1 and 3 < col < side - 4 and chance.random() < 0.12:
                rows[row][col] = "#"
    walk = []
    for row in range(side):
        cols = range(side) if row % 2 == 0 else range(side - 1, -1, -1)
        for col in cols:
            if rows[row][col] == "#":
                continue
            if walk and abs(walk[-1] % side - col) + abs(walk[-1] // side - row) != 1:
                previous = walk[-1] % side
                # Round the wall by the row above.
                step = 1 if col > previous else -1
                walk += [(row - 1) * side + c for c in range(previous, col + step, step)]
            walk.append(row * side + col)
    world = grid_world("large", ["".join(row) for row in rows])
    visited = len(set(walk))
    plan = {
        "policy": "rows",
        "walk": walk,
        "costs": list(range(len(walk))),
        "visited": visited,
        "coverage": 100 * visited / world["valid"],
        "cost": len(walk) - 1,
        "upper_bound": 100.0,
        "optimal": False,
        "budget": len(walk),
        "prize": None,
        "scores": None,
    }
    half = walk[: len(walk) // 2]
    short = plan | {"policy": "half of the rows", "walk": half, "costs": list(range(len(half))), "cost": len(half) - 1}
    short["visited"] = len(set(half))
    short["coverage"] = 100 * short["visited"] / world["valid"]
    return {"title": "Large", "world": world, "budget": len(walk), "plans": [plan, short]}


def large_graph_replay(count):
    """A random walk on a planar-like graph of many nodes."""
    chance = random.Random(11)
    side = math.isqrt(count)
    place = lambda node: (node % side + chance.uniform(-0.35, 0.35), node // side + chance.uniform(-0.35, 0.35))
    places = [place(node) for node in range(side * side)]
    neighbours = [[] for _ in places]
    edges = []
    for node in range(side * side):
        for other in ([node + 1] if node % side < side - 1 else []) + (
            [node + side] if node + side < side * side else []
        ):
            edges += [node, other]
            neighbours[node].append(other)
            neighbours[other].append(node)
    walk = [side * side // 2 + side // 2]
    seen = {walk[0]}
    while len(walk) < count:
        fresh = [node for node in neighbours[walk[-1]] if node not in seen]
        walk.append(chance.choice(fresh or neighbours[walk[-1]]))
        seen.add(walk[-1])
    world = {
        "name": "large graph",
        "nodes": len(places),
        "valid": len(places),
        "kind": "graph",
        "blocked": "",
        "x": [round(x, 3) for x, _ in places],
        "y": [round(y, 3) for _, y in places],
        "edges": edges,
        "directed": False,
        "labels": None,
        "prizes": None,
        "unit": "",
    }
    plan = {
        "policy": "random-walk",
        "walk": walk,
        "costs": list(range(len(walk))),
        "visited": len(seen),
        "coverage": 100 * len(seen) / len(places),
        "cost": len(walk) - 1,
        "upper_bound": 100.0,
        "optimal": False,
        "prize": None,
        "scores": None,
    }
    return {"title": "Large graph", "world": world, "budget": len(walk), "plans": [plan]}


def document(title, replays=(), runs=(), evaluations=()):
    return {
        "version": 1,
        "title": title,
        "watch": False,
        "replays": list(replays),
        "runs": list(runs),
        "evaluations": list(evaluations),
    }


def sample(program, folder):
    """One report with everything: seven worlds, two of them explored, three runs, an evaluation."""
    (folder / "town.json").write_text(json.dumps(town(5, 40)))
    (folder / "cities.oplib").write_text(orienteering(9, 30))
    for family, size in (("geometric", 200), ("loop-maze", 21), ("rooms", 24), ("hexagons", 100)):
        call(program, "maps", "generate", family, "--size", size, "--count", 1, "--seed", 3, "--out", folder / family)
    (graph,) = (folder / "geometric").glob("*.json")
    (maze,) = (folder / "loop-maze").iterdir()
    (rooms,) = (folder / "rooms").iterdir()
    (hexagons,) = (folder / "hexagons").glob("*.json")
    replays = [
        replay(program, folder, "paper:a", ("explorer", "search", "nearest", "random"), 25, scored=True),
        replay(program, folder, maze, ("search", "dfs"), "1.1x"),
        replay(program, folder, graph, ("search", "nearest"), "1.1x"),
        replay(program, folder, folder / "town.json", ("search", "nearest"), 400),
        replay(program, folder, folder / "cities.oplib", ("search", "nearest"), 250),
        replay(program, folder, rooms, ("pocket", "nearest"), "0.5x", reveal="sight:5"),
        replay(program, folder, hexagons, ("dfs",), "0.4x", reveal="edges"),
    ]
    run = folder / "explorer"
    small = ["--rounds", 8, "--largest", 6, "--walks", 16, "--updates", 10, "--teacher-steps", 1]
    call(program, "train", *small, "--out", run)
    policies = [word for policy in ("random", "dfs", "nearest", "explorer", "exact") for word in ("--policy", policy)]
    (folder / "evaluation.json").write_text(call(program, "evaluate", *policies, "--episodes", 10, "--json"))
    written = data_of(program, folder, run, folder / "evaluation.json")
    runs = [{"name": f"paper, seed {seed}", "lines": curve(seed, 4000)} for seed in (1, 2)] + written["runs"]
    return document("GraphDRL report", replays, runs, written["evaluations"])
