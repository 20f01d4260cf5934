"""What others wrote, on our environments: Stable-Baselines3, sb3-contrib and PyTorch Geometric; our examples of each.

They run in an environment of their own, beside Debian's PyTorch, with an older Gymnasium than the tests' own.
"""

import csv
import json
import os
import re
import subprocess

import pytest

from conftest import ROOT, python_blocks

PYTHON = ROOT / "build" / "venv-learners" / "bin" / "python"
EXAMPLES = ROOT / "examples" / "python"


def run_python(*arguments, folder):
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [PYTHON, *map(str, arguments)], capture_output=True, text=True, cwd=folder, env=environment, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("Grid", {}),
        ("Grid", {"family": "maze"}),
        ("Graph", {}),
        ("Graph", {"family": "geometric", "weighted": True}),
        ("FirstVisit", {}),
        ("FirstVisit", {"family": "tree"}),
    ],
)
def test_the_checker_of_stable_baselines3_has_nothing_to_say(name, options, tmp_path):
    run_python(
        "-W",
        "error",
        "-c",
        "import graphdrl.environments, gymnasium, json, sys\n"
        "from stable_baselines3.common.env_checker import check_env\n"
        "check_env(gymnasium.make(sys.argv[1], **json.loads(sys.argv[2])).unwrapped)",
        f"GraphDRL/{name}-v0",
        json.dumps(options),
        folder=tmp_path,
    )


def test_our_vector_environments_work_with_an_older_gymnasium(tmp_path):
    run_python(
        "-c",
        "import graphdrl.environments, gymnasium, numpy as np\n"
        "assert gymnasium.__version__ == '1.0.0'\n"
        "for name in ('Grid', 'Graph', 'FirstVisit'):\n"
        "    envs = gymnasium.make_vec(f'GraphDRL/{name}-v0', num_envs=3)\n"
        "    envs.reset(seed=1)\n"
        "    observations, rewards, *_ = envs.step(np.zeros(3, np.int64))\n"
        "    assert len(observations) == len(rewards) == 3",
        folder=tmp_path,
    )


def test_dqn_on_map_a(tmp_path):
    text = run_python(EXAMPLES / "dqn_on_map_a.py", "--steps", 500, "--out", tmp_path / "curves", folder=tmp_path)
    assert len(re.findall(r"greedy coverage from all starts \d+\.\d %", text)) == 2
    rows = list(csv.DictReader((tmp_path / "curves" / "curves.csv").open()))
    assert [row["step"] for row in rows if row["learner"] == "graphdrl"] == ["250", "500"]
    assert [row["step"] for row in rows if row["learner"] == "stable-baselines3"][:2] == ["25", "50"]
    assert "</svg>" in (tmp_path / "curves" / "curves.svg").read_text()


def test_what_the_docs_say_of_stable_baselines3(tmp_path):
    """The block that needs it and the one after it, shortened."""
    blocks = [code for _, code, _ in python_blocks("docs/coming_from.md")]
    at = next(i for i, code in enumerate(blocks) if "stable_baselines3" in code)
    code = "\n".join(blocks[at : at + 2])
    for long, short in (("50_000", "500"), ("2_000", "12")):
        assert code.count(long) == 1
        code = code.replace(long, short)
    text = run_python("-c", code, folder=tmp_path)
    assert re.match(r"\d+ of 19 cells\n<Plan paper:a, policy>\n", text), text


def test_maskable_ppo(tmp_path):
    text = run_python(EXAMPLES / "maskable_ppo.py", "--steps", 2048, "--episodes", 5, folder=tmp_path)
    nearest, learned, explorer = (float(share) for share in re.findall(r"(\d+\.\d) ± ", text))
    assert 0 < learned <= 100 and nearest < explorer <= 100


def test_pyg_policy(tmp_path):
    text = run_python(EXAMPLES / "pyg_policy.py", 300, folder=tmp_path)
    shares = [float(share) for share in re.findall(r"(\d+\.\d) %", text)]
    assert len(shares) == 5 and shares[-1] > 55  # random moves visit 51 % of a tree
