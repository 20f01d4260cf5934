#!/usr/bin/env python3
"""Our plans beside those of solvers that others wrote, on the same worlds, one thread each.

EA4OP (github.com/gkobeaga/op-solver, built by the user), OR-tools' routing and PyVRP get the matrix of shortest
distances and an open end. Every solver's order of nodes is walked on the graph, with what it passes counted, before it
is believed. Distances are whole numbers for all solvers: where costs are not, they are scaled and rounded up, so that
no walk costs more than it seems to. A solver's time is what it takes itself; that of the matrix is not counted.
"""

import argparse
import heapq
import json
import pathlib
import statistics
import subprocess
import tempfile
import time

SCALE = 1000  # of costs that are not whole


class Graph:
    def __init__(self, path):
        text = path.read_text()
        self.edges = {}
        if text.lstrip().startswith("{"):
            data = json.loads(text)
            both = not data.get("directed", False)
            ids = {node["id"]: place for place, node in enumerate(data["nodes"])}
            self.edges = {place: {} for place in ids.values()}
            for link in data.get("links", data.get("edges")):
                a, b, cost = ids[link["source"]], ids[link["target"]], link.get("weight", 1)
                self.edges[a][b] = cost
                if both:
                    self.edges[b][a] = cost
        else:
            rows = text.split()
            free = {(r, c) for r, row in enumerate(rows) for c, cell in enumerate(row) if cell == "."}
            width = len(rows[0])
            for r, c in free:
                steps = ((r, c - 1), (r - 1, c), (r, c + 1), (r + 1, c))
                self.edges[r * width + c] = {a * width + b: 1 for a, b in steps if (a, b) in free}

    def distances(self, start):
        """Costs of cheapest ways from a node, and the node before each on it."""
        costs, before, heap = {}, {}, [(0, start, start)]
        while heap:
            cost, node, last = heapq.heappop(heap)
            if node in costs:
                continue
            costs[node], before[node] = cost, last
            for other, more in self.edges[node].items():
                if other not in costs:
                    heapq.heappush(heap, (cost + more, other, node))
        return costs, before


