"""Outside programs, asked what they are: under a name on the PATH anything may stand, or nothing."""

import functools
import os
import re
import shutil
import subprocess

import pytest


@functools.cache
def find_program(name, question, answer):
    """The first program of this name on the PATH whose answer to the question matches; None where there is none."""
    for folder in os.get_exec_path():
        path = shutil.which(name, path=folder)
        if path is None:
            continue
        try:
            done = subprocess.run([path, question], input=b"", capture_output=True, timeout=60, check=False)
        except (OSError, subprocess.TimeoutExpired):
            continue
        said = (done.stdout + done.stderr).decode(errors="replace")
        if done.returncode == 0 and re.search(answer, said, re.MULTILINE):
            return path
    return None


def require_program(name, question, answer):
    """The same, but skips the test where there is none."""
    path = find_program(name, question, answer)
    if path is None:
        pytest.skip(f"no program '{name}' on the PATH whose answer to {question} has '{answer}'")
    return path
