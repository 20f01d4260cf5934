"""The report page in a real browser."""

import copy
import functools
import http.server
import json
import re
import subprocess
import threading
import time
import urllib.error
import urllib.request

import pytest
from conftest import PROGRAM, Page
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys


def visited_after(plan, step):
    return len(set(plan["walk"][: step + 1]))


def step_at(plan, cost):
    return max(step for step, spent in enumerate(plan["costs"]) if spent <= cost + 1e-9)


def number(text):
    return float(re.sub(r"[^0-9.eE-]", "", text))


def expect_numbers(page, world, plan, step, pane=0):
    shown = page.numbers(pane)
    assert number(shown["step"]) == step
    assert number(shown["visited"]) == visited_after(plan, step)
    assert shown["coverage"] == f"{100 * visited_after(plan, step) / world['valid']:.1f} %"
    assert number(shown["cost"]) == pytest.approx(plan["costs"][step], abs=0.006)
    if world["prizes"]:
        prize = sum(world["prizes"][node] for node in set(plan["walk"][: step + 1]))
        assert number(shown["prize"]) == pytest.approx(prize)


def wait_until(condition, seconds=10):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return
        time.sleep(0.05)
    raise AssertionError("this did not happen in time")


def one_replay(sample, index=0, plans=None):
    replay = copy.deepcopy(sample["replays"][index])
    if plans:
        replay["plans"] = [plan for plan in replay["plans"] if plan["policy"] in plans]
    return {"version": 1, "title": "One", "watch": False, "replays": [replay], "runs": [], "evaluations": []}


# --- Opening -----------------------------------------------------------------------------------------------------


def test_opens_from_disk_without_network_or_complaint(show, sample):
    page = show(sample)
    page.click("to-end")
    page.settle()
    assert page.complaints() == []
    assert page.problems() == []
    assert [url for url in page.requests() if not url.startswith("file:")] == []
    assert page.text("h1") == sample["title"]
    assert page.texts("nav a") == ["Replays", "Runs", "Evaluations"]


def test_the_policy_forbids_the_network(show, sample):
    page = show(sample)
    refused = page.driver.execute_async_script(
        "const done = arguments[0]; fetch('https://example.org/').then(() => done(false), () => done(true));"
    )
    assert refused
    assert any("Content Security Policy" in message for message in page.complaints())


def test_sections_without_data_are_left_out(show, sample):
    page = show(sample | {"runs": [], "evaluations": []})
    hidden = page.js("return ['replays', 'runs', 'evaluations'].map((id) => document.getElementById(id).hidden)")
    assert hidden == [False, True, True]
    assert page.js("return document.getElementById('contents').hidden")


def test_an_empty_report_says_so(show):
    page = show({"version": 1, "title": "Empty", "watch": False, "replays": [], "runs": [], "evaluations": []})
    assert page.problems() == ["There is nothing in this report."]
    assert page.complaints() == []


# --- Replays -----------------------------------------------------------------------------------------------------


def test_buttons_move_through_the_walk(show, sample):
    data = one_replay(sample, plans=["search"])
    world, plan = data["replays"][0]["world"], data["replays"][0]["plans"][0]
    last = len(plan["walk"]) - 1
    page = show(data)
    expect_numbers(page, world, plan, 0)
    for name, step in (
        ("step-forward", 1),
        ("step-forward", 2),
        ("step-back", 1),
        ("to-end", last),
        ("step-forward", last),
        ("to-begin", 0),
        ("step-back", 0),
    ):
        page.click(name)
        expect_numbers(page, world, plan, step)


