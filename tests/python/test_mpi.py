"""graphdrl-mpi: the same bytes on any number of ranks, whatever dies."""

import os
import pathlib
import re
import signal
import subprocess
import time

import pytest

BIN = pathlib.Path(os.environ["GRAPHDRL_BIN"])
FAULTS = BIN / "libgraphdrl_faults.so"
EXPLORER = "train --rounds 2 --walks 12 --updates 8 --batch-size 16 --largest 5".split()
LONGER = "train --rounds 24 --walks 12 --updates 20 --batch-size 16 --largest 5 --checkpoint-every 1".split()
ONLINE = [*EXPLORER, "--reveal", "edges"]
PAPER = "train --preset paper --episodes 2 --budget 10 --batch-size 4".split()
# Tests may be root's, on fewer processors than ranks, in a container.
ENVIRONMENT = os.environ | {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_plm_rsh_agent": "",
}


def command(ranks, *arguments):
    return ["mpirun", "--quiet", "-n", str(ranks), BIN / "graphdrl-mpi", *map(str, arguments)]


def on_ranks(ranks, *arguments, cwd, expected=0):
    done = subprocess.run(
        command(ranks, *arguments), env=ENVIRONMENT, cwd=cwd, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == expected, done.stderr
    return done


def alone(run, *arguments, cwd):
    done = run("graphdrl", *arguments, cwd=cwd)
    assert done.returncode == 0, done.stderr
    return done.stdout


def policies(folder):
    return [path.read_bytes() for path in sorted(folder.rglob("policy.safetensors"))]


TRAININGS = {"known": EXPLORER, "online": ONLINE, "seeds": [*PAPER, "--seeds", "1-4"], "paper": PAPER}


@pytest.mark.parametrize("training", TRAININGS.values(), ids=TRAININGS)
def test_trains_to_the_same_bytes(run, tmp_path, training):
    alone(run, *training, "--out", "alone", cwd=tmp_path)
    expected = policies(tmp_path / "alone")
    assert expected
    for ranks, threads in (1, 2), (2, 1), (3, 2):
        out = f"{ranks}x{threads}"
        on_ranks(ranks, *training, "--threads", threads, "--out", out, cwd=tmp_path)
        assert policies(tmp_path / out) == expected, out


def start(ranks, *arguments, cwd):
    options = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(command(ranks, *arguments), env=ENVIRONMENT, cwd=cwd, **options)


def wait_until(true):
    deadline = time.monotonic() + 60
    while not true() and time.monotonic() < deadline:
        time.sleep(0.01)


def ranks_of(job):
    """The processes that mpirun has started."""
    found = []
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            name, _, rest = stat.read_text().rpartition(")")
        except OSError:
            continue
        if int(rest.split()[1]) == job.pid and "graphdrl-mpi" in name:
            found.append(int(stat.parent.name))
    return sorted(found)


def kill_a_rank(job):
    """The last one. mpirun ends the others."""
    ranks = ranks_of(job)
    assert ranks, "the job has ended before it could be killed"
    os.kill(ranks[-1], signal.SIGKILL)
    job.communicate(timeout=60)
    return job.returncode


def lines_of(file):
    return file.read_text().count("\n") if file.exists() else 0


def test_goes_on_after_a_kill_on_another_number_of_ranks(run, tmp_path):
    alone(run, *LONGER, "--out", "alone", cwd=tmp_path)
    job = start(3, *LONGER, "--threads", 1, "--out", "killed", cwd=tmp_path)
    wait_until(lambda: lines_of(tmp_path / "killed" / "metrics.jsonl") >= 2)
    assert kill_a_rank(job) != 0
    on_ranks(2, "train", "--resume", "killed", cwd=tmp_path)
    assert policies(tmp_path / "killed") == policies(tmp_path / "alone")


def test_a_signal_ends_it_in_good_order(run, tmp_path):
    job = start(2, *LONGER, "--threads", 1, "--out", "stopped", cwd=tmp_path)
    wait_until(lambda: lines_of(tmp_path / "stopped" / "metrics.jsonl") >= 1)
    job.terminate()
    assert "everything is saved" in job.communicate(timeout=60)[1]
    alone(run, *LONGER, "--out", "alone", cwd=tmp_path)
    on_ranks(3, "train", "--resume", "stopped", cwd=tmp_path)
    assert policies(tmp_path / "stopped") == policies(tmp_path / "alone")


def test_a_sweep_does_what_is_missing(run, tmp_path):
    training = "train --preset paper --episodes 12 --budget 20 --batch-size 4 --seeds 1-8".split()
    sweep = [*training, "--out", "sweep"]
    for begun in 2, 4, 6:
        job = start(2, *sweep, "--threads", 1, cwd=tmp_path)
        wait_until(lambda begun=begun: len(policies(tmp_path / "sweep")) >= begun)
        kill_a_rank(job)
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "sweep").rglob("policy.safetensors")}
    on_ranks(2, *sweep, "--threads", 1, cwd=tmp_path)
    assert sum(path.stat().st_mtime_ns == time for path, time in before.items()) >= 2  # none twice
    alone(run, *training, "--out", "alone", cwd=tmp_path)
    assert len(policies(tmp_path / "sweep")) == 8
    assert policies(tmp_path / "sweep") == policies(tmp_path / "alone")


