"""The server of `report --watch`, asked as nobody should ask it."""

import concurrent.futures
import contextlib
import functools
import http.client
import json
import os
import re
import resource
import signal
import socket
import subprocess
import time

import pytest

from conftest import BIN

PATIENCE = 60  # seconds: who waits so long has failed


@contextlib.contextmanager
def serving(*arguments, **options):
    """Serves a report at a free port; gives process and port."""
    command = [BIN / "graphdrl", "report", "--watch", *map(str, arguments)]
    if "--port" not in arguments:
        command += ["--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, **options) as process:
        try:
            yield process, int(re.search(r"http://127\.0\.0\.1:(\d+)/", process.stdout.readline())[1])
        finally:
            process.kill()


@pytest.fixture
def run_folder(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "metrics.jsonl").write_text('{"episode": 1, "coverage": 5}\n')
    return folder


@pytest.fixture
def port(run_folder):
    with serving(run_folder) as (_, number):
        yield number


def connect(port):
    return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)


def get(port, path="/data.json", connection=None):
    """Gives status and text; over a connection that is kept, or a new one."""
    asked = connection or http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
    asked.request("GET", path)
    answer = asked.getresponse()
    text = answer.read().decode()
    if connection is None:
        asked.close()
    return answer.status, text


def say(port, request):
    """Sends bytes and an end; gives all that the server says until it closes."""
    with connect(port) as client:
        client.sendall(request)
        client.shutdown(socket.SHUT_WR)
        return b"".join(iter(lambda: client.recv(1 << 16), b""))