class Problem:
    """The nodes that can be had for the budget, the start first, and whole distances between them."""

    def __init__(self, graph, start, budget):
        self.graph, self.budget = graph, budget
        costs, _ = graph.distances(start)
        self.nodes = sorted(node for node in costs if costs[node] <= budget)
        self.nodes.remove(start)
        self.nodes.insert(0, start)
        self.ways = {node: graph.distances(node) for node in self.nodes}
        whole = all(cost == int(cost) for edges in graph.edges.values() for cost in edges.values())
        self.scale = 1 if whole else SCALE
        up = lambda cost: -int(-cost * self.scale // 1)  # noqa: E731
        self.matrix = [[up(self.ways[a][0][b]) for b in self.nodes] for a in self.nodes]
        self.limit = int(budget * self.scale)

    def visits(self, order):
        """How many nodes a walk visits that makes for these places in order; it must be within the budget."""
        here, cost, visited = self.nodes[0], 0, {self.nodes[0]}
        for place in order:
            target = self.nodes[place]
            costs, before = self.ways[here]
            cost += costs[target]
            step = target
            while step != here:
                visited.add(step)
                step = before[step]
            here = target
        assert cost <= self.budget * (1 + 1e-9), (cost, self.budget)
        return len(visited)


def ea4op(problem, _seconds, binary):
    """The end is a node more: worth more than all others, at no cost from the start, and for limit + 1 from others."""
    count = len(problem.nodes)
    far = problem.limit + 1
    rows = [row + [0 if place == 0 else far] for place, row in enumerate(problem.matrix)]
    rows.append([0] + [far] * (count - 1) + [0])
    with tempfile.TemporaryDirectory() as folder:
        lines = ["NAME : world", "TYPE : OP", f"DIMENSION : {count + 1}", f"COST_LIMIT : {problem.limit + far}"]
        lines += ["EDGE_WEIGHT_TYPE : EXPLICIT", "EDGE_WEIGHT_FORMAT : LOWER_DIAG_ROW", "EDGE_WEIGHT_SECTION"]
        lines += [" ".join(map(str, row[: place + 1])) for place, row in enumerate(rows)]
        lines += ["NODE_SCORE_SECTION"] + [f"{place + 1} 1" for place in range(count)] + [f"{count + 1} {2 * count}"]
        lines += ["DEPOT_SECTION", "1", "-1", "EOF", ""]
        pathlib.Path(folder, "world.oplib").write_text("\n".join(lines))
        begin = time.perf_counter()
        command = [binary, "opt", "--op-exact", "0", "world.oplib"]
        if subprocess.run(command, cwd=folder, check=False, capture_output=True).returncode != 0:
            return None, 0  # it crashes on some worlds
        elapsed = time.perf_counter() - begin
        documents = pathlib.Path(folder, "stats.json").read_text()
    decoder, at, best = json.JSONDecoder(), 0, None
    while at < len(documents.strip()):
        document, at = decoder.raw_decode(documents, at)
        at += len(documents[at:]) - len(documents[at:].lstrip())
        if document.get("sol", {}).get("val", -1) >= (best or {"val": -1})["val"]:
            best = document["sol"]
    cycle = [place - 1 for place in best["cycle"]]
    at = cycle.index(0)
    cycle = cycle[at + 1 :] + cycle[:at]
    if count not in cycle:
        return 1, elapsed
    order = cycle[:-1] if cycle[-1] == count else cycle[:0:-1]
    return problem.visits(order), elapsed


def ortools(problem, seconds, _binary):
    """Guided local search; a node left out costs more than any way."""
    from ortools.constraint_solver import pywrapcp, routing_enums_pb2

    count = len(problem.nodes)
    manager = pywrapcp.RoutingIndexManager(count + 1, 1, [0], [count])
    routing = pywrapcp.RoutingModel(manager)
    cost = lambda a, b: 0 if b == count else problem.matrix[a][b] if a < count else 0  # noqa: E731
    transit = routing.RegisterTransitCallback(lambda a, b: cost(manager.IndexToNode(a), manager.IndexToNode(b)))
    routing.SetArcCostEvaluatorOfAllVehicles(transit)
    routing.AddDimension(transit, 0, problem.limit, True, "cost")
    for place in range(1, count):
        routing.AddDisjunction([manager.NodeToIndex(place)], problem.limit + 1)
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PATH_CHEAPEST_ARC
    parameters.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    parameters.time_limit.FromMilliseconds(int(1000 * seconds))
    begin = time.perf_counter()
    solution = routing.SolveWithParameters(parameters)
    elapsed = time.perf_counter() - begin
    order, at = [], routing.Start(0)
    while solution and not routing.IsEnd(at):
        at = solution.Value(routing.NextVar(at))
        order.append(manager.IndexToNode(at))
    return problem.visits([place for place in order if 0 < place < count]), elapsed


def pyvrp(problem, seconds, _binary):
    """One vehicle, clients with prizes; the way to the second depot, where it ends, costs nothing."""
    import pyvrp as vrp
    from pyvrp.stop import MaxRuntime

    count = len(problem.nodes)
    model = vrp.Model()
    depots = [model.add_depot(0, 0), model.add_depot(0, 0)]
    places = [depots[0]] + [
        model.add_client(0, 0, prize=problem.limit + 1, required=False) for _ in range(1, count)
    ]
    model.add_vehicle_type(1, start_depot=depots[0], end_depot=depots[1], max_distance=problem.limit)
    for a in range(count):
        model.add_edge(places[a], depots[1], distance=0)
        model.add_edge(depots[1], places[a], distance=0)
        for b in range(count):
            if a != b:
                model.add_edge(places[a], places[b], distance=problem.matrix[a][b])
    begin = time.perf_counter()
    result = model.solve(stop=MaxRuntime(seconds), seed=1, display=False)
    elapsed = time.perf_counter() - begin
    routes = result.best.routes() if result.best.is_feasible() else []
    first = len(depots)  # clients are numbered after the depots
    order = [client - first + 1 for route in routes for client in route.visits()]
    return problem.visits(order), elapsed


SOLVERS = {"ea4op": ea4op, "ortools": ortools, "pyvrp": pyvrp}


def ours(graphdrl, path, budget, policy, seconds):
    command = [graphdrl, "plan", path, "--budget", budget, "--policy", policy, "--threads", "1", "--json"]
    if seconds:
        command += ["--time-limit", f"{seconds:.4f}"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("graphdrl")
    parser.add_argument("--worlds", nargs="+", default=["obstacles-11"], help="FAMILY-SIZE or FAMILY-SIZE-weighted")
    parser.add_argument("--count", type=int, default=5, help="worlds of each")
    parser.add_argument("--split", default="validation")
    parser.add_argument("--budget", default="1.0x")
    parser.add_argument("--solvers", nargs="*", default=["ortools", "pyvrp"], choices=SOLVERS)
    parser.add_argument("--policies", nargs="*", default=["nearest", "search"])
    parser.add_argument("--seconds", type=float, default=1, help="a world, for all but nearest and EA4OP")
    parser.add_argument("--ea4op", help="the program op-solver")
    parser.add_argument("--share-of-ea4op", type=float, help="instead: this share of EA4OP's time, 0.01 s at least")
    parser.add_argument("--json", action="store_true", help="print every world's figures")
    arguments = parser.parse_args()
    if "ea4op" in arguments.solvers and not arguments.ea4op:
        parser.error("--solvers ea4op needs --ea4op PROGRAM")
    if arguments.share_of_ea4op and arguments.solvers[:1] != ["ea4op"]:
        parser.error("--share-of-ea4op needs ea4op as the first of --solvers")
    for family in arguments.worlds:
        name, size, *weighted = family.split("-weighted")[0].rsplit("-", 1) + ["weighted"] * ("-weighted" in family)
        rows, failed = [], []
        with tempfile.TemporaryDirectory() as folder:
            command = [arguments.graphdrl, "maps", "generate", name, "--size", size, "--split", arguments.split]
            command += ["--count", str(arguments.count), "--out", f"{folder}/worlds"] + ["--weighted"] * len(weighted)
            subprocess.run(command, check=True, capture_output=True)
            for path in sorted(pathlib.Path(folder, "worlds").iterdir()):
                told = ours(arguments.graphdrl, path, arguments.budget, "nearest", None)
                valid = round(100 * told["visited"] / told["coverage"])
                problem = Problem(Graph(path), told["start"], told["budget"])
                row, seconds, visited = {}, arguments.seconds, 0
                for solver in arguments.solvers:
                    visited, elapsed = SOLVERS[solver](problem, seconds, arguments.ea4op)
                    if visited is None:
                        break
                    row[solver] = {"coverage": 100 * visited / valid, "seconds": elapsed}
                    if solver == "ea4op" and arguments.share_of_ea4op:
                        seconds = max(0.01, arguments.share_of_ea4op * elapsed)
                if visited is None:
                    failed.append(path.stem)
                    continue
                for policy in arguments.policies:
                    plan = ours(arguments.graphdrl, path, arguments.budget, policy, seconds)
                    row[policy] = {"coverage": plan["coverage"], "seconds": plan["elapsed_s"]}
                    row["bound"] = {"coverage": plan["upper_bound"], "seconds": 0}
                rows.append(row)
                if arguments.json:
                    print(json.dumps({"world": path.stem, "nodes": valid, **row}), flush=True)
        figures = [
            f"{who} {statistics.mean(row[who]['coverage'] for row in rows):.2f} "
            f"({statistics.mean(row[who]['seconds'] for row in rows):.3f} s)"
            for who in (rows[0] if rows else ())
        ]
        without = f" (without {', '.join(failed)}, where a solver crashed)" if failed else ""
        print(f"{family}, {len(rows)} worlds{without}: " + ", ".join(figures), flush=True)


if __name__ == "__main__":
    main()
