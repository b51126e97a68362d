# SPDX-License-Identifier: MIT
"""Scenes with the option --static."""
import pytest

from slideline_tools import scenes


@pytest.mark.parametrize("name", ("patch", "hertz"))
def test_static_deck(tool, tmp_path, name):
    path = tmp_path / "scene.k"
    done = tool("make-deck", name, "--static", "--ctype", 7, "-o", path)
    assert done.returncode == 0, done.stderr
    text = path.read_text()
    assert text == getattr(scenes, name)(ctype=7, static=True)
    assert "*CONTROL_IMPLICIT_GENERAL" in text
    assert "*DAMPING_GLOBAL" not in text and "*CONTROL_HOURGLASS" not in text
    plain = getattr(scenes, name)(ctype=7)
    assert "*CONTROL_IMPLICIT" not in plain and "*DAMPING_GLOBAL" in plain
    # The same meshes, node by node.
    assert text[text.index("*NODE"):] == plain[plain.index("*NODE"):]


def test_other_scenes_have_no_static_deck(tool, tmp_path):
    assert tool("make-deck", "block", "--static", "-o", tmp_path / "x.k").returncode == 2