def ask_many(port, requests, askers):
    """Many requests by several at once, every other one over a connection that is kept."""

    def ask(_):
        kept = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
        for i in range(requests // askers):
            assert get(port, connection=kept if i % 2 else None)[0] == 200
        kept.close()

    with concurrent.futures.ThreadPoolExecutor(askers) as pool:
        list(pool.map(ask, range(askers)))


@pytest.mark.parametrize("idle, requests", [(50, 300), (500, 100)])
def test_idle_and_slow_connections_block_nobody(port, run_folder, idle, requests):
    with contextlib.ExitStack() as stack:
        silent = [stack.enter_context(connect(port)) for _ in range(idle)]
        slow = [stack.enter_context(connect(port)) for _ in range(20)]
        for client in slow:
            client.sendall(b"GET /data.json HTTP/1.1\r\nHost: local")
        for client in (stack.enter_context(connect(port)) for _ in range(20)):  # they never read
            client.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n" * 100)
        with (run_folder / "metrics.jsonl").open("a") as metrics:
            metrics.write('{"episode": 2, "coverage": 6}\n')
        ask_many(port, requests, 4)
        # A slow one that goes on is answered, since it began within the limit of connections.
        slow[-1].sendall(b"host\r\nConnection: close\r\n\r\n")
        assert slow[-1].makefile("rb").read().startswith(b"HTTP/1.1 200 OK\r\n")
        if idle > 256:
            assert silent[0].recv(1) == b""  # the longest idle one made way


def test_what_a_request_may_be(port):
    local = " HTTP/1.1\r\nHost: localhost\r\n"
    for request, status in (
        ("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", 200),
        ("GET /?x HTTP/1.1\r\nHost: localhost:80\r\n\r\n", 200),
        ("HEAD / HTTP/1.1\r\nHost: [::1]\r\n\r\n", 200),
        ("GET / HTTP/1.1\r\nHost: another.example\r\n\r\n", 403),
        (f"GET /{local}Origin: http://another.example\r\n\r\n", 403),
        (f"GET /etc/passwd{local}\r\n", 404),
        (f"GET /../{local}\r\n", 404),
        (f"POST /{local}Content-Length: 2\r\n\r\nab", 405),
        (f"PUT /data.json{local}\r\n", 405),
        (f"GET /{local}Content-Length: 1048577\r\n\r\n", 413),
        (f"GET /{local}Cookie: {'a' * 17_000}\r\n\r\n", 431),
        (f"GET /{'a' * 1_000_000}{local}\r\n", 431),
        ("GET / HTTP/1.1\r\nHo", 400),
        ("\x16\x03\x01\x02\x00\x01\x00\r\n\r\n", 400),
        ("\n" * 100, 400),
    ):
        try:
            assert int(say(port, request.encode()).split()[1]) == status, request[:100]
        except (BrokenPipeError, ConnectionResetError):
            assert status == 431  # said, and not heard by who goes on sending
        assert get(port)[0] == 200


def test_garbage_of_every_kind_leaves_the_server_well(port):
    request = b"POST /data.json HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n0\r\n\r\n"
    for end in range(len(request)):
        assert say(port, request[:end])[:12] in (b"", b"HTTP/1.1 400", b"HTTP/1.1 405")
        spoilt = request[:end] + bytes([request[end] ^ 0xFF]) + request[end + 1 :]
        assert say(port, spoilt)[:10] == b"HTTP/1.1 4"
    assert get(port)[0] == 200


def test_the_page_follows_its_inputs(run_folder):
    """Also where neither size nor time of writing tells a change; errors in between are told."""
    metrics = run_folder / "metrics.jsonl"
    with serving(run_folder) as (process, port):

        def wait_for(status, text):
            end = time.monotonic() + PATIENCE
            while True:
                answer = get(port)
                if answer[0] == status and text in answer[1]:
                    return answer[1]
                assert time.monotonic() < end, answer
                time.sleep(0.05)

        metrics.write_text('{"episode": 1, "coverage": 6}\n')
        stamp = metrics.stat().st_mtime_ns
        assert json.loads(wait_for(200, '"coverage":6'))["runs"][0]["lines"] == [{"coverage": 6, "episode": 1}]
        metrics.write_text('{"episode": 1, "coverage": 9}\n')
        os.utime(metrics, ns=(stamp, stamp))
        wait_for(200, '"coverage":9')
        metrics.write_text("[]\n")
        assert wait_for(500, "metrics.jsonl:1: bad line of metrics").count("\n") == 0
        metrics.unlink()
        wait_for(500, "metrics.jsonl: cannot read the file")
        assert get(port, "/")[0] == 500
        metrics.write_text('{"episode": 1, "coverage": 3}\n')
        wait_for(200, '"coverage":3')
        assert process.poll() is None


def test_the_page_is_not_made_again_without_need(port):
    """Every making of the page has another nonce."""
    pages = []
    end = time.monotonic() + PATIENCE
    while len(pages) < 4 or len(set(pages[-4:])) > 1:  # over more than a second
        assert time.monotonic() < end, "made again and again"
        pages.append(get(port, "/"))
        time.sleep(0.5)


def test_a_plan_of_a_graph_is_shown_again_after_a_change(tmp_path, run_folder):
    (tmp_path / "graph.tgf").write_text("1\n2\n3\n#\n1 2\n2 3\n")
    (tmp_path / "walk.csv").write_text("1 2\n")
    with serving(tmp_path / "walk.csv", run_folder, "--map", tmp_path / "graph.tgf") as (_, port):
        before = json.loads(get(port)[1])
        (tmp_path / "walk.csv").write_text("1 2 3\n")
        end = time.monotonic() + PATIENCE
        while (after := json.loads(get(port)[1])) == before:
            assert time.monotonic() < end
            time.sleep(0.05)
    assert [replay["plans"][0]["walk"] for replay in before["replays"] + after["replays"]] == [[0, 1], [0, 1, 2]]
    assert after["replays"][0]["world"] == before["replays"][0]["world"]
    assert after["runs"] == before["runs"]


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_and_frees_the_port(run_folder, run, ending):
    with serving(run_folder) as (process, port), connect(port) as idle:
        assert get(port)[0] == 200
        taken = run("graphdrl", "report", "--watch", run_folder, "--port", port)
        assert taken.returncode == 2 and "--port: the port cannot be used" in taken.stderr
        process.send_signal(ending)
        assert process.wait(PATIENCE) == -ending
        with contextlib.suppress(ConnectionResetError):
            assert idle.recv(1) == b""
    with serving(run_folder, "--port", port) as (_, again):
        assert again == port


def test_it_goes_on_with_few_descriptors(run_folder):
    few = functools.partial(resource.setrlimit, resource.RLIMIT_NOFILE, (40, 40))
    with serving(run_folder, preexec_fn=few) as (_, port), contextlib.ExitStack() as stack:
        for _ in range(100):
            stack.enter_context(connect(port))
        for _ in range(20):
            assert get(port)[0] == 200
