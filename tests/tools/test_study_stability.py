# SPDX-License-Identifier: MIT
"""The stability maps: springs, eigenvalues, verdicts, and a few cells with the program."""
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.decks import Grid
from slideline_tools.histories import History, energy_made
from slideline_tools.studies.common import verification
from slideline_tools.studies.framework.job import Options
from slideline_tools.studies.stability import measures, study as stability
from slideline_tools.studies.stability.scenes import SCENES

springs = verification(".", "springs").springs
Model, quad_stiffness = verification(".", "eigen").Model, verification(".", "eigen").quad_stiffness
ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "tests" / "verification" / "contact_forces"
SLAVE, MASTER = np.array([0.1, 0.31, 0.55, 0.9]), np.array([0.0, 0.2, 0.45, 0.62, 0.7, 1.0])


@pytest.mark.parametrize("ctype", ALL_TYPES)
def test_springs_are_the_derivative_of_brute_force_contact_forces(ctype):
    sys.path.insert(0, str(REFERENCE))
    try:
        from reference import Chain, Rule, contact_forces
    finally:
        sys.path.remove(str(REFERENCE))
    master = MASTER[::-1]  # walked with the body on the left
    n, depth, nudge = len(SLAVE), 1.0e-5, 1.0e-7
    x = np.concatenate([SLAVE, master])
    y = np.where(np.arange(len(x)) < n, -depth, 0.0)
    start = [Chain(np.stack([SLAVE, 0.0 * SLAVE], axis=1)),
             Chain(np.stack([master, 0.0 * master], axis=1))]
    mean = float(np.mean(np.diff(SLAVE)))
    rule = Rule(ctype, mean if ctype == 1 else 1.0, 0 if ctype == 1 else 1, gauss=4)

    def forces(k, change):
        moved = y.copy()
        moved[k] += change
        points = np.stack([x, moved], axis=1)
        return np.concatenate(contact_forces(rule, Chain(points[:n]), Chain(points[n:]), start))[:, 1]

    found = np.stack([(forces(k, -nudge) - forces(k, nudge)) / (2.0 * nudge)
                      for k in range(len(x))], axis=1)
    order = np.concatenate([np.arange(n), len(x) - 1 - np.arange(len(MASTER))])
    expected = springs(ctype, SLAVE, MASTER)
    assert found[np.ix_(order, order)] == pytest.approx(expected, abs=2.0e-4 * expected.max())
    assert expected.sum(axis=1) == pytest.approx(0.0, abs=1.0e-12)  # both sides together


def test_springs_without_a_master_carry_nothing():
    over = springs(5, [0.0, 1.0, 2.0], [0.0, 0.5, 1.0])
    assert np.all(over[2] == 0.0)
    assert over[0, 0] == pytest.approx(0.25 + 0.5 * 0.5 ** 2)  # its own, and at the middle


def test_stiffness_of_a_quad():
    a, b, young, poisson, hourglass = 0.4, 0.3, 2.0e6, 0.3, 0.1
    x = np.array([[0.0, 0.0], [a, 0.0], [a, b], [0.0, b]])
    stiffness, area = quad_stiffness(x, young, poisson, hourglass)
    assert area == pytest.approx(a * b)
    rigid = [np.tile([1.0, 0.0], 4), np.tile([0.0, 1.0], 4),
             np.stack([-x[:, 1], x[:, 0]], axis=1).ravel()]
    for mode in rigid:
        assert stiffness @ mode == pytest.approx(0.0, abs=1e-6)
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    wave = lame + young / (1.0 + poisson)
    stretch = np.stack([x[:, 0], 0.0 * x[:, 0]], axis=1).ravel()
    assert stretch @ stiffness @ stretch == pytest.approx(wave * area)
    bend = np.zeros(8)
    bend[0::2] = [1.0, -1.0, 1.0, -1.0]  # doc/theory/elements.md: frequency of the pure mode
    square = bend @ stiffness @ bend / (4.0 * 0.25 * area)
    assert square == pytest.approx(4.0 * wave * hourglass * (1.0 / a ** 2 + 1.0 / b ** 2))


def test_limit_of_two_quads_and_springs():
    grids = [Grid([0.0, 1.0], [-1.0, 0.0]), Grid([0.0, 1.0], [0.0, 1.0], first_node=11)]
    model = Model(grids, 1.0, 0.0, [1.0, 1.0], 0.0)
    stiff = np.zeros((8, 8))
    for slave, master in zip(model.rows(grids[1].lower), model.rows(grids[0].upper[::-1])):
        stiff[np.ix_([slave, master], [slave, master])] += 1e8 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    assert model.limit(stiff) == pytest.approx(2.0 / np.sqrt(1e8 * 2.0 / 0.25), rel=1e-6)
    assert model.limit(0.0 * stiff) == pytest.approx(1.0)  # L/c, without Poisson's ratio
    model.fix(grids[0].node.ravel(), 1)
    model.fix(grids[0].node.ravel(), 0)
    assert model.limit(stiff) == pytest.approx(2.0 / np.sqrt(1e8 / 0.25), rel=1e-6)


