# SPDX-License-Identifier: MIT
"""The studies of friction: predicted and measured flutter, partial slip, roughness, verdicts, and a few runs of each."""
import subprocess

import numpy as np
import pytest

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.studies.claims_friction import study as claims_friction
from slideline_tools.studies.framework import registry
from slideline_tools.studies.framework.job import Options, interleave
from slideline_tools.studies.speed_accuracy_friction import (measures as slip, page as speed_accuracy_friction_page,
                                                             study as speed_accuracy_friction)
from slideline_tools.studies.stability_friction import (measures, page as stability_friction_page, scene,
                                                        study as stability_friction)

NEW = ("stability-friction", "speed-accuracy-friction", "claims-friction")


def run(program, job, folder):
    """One job of a study; its row."""
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder / f"{job.jobid}.k"
    deck.write_text(job.deck_text, encoding="utf-8")
    done = subprocess.run([program, f"i={deck}", f"d={folder}", f"jobid={job.jobid}", *job.options], capture_output=True,
                          text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    return folder


@pytest.mark.parametrize("name", NEW)
def test_jobs_have_names_of_their_own_and_a_quick_form(name):
    study = registry.load(name)
    quick = study.jobs(Options(levels=tuple(study.quick_levels), types=(5, 7), quick=True))
    assert quick and interleave(quick, 2)  # refuses two jobs of one name
    assert {job.labels["type"] for job in quick} == {5, 7}
    assert all(job.folder_name.replace(".", "").isprintable() and "/" not in job.folder_name for job in quick)


# ---- flutter ----------------------------------------------------------------------------------------

@pytest.mark.parametrize("ctype", ALL_TYPES)
def test_nothing_grows_without_friction(ctype):
    model, stiffness = scene.flutter(ctype), scene.penalty(1.0)
    rate, _ = model.growth(0.0, stiffness, model.step(stiffness))
    assert abs(rate) < 1.0e-4  # 1/s; 440 with mu 0.5


def test_growth_is_that_of_leap_frog_step_by_step():
    """The same matrices, stepped in time from noise."""
    model, stiffness, friction, mass = scene.flutter(5), scene.penalty(1.0), 0.5, 300.0
    step = model.step(stiffness)
    matrix = model.model.stiffness.copy()
    pressed = stiffness * model.springs
    matrix[1::2, 1::2] += pressed
    matrix[0::2, 1::2] -= friction * pressed
    free = model.model.free
    matrix = (matrix / np.repeat(model.model.mass, 2)[:, None])[np.ix_(free, free)]
    damp = 0.5 * mass * step
    before = np.random.default_rng(1).standard_normal(free.sum()) * 1.0e-9
    now, sizes = before.copy(), []
    for number in range(2400):
        before, now = now, (2.0 * now - (1.0 - damp) * before - step ** 2 * (matrix @ now)) / (1.0 + damp)
        if number >= 1200:
            sizes.append(np.sum(now ** 2))
    third = len(sizes) // 3
    measured = 0.5 * np.log(np.sum(sizes[-third:]) / np.sum(sizes[:third])) / (2 * third * step)
    assert measured == pytest.approx(model.growth(friction, stiffness, step, mass)[0], rel=0.03)


def test_the_rate_of_what_grows_beside_what_does_not():
    times = np.linspace(1.0, 2.0, 500)
    squares = 1.0e-12 + 1.0e-15 * np.exp(2.0 * 7.5 * (times - 1.0))
    rate, shown = measures.fitted_rate(times, squares)
    assert rate == pytest.approx(7.5, rel=1e-2) and shown == pytest.approx(1.0e-3 * np.exp(15.0), rel=0.1)
    rate, shown = measures.fitted_rate(times, np.full(500, 1.0e-12))
    assert shown < 1.0 or rate < 0.1


def test_the_last_stretch_ends_before_slip_may_stop():
    times = np.linspace(0.0, 1.0, 101)
    squares = (1.0e-8 * np.exp(20.0 * times)) ** 2
    when, kept = measures.last_stretch(times, squares)
    assert np.sqrt(kept.max()) <= measures.LARGEST * scene.SPEED < np.sqrt(squares.max())
    assert np.sqrt(kept[-1] / kept[1]) <= measures.STRETCH


@pytest.mark.parametrize("kind, friction", [("map", 0.5), ("mass", 0.5)])
def test_the_program_flutters_as_predicted_and_mass_damping_stops_it(slideline, tmp_path, kind, friction):
    if kind == "map":
        job = stability_friction.job(5, friction, 1.0, "map")
        row = measures.measure_run(run(slideline, job, tmp_path), "run")
        assert row["rate"] == pytest.approx(job.labels["predicted"], rel=0.1)
        assert row["omega"] == pytest.approx(job.labels["predicted_omega"], rel=0.05)
    else:
        amount, cure = next((amount, cure) for kind, amount, cure in stability_friction.cures(5) if kind == "mass" and amount > 1.0)
        job = stability_friction.job(5, friction, 1.0, "mass", amount, cure)
        assert job.labels["predicted"] < 0.0
        assert measures.measure_run(run(slideline, job, tmp_path), "run")["rate"] == 0.0


def flutter_rows():
    """Rows of two types and two coefficients; the second type is half as fast as predicted."""
    return [{"kind": "map", "type": ctype, "friction": friction, "ratio": 1.0, "amount": 0.0, "step": 4.0e-5, "mass": 0.0,
             "predicted": 200.0 * friction, "predicted_omega": 2.0e4, "rate": 200.0 * friction / (1.0 + (ctype == 7)),
             "omega": 2.0e4, "shown": 100.0, "state": "finished"} for ctype in (5, 7) for friction in (0.1, 0.5)]


def test_the_page_of_the_flutter_tells_its_rows(tmp_path):
    stability_friction_page.write_friction_page(flutter_rows(), tmp_path)
    text = (tmp_path / "studies/stability_friction.md").read_text()
    assert "| 5 NTS-mAR | 2 | 1.00 | 1.00 | 0 | 0 |" in text and "| 7 segmented mortar | 2 | 0.50 | 0.50 | 0 | 0 |" in text
    assert (tmp_path / "pictures/stability_friction.png").stat().st_size > 1000


# ---- partial slip and ironing -----------------------------------------------------------------------

def test_exact_traction_carries_the_shear():
    load, shear = 1.0e6, 1.2e5
    x = np.linspace(-2.0e-3, 2.0e-3, 40001)
    traction, a, c = slip.exact_traction(x, load, shear)
    assert np.sum(traction) * (x[1] - x[0]) == pytest.approx(shear, rel=1e-4)
    assert 0.0 < c < a and np.all(traction[np.abs(x) > a] == 0.0)
    pressure = 2.0 * load / (np.pi * a) * slip.ellipse(x / a)
    slips = (np.abs(x) > c) & (np.abs(x) < a)
    np.testing.assert_allclose(traction[slips], slip.FRICTION * pressure[slips])
    assert np.all(traction <= slip.FRICTION * pressure * (1.0 + 1e-12))


def test_roughness_is_that_of_the_wave_of_an_element():
    """A wave with the period of an element of the slab, on a slow trend."""
    share = np.linspace(0.0, 1.0, slip.PLACES)
    cells = slip.ALONG * (slip.JUDGED[1] - slip.JUDGED[0]) * slip.CELLS / slip.SLAB
    force = 100.0 + 5.0 * share + 2.0 * np.sin(2.0 * np.pi * cells * share)
    rough, largest = slip.roughness(force, 1)
    assert rough == pytest.approx(2.0 / np.sqrt(2.0) / force.mean(), rel=0.03)
    assert largest == pytest.approx(2.0 / force.mean(), rel=0.05)


def test_a_die_that_loses_its_slab_does_not_come_through():
    rows = [{"scene": "ironing", "role": "sweep", "type": ctype, "level": level, "vertical": vertical, "state": "finished"}
            for ctype, level, vertical in ((1, 1, 98.0), (1, 2, 20.0), (5, 1, 95.0), (5, 2, 99.0))]
    rows.append({"scene": "ironing", "role": "reference", "type": 7, "level": 3, "vertical": 100.0, "state": "finished"})
    assert speed_accuracy_friction_page.held(rows) == [5]


def test_partial_slip_with_the_program(slideline, tmp_path):
    job = speed_accuracy_friction.job("partial_slip", 1, 5, "sweep")
    row = slip.judge_rolled(run(slideline, job, tmp_path), "run")
    assert row["traction_error"] < 0.15 and row["edge_error"] < 1.0 / row["segments"]
    assert 0.4 < row["shear"] < 0.6 and row["iterations"] > 12


# ---- claims -----------------------------------------------------------------------------------------

def claim_rows(deviations):
    """Rows of one mesh: {(type, rule): deviation}."""
    return [{"type": ctype, "rule": rule, "mesh": "5/4", "bodies": words, "state": "finished",
             **{f"{part}_{side}": value for part in claims_friction.PARTS for side in claims_friction.SIDES}}
            for (ctype, rule), value in deviations.items() for words in ("like", "unlike")]


def test_verdicts_follow_the_figures():
    rows = claim_rows({(4, "stick"): 1e-12, (5, "stick"): 1e-12, (5, "slip"): 2e-9, (1, "stick"): 0.3, (1, "slip"): 0.1})
    assert claims_friction.exact_types(rows, ("stick",)) == [4, 5]
    assert claims_friction.verdict_of([4, 5], {1, 4, 5}) == "yes" and claims_friction.verdict_of([4], {4, 5}) == "partly"
    assert claims_friction.exact_types(rows, ("slip",)) == [] and claims_friction.verdict_of([], {4, 5}) == "no"
    assert claims_friction.others(rows) == {1: (0.3, 0.3)}
    assert claims_friction.slip_difference(rows) == {1: 0.0, 5: 0.0}
    assert claims_friction.deviation(4.5) == "450 %" and claims_friction.deviation(3.2e-12) == "3e-12"


@pytest.mark.parametrize("ctype, is_exact", [(5, True), (2, False)])
def test_claims_with_the_program(slideline, tmp_path, ctype, is_exact):
    jobs = claims_friction.jobs(Options(types=(ctype,), quick=True))
    rows = [{**job.labels, "state": "finished",
             **claims_friction.measure(job, run(slideline, job, tmp_path / job.folder_name))} for job in jobs]
    assert (claims_friction.exact_types(rows, ("stick", "slip")) == [ctype]) is is_exact
    assert claims_friction.slip_difference(rows)[ctype] < 1e-9


def test_a_run_without_a_stick_zone_is_no_measure(tmp_path):
    names = "time,interface,node,s,x,y,gap,pressure,fx,fy,length,traction,slip,state"
    (tmp_path / "run.contact.csv").write_text(f"{names}\n3,1,1,0,0,0,-1,1e9,0,0,1e-4,3e8,0,2\n3,1,2,0,1e-4,0,-1,1e9,0,0,1e-4,3e8,0,2\n")
    with pytest.raises(UserError, match="nothing sticks"):
        slip.judge_rolled(tmp_path, "run")


def test_nodal_means_carry_the_shear_on_a_coarse_chain():
    load, shear = 1.0e6, 1.2e5
    x = np.linspace(-1.0e-3, 1.0e-3, 8)
    means, a, _ = slip.nodal_means(x, load, shear)
    length = np.convolve(np.diff(x), [0.5, 0.5])
    assert a < 1.0e-3 and np.sum(means * length) == pytest.approx(shear, rel=1e-3)