def test_every_step_shows_the_walks_own_numbers(show, sample):
    for index, replay in enumerate(sample["replays"][:5]):
        for plan in replay["plans"][:2]:
            page = show(one_replay(sample, index, [plan["policy"]]))
            for step in range(0, len(plan["walk"]), max(1, len(plan["walk"]) // 25)):
                page.scrub(step)
                expect_numbers(page, replay["world"], plan, step)
            page.click("to-end")
            assert number(page.numbers()["visited"]) == plan["visited"]
            assert number(page.numbers()["coverage"]) == pytest.approx(plan["coverage"], abs=0.051)
            assert number(page.numbers()["cost"]) == pytest.approx(plan["cost"], abs=0.006)


def test_keys_drive_the_replay(show, sample):
    data = one_replay(sample, plans=["search"])
    last = len(data["replays"][0]["plans"][0]["walk"]) - 1
    page = show(data)
    canvas = page.driver.find_element(By.CSS_SELECTOR, ".map")
    page.js("arguments[0].focus()", canvas)
    keys = page.driver.switch_to.active_element
    for key, step in (
        (Keys.ARROW_RIGHT, 1),
        (Keys.ARROW_RIGHT, 2),
        (Keys.ARROW_LEFT, 1),
        (Keys.END, last),
        (Keys.HOME, 0),
    ):
        keys.send_keys(key)
        assert page.tick() == step
    speed = lambda: int(page.js("return document.getElementById('speed').value"))
    before = speed()
    keys.send_keys("+")
    assert speed() == before + 1
    keys.send_keys("-")
    assert speed() == before
    keys.send_keys(" ")
    assert page.js("return document.getElementById('play').getAttribute('aria-label')") == "Pause"
    wait_until(lambda: page.tick() >= 2)
    keys.send_keys(" ")
    assert page.js("return document.getElementById('play').getAttribute('aria-label')") == "Play"


def test_keys_work_on_the_scrubber(show, sample):
    page = show(one_replay(sample, plans=["search"]))
    scrubber = page.driver.find_element(By.ID, "scrubber")
    scrubber.send_keys(Keys.ARROW_RIGHT)
    scrubber.send_keys(Keys.ARROW_RIGHT)
    assert page.numbers()["step"] == "2"
    scrubber.send_keys(Keys.END)
    assert page.tick() == int(scrubber.get_attribute("max"))


def test_playing_ends_at_the_end_and_begins_anew(show, sample):
    page = show(one_replay(sample, plans=["search"]))
    page.choose("speed", "100 steps/s")
    page.click("play")
    wait_until(lambda: page.js("return document.getElementById('play').getAttribute('aria-label')") == "Play")
    assert page.tick() == int(page.js("return document.getElementById('scrubber').max"))
    page.choose("speed", "1 step/s")
    page.click("play")
    assert page.tick() < 2


def test_two_plans_share_the_cost(show, sample):
    index = 3  # with costs that are no whole numbers
    replay = sample["replays"][index]
    plans = replay["plans"][:2]
    page = show(one_replay(sample, index, [plan["policy"] for plan in plans]))
    assert len(page.texts(".pane")) == 2
    events = sorted({round(cost, 6) for plan in plans for cost in plan["costs"]})
    assert int(page.js("return document.getElementById('scrubber').max")) == len(events) - 1
    for tick, cost in enumerate(events):
        page.scrub(tick)
        for pane, plan in enumerate(plans):
            expect_numbers(page, replay["world"], plan, step_at(plan, cost), pane)


def test_without_costs_every_step_costs_one(show, sample):
    data = one_replay(sample, 1)
    plans = copy.deepcopy(data["replays"][0]["plans"])
    for plan in data["replays"][0]["plans"]:
        del plan["costs"], plan["budget"]
    page = show(data)
    page.scrub(40)
    expect_numbers(page, data["replays"][0]["world"], plans[0], 40)
    assert page.text(".number-cost + small") == f"of {data['replays'][0]['budget']:g}"


def test_plans_are_chosen(show, sample):
    page = show(sample)
    policies = [plan["policy"] for plan in sample["replays"][0]["plans"]]
    assert page.texts(".pane-name") == policies[:2]
    page.choose("plan-0", policies[2])
    page.choose("plan-1", policies[3])
    assert page.texts(".pane-name") == policies[2:4]
    page.choose("plan-1", "none")
    assert page.texts(".pane-name") == policies[2:3]
    page.choose("replay", sample["replays"][1]["title"])
    assert page.texts(".pane-name") == [plan["policy"] for plan in sample["replays"][1]["plans"][:2]]


def test_scores_are_listed_best_first(show, sample):
    plan = sample["replays"][0]["plans"][0]
    page = show(one_replay(sample, plans=[plan["policy"]]))
    flat = plan["scores"][0]
    expected = sorted(zip(flat[1::2], flat[::2]))
    listed = page.js("return [...document.querySelectorAll('.scores li')].map((item) => item.children[1].textContent)")
    assert [int(re.search(r"node (\d+)", text)[1]) for text in listed] == [node for _, node in expected]
    assert [text.endswith("taken") for text in listed] == [node == plan["walk"][1] for _, node in expected]


def test_fog_lifts_where_nodes_are_seen(show, sample):
    """Cell by cell: one that has not been seen yet has another colour than without fog, the others have the same."""
    data = one_replay(sample, 5, ["pocket"])
    world, plan = data["replays"][0]["world"], data["replays"][0]["plans"][0]
    page = show(data)
    colours = lambda: page.js(
        """const [rows, cols, nodes] = arguments;
        const map = document.querySelector('.map');
        const scale = (1 - 4 / Math.max(map.width, map.height)) * Math.min(map.width / cols, map.height / rows);
        const at = (node) => [(node % cols) + 0.2 - cols / 2, Math.floor(node / cols) + 0.2 - rows / 2];
        const place = (node) => [map.width / 2 + at(node)[0] * scale, map.height / 2 + at(node)[1] * scale];
        const context = map.getContext('2d');
        return nodes.map((node) => context.getImageData(...place(node), 1, 1).data.join());""",
        world["rows"],
        world["cols"],
        sorted(set(plan["seen_nodes"])),
    )
    for step in (0, 5, len(plan["walk"]) // 2, 3):
        page.scrub(step)
        page.settle()
        assert number(page.text(".number-seen")) == plan["seen_after_step"][step]
        fogged = colours()
        page.click("fog")
        page.settle()
        clear = colours()
        page.click("fog")
        page.settle()
        assert colours() == fogged
        unseen = {node for node, one, other in zip(sorted(plan["seen_nodes"]), fogged, clear) if one != other}
        assert unseen == set(plan["seen_nodes"][plan["seen_after_step"][step] :])


def test_fog_is_offered_where_a_plan_explores(show, sample):
    page = show(sample)
    field = "return document.getElementById('fog-field').hidden"
    assert page.js(field)
    page.choose("replay", sample["replays"][6]["title"])
    assert not page.js(field)
    keys = "return ['.fog-key', '.missed-key'].map((key) => document.querySelector(key).checkVisibility())"
    assert page.js(keys) == [True, True]
    box = page.driver.find_element("id", "fog")
    box.send_keys(" ")
    assert page.js(keys) == [False, True]
    assert page.js("return document.getElementById('play').getAttribute('aria-label')") == "Play"


def test_going_back_covers_a_graph_again(show, sample):
    page = show(one_replay(sample, 6))
    picture = "return document.querySelector('.map').toDataURL()"
    begin = page.js(picture)
    page.click("to-end")
    page.click("to-begin")
    page.settle()
    assert page.js(picture) == begin
    page.click("fog")
    page.settle()
    assert page.js(picture) != begin


def test_the_map_is_drawn_and_changes(show, sample):
    for index in range(len(sample["replays"])):
        page = show(one_replay(sample, index))
        picture = "return document.querySelector('.map').toDataURL()"
        begin = page.js(picture)
        assert page.ink(".map") > 0.02
        page.click("to-end")
        page.settle()
        end = page.js(picture)
        assert end != begin
        page.click("to-begin")
        page.settle()
        assert page.js(picture) == begin
        page.click("to-end")
        page.settle()
        assert page.js(picture) == end


def test_going_back_draws_what_going_there_drew(show, large):
    page = show(large)
    picture = "return document.querySelector('.map').toDataURL()"
    last = int(page.js("return document.getElementById('scrubber').max"))
    ways = {}
    for tick in (last // 5, last // 2, last, last // 2, last // 5):
        page.scrub(tick)
        page.settle()
        drawn = page.js(picture)
        assert ways.setdefault(tick, drawn) == drawn


def test_zoom_and_movement_by_buttons_and_keys(show, sample):
    page = show(one_replay(sample, 1))
    picture = "return document.querySelector('.map').toDataURL()"
    whole = page.js(picture)
    page.driver.find_element(By.CSS_SELECTOR, ".zoom-in").click()
    time.sleep(0.3)
    page.settle()
    near = page.js(picture)
    assert near != whole
    page.js("document.querySelector('.map').focus()")
    page.driver.switch_to.active_element.send_keys(Keys.SHIFT + Keys.ARROW_RIGHT)
    time.sleep(0.3)
    page.settle()
    assert page.js(picture) != near
    page.driver.find_element(By.CSS_SELECTOR, ".zoom-fit").click()
    page.settle()
    assert page.js(picture) == whole


def test_the_progress_chart_ends_where_the_walk_ends(show, sample):
    page = show(one_replay(sample, 1))
    plans = sample["replays"][1]["plans"][:2]
    ends = page.js("""return Chart.getChart('progress').data.datasets.filter((set) => !set.bound)
        .map(({ data }) => [data.length, data[data.length - 1].x, data[data.length - 1].y]);""")
    for (count, x, y), plan in zip(ends, plans):
        assert count == len(plan["walk"])
        assert x == plan["cost"]
        assert y == pytest.approx(plan["coverage"])
    bounds = page.js(
        "return Chart.getChart('progress').data.datasets.filter((set) => set.bound).map(({ data }) => data[0].y)"
    )
    assert bounds == pytest.approx([plan["upper_bound"] for plan in plans])


def test_the_live_region_speaks_when_moving_stops(show, sample):
    page = show(one_replay(sample, plans=["search"]))
    page.choose("speed", "100 steps/s")
    page.js("""window.spoken = 0;
        new MutationObserver(() => ++window.spoken).observe(document.getElementById('said'), { childList: true });""")
    page.click("to-begin")
    page.click("play")
    time.sleep(1.5)
    assert page.js("return window.spoken") <= 2
    assert "100.0 % visited" in page.text("#said")
    assert "100.0 % visited" in page.js("return document.getElementById('scrubber').getAttribute('aria-valuetext')")


def test_little_motion_where_it_is_asked_for(show, sample):
    page = show(one_replay(sample, 1), calm=True)
    page.choose("speed", "100 steps/s")
    page.js(
        """window.seen = new Set();
        const read = () => { window.seen.add(document.getElementById('scrubber').value); requestAnimationFrame(read); };
        read();"""
    )
    page.click("play")
    time.sleep(1.6)
    assert 2 <= page.js("return window.seen.size") <= 5


def test_large_worlds_load_and_scrub(show, large):
    begin = time.monotonic()
    page = show(large)
    replay = large["replays"][0]
    plan = replay["plans"][0]
    print(f"{replay['world']['nodes']} nodes, {len(plan['walk'])} steps: shown in {time.monotonic() - begin:.2f} s")
    assert replay["world"]["valid"] >= 99_000 and len(plan["walk"]) >= 99_000
    last = int(page.js("return document.getElementById('scrubber').max"))
    for tick in (last, last // 2, last // 3, last // 3 + 1, 0):
        begin = time.monotonic()
        page.scrub(tick)
        page.settle()
        print(f"to step {tick}: {1000 * (time.monotonic() - begin):.0f} ms")
        expect_numbers(page, replay["world"], plan, step_at(plan, plan["costs"][tick]))
    assert page.complaints() == []


# --- Runs and evaluations ----------------------------------------------------------------------------------------


def test_every_metric_has_a_chart_with_every_run(show, sample):
    page = show(sample)
    metrics = {}
    for run in sample["runs"]:
        for name in {name for line in run["lines"] for name in line} - {"episode", "round", "steps", "states"}:
            metrics.setdefault(name, []).append(run["name"])
    charts = page.js("""return [...document.querySelectorAll('#runs canvas')].map((canvas) =>
        Chart.getChart(canvas).data.datasets.filter((set) => !set.raw).map((set) => set.label));""")
    assert sorted(map(sorted, charts)) == sorted(map(sorted, metrics.values()))
    loss = page.js(
        """const figures = [...document.querySelectorAll('#runs figure')];
        const box = figures.find((figure) => figure.querySelector('h3').textContent === 'loss');
        const chart = Chart.getChart(box.querySelector('canvas'));
        return [chart.options.scales.y.type, box.querySelector('input').checked];"""
    )
    assert loss == ["logarithmic", True]


def test_smoothing_and_hiding_runs(show, sample):
    page = show(sample)
    thick = "return Chart.getChart(document.querySelector('#runs canvas')).data.datasets.filter((set) => !set.raw)"
    page.js("const s = document.getElementById('smoothing'); s.value = 0; s.dispatchEvent(new Event('input'));")
    page.settle()
    first = sample["runs"][0]
    metric = next(name for name in first["lines"][0] if name not in ("episode", "steps"))
    shown = page.js(thick + "[0].data.map((point) => point.y)")
    # Long curves are thinned for drawing; both ends stay.
    assert shown[0] == pytest.approx(first["lines"][0][metric])
    assert shown[-1] == pytest.approx(first["lines"][-1][metric])
    page.driver.find_element(By.CSS_SELECTOR, "#runs .legend input").click()
    assert first["name"] not in page.js(thick + ".map((set) => set.label)")
    assert page.js("return document.activeElement.type") == "checkbox"


def test_the_tables_hold_the_evaluation(show, sample):
    page = show(sample)
    evaluation = sample["evaluations"][0]
    cells = page.js(
        """return [...document.querySelectorAll('.map-table tbody tr')]
          .map((row) => [...row.cells].map((cell) => cell.textContent))"""
    )
    assert len(cells) == len(evaluation["rows"])
    for shown, row in zip(cells, evaluation["rows"]):
        assert shown[:3] == [row["map"], row["policy"], str(row["valid_nodes"])]
        assert shown[3:6] == [f"{row[name]:.1f}" for name in ("mean", "std", "best")]
        assert shown[6] == " – ".join(f"{value:.1f}" for value in row["ci95"])
        assert shown[8:] == [f"{row['paper'][name]:.1f}" for name in ("mean", "std", "best")]
    ladder = page.js(
        """return [...document.querySelectorAll('.ladder-table tbody tr')]
          .map((row) => [...row.cells].map((cell) => cell.textContent))"""
    )
    for shown, entry in zip(ladder, evaluation["overall"]):
        assert shown[:3] == [entry["policy"], str(entry["maps"]), f"{entry['mean']:.1f}"]
        assert shown[4] == f"{100 * entry['ratio_to_optimum']:.1f} %"
    assert page.js(
        "return [...document.querySelectorAll('#evaluations canvas')].every((canvas) => Chart.getChart(canvas))"
    )
    assert page.js(
        """return [...document.querySelectorAll('table th')]
          .every((head) => head.scope === 'col' || head.scope === 'row')"""
    )


def test_one_policy_of_the_evaluation(show, sample):
    page = show(sample)
    page.js(
        """const select = document.querySelector('.policy-choice');
        select.value = 'policy:dfs';
        select.dispatchEvent(new Event('change'));"""
    )
    assert set(page.texts(".map-table tbody td:nth-child(2)")) == {"dfs"}


def test_values_that_are_missing_are_dashes(show):
    row = {"map": "m", "policy": "exact", "valid_nodes": 40, "budget": 25.0, "episodes": 1}
    row |= {"mean": None, "std": None, "best": None, "ci95": None, "optimum": None, "paper": None}
    overall = {"policy": "exact", "maps": 0, "mean": None, "ratio_to_optimum": None}
    page = show(
        {
            "version": 1,
            "title": "Missing",
            "watch": False,
            "evaluations": [{"name": "e", "rows": [row], "overall": [overall]}],
        }
    )
    assert page.texts(".map-table tbody td")[2:] == ["–"] * 5
    assert page.texts(".ladder-table tbody td") == ["0", "–", "–", "–"]
    assert page.complaints() == []


# --- Data that is wrong ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text, expected",
    [
        ("{", "it is not JSON"),
        ("[]", "its version is undefined"),
        ('{"version": 2}', "its version is 2, and this page reads version 1"),
        ('{"version": 1, "replays": 3}', '"replays" is not a list'),
    ],
)
def test_a_document_that_cannot_be_read_is_one_line(show, text, expected):
    page = show(text)
    (line,) = page.problems()
    assert expected in line


@pytest.mark.parametrize(
    "spoil, expected",
    [
        (lambda replay: replay["plans"][0]["walk"].__setitem__(1, 77), "names node 77, but the world has 25"),
        (lambda replay: replay["plans"][0]["walk"].__setitem__(1, 3), "goes over node 3, which is blocked"),
        (lambda replay: replay["plans"][0]["costs"].pop(), "does not have one cost per node"),
        (lambda replay: replay["plans"][0].__setitem__("visited", 3), "says it visits 3 nodes, but its walk visits 19"),
        (lambda replay: replay["world"].__setitem__("blocked", "%%"), "is not base64"),
        (lambda replay: replay["world"].__setitem__("rows", 4), "a grid of 4 by 5 cells does not have 25 nodes"),
        (lambda replay: replay.__setitem__("plans", []), "there is no plan"),
        (lambda replay: replay.__setitem__("world", None), "the world is missing"),
    ],
)
def test_a_replay_that_is_wrong_is_one_line_and_the_rest_stays(show, sample, spoil, expected):
    data = copy.deepcopy(sample)
    spoil(data["replays"][0])
    page = show(data)
    (line,) = page.problems()
    assert line.startswith("Replay 1: ") and expected in line
    assert page.texts(".pane-name") == [plan["policy"] for plan in sample["replays"][1]["plans"][:2]]
    assert page.complaints() == []


@pytest.mark.parametrize(
    "nodes, counts, expected",
    [
        ([0, 77], lambda steps: [2] * steps, "sees node 77, but the world has 25"),
        ([0, 1], lambda steps: [2], "does not have one count of nodes seen per node of its walk"),
        ([0, 1], lambda steps: [1] * steps, "do not fit their counts"),
        ([0, 1], lambda steps: [2, 1] + [2] * (steps - 2), "do not fit their counts"),
    ],
)
def test_nodes_seen_that_cannot_be_are_one_line(show, sample, nodes, counts, expected):
    data = one_replay(sample)
    plan = data["replays"][0]["plans"][0]
    plan |= {"seen_nodes": nodes, "seen_after_step": counts(len(plan["walk"]))}
    (line,) = show(data).problems()
    assert line.startswith("Replay 1: ") and expected in line


HOSTILE = "</script><img src=x onerror='window.hacked=1'>{{data}}<!--\u2028'\"&"


def hostile_document(sample):
    data = copy.deepcopy(sample)
    data["title"] = HOSTILE
    for replay in data["replays"]:
        replay["title"] = replay["world"]["name"] = HOSTILE
        if replay["world"]["labels"]:
            replay["world"]["labels"] = [HOSTILE] * replay["world"]["nodes"]
        for plan in replay["plans"]:
            plan["policy"] = plan["scores_name"] = HOSTILE
    for run in data["runs"]:
        run["name"] = HOSTILE
        for line in run["lines"]:
            line[HOSTILE] = 1.5
    for evaluation in data["evaluations"]:
        evaluation["name"] = HOSTILE
        for row in evaluation["rows"] + evaluation["overall"]:
            row["policy"] = HOSTILE
            row["map"] = HOSTILE
    return data


def test_hostile_text_stays_text(show, sample):
    data = hostile_document(sample)
    page = show(data)
    for replay in range(len(data["replays"])):
        page.js(
            """const select = document.getElementById('replay');
            select.value = arguments[0];
            select.dispatchEvent(new Event('change'));""",
            str(replay),
        )
        page.click("to-end")
        page.js("document.querySelectorAll('details').forEach((details) => (details.open = true))")
        page.settle()
    assert page.js("return window.hacked === undefined && document.querySelectorAll('img').length === 0")
    assert page.text("h1") == HOSTILE
    assert HOSTILE in page.texts(".pane-name")
    assert HOSTILE in page.texts("#runs th")
    assert HOSTILE in page.texts("#evaluations th")
    assert page.complaints() == []


# --- For everyone ------------------------------------------------------------------------------------------------

CONTRASTS = """
  const parse = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const over = (top, below) => [0, 1, 2].map((i) => top[i] * (top[3] ?? 1) + below[i] * (1 - (top[3] ?? 1)));
  const ground = (element) => {
    const layers = [];
    for (let at = element; at; at = at.parentElement) layers.unshift(parse(getComputedStyle(at).backgroundColor));
    return layers.reduce((below, top) => over(top, below), [255, 255, 255]);
  };
  const linear = (byte) => (byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);
  const luminance = (c) => 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement;
    if (!walker.currentNode.textContent.trim() || !element.checkVisibility()) continue;
    if (element.closest('script, style, .hidden')) continue;
    const below = ground(element);
    const [a, b] = [luminance(over(parse(getComputedStyle(element).color), below)), luminance(below)];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    found.push([ratio, element.tagName, walker.currentNode.textContent.trim().slice(0, 40)]);
  }
  return found.sort((a, b) => a[0] - b[0]);
"""


@pytest.mark.parametrize("dark", [False, True])
def test_text_has_contrast(show, sample, dark):
    data = copy.deepcopy(sample)
    data["replays"].append({"title": "wrong", "world": None, "plans": []})
    page = show(data, dark=dark)
    found = page.js(CONTRASTS)
    print("least contrasts:", found[:3])
    assert len(found) > 100
    assert found[0][0] >= 4.5


@pytest.mark.parametrize("dark", [False, True])
def test_controls_and_marks_have_contrast(show, sample, dark):
    page = show(sample, dark=dark)
    names = ["control-line", "accent", "missed", "now", "plan-0", "plan-1"]
    values = page.js(
        """const style = getComputedStyle(document.documentElement);
        return [...arguments[0], 'surface', 'free'].map((name) => style.getPropertyValue(`--${name}`).trim());""",
        names,
    )
    for name, value in zip(names, values):
        assert contrast(value, values[-2]) >= 3, name
    assert contrast(values[names.index("missed")], values[-1]) >= 3
    assert contrast(values[names.index("now")], values[-1]) >= 3


def contrast(a, b):
    def luminance(colour):
        channels = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(a), luminance(b)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("hostile", [False, True])
@pytest.mark.parametrize("width", [360, 768])
def test_no_sideways_scrolling(show, sample, width, hostile):
    page = show(hostile_document(sample) if hostile else sample, width=width, height=740)
    for replay in range(len(sample["replays"])):
        page.js(
            """const select = document.getElementById('replay');
            select.value = arguments[0];
            select.dispatchEvent(new Event('change'));""",
            str(replay),
        )
        page.settle()
        assert page.js("return document.documentElement.scrollWidth") <= width


def test_the_theme_follows_the_system_and_the_button(show, sample):
    theme = "return document.documentElement.dataset.theme"
    page = show(sample, dark=True)
    assert page.js(theme) == "dark"
    page.click("theme")
    assert page.js(theme) == "light"
    assert page.text("#theme") == "Dark theme"
    page.driver.refresh()
    assert page.js(theme) == "light"
    page.click("theme")
    assert page.js(theme) == "dark"
    assert show(sample).js(theme) == "light"


def test_headings_landmarks_and_names(show, sample):
    page = show(sample)
    levels = page.js(
        """return [...document.querySelectorAll('h1, h2, h3, h4')]
          .filter((h) => h.checkVisibility()).map((h) => Number(h.tagName[1]))"""
    )
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(after - before <= 1 for before, after in zip(levels, levels[1:]))
    for tag in ("header", "nav", "main", "footer"):
        assert page.driver.find_elements(By.TAG_NAME, tag)
    page.driver.execute_cdp_cmd("Accessibility.enable", {})
    tree = page.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
    roles = {"button", "combobox", "slider", "checkbox", "img", "image", "table", "link", "region"}
    nameless = [
        node["role"]["value"]
        for node in tree
        if not node["ignored"] and node["role"]["value"] in roles and not node["name"]["value"]
    ]
    assert nameless == []


def test_everything_can_be_reached_by_tab(show, sample):
    page = show(sample)
    wanted = page.js("""return [...document.querySelectorAll('a, button, select, input, summary, canvas[tabindex]')]
        .filter((e) => e.checkVisibility() && !e.disabled).length""")
    page.js(
        "window.reached = new Set(); document.addEventListener('focusin', (event) => window.reached.add(event.target));"
    )
    page.js("document.body.focus()")
    body = page.driver.find_element(By.TAG_NAME, "body")
    body.send_keys(Keys.TAB)
    for _ in range(wanted + 10):
        page.driver.switch_to.active_element.send_keys(Keys.TAB)
    reached = page.js(
        "return [...window.reached].filter((e) => e.matches('a, button, select, input, summary, canvas')).length"
    )
    assert reached == wanted


def test_the_map_has_a_text(show, sample):
    page = show(one_replay(sample, plans=["search"]))
    label = page.js("return document.querySelector('.map').getAttribute('aria-label')")
    assert "19 valid" in label and "visits 19 nodes, 100.0 %" in label
    page.js("document.querySelector('.walk-text').open = true")
    wait_until(lambda: page.text(".walk-text p"))
    walk = sample["replays"][0]["plans"][1]["walk"]
    assert page.text(".walk-text p").endswith("Nodes in order: " + " ".join(map(str, walk)))


# --- Watching ----------------------------------------------------------------------------------------------------


@pytest.fixture
def server(tmp_path):
    handler = functools.partial(QuietHandler, directory=str(tmp_path))
    made = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=made.serve_forever, daemon=True).start()
    yield made
    made.shutdown()
    made.server_close()


class QuietHandler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *arguments):
        pass


def test_watching(show, assemble, driver, server, sample, tmp_path):
    data = {**sample, "watch": True, "replays": sample["replays"][:2]}
    data["runs"] = [{"name": "run", "lines": sample["runs"][0]["lines"][:10]}]
    page = show(sample)  # sets the theme and the size
    (tmp_path / "index.html").write_text(assemble(json.dumps(data)), encoding="utf-8")
    (tmp_path / "data.json").write_text(json.dumps(data))
    page.requests()
    page.complaints()
    driver.get(f"http://127.0.0.1:{server.server_port}/index.html")
    assert page.text("#watch").startswith("Watching. Last updated at")
    page.choose("replay", data["replays"][1]["title"])
    page.scrub(30)
    page.js("const s = document.getElementById('smoothing'); s.value = 10; s.dispatchEvent(new Event('input'));")
    page.js("window.kept = document.getElementById('smoothing')")
    points = "return Chart.getChart(document.querySelector('#runs canvas')).data.datasets[0].data.length"
    assert page.js(points) == 10

    data["runs"][0]["lines"] = sample["runs"][0]["lines"][:40]
    (tmp_path / "data.json").write_text(json.dumps(data))
    wait_until(lambda: page.js(points) == 40)
    assert page.tick() == 30
    assert page.texts(".pane-name") == [plan["policy"] for plan in data["replays"][1]["plans"][:2]]
    assert page.js("return window.kept.isConnected && window.kept.value") == "10"

    # Another replay comes first: the one on show stays, where it was.
    data["replays"].insert(0, copy.deepcopy(sample["replays"][2]))
    (tmp_path / "data.json").write_text(json.dumps(data))
    wait_until(lambda: page.js("return document.getElementById('replay').options.length") == 3)
    assert page.tick() == 30
    assert page.js("return document.getElementById('replay').selectedOptions[0].text") == data["replays"][2]["title"]
    assert page.complaints() == []
    assert {url.split("?")[0].rsplit("/", 1)[1] for url in page.requests()} == {"index.html", "data.json"}

    # Half a document: a line says so, and what was there stays. Then it is whole again.
    (tmp_path / "data.json").write_text('{"version": 1,')
    wait_until(lambda: any("cannot be read" in line for line in page.problems()))
    assert page.tick() == 30
    (tmp_path / "data.json").write_text(json.dumps(data))
    wait_until(lambda: page.problems() == [])

    (tmp_path / "data.json").unlink()
    wait_until(lambda: page.text("#watch").startswith("The server has not answered since"))
    assert page.js("return document.getElementById('watch').classList.contains('gone')")
    (tmp_path / "data.json").write_text(json.dumps(data))
    wait_until(lambda: page.text("#watch").startswith("Watching."))


def test_watching_a_training(driver, show, sample, tmp_path):
    """The program itself serves the page, and what the run has written so far."""
    run = tmp_path / "run"
    run.mkdir()
    lines = [json.dumps(line) for line in sample["runs"][0]["lines"][:30]]
    (run / "metrics.jsonl").write_text("\n".join(lines[:20]) + "\n" + lines[20][:9])
    show(sample)  # sets the theme and the size
    command = [PROGRAM, "report", "--watch", run, "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            address = re.search(r"http://127\.0\.0\.1:\d+/", process.stdout.readline())[0]
            driver.get(address)
            points = "return Chart.getChart(document.querySelector('#runs canvas')).data.datasets[0].data.length"
            page = Page(driver)
            assert page.js(points) == 20
            page.complaints()
            (run / "metrics.jsonl").write_text("\n".join(lines) + "\n")
            wait_until(lambda: page.js(points) == 30)
            assert page.complaints() == []
            taken = subprocess.run([PROGRAM, "report", "--watch", run, "--port", address.split(":")[2][:-1]],
                                   capture_output=True, text=True, timeout=20, check=False)
            assert taken.returncode == 2 and "the port cannot be used" in taken.stderr
            request = urllib.request.Request(address + "data.json", headers={"Host": "another.example"})
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(request, timeout=20)
        finally:
            process.terminate()