def test_tunes_evaluates_and_plans_as_one_process(run, tmp_path):
    alone(run, "maps", "generate", "obstacles", "--size", 7, "--count", 6, "--out", "maps", cwd=tmp_path)
    tune = "tune --rounds 3x1,1x2 --episodes 2 --train-maps 2 --validation-maps 2".split()
    evaluate = "evaluate --maps maps --policy nearest --policy search:200 --episodes 4".split()
    plan = "plan maps --budget 0.8x".split()
    expected = alone(run, *tune, "--out", "tune", cwd=tmp_path)
    assert on_ranks(2, *tune, "--out", "tune-2", cwd=tmp_path).stdout == expected
    expected = alone(run, *evaluate, cwd=tmp_path)
    assert on_ranks(3, *evaluate, cwd=tmp_path).stdout == expected
    assert on_ranks(2, *evaluate, "--out", "kept", cwd=tmp_path).stdout == expected
    assert alone(run, *evaluate, "--out", "kept", "--merge", cwd=tmp_path) == expected
    alone(run, *plan, "--out", "plans", cwd=tmp_path)
    on_ranks(3, *plan, "--out", "plans-3", cwd=tmp_path)
    expected = (tmp_path / "plans" / "summary.csv").read_bytes()
    assert expected.count(b"\n") == 7
    assert (tmp_path / "plans-3" / "summary.csv").read_bytes() == expected


def test_bad_input_gets_one_line(run, tmp_path):
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "bad.txt").write_text("junk")
    for arguments, said in (
        (["train", "--bogus"], "--bogus"),
        (["train", "--rounds", "0"], "rounds"),
        (["plan", "nowhere.txt", "--budget", "3"], "no such map"),
        (["evaluate", "--maps", "maps"], "junk"),
        ([*PAPER, "--seeds", "1-3", "--maps", "maps"], "junk"),
    ):
        done = on_ranks(2, *arguments, cwd=tmp_path, expected=2)
        lines = [line for line in done.stderr.splitlines() if line.startswith("graphdrl")]
        assert len(lines) == 1 and said in lines[0], done.stderr


def test_ranks_must_be_told_the_same(tmp_path):
    one = [BIN / "graphdrl-mpi", "train", "--rounds", "1", "--out", "run"]
    other = [BIN / "graphdrl-mpi", "train", "--rounds", "2", "--out", "run"]
    done = subprocess.run(
        ["mpirun", "--quiet", "-n", "1", *one, ":", "-n", "1", *other],
        env=ENVIRONMENT, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False,
    )
    assert done.returncode == 2
    assert "rank 1 has other options than rank 0" in done.stderr
    assert not (tmp_path / "run").exists()


