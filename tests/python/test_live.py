"""`graphdrl explore --live`: a client and the program, line by line."""

import http.client
import json
import random
import re
import signal
import subprocess

import graphdrl
import numpy
import pytest

from conftest import BIN, ROOT


def conversation(lines, *options):
    """What the program answers to these lines."""
    process = subprocess.run(
        [BIN / "graphdrl", "explore", "--live", *options],
        input="".join(line + "\n" for line in lines), capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert process.returncode == 0, process.stderr
    return process.stdout.splitlines(), process.stderr


def refusal(*arguments):
    """The one line in which the program refuses its arguments."""
    process = subprocess.run(
        [BIN / "graphdrl", *map(str, arguments)], input="", capture_output=True, text=True, timeout=60, check=False
    )
    assert process.returncode == 2 and process.stdout == "" and process.stderr.count("\n") == 1, process.stderr
    return process.stderr


class Client:
    """A machine of seven states, and the program that explores it."""

    def __init__(self, *options):
        self.process = subprocess.Popen(
            [BIN / "graphdrl", "explore", "--live", *map(str, options)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip

    def ask(self, message):
        print(json.dumps(message), file=self.process.stdin, flush=True)
        return json.loads(self.process.stdout.readline())

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def close(self):
        out, _ = self.process.communicate(timeout=60)
        return [json.loads(line) for line in out.splitlines()]


def outcome(state, answer):
    """Where a step leads in a machine of seven states."""
    if "reset" in answer:
        return "s0"
    return f"s{(3 * int(state[1:]) + ord(answer['move'])) % 7}"


def test_the_page_shows_conversations_as_they_are():
    text = (ROOT / "docs" / "live.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```text\n(.*?)```", text, re.DOTALL)
    assert len(blocks) == 3
    for block in blocks:
        lines = block.replace("\n  ", "").splitlines()
        answers, _ = conversation([line[2:] for line in lines if line.startswith(">")])
        assert answers[: len(lines) // 2] == [line[2:] for line in lines if line.startswith("<")]


def test_a_killed_exploration_goes_on_as_one_that_was_not(tmp_path):
    rng = random.Random(3)
    options = ["--cover", "edges", "--reset-cost", "2", "--transcript"]

    def drive(name, kills=()):
        file = tmp_path / f"{name}.jsonl"
        client, state, log = Client(*options, file), "s0", []
        for turn in range(200):
            message = {"id": turn, "state": state, "moves": ["a", "b", "c", "d"]}
            answer = client.ask(message)
            if turn in kills:
                client.kill()
                client = Client(*options, file, "--resume")
                assert client.ask(message) == answer  # the client may not have had it
            log.append(answer)
            if "done" in answer:
                break
            state = outcome(state, answer)
        rest = client.close()
        assert rest == []
        return log, file.read_bytes()

    whole = drive("whole")
    for name in "abc":
        assert drive(name, rng.sample(range(len(whole[0]) - 1), 7)) == whole


def test_the_discovered_map_is_a_map(run, tmp_path):
    files = [tmp_path / name for name in ("map.graphml", "map.dot", "map.json", "walk.html", "walk.svg")]
    client = Client("--cover", "edges", *[part for file in files for part in ("--out", file)])
    state, answer = "s0", client.ask({"state": "s0", "moves": ["a", "b"]})
    while "done" not in answer:
        state = outcome(state, answer)
        answer = client.ask({"state": state, "moves": ["a", "b"]})
    client.close()
    for file in files[:3]:
        about = json.loads(run("graphdrl", "maps", "info", file, "--json").stdout)
        assert about["nodes"] == 7 and about["directed"]
    assert "s3" in files[3].read_text(encoding="utf-8")


def test_a_transcript_is_a_replay(run, tmp_path):
    file = tmp_path / "door.jsonl"
    client = Client("--cover", "edges", "--transcript", file)
    state, answer = "s0", client.ask({"state": "s0", "moves": ["a", "b"]})
    while "done" not in answer:
        state = outcome(state, answer)
        answer = client.ask({"state": state, "moves": ["a", "b"]})
    client.close()
    before = file.read_bytes()
    assert run("graphdrl", "report", file, "-o", tmp_path / "page.html").returncode == 0
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert '"s6"' in page and '"policy":"novelty"' in page
    assert file.read_bytes() == before


def test_what_is_wrong_gets_one_line(tmp_path):
    answers, _ = conversation(["", "nonsense", '{"state":"a","cost":NaN}', '{"id":1,"state":"a","moves":["x"]}'])
    assert [list(json.loads(line)) for line in answers[:2]] == [["error"], ["error"]]
    assert json.loads(answers[2]) == {"id": 1, "move": "x"}
    assert "reset-cost" in refusal("explore", "--live", "--reset-cost", "-1")
    assert "--live" in refusal("explore", "--live", "paper:a")
    assert "--live" in refusal("explore", "--live", "--robot-radius", "1")
    assert "a budget in units of cost" in refusal("explore", "--live", "--budget", "1.1x")
    assert "anywhere or start" in refusal("explore", "--live", "--end", "7")
    assert "no such policy" in refusal("explore", "--live", "--policy", "best")
    assert "--transcript" in refusal("explore", "--live", "--sync")
    assert "map is required" in refusal("explore", "--cover", "edges")
    assert "map" in refusal("explore")
    taken = tmp_path / "taken"
    taken.write_text("there\n", encoding="utf-8")
    assert "--resume" in refusal("explore", "--live", "--transcript", taken)
    assert "no transcript" in refusal("explore", "--live", "--transcript", taken, "--resume")
    assert "none" in refusal("explore", "--live", "--transcript", tmp_path / "none", "--resume")
    assert taken.read_text(encoding="utf-8") == "there\n"


def test_long_lines_are_skipped():
    long = '{"state":"' + "x" * (65 << 20) + '"}'
    answers, _ = conversation([long, '{"state":"a","moves":[]}'])
    assert "64 MiB" in json.loads(answers[0])["error"]
    assert json.loads(answers[1])["done"] == "covered"


@pytest.mark.parametrize("policy", ["novelty", "nearest", "explorer", "search:200"])
def test_a_budget_holds_and_the_walk_comes_home(policy):
    client = Client("--budget", "15", "--end", "start", "--reset-cost", "1", "--policy", policy)
    state, spent, answer = "s0", 0, client.ask({"state": "s0", "moves": ["a", "b", "c"]})
    while "done" not in answer:
        state, spent = outcome(state, answer), spent + 1
        answer = client.ask({"state": state, "moves": ["a", "b", "c"]})
    assert state == "s0" and spent <= 15 and answer["report"]["cost"] == spent
    client.close()


def test_python_walks_as_the_program(tmp_path):
    options = {"cover": "edges", "reset_cost": 2.0, "seed": 3, "policy": "nearest"}
    live = graphdrl.LiveExploration(**options, transcript=tmp_path / "t.jsonl")
    client = Client("--cover", "edges", "--reset-cost", "2", "--seed", "3", "--policy", "nearest")
    state, moves = "s0", ["a", ("b", "s0"), graphdrl.Move("c", cost=2.5)]
    while True:
        message = {"state": state, "moves": ["a", {"move": "b", "to": "s0"}, {"move": "c", "cost": 2.5}]}
        answer = client.ask(message)
        live.observe(state, moves)
        step = live.next()
        assert answer.get("expects") == step.expects
        assert (answer.get("move"), answer.get("reset", False), answer.get("done")) == step[:3]
        if step.done:
            break
        state = outcome(state, answer)
    client.close()
    assert live.report() == answer["report"]
    assert set(live.world().nodes) == {f"s{i}" for i in range(7)} and live.plan().visited == 7
    live.save(tmp_path / "map.graphml")
    assert graphdrl.World.from_file(tmp_path / "map.graphml").node_count == 7
    again = graphdrl.LiveExploration(transcript=tmp_path / "t.jsonl", resume=True)
    assert again.report() == live.report() and again.next() == live.next()


CORRIDOR = [[100, 100, 100, 100, 100], [0, 0, 0, -1, -1], [100, 100, 100, 100, 100]]  # rows from the bottom


def test_python_goes_through_cells_as_the_program(tmp_path):
    live = graphdrl.LiveExploration(end="start", transcript=tmp_path / "t.jsonl")
    client = Client("--end", "start")
    rest = [[100, 100, 100], [-1, 0, 100], [100, 100, 100]]
    walls = {"origin": [-0.5, 0], "resolution": 0.5, "width": 1, "height": 3, "data": [100, 100, 100]}
    assert client.ask({"at": [0.1, 0.6], "cells": walls})["done"] == "covered"  # nothing is known beside it
    live.observe_cells((0.1, 0.6), graphdrl.Cells([[100]] * 3, (-0.5, 0), 0.5))
    for rows, x in ((CORRIDOR, 0), (rest, 1)):
        cells = {"origin": [x, 0], "resolution": 0.5, "width": len(rows[0]), "height": 3, "data": sum(rows, [])}
        at = [x + 0.1, 0.6]
        answer = client.ask({"at": at, "cells": cells})
        live.observe_cells(at, graphdrl.Cells(numpy.array(rows), (x, 0), 0.5))
        assert answer["goto"] == [list(point) for point in live.next().goto]
    assert live.next() == graphdrl.Step(goto=((0.75, 0.75), (0.25, 0.75)))  # all is seen: home
    answer = client.ask({"at": [0.25, 0.75]})
    live.observe_cells([0.25, 0.75])
    assert answer["done"] == live.next().done == "covered"
    assert answer["report"] == live.report()
    assert live.report() == {
        "steps": 2, "cost": 2.0, "at": [0.25, 0.75], "seen": 4, "visited": 3, "left": 0, "changed": 0, "failed": [],
    }  # fmt: skip
    client.close()
    for name in ("map.txt", "map.pgm", "map.json", "map.graphml", "map.map"):
        live.save(tmp_path / name)
        assert graphdrl.World.from_file(tmp_path / name).node_count in (4, 18)
    live.save(tmp_path / "walk.html")
    assert live.world().shape == (3, 6) and live.plan().visited == 3
    again = graphdrl.LiveExploration(transcript=tmp_path / "t.jsonl", resume=True)
    assert again.report() == live.report() and again.next() == live.next()


def test_python_says_what_is_wrong_with_cells():
    live = graphdrl.LiveExploration()
    for wrong, says in [
        (lambda: live.observe_cells((0, 0)), "the cells around"),
        (lambda: live.observe_cells(7, None), "x and y"),
        (lambda: live.observe_cells((0, 0), [[0]]), "Cells"),
        (lambda: live.observe_cells((0, 0), graphdrl.Cells([[0], [0, 0]], (0, 0), 1)), "rows of whole numbers"),
        (lambda: live.observe_cells((0, 0), graphdrl.Cells([[0.5]], (0, 0), 1)), "rows of whole numbers"),
        (lambda: live.observe_cells((0, 0), graphdrl.Cells([[101]], (0, 0), 1)), "from -1 to 100"),
        (lambda: live.observe_cells((0, 0), graphdrl.Cells([[100]], (0, 0), 1)), "no free cell"),
        (lambda: graphdrl.LiveExploration(connectivity=6), "4 or 8"),
        (lambda: graphdrl.LiveExploration(score="best"), "visited or seen"),
    ]:
        with pytest.raises(graphdrl.Error, match=says):
            wrong()
    live.observe_cells((0, 0), graphdrl.Cells([[0]], (0, 0), 1))
    assert live.next().done


def test_python_says_what_is_wrong(tmp_path):
    live = graphdrl.LiveExploration()
    for wrong, says in [
        (lambda: live.next(), "nothing was observed"),
        (lambda: live.observe(7), "bad state"),
        (lambda: live.observe("a", 3), "a list of moves"),
        (lambda: live.observe("a", [3]), "names or Moves"),
        (lambda: live.observe("a", ["x", "x"]), "twice"),
        (lambda: live.observe("a", cost=float("nan")), "NaN"),
        (lambda: live.observe("a", failed=True), "failed"),
        (lambda: graphdrl.LiveExploration(cover="faces"), "nodes or edges"),
        (lambda: graphdrl.LiveExploration(policy="best"), "no such policy"),
        (lambda: graphdrl.LiveExploration(budget=-1), "budget"),
        (lambda: graphdrl.LiveExploration(resume=True), "transcript"),
        (lambda: live.save(tmp_path / "map.dot"), "nothing was observed"),
    ]:
        with pytest.raises(graphdrl.Error, match=says):
            wrong()
    live.observe("a", ["x"])
    assert live.next() == graphdrl.Step(move="x")


def test_explorations_are_served(tmp_path):
    with subprocess.Popen([BIN / "graphdrl", "serve", "--port", "0"], stdout=subprocess.PIPE, text=True) as server:
        try:
            port = int(re.search(r":(\d+)/", server.stdout.readline())[1])

            def ask(method, path, message=None, headers=None):
                connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
                connection.request(method, path, None if message is None else json.dumps(message), headers or {})
                answer = connection.getresponse()
                return answer.status, answer.read().decode()

            names = []
            for _ in range(4):
                status, made = ask("POST", "/explorations", {"open": {"cover": "edges", "reset_cost": 1}})
                assert status == 201
                names.append("/explorations/" + json.loads(made)["exploration"])
            clients = [Client("--cover", "edges", "--reset-cost", "1") for _ in names]
            states, left = ["s0"] * 4, {0, 1, 2, 3}
            for turn in range(200):
                for k in sorted(left):
                    message = {"id": turn, "state": states[k], "moves": ["a", "b", "c"][: 1 + k % 3]}
                    status, answer = ask("POST", names[k], message)
                    answer = json.loads(answer)
                    assert status == 200 and answer == clients[k].ask(message)
                    if "done" in answer:
                        left.remove(k)
                    else:
                        states[k] = outcome(states[k], answer)
            assert not left
            for client in clients:
                client.close()
            assert ask("POST", names[0], {"state": ""})[0] == 400
            assert ask("POST", names[0], {"state": "x"}, {"Origin": "http://elsewhere.org"})[0] == 403
            assert ask("PUT", names[0], {"state": "x"})[0] == 405
            status, transcript = ask("GET", names[0])
            (tmp_path / "t.jsonl").write_text(transcript, encoding="utf-8")
            assert graphdrl.LiveExploration(transcript=tmp_path / "t.jsonl", resume=True).report()["states"] > 1
            assert ask("DELETE", names[0])[0] == 200 and ask("GET", names[0])[0] == 404
        finally:
            server.kill()
