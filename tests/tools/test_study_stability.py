# SPDX-License-Identifier: MIT
"""The stability maps: springs, eigenvalues, verdicts, and a few cells with the program."""
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.decks import Grid
from slideline_tools.histories import History, HistoryError, energy_made
from slideline_tools.studies.framework.job import Options
from slideline_tools.studies.stability import measures, page as stability_page, study as stability
from slideline_tools.studies.stability.eigen import Model, quad_stiffness
from slideline_tools.studies.stability.failing import keep_failing
from slideline_tools.studies.stability.scenes import SCENES
from slideline_tools.studies.stability.springs import springs

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


def test_rows_below_the_limit():
    row = {"scene": "patch", "type": 1}
    rows = [{**row, "kind": "limit", "decade": x, "program_limit": y} for x, y in ((0.0, 0.8), (2.0, 0.2))]
    rows += [{**row, "kind": "map", "decade": 1.0, "step": step, "verdict": "blown up"}
             for step in (0.4, 0.6, 0.7)]
    assert [r.get("below_limit") for r in stability.mark_below(rows)[2:]] == [True, False, False]


def cells_with_decks(folder):
    """Rows of every kind of cell, two meshes among them, and their run folders."""
    head = "*KEYWORD\n*TITLE\ncell {}\n"
    mesh = "*NODE\n$ nid x y\n1,0.0,{}\n*ELEMENT_SHELL\n1,1,1,2,3,4\n"
    rows = []
    for number, (step, decade, verdict) in enumerate((
            (0.4, 1.0, "blown up"), (0.6, 1.0, "blown up"), (0.4, 2.0, "blown up"), (0.7, 1.0, "stable"),
            (0.2, -4.0, "penetrating"), (0.2, -3.5, "penetrating"), (0.2, 0.0, None), (0.2, 0.5, ""))):
        row = {"scene": "patch", "type": 1, "kind": "map", "decade": decade, "step": step,
               "run": f"cell_{number}", "state": "finished"}
        if verdict:
            row["verdict"] = verdict
        elif verdict is None:
            row["state"] = "failed"
        rows.append(row)
        run = folder / "runs" / row["run"]
        run.mkdir(parents=True)
        (run / "patch.k").write_text("*KEYWORD\n&pen\n*END\n")
        (run / "patch.effective.k").write_text(
            head.format(number) + mesh.format(float(number == 4)) + "*CONTROL_ENERGY\n2\n*NODE\n9,9.0,9.0\n*END\n")
    return rows


def test_every_failing_cell_has_its_deck(tmp_path):
    rows = cells_with_decks(tmp_path)
    stale = tmp_path / "failing" / "of_another_time.k"
    stale.parent.mkdir()
    stale.write_text("")
    assert keep_failing(rows, tmp_path) == 6
    names = sorted(path.name for path in (tmp_path / "failing").glob("cell_*.k"))
    assert names == ["cell_0_blown_up.k", "cell_1_blown_up.k", "cell_2_blown_up.k", "cell_4_penetrating.k",
                     "cell_5_penetrating.k", "cell_6_not_measured.k"]
    assert not stale.exists()
    assert len(list((tmp_path / "failing").glob("mesh_*.k"))) == 2
    text = (tmp_path / "failing" / "cell_1_blown_up.k").read_text()
    included = re.search(r"\*INCLUDE\n(mesh_\w+\.k)\n", text).group(1)
    assert text == f"*KEYWORD\n*TITLE\ncell 1\n*INCLUDE\n{included}\n*CONTROL_ENERGY\n2\n*END\n"
    assert (tmp_path / "failing" / included).read_text() == (
        "*KEYWORD\n*NODE\n$ nid x y\n1,0.0,0.0\n*ELEMENT_SHELL\n1,1,1,2,3,4\n*NODE\n9,9.0,9.0\n*END\n")


def test_deck_of_a_failing_cell_runs_to_the_same_bits(slideline, tmp_path):
    scene = SCENES["block"]
    run = tmp_path / "runs" / "cell"
    run.mkdir(parents=True)
    (run / "block.k").write_text(scene.deck(2))
    subprocess.run([slideline, "i=block.k", "d=.", "ctype=2", "punit=2", "pen=1e5", "dt=1e3", "tssfac=0.7",
                    "endtim=0.05", *scene.options], cwd=run, capture_output=True, check=False)
    keep_failing([{"run": "cell", "verdict": "blown up"}], tmp_path)
    subprocess.run([slideline, "i=cell_blown_up.k", "d=again"], cwd=tmp_path / "failing",
                   capture_output=True, check=False)
    again = tmp_path / "failing" / "again" / "cell_blown_up.glstat.csv"
    assert again.read_bytes() == (run / "block.glstat.csv").read_bytes()