def test_a_full_disk_on_one_rank_ends_all(tmp_path):
    training = [BIN / "graphdrl-mpi", *PAPER, "--seeds", "1-6", "--out", "full", "--threads", "1"]
    (tmp_path / "full").mkdir()
    full = [
        f"LD_PRELOAD={FAULTS.name}",
        f"LD_LIBRARY_PATH={FAULTS.parent}:{os.environ.get('LD_LIBRARY_PATH', '')}",
        f"GRAPHDRL_FAULTS_BELOW={tmp_path / 'full'}",
        "GRAPHDRL_FAULTS_AT=1",
        "GRAPHDRL_FAULTS_DO=ENOSPC",
        "GRAPHDRL_FAULTS_ON=1",
    ]
    done = subprocess.run(
        ["mpirun", "--quiet", "-n", "1", *training, ":", "-n", "1", "env", *full, *training],
        env=ENVIRONMENT, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False,
    )
    assert done.returncode == 3, done.stderr
    assert re.search(r"^rank 1: graphdrl.*No space left on device", done.stderr, re.MULTILINE), done.stderr


def shells(count, *arguments, cwd):
    """So many processes at once, each with a share."""
    jobs = [
        subprocess.Popen([BIN / "graphdrl", *arguments, "--task", f"{i + 1}/{count}", "--threads", "1"], cwd=cwd)
        for i in range(count)
    ]
    assert [job.wait(120) for job in jobs] == [0] * count


def test_shares_of_evaluations_and_plans_come_to_what_one_process_gives(run, tmp_path):
    alone(run, "maps", "generate", "obstacles", "--size", 6, "--count", 7, "--out", "maps", cwd=tmp_path)
    evaluate = "evaluate --maps maps --policy nearest --policy search:200 --episodes 3".split()
    lacking = run("graphdrl", *evaluate, "--out", "table", "--merge", cwd=tmp_path)
    assert lacking.returncode == 2 and "results are lacking" in lacking.stderr
    shells(20, *evaluate, "--out", "table", cwd=tmp_path)
    assert alone(run, *evaluate, "--out", "table", "--merge", cwd=tmp_path) == alone(run, *evaluate, cwd=tmp_path)
    plan = "plan maps --budget 0.8x".split()
    shells(20, *plan, "--out", "shares", cwd=tmp_path)
    alone(run, *plan, "--out", "shares", "--merge", cwd=tmp_path)
    alone(run, *plan, "--out", "alone", cwd=tmp_path)
    table = (tmp_path / "alone" / "summary.csv").read_bytes()
    assert table.count(b"\n") == 8
    assert (tmp_path / "shares" / "summary.csv").read_bytes() == table


def test_shares_of_a_search_for_hyper_parameters(run, tmp_path):
    tune = "tune --rounds 3x1,1x2 --episodes 2 --train-maps 2 --validation-maps 2".split()
    early = run("graphdrl", *tune, "--out", "shares", "--merge", cwd=tmp_path)
    assert early.returncode == 2 and "round 1 is not whole" in early.stderr
    for _ in range(2):
        shells(3, *tune, "--out", "shares", cwd=tmp_path)
    assert alone(run, *tune, "--out", "shares", "--merge", cwd=tmp_path) == alone(
        run, *tune, "--out", "alone", cwd=tmp_path
    )


