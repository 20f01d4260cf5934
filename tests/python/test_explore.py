"""`graphdrl explore`, and `evaluate` on maps that are not known."""

import json

import pytest

RULES = ["nearest", "dfs", "pocket", "open", "frontier", "tour"]


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


def test_the_default_is_a_tour_where_what_is_seen_from_afar_counts(run, grid, tmp_path):
    assert explored(run, grid, "--budget", "5", "--reveal", "sight:3", "--score", "seen")["policy"] == "tour"
    assert explored(run, grid, "--budget", "5", "--reveal", "radius:3", "--score", "seen")["policy"] == "tour"
    assert explored(run, grid, "--budget", "5", "--reveal", "sight:3")["policy"] == "explorer"
    assert explored(run, grid, "--budget", "5", "--score", "seen")["policy"] == "explorer"
    graph = tmp_path / "graph.txt"
    graph.write_text("a b\nb c\nc d\n")
    assert explored(run, graph, "--budget", "5", "--reveal", "radius:1", "--score", "seen")["policy"] == "explorer"


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


def test_evaluate_until_covered_compares_costs(run, grid, tmp_path):
    arguments = ["graphdrl", "evaluate", "--maps", grid, "--reveal", "edges", "--until", "covered", "--end", "start"]
    arguments += ["--start", "2,0", "--episodes", "3", "--price", "0.2", "--json"]
    document = json.loads(run(*arguments).stdout)
    nearest = next(row for row in document["families"] if row["policy"] == "nearest")
    walk = explored(run, grid, "--policy", "nearest", "--until", "covered", "--start", "2,0", "--end", "start")
    assert nearest["cost"]["mean"] == walk["cost"]  # cells have no numbers to hide: each episode is the same
    asked = ["--budget", "inf", "--start", "2,0", "--end", "start", "--json"]
    tour = json.loads(run("graphdrl", "plan", grid, *asked).stdout)
    # The plan need not be cheap where the budget pays for everything; the tour is.
    assert tour["visited"] == 40 and nearest["known"]["mean"] < tour["cost"]
    assert nearest["price_of_ignorance"]["mean"] == pytest.approx(walk["cost"] / nearest["known"]["mean"])
    text = run(*arguments[:-1]).stdout
    assert text.startswith("Cost until nothing is left that is known") and "3 episodes per map from '2,0'" in text
    for wrong in (["--reveal", "all"], ["--policy", "random-walk"], ["--all-starts"], ["--budget", "9"]):
        process = run(*arguments, *wrong)
        assert process.returncode == 2 and len(process.stderr.splitlines()) == 1, process.stderr


def test_small_worlds_have_their_optimum_beside_them(run, tmp_path):
    path = tmp_path / "small.txt"
    path.write_text("....\n.#..\n....\n")
    process = run("graphdrl", "evaluate", "--maps", path, "--reveal", "edges", "--budget", "9", "--json")
    for row in json.loads(process.stdout)["families"]:
        assert row["known"]["mean"] >= row["coverage"]["mean"] and row["price_of_ignorance"]["mean"] >= 1


def test_what_is_known_of_some_maps_of_a_family_is_not_known_of_the_family(run, tmp_path):
    (tmp_path / "a.txt").write_text("....\n.#..\n....\n")
    (tmp_path / "b.txt").write_text("......\n" * 6)
    process = run("graphdrl", "evaluate", "--maps", tmp_path, "--reveal", "edges", "--budget", "9", "--json")
    document = json.loads(process.stdout)
    assert all(row["known"] is None and row["coverage"]["mean"] > 0 for row in document["families"])
    assert [row["known"] is None for row in document["rows"][:2]] == [False, True]


def test_planners_look_as_far_as_the_nearest_thing_worth_a_visit(run, tmp_path):
    # A ring of arcs: to enter the next node is to go all the way round.
    ring = tmp_path / "ring.edges"
    ring.write_text("".join(f"{i} {(i + 1) % 11}\n" for i in range(11)))
    arguments = ["--directed", "--reveal", "radius:20", "--until", "covered", "--end", "start", "--policy", "search:50"]
    assert explored(run, ring, *arguments)["visited"] == 11
    far = tmp_path / "far.graphml"
    nodes = "".join(f'<node id="n{i}"><data key="p">{10 if i == 5 else 0}</data></node>' for i in range(6))
    edges = "".join(f'<edge source="n{i}" target="n{i + 1}"/>' for i in range(5))
    far.write_text(
        '<graphml><key id="p" for="node" attr.name="prize" attr.type="int"/><graph edgedefault="undirected">'
        f"{nodes}{edges}</graph></graphml>"
    )
    assert explored(run, far, "--reveal", "radius:9", "--budget", "9", "--policy", "search:50")["prize"] == 10


def test_the_price_of_ignorance_of_one_walk(run, grid):
    covered = explored(run, grid, "--until", "covered", "--end", "start", "--price", "0.2")
    assert covered["known"]["visited"] == 40
    assert covered["price_of_ignorance"] == pytest.approx(covered["cost"] / covered["known"]["cost"])
    plan = explored(run, grid, "--budget", "30", "--price", "0.2")
    assert plan["price_of_ignorance"] == pytest.approx(plan["known"]["visited"] / plan["visited"])
    text = run("graphdrl", "explore", grid, "--budget", "30", "--price", "0.2").stdout
    assert "a walk that knows the map visits 31 for 30: the price of ignorance is" in text


def test_it_says_what_was_left_for_want_of_a_way_back(run, tmp_path):
    path = tmp_path / "arcs.edges"
    path.write_text("a b\nb a\nb c\n")
    arguments = ["graphdrl", "explore", path, "--directed", "--until", "covered", "--end", "start"]
    process = run(*arguments)
    assert process.returncode == 0, process.stderr
    assert process.stdout.count("1 node was not entered: no way back is known") == 1
    assert json.loads(run(*arguments, "--json").stdout)["no_way_back"] == 1


def test_an_old_map_is_a_guess(run, grid, tmp_path):
    old = tmp_path / "old.txt"
    old.write_text(grid.read_text().replace("##..#", ".#..#"))
    plan = explored(run, grid, "--believed", old, "--budget", "39", "--price", "0.2")
    assert plan["policy"].startswith("search") and plan["visited"] > explored(run, grid, "--budget", "39")["visited"]
    process = run(
        *["graphdrl", "evaluate", "--maps", grid, "--believed", old, "--reveal", "edges", "--budget", "39", "--json"],
        *["--policy", "search:500", "--policy", "nearest", "--episodes", "5"],
    )
    search, nearest = json.loads(process.stdout)["families"]
    assert search["coverage"]["mean"] > nearest["coverage"]["mean"]
    wide = tmp_path / "wide.txt"
    wide.write_text("..........\n")
    for arguments, words in (
        (["--believed", wide], "the believed map is of another kind"),
        (["--believed", old, "--policy", "pocket"], "does not plan on an old map"),
        (["--believed", old, "--end", "start"], "ways back must be known"),
        (["--believed", old, "--score", "seen"], "an old map goes with the score visited"),
        (["--price", "1", "--time-limit", "1"], "--time-limit"),
        (["--price", "1", "--score", "seen"], "the price of ignorance"),
        (["--policy", ""], "policy"),
        (["--believed", old, "--reveal", "all"], "an old map goes with a map that is not known"),
    ):
        process = run("graphdrl", "explore", grid, "--budget", "9", *arguments)
        assert process.returncode == 2 and words in process.stderr and len(process.stderr.splitlines()) == 1


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