def test_texts_on_soft_penalties_follow_the_cells():
    def cell(ctype, decade, verdict, depth, below=True):
        return {"type": ctype, "kind": "map", "decade": decade, "verdict": verdict,
                "depth": depth, **({"below_limit": True} if below else {})}

    rows = [cell(1, -0.5, "penetrating", 0.2), cell(1, 0.5, "penetrating", 0.18),
            cell(2, -0.5, "penetrating", 0.2), cell(2, 0.5, "stable", 0.06),
            cell(2, 0.5, "blown up", 0.9, below=False), cell(5, -0.5, "stable", 0.03),
            cell(5, 0.5, "stable", 0.04), cell(5, 0.5, "stable", 0.06),
            cell(5, 1.0, "blown up", 0.9)]
    assert stability_page.smallest_penalties({"block": rows}) == \
        "Block 0.3 (type 5), 3 (type 2), none (type 1)"
    assert stability_page.good_decades(rows, 5) == [-0.5, 0.5]
    table = stability_page.depth_table(rows, 0.24).splitlines()
    assert table[0] == "| type | 0.3 | 1 | 3 | 10 |"
    assert table[2:] == ["| 1 NTS | 0.83 |  | 0.75 |  |", "| 2 NTS-AR | 0.83 |  | 0.25 |  |",
                         "| 5 NTS-mAR | 0.12 |  | 0.25 |  |"]


def test_jobs_are_unique_and_complete():
    jobs = stability.jobs(Options(types=(1, 7)))
    maps = len(stability.DECADES) * len(stability.STEPS)
    assert len({job.name for job in jobs}) == len(jobs) == 2 * len(SCENES) * (maps + 7)


def test_jobs_of_implicit_penalty():
    """A map of its own: PEN on K L/A, no compliance last, steps up to just below L/c, no limit to ask for."""
    jobs = stability.jobs(Options(types=(7, "7i")))
    mine = [job for job in jobs if job.labels["type"] == "7i"]
    assert {job.labels["kind"] for job in mine} == {"map"} and len({job.name for job in jobs}) == len(jobs)
    assert len(mine) == len(SCENES) * (len(stability.DECADES) + 1) * len(stability.IMPLICIT_STEPS)
    assert 0.995 in stability.IMPLICIT_STEPS and len(stability.IMPLICIT_STEPS) == len(stability.STEPS)
    pens = {job.labels["decade"]: [word for word in job.options if word.startswith("p:pen=")] for job in mine}
    assert pens[0.0] == ["p:pen=1"] and pens[stability_page.NO_COMPLIANCE] == ["p:pen=-1"]
    assert all("punit=4" in job.options for job in mine)


def implicit_rows():
    """A small map of type 7 and of implicit penalty, which is stable below L/c from 1 on."""
    rows = [{"scene": "block", "type": 7, "kind": "limit", "decade": x, "program_limit": y, "both_limits": y, "true_limit": y}
            for x, y in ((-2.0, 1.0), (2.0, 0.3))]
    for ctype, decades in ((7, (-2.0, 0.0, 2.0)), ("7i", (-2.0, 0.0, 2.0, stability_page.NO_COMPLIANCE))):
        for decade in decades:
            for step in (0.2, 0.995, 1.2):
                verdict = "blown up" if step > 1.0 else "penetrating" if decade < 0.0 else "stable"
                rows.append({"scene": "block", "type": ctype, "kind": "map", "decade": decade, "step": step,
                             "verdict": verdict, "depth": 0.1})
    return rows


def test_implicit_penalty_below_the_limit_of_the_elements():
    rows = stability.mark_below(implicit_rows())
    mine = [row for row in rows if row["type"] == "7i"]
    assert all(row["below_limit"] == (row["step"] < 1.0) for row in mine)
    by_scene = {"block": rows}
    assert stability_page.implicit_text(by_scene) == \
        "Block stable from 1e+0.0 to no compliance, 0 of 8 cells blew up or chattered"
    assert "7i" not in stability_page.limit_table(by_scene)
    assert "| Block | 7i PUNIT 4 | 8 | 6 | 0 | 0 | 0 | 2 | 0 | 4 | 0 |" in stability_page.count_table(by_scene)
    assert stability_page.blown_text(by_scene) == "no cell of these maps"
    mine[3]["verdict"] = "blown up"  # at 1, step 0.2
    assert stability_page.blown_text(by_scene) == "Block type 7i (1 cell)"
    assert stability_page.implicit_text(by_scene) == \
        "Block stable from 1e+2.0 to no compliance, 1 of 8 cells blew up or chattered"


