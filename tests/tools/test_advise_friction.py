# SPDX-License-Identifier: MIT
"""Advice on friction: that of frictionless runs in all but name, and flutter of sliding that nothing damps."""
import importlib.util
import re
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest

from conftest import ROOT
from slideline_tools.advise import advise, rubbing
from slideline_tools.histories import History

EXAMPLES = ROOT / "doc/examples"


def run(program, folder, text, *arguments):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "deck.k").write_text(text)
    done = subprocess.run([program, f"i={folder / 'deck.k'}", f"d={folder}", "jobid=run", *arguments], capture_output=True,
                          text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    return {item.topic: item for item in advise(folder)[1]}


@pytest.fixture
def fluttering(monkeypatch):
    """The deck of flutter in the case friction_waves at mu 0.5, long enough for flutter to reach the sliding speed, with 400 states."""
    monkeypatch.syspath_prepend(str(ROOT / "tests/verification"))
    spec = importlib.util.spec_from_file_location("flutter", ROOT / "tests/verification/friction_waves/flutter.py")
    case = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(case)
    case.FOLDS = 25.0
    scene = case.Scene(5, 1, 1.0)
    rate, _, shape = scene.motion(0.5)
    deck, begin = case.deck(scene, 0.5, shape, rate)
    return deck.output(plot=(begin + case.FOLDS / rate) / 400).text()


def test_changes_count_pressed_nodes_alone():
    table = History("contact", {"time": np.repeat([0.0, 1.0, 2.0], 3), "node": np.tile([1, 2, 3], 3),
                                "state": np.array([1, 2, 0, 2, 2, 1, 1, 0, 1], dtype=float)})
    assert rubbing.changes(table) == (2, 4)


def test_flutter_is_reported_and_damping_silences_it(slideline, tmp_path, fluttering):
    """Without damping from the start, which rings; with damping that fades out later."""
    item = run(slideline, tmp_path / "bare", re.sub(r"\*DAMPING_GLOBAL\n.*\n", "", fluttering))["undamped sliding"]
    assert item.seconds is None and "mu 0.5" in item.evidence and "studies/stability.md" in item.evidence
    assert int(re.match(r"(\d+)%", item.evidence)[1]) >= 100 * rubbing.CHANGING
    assert "undamped sliding" not in run(slideline, tmp_path / "damped", fluttering)


def test_damping_of_contact_is_known_from_sleout_else_from_the_deck():
    """A number above 0 in column 41 of the second card, behind a title card where there is one."""
    card = "*CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE{}\n         1         2\n{}\n"

    def is_damped(text, **tables):
        return rubbing.is_damped(SimpleNamespace(deck=text, tables=tables, options=""), SimpleNamespace(id=1))

    damped = " " * 40 + "      20.0"
    assert is_damped(card.format("", damped)) and is_damped(card.format("_TITLE\n         1 pair", damped))
    assert not is_damped(card.format("", " " * 40 + "       0.0")) and not is_damped(card.format("", ""))
    for work in (0.0, 2.0):
        sleout = History("sleout", {"interface": np.array([1, 2]), "damping": np.array([work, 1.0])})
        assert is_damped(card.format("", damped), sleout=sleout) is (work > 0.0)


def test_growth_is_the_slowest_that_the_page_tells():
    page = (ROOT / "doc/studies/stability.md").read_text(encoding="utf-8")
    cells = re.search(r"^\| 1 \|(.*)\|$", page.split("## Flutter of sliding")[1], re.MULTILINE)[1].split("|")
    assert list(rubbing.GROWTH[1][1:]) == [float(cell.split(" to ")[0]) for cell in cells]


def test_friction_between_bars_that_meet_squarely_is_needless(slideline, tmp_path):
    text = (EXAMPLES / "contact_2d_penalty_friction.k").read_text().replace(
        "*INCLUDE\nparts/two_bars.k", (EXAMPLES / "parts/two_bars.k").read_text())
    text = text.replace("*END", "*DATABASE_BINARY_D3PLOT\n0.001,\n*END")
    text = re.sub(r"\*END\n(?=.*\*CONTACT)", "", text, flags=re.S)
    found = run(slideline, tmp_path, text)
    assert "needless friction" in found and "fs.1=0" in found["needless friction"].change


def test_friction_that_stops_a_block_is_not_needless(slideline, tmp_path):
    text = (EXAMPLES / "contact_2d_slideline_friction.k").read_text()
    text = re.sub(r"(\*DATABASE_BINARY_D3PLOT\n) *0\.05", r"\1     0.005", text)
    assert {"needless friction", "undamped sliding"}.isdisjoint(run(slideline, tmp_path, text))