def test_a_folder_of_plans_is_done_once_and_a_bad_map_is_left_out(run, tmp_path):
    maps = tmp_path / "maps"
    alone(run, "maps", "generate", "obstacles", "--size", 6, "--count", 3, "--out", "maps", cwd=tmp_path)
    plan = ["plan", "maps", "--budget", "0.8x", "--out", "plans"]
    (maps / "bad.txt").write_text("junk")
    for time_ in 1, 2, 3, 4:
        done = run("graphdrl", *plan, cwd=tmp_path)
        assert done.returncode == 2
        assert (f"bad failed, {time_} of 3 times" if time_ < 4 else "bad failed 3 times and is left out") in done.stderr
    plans = sorted((tmp_path / "plans").glob("obstacles*.json"))
    assert len(plans) == 3
    first = plans[0].stat().st_mtime_ns
    assert run("graphdrl", *plan, "--merge", cwd=tmp_path).returncode == 2  # named, too
    assert plans[0].stat().st_mtime_ns == first
    assert (tmp_path / "plans" / "summary.csv").read_text().count("\n") == 4
    # Other maps, other options, and a folder that is somebody else's.
    (maps / "bad.txt").unlink()
    for arguments, said in (
        (plan, "other options or files"),
        (["plan", "maps", "--budget", "0.7x", "--out", "plans"], "other options or files"),
        ([*plan, "--task", "4/3"], "bad share"),
        (["plan", "paper:a", "--budget", "9", "--task", "1/2"], "no shares"),
        (["plan", "maps", "--budget", "9"], "more than one map"),
    ):
        refused = run("graphdrl", *arguments, cwd=tmp_path)
        assert refused.returncode == 2 and said in refused.stderr, refused.stderr
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / plans[0].name).write_text("mine")
    assert run("graphdrl", *plan[:-1], "mine", cwd=tmp_path).returncode == 2
    assert (tmp_path / "mine" / plans[0].name).read_text() == "mine"


def test_a_killed_folder_of_plans_goes_on(run, tmp_path):
    alone(run, "maps", "generate", "rooms", "--size", 20, "--count", 12, "--out", "maps", cwd=tmp_path)
    plan = ["plan", "maps", "--budget", "1.0x", "--out", "plans"]
    plans = tmp_path / "plans"
    for made in 2, 5:
        with subprocess.Popen([BIN / "graphdrl", *plan], cwd=tmp_path, stderr=subprocess.DEVNULL) as job:
            wait_until(lambda made=made: len(list(plans.glob("rooms*.json"))) >= made)
            job.kill()
    kept = {path: path.stat().st_mtime_ns for path in plans.glob("rooms*.json")}
    alone(run, *plan, cwd=tmp_path)
    assert len(list(plans.glob("rooms*.json"))) == 12
    assert all(path.stat().st_mtime_ns == time for path, time in kept.items())


@pytest.mark.parametrize("what", ["maps", "config"])
def test_files_must_be_the_same_on_all_ranks(run, tmp_path, what):
    """Each rank has a folder of its own, as on machines without a shared disk."""
    arguments = {
        "maps": "evaluate --maps map.txt --policy nearest --episodes 2 --budget 5".split(),
        "config": "train --config options.json --out run".split(),
    }[what]
    job = ["mpirun", "--quiet"]
    for rank in "one", "two":
        (tmp_path / rank).mkdir()
        (tmp_path / rank / "map.txt").write_text(".....\n..#..\n" if rank == "one" else ".....\n.#...\n")
        (tmp_path / rank / "options.json").write_text('{"rounds": %d}' % (1 if rank == "one" else 2))
        job += [":"] if rank == "two" else []
        job += ["-n", "1", "-wdir", tmp_path / rank, BIN / "graphdrl-mpi", *arguments]
    done = subprocess.run(job, env=ENVIRONMENT, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 2
    assert "than rank 0" in done.stderr


def test_shares_of_a_sweep(run, tmp_path):
    sweep = [*PAPER, "--seeds", "1-9", "--out", "shares"]
    lacking = run("graphdrl", *sweep, "--merge", cwd=tmp_path)
    assert lacking.returncode == 2 and "not trained yet" in lacking.stderr
    shells(20, *sweep, cwd=tmp_path)
    assert "Trained 9 seeds" in alone(run, *sweep, "--merge", cwd=tmp_path)
    alone(run, *PAPER, "--seeds", "1-9", "--out", "alone", cwd=tmp_path)
    assert policies(tmp_path / "shares") == policies(tmp_path / "alone")
