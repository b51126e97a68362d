# SPDX-License-Identifier: MIT
"""A script that waits for another build says for what it waits."""
import pathlib
import select
import shutil
import subprocess
import time

import pytest

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"


@pytest.fixture
def tree(tmp_path):
    """A tree with the set-up alone."""
    if not shutil.which("flock"):
        pytest.skip("flock is not installed: nothing waits here")
    (tmp_path / "tools").mkdir()
    for name in ("setup.sh", "help.sh"):
        shutil.copy(TOOLS / name, tmp_path / "tools" / name)
    return tmp_path


def start(tree, script, text):
    """A script of that name which takes the lock."""
    path = tree / "tools" / script
    path.write_text(f'. "$(dirname "$0")/setup.sh"\nlock\necho got it\n{text}\n')
    return subprocess.Popen(["bash", path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            text=True)


def test_who_waits_says_for_whom(tree):
    first = start(tree, "first.sh", "read -r _")
    assert first.stdout.readline() == "got it\n"
    second = start(tree, "second.sh", "")
    ready, _, _ = select.select([second.stderr], [], [], 20.0)
    if not ready:
        first.communicate("\n", timeout=20)
        pytest.fail("it waits and says nothing")
    said = second.stderr.readline()
    assert said.startswith(f"waiting for another set-up or build in {tree} (first.sh since ")
    assert f"process {first.pid})" in said
    time.sleep(0.1)
    assert second.poll() is None
    first.communicate("\n", timeout=20)
    out, trouble = second.communicate(timeout=20)
    assert (out, trouble, second.returncode) == ("got it\n", "", 0)


def test_who_need_not_wait_says_nothing(tree):
    out, trouble = start(tree, "first.sh", "").communicate(timeout=20)
    assert (out, trouble) == ("got it\n", "")