@pytest.mark.parametrize("change, status, verdict", [
    ({}, 0, measures.STABLE), ({}, 2, measures.BLOWN_UP), ({"drift": 0.06}, 0, measures.BLOWN_UP),
    ({"created": 0.06}, 0, measures.BLOWN_UP), ({"depth": 0.21}, 0, measures.PENETRATING),
    ({"swings": 4.1}, 0, measures.CHATTERING), ({"uneven": 0.31}, 0, measures.LOCKED),
    ({"uneven": 0.31, "depth": 0.21, "swings": 5.0}, 0, measures.PENETRATING)])
def test_verdicts(change, status, verdict):
    good = dict(drift=0.01, created=0.01, depth=0.1, swings=1.0, uneven=0.1)
    assert measures.judge(status, {**good, **change}, 0.2, np.inf, True) == verdict
    if change == {"uneven": 0.31}:
        assert measures.judge(0, {**good, **change}, 0.2, np.inf, False) == measures.STABLE


def table_of(*rows):
    """Cells (type, decade, step, verdict, depth) and limits (type, decade, limit) of the blocks."""
    table = pd.DataFrame([{"scene": "block", "type": row[0], "decade": row[1],
                           **({"kind": "limit", "program_limit": row[2]} if len(row) == 3 else
                              dict(zip(("kind", "step", "verdict", "depth"), ("map", *row[2:]))))} for row in rows])
    return stability.with_below(table).assign(both_limits=table["program_limit"])


def made_table():
    """Type 7, and implicit penalty, which is stable below L/c from 1 on."""
    rows = [(7, -2.0, 1.0), (7, 2.0, 0.3)]
    for ctype, decades in ((7, (-2.0, 0.0, 2.0)), ("7i", (-2.0, 0.0, 2.0, stability.NO_COMPLIANCE))):
        rows += [(ctype, decade, step, "blown up" if step > 1.0 else "penetrating" if decade < 0.0 else "stable", 0.12)
                 for decade in decades for step in (0.2, 0.995, 1.2)]
    return table_of(*rows)


def test_cells_below_the_limit():
    found = table_of((1, 0.0, 0.8), (1, 2.0, 0.2), *((1, 1.0, step, "blown up", 0.1) for step in (0.4, 0.6, 0.7)))
    assert found["below_limit"].tolist()[2:] == [True, False, False]
    mine = made_table().query("type == '7i'")
    assert (mine["below_limit"] == (mine["step"] < 1.0)).all()


def test_page():
    text = stability.page(made_table())
    assert "| 7 segmented mortar | 1.00 |" in text and "Of 4 cells of the types by number 0 blew up" in text
    assert "| block | 7i PUNIT 4 | 6 | 0 | 0 | 0 | 2 | 0 |" in text
    assert "| 7i PUNIT 4 | 1e+0.0 to no compliance |" in text and "| 7 segmented mortar | 0.50 | 0.50 | 0.50 |" in text
    text = stability.page(table_of((1, 0.0, 0.8), (1, 0.0, 0.2, "stable", 0.1), (1, 0.0, 0.4, "blown up", 0.1)))
    assert "Of 2 cells of the types by number 1 blew up" in text and "| 1 NTS | none |" in text


def test_map_of_implicit_penalty_shows_each_cell(plain_pictures):
    """Without compliance stands apart at the right; the steps are its own."""
    axes = stability.draw_maps(made_table()).axes[1]
    assert axes.get_title() == "7i PUNIT 4"
    cells, apart = axes.get_images()
    assert cells.get_array().shape == (3, 3) and apart.get_array().shape == (3, 1)
    assert apart.get_extent()[0] > cells.get_extent()[1] and apart.get_extent()[1] <= axes.get_xlim()[1]
    assert axes.get_xticklabels()[-1].get_text() == "<0"
    assert [text.get_text() for text in axes.get_yticklabels()] == ["0.2", "0.995", "1.2"]


def test_jobs_are_unique_and_complete():
    """A limit for each full decade; implicit penalty: no compliance last, steps up to just below L/c, no limit to ask for."""
    jobs = stability.jobs(Options(types=(1, 7, "7i")))
    mine = [job for job in jobs if job.labels["type"] == "7i"]
    maps = len(stability.DECADES) * len(stability.STEPS)
    assert len({job.name for job in jobs}) == len(jobs) == len(mine) + 2 * len(SCENES) * (maps + 7)
    assert len(mine) == len(SCENES) * (len(stability.DECADES) + 1) * len(stability.IMPLICIT_STEPS)
    pens = {job.labels["decade"]: [word for word in job.options if word.startswith("p:pen=")] for job in mine}
    assert pens[0.0] == ["p:pen=1"] and pens[stability.NO_COMPLIANCE] == ["p:pen=-1"]
    assert all("punit=4" in job.options and job.labels["kind"] == "map" for job in mine)


