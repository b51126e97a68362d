# SPDX-License-Identifier: MIT
"""Advice on friction: that of frictionless runs in all but name, and flutter of sliding that nothing damps."""
import re
import subprocess

import numpy as np
import pytest

from conftest import ROOT
from slideline_tools.advise import advise, rubbing, touching
from slideline_tools.histories import History
from slideline_tools.studies.stability_friction import scene

EXAMPLES = ROOT / "doc/examples"


def run(program, folder, text, *arguments):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "deck.k").write_text(text)
    done = subprocess.run([program, f"i={folder / 'deck.k'}", f"d={folder}", "jobid=run", *arguments], capture_output=True,
                          text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    return {item.topic: item for item in advise(folder)[1]}


def fluttering(cure=scene.Cure(), states=400):
    """Steady sliding at mu 0.5 with many states, whose flutter has the time to reach the sliding speed."""
    text = scene.deck(5, 0.5, 1.0, cure)
    end = float(re.search(r"\*CONTROL_TERMINATION\n.*\n\s*(\S+)", text)[1])
    return re.sub(r"(\*DATABASE_BINARY_D3PLOT\n.*\n).*", lambda found: f"{found[1]}{end / states:.6g},", text)


def test_changes_count_pressed_nodes_alone():
    table = History("contact", {"time": np.repeat([0.0, 1.0, 2.0], 3), "node": np.tile([1, 2, 3], 3),
                                "state": np.array([1, 2, 0, 2, 2, 1, 1, 0, 1], dtype=float)})
    assert rubbing.changes(table) == (2, 4)


def damped_first(text, after):
    """The deck without any damping, which holds the flutter down at first: its start lets bodies ring."""
    return re.sub(r"\*DAMPING_GLOBAL\n.*\n.*\n", "", text) if after else text


def test_flutter_is_told_and_damping_silences_it(slideline, tmp_path):
    found = run(slideline, tmp_path / "bare", damped_first(fluttering(), True))
    item = found["undamped sliding"]
    assert item.seconds is None and "mu 0.5" in item.evidence and "studies/stability.md" in item.evidence
    assert int(re.match(r"(\d+)%", item.evidence)[1]) >= 100 * rubbing.CHANGING
    assert "undamped sliding" not in run(slideline, tmp_path / "damped", fluttering())


def test_growth_is_no_more_than_the_eigenvalues_give():
    """The table rises with mu and lies below the rates of type 7, at a penalty of K L/A."""
    model, stiffness = scene.flutter(7), scene.penalty(1.0)
    unit = 1000.0 * model.model.limit(0.0 * model.springs)
    for friction, folds in list(zip(*rubbing.GROWTH))[2:]:
        rate, _ = model.growth(friction, stiffness, model.step(stiffness))
        assert 0.3 * rate * unit < folds <= 1.1 * rate * unit
    assert np.all(np.diff(rubbing.GROWTH[1]) >= 0.0)


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


def test_dear_types_with_friction_are_judged_by_the_study_with_friction():
    assert set(touching.CHEAPER_WITH_FRICTION) < set(touching.CHEAPER)
    assert all(saved < touching.CHEAPER[ctype][2] for ctype, (_, _, saved) in touching.CHEAPER_WITH_FRICTION.items())
