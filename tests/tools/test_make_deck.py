# SPDX-License-Identifier: MIT
"""The command make-deck: what it writes with which options."""
import argparse
import inspect
import pathlib
import re

import pytest

from slideline_tools import cli, scenes
from slideline_tools.commands import decks
from slideline_tools.scenes.patch import MESHES, SURFACES
from test_decks import Model

ROOT = pathlib.Path(__file__).resolve().parents[2]


def test_make_deck_with_a_rigid_die(tmp_path, tool):
    path = tmp_path / "x.k"
    assert tool("make-deck", "sliding", "--rigid-die", "--output", path).returncode == 0
    assert path.read_text() == scenes.sliding(rigid_die=True)


def test_penalty_of_the_patch_takes_damping_and_step_along(tmp_path, tool):
    path = tmp_path / "x.k"
    assert tool("make-deck", "patch", "--penalty", "1e3", "-o", path).returncode == 0
    soft, usual = Model(path.read_text()).parameters, Model(scenes.patch()).parameters
    assert soft["pen"] == 1.0e3 and usual["pen"] == 1.0e6
    assert soft["damp"] < usual["damp"] and soft["endtim"] > usual["endtim"]


@pytest.mark.parametrize("scene", ["sliding", "block"])
def test_make_deck_of_the_other_scenes(tmp_path, tool, scene):
    path = tmp_path / "x.k"
    assert tool("make-deck", scene, "--ctype", 3, "--output", path).returncode == 0
    assert Model(path.read_text()).parameters["ctype"] == 3


@pytest.mark.parametrize("words, deck", [
    ("collision", "collision/collision.k"),
    ("collision --level 2", "collision/collision_2.k"),
    ("sliding", "sliding/sliding.k"),
    ("sliding --level 3", "sliding/sliding_3.k"),
    ("block", "block/block.k"),
    ("block --implicit --level 2", "block/block_implicit_2.k"),
    ("patch", "patch/patch_5_4.k"),
    ("patch --mesh 51/50", "patch/patch_51_50.k"),
    ("hertz", "hertz/hertz.k"),
    ("symmetric_plate", "symmetric_plate/plate_8x4_elastic.k"),
    ("symmetric_plate --nx 16 --ny 8 --elastoplastic",
     "symmetric_plate/plate_16x8_elastoplastic.k"),
    ("taylor", "taylor/taylor.k"),
])
def test_make_deck_writes_the_committed_deck(tmp_path, tool, words, deck):
    path = tmp_path / "new" / "x.k"
    assert tool("make-deck", *words.split(), "--output", path).returncode == 0
    assert path.read_text() == (ROOT / "input" / deck).read_text()


def scene_parsers():
    return {one.prog.split()[-1]: one for one in cli.parsers(cli.build_parser()) if " make-deck " in one.prog}


@pytest.mark.parametrize("name", scene_parsers())
def test_defaults_that_the_help_names_are_those_of_the_scene(name):
    """The parser itself has none."""
    wanted = inspect.signature(getattr(scenes, name)).parameters
    for action in scene_parsers()[name]._actions:
        if action.dest in ("help", "output"):
            continue
        assert action.default is argparse.SUPPRESS and action.dest in wanted
        named = re.search(r"\(([\w./]+)\)$", action.help)
        if named:
            value = wanted[action.dest].default
            assert type(value)(named[1]) == value, action.dest


def test_names_of_the_meshes():
    choices = {option: words.get("choices") for option, words in decks.OWN_OPTIONS["patch"]}
    assert choices["--mesh"] == tuple(MESHES) and choices["--surfaces"] == SURFACES


def test_make_deck_refuses(tmp_path, tool):
    finished = tool("make-deck", "collision", "--level", 0, "--output", tmp_path / "c.k")
    assert finished.returncode == 2 and "level" in finished.stderr
    finished = tool("make-deck", "symmetric_plate", "--nx", 12, "--output", tmp_path / "p.k")
    assert finished.returncode == 2 and "multiple of 8" in finished.stderr
    assert tool("make-deck", "patch", "--mesh", "9/9", "-o", tmp_path / "m.k").returncode == 2
    finished = tool("make-deck", "patch", "--penalty", 0, "-o", tmp_path / "m.k")
    assert finished.returncode == 2 and "penalty" in finished.stderr
    assert not list(tmp_path.iterdir())