@pytest.mark.parametrize("ctype, decade, step, verdict", [
    ("7i", 4.0, 0.995, "stable"), ("7i", stability.NO_COMPLIANCE, 0.995, "stable"), ("7i", -2.0, 0.5, "penetrating"),
    ("7i", 1.0, 1.2, "blown up"), (2, 0.0, 0.5, "stable"), (2, 0.0, 1.2, "blown up"), (2, -2.0, 0.5, "penetrating"),
    (2, 4.0, 0.5, "limited"), (2, 0.0, None, 0.84), (3, 0.0, None, 0.55)])
def test_cells_and_limits_with_the_program(slideline, tmp_path, ctype, decade, step, verdict):
    """Verdicts of the patch; the program's limit over L/c where there is no step."""
    job = next(job for job in stability.jobs(Options(types=(ctype,))) if job.labels["scene"] == "patch"
               and job.labels["decade"] == decade and job.labels.get("step") == step)
    (tmp_path / "run.k").write_text(job.deck)
    subprocess.run([slideline, "i=run.k", "d=.", "jobid=patch", *job.options], cwd=tmp_path, capture_output=True, check=False)
    found = stability.measure(job, tmp_path)
    assert found.get("verdict") == verdict or found["program_limit"] == pytest.approx(verdict, abs=0.05)


def test_limits_of_springs_and_elements():
    """Stiff springs rule alone, soft ones do not; half of 2/omega where they open and close."""
    scene = SCENES["block"]
    row = {"scene": "block", "type": 2, "kind": "limit", "element_limit": 0.5}
    table = stability.with_limits(pd.DataFrame([{**row, "penalty": 1.0e9}, {**row, "penalty": 1.0}]))
    stiff, soft = table.to_dict("records")
    alone = scene.limit(2, 1.0e9, False) / 0.5
    assert stiff["spring_limit"] == pytest.approx(alone) and 0.9 * alone < stiff["true_limit"] < alone
    assert stiff["both_limits"] == stiff["opening_limit"] == pytest.approx(0.5 * alone)
    assert soft["both_limits"] == soft["true_limit"] < 1e-2 * soft["opening_limit"]
    assert scene.limit(2, 4.0e9, False) == pytest.approx(0.5 * scene.limit(2, 1.0e9, False))


def test_energy_made_is_seen_behind_what_springs_hold_and_damping_takes():
    """Two interfaces at three times. In the second the first has made 3 J while it holds 5 and VDC has
    taken 4 (its column `contact` says +6: nothing made); the other has lost 2, which hides nothing."""
    sleout = History("sleout", {
        "time": np.repeat([0.0, 1.0, 2.0], 2), "cycle": np.repeat([0, 10, 20], 2),
        "interface": np.array([1, 2] * 3), "energy": np.array([0.0, 0.0, 2.0, 2.0, 1.0, 2.0]),
        "damping": np.array([0.0, 0.0, 4.0, 0.0, 4.0, 0.0]), "stored": np.array([0.0, 0.0, 5.0, 0.0, 2.0, 0.0])})
    assert energy_made(sleout) == pytest.approx([0.0, 3.0, 1.0])
    whole = np.array([20.0, 20.0, 20.0])
    glstat = History("glstat", {"total": whole, "external_work": 0.0 * whole,
                                "contact": np.array([0.0, 8.0, 7.0])})
    assert measures.energies(glstat, sleout) == pytest.approx((0.0, 0.15))
    with pytest.raises(UserError, match="no rows"):
        energy_made(sleout.rows(slice(0, 0)))


def test_the_program_knows_how_sharp_its_limit_is():
    """With the default penalty the start warns of the step only beyond the least ratio of the page (contact_step_limit.f90)."""
    text = (ROOT / "doc/studies/stability.md").read_text(encoding="utf-8")
    section = text[text.index("## Is the program's limit safe"):].split("\n## ")[0]
    rows = [line for line in section.splitlines() if line.startswith("| ")]
    ratios = [float(number) for line in rows for number in re.findall(r"(\d\.\d\d) to", line)]
    source = (ROOT / "src/contact/contact_step_limit.f90").read_text(encoding="utf-8")
    assert len(ratios) == 21 and float(re.search(r"sharpness = (\S+)_wp", source)[1]) == min(ratios)