def test_map_of_implicit_penalty_shows_each_cell(plain_pictures):
    """Without compliance stands apart at the right; the steps are its own."""
    figure = stability_page.draw_maps({"block": stability.mark_below(implicit_rows())})
    axes = figure.axes[1]
    assert axes.get_title() == "7i PUNIT 4"
    cells, apart = axes.get_images()
    assert cells.get_array().shape == (3, 3) and apart.get_array().shape == (3, 1)
    assert apart.get_extent()[0] > cells.get_extent()[1] and apart.get_extent()[1] <= axes.get_xlim()[1]
    assert axes.get_xticklabels()[-1].get_text() == "<0"
    assert [text.get_text() for text in axes.get_yticklabels()] == ["0.2", "0.995", "1.2"]


@pytest.mark.parametrize("pen, step, verdict", [
    ("1e4", 0.995, "stable"), ("-1", 0.995, "stable"), ("1e-2", 0.5, "penetrating"), ("10", 1.2, "blown up")])
def test_implicit_cells_with_the_program(slideline, tmp_path, pen, step, verdict):
    scene = SCENES["patch"]
    (tmp_path / "run.k").write_text(scene.deck(7))
    subprocess.run([slideline, "i=run.k", "d=.", "ctype=7", "punit=4", f"p:pen={pen}", "dt=1e3",
                    f"tssfac={step}", f"endtim={scene.end}", *scene.options],
                   cwd=tmp_path, capture_output=True, check=False)
    assert stability.measure_cell(tmp_path, "run", scene)["verdict"] == verdict


@pytest.mark.parametrize("pen, step, verdict", [
    ("10", 0.5, "stable"), ("10", 1.2, "blown up"), ("1e-2", 0.5, "penetrating"),
    ("1e4", 0.5, "limited")])
def test_cells_with_the_program(slideline, tmp_path, pen, step, verdict):
    scene = SCENES["patch"]
    (tmp_path / "run.k").write_text(scene.deck(2))
    subprocess.run([slideline, "i=run.k", "d=.", "ctype=2", "punit=2", f"pen={pen}", "dt=1e3",
                    f"tssfac={step}", f"endtim={scene.end}", *scene.options],
                   cwd=tmp_path, capture_output=True, check=False)
    assert stability.measure_cell(tmp_path, "run", scene)["verdict"] == verdict


def test_limits_of_springs_and_elements():
    """Stiff springs rule alone, soft ones do not; half of 2/omega where they open and close."""
    scene = SCENES["block"]
    row = {"scene": "block", "type": 2, "kind": "limit", "penalty": 1.0e9, "element_limit": 0.5}
    found, = stability.derive(pd.DataFrame([row]), None).to_dict("records")
    alone = scene.limit(2, 1.0e9, False) / 0.5
    assert found["spring_limit"] == pytest.approx(alone)
    assert found["both_limits"] == found["opening_limit"] == pytest.approx(0.5 * alone)
    assert 0.9 * alone < found["true_limit"] < alone
    soft, = stability.derive(pd.DataFrame([{**row, "penalty": 1.0}]), None).to_dict("records")
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
    with pytest.raises(HistoryError, match="no rows"):
        energy_made(sleout.rows(slice(0, 0)))


def test_the_program_knows_how_sharp_its_limit_is():
    """Where nobody chose the penalty the start warns of the step only beyond the least ratio of the page (contact_step_limit.f90)."""
    text = (ROOT / "doc/studies/stability.md").read_text(encoding="utf-8")
    table = text[text.index("## Is the program's limit safe"):].split("\n## ")[0]
    ratios = [float(number) for number in re.findall(r"(\d\.\d\d) to", table)]
    source = (ROOT / "src/contact/contact_step_limit.f90").read_text(encoding="utf-8")
    assert len(ratios) == 21 and float(re.search(r"sharpness = (\S+)_wp", source)[1]) == min(ratios)
