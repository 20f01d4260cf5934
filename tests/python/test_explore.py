"""`graphdrl explore`, and `evaluate` on maps that are not known."""

import json

import pytest

RULES = ["nearest", "dfs", "pocket", "open", "frontier"]


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    path = tmp_path_factory.mktemp("explore") / "grid.txt"
    path.write_text("........\n.##..#..\n....##..\n.#......\n...#..#.\n........\n")
    return path


def explored(run, grid, *arguments):
    process = run("graphdrl", "explore", grid, "--json", *arguments)
    assert process.returncode == 0, process.stderr
    return json.loads(process.stdout)


@pytest.mark.parametrize("policy", RULES)
def test_a_walk_of_an_unknown_map_is_a_walk(run, grid, policy, tmp_path):
    walk = tmp_path / "walk.json"
    plan = explored(run, grid, "--policy", policy, "--budget", "30", "--end", "start", "--out", walk)
    assert plan["reveal"] == "edges" and plan["score"] == "visited"
    assert plan["walk"][0] == plan["walk"][-1] == 0 and plan["cost"] <= 30
    # Seen are the nodes next to those visited, in an order in which all that were visited come.
    assert len(plan["seen_after_step"]) == len(plan["walk"])
    assert plan["seen_after_step"][-1] == plan["seen"] == len(set(plan["seen_nodes"]))
    for step, node in enumerate(plan["walk"]):
        assert node in plan["seen_nodes"][: plan["seen_after_step"][step]]
    assert plan["upper_bound"] >= plan["coverage"]
    check = run("graphdrl", "check", grid, walk, "--budget", "30", "--end", "start", "--json")
    assert json.loads(check.stdout)["visited"] == plan["visited"]


def test_until_covered_visits_all_there_is(run, grid):
    for policy in RULES:
        plan = explored(run, grid, "--policy", policy, "--until", "covered", "--end", "start")
        assert plan["coverage"] == 100 and plan["walk"][-1] == 0


def test_the_further_it_sees_the_fewer_steps_it_takes_to_see_all(run, grid):
    costs = []
    for reveal in ("edges", "sight:2", "sight:9"):
        plan = explored(run, grid, "--reveal", reveal, "--score", "seen", "--until", "covered", "--policy", "nearest")
        assert plan["seen"] == 40
        costs.append(plan["cost"])
    assert costs[0] > costs[1] > costs[2]
    everything = explored(run, grid, "--reveal", "radius:100", "--score", "seen", "--budget", "50")
    assert everything["cost"] == 0 and everything["seen"] == 40


def test_planners_plan_on_what_is_known(run, grid):
    for policy in ("search:50", "beam:4", "explorer", "exact"):
        plan = explored(run, grid, "--policy", policy, "--budget", "20", "--end", "start")
        assert plan["walk"][-1] == 0 and 0 < plan["visited"] < 40


def test_evaluate_tells_the_price_of_ignorance(run, grid, tmp_path):
    made = run("graphdrl", "maps", "generate", "maze", "--size", "7", "--count", "3", "--out", tmp_path / "mazes")
    assert made.returncode == 0
    process = run(
        *["graphdrl", "evaluate", "--maps", grid, "--maps", tmp_path / "mazes", "--reveal", "edges"],
        *["--budget", "1.0x", "--episodes", "4", "--price", "0.05", "--json"],
    )
    assert process.returncode == 0, process.stderr
    document = json.loads(process.stdout)
    assert [row["family"] for row in document["families"][:2]] == [str(grid), str(tmp_path / "mazes")]
    assert [row["maps"] for row in document["families"][:2]] == [1, 3]
    for row in document["families"]:
        assert row["coverage"]["mean"] <= row["known"]["mean"] + 1e-9
        assert row["price_of_ignorance"]["mean"] >= 1
    text = run(
        *["graphdrl", "evaluate", "--maps", tmp_path / "mazes", "--reveal", "edges", "--policy", "nearest"],
        *["--budget", "1.0x", "--episodes", "2"],
    ).stdout
    assert "of unknown maps that reveal edges" in text and "price of ignorance" in text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--reveal", "radius:0", "--budget", "9"], "bad reveal"),
        (["--reveal", "radius:nan", "--budget", "9"], "bad reveal"),
        (["--reveal", "sight", "--budget", "9"], "bad reveal"),
        (["--budget", "9", "--until", "covered"], "--until"),
        (["--budget", "9", "--score", "both"], "--score"),
        (["--budget", "9", "--think-time", "0"], "--think-time"),
        ([], "no budget"),
    ],
)
def test_bad_input(run, grid, arguments, words):
    process = run("graphdrl", "explore", grid, *arguments)
    assert process.returncode == 2 and words in process.stderr
    assert len(process.stderr.splitlines()) == 1, process.stderr


def test_sight_needs_cells(run, tmp_path):
    path = tmp_path / "path.edges"
    path.write_text("a b\nb c\n")
    process = run("graphdrl", "explore", path, "--reveal", "sight:3", "--budget", "9")
    assert process.returncode == 2 and "sight needs a map of cells" in process.stderr
