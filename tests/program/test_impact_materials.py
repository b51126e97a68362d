# SPDX-License-Identifier: MIT
"""What a run says of equations of state, failure and fluids: warnings, lines of the log, errors, energy at the start."""
import re
import subprocess

import numpy as np
import pytest

from conftest import numbers
from meshes import Deck, grid

FLUID = "*EOS_LINEAR_POLYNOMIAL", (5, 0.0, 2.0e9)
GRUNEISEN = "*EOS_GRUNEISEN", (5, 4000.0, 1.5, 0.0, 0.0, 2.0), (1.0,)
COPPER = (1, 8930.0, 46.0e9, 124.0e9, 0.34), (90.0e6, 292.0e6, 0.31, 0.025, 1.09, 1356.0, 293.0, 1.0)


def block(*keywords, end=1.0e-4, dt=None, form=(13, None), eos=5, pull=None, n=2):
    """n x n elements of 0.1 m, with the keywords given; free, or its sides x pulled apart by a displacement over the run."""
    deck = Deck("block").control(end, dt=dt)
    deck.add("*PART", "block", (1, 1, 1, eos)).add("*SECTION_SHELL", (1, form[0], None, form[1]), (1.0,))
    for keyword, *cards in keywords:
        deck.add(keyword, *cards)
    nodes = deck.mesh(*grid(n, n, 0.1, 0.1, (0.1 if form[0] == 15 else 0.0, 0.0))).reshape(n + 1, n + 1)
    if pull:
        deck.curve(1, [(0.0, 0.0), (end, pull)]).fix(nodes.ravel(), y=1).fix(nodes[:, 0], x=1)
        for node in nodes[:, -1]:
            deck.prescribe(node, 1, 2, 1)
    return deck.output(plot=end / 4, glstat=end / 20)


def log_of(slideline, tmp_path, deck, status=0):
    done = slideline("d=r", deck=deck)
    assert done.returncode == status, done.stderr
    return (tmp_path / "r" / "job.log").read_text(), done.stderr


@pytest.mark.parametrize("gamma", (0.0, 1.5))
def test_pressure_at_the_start_has_its_energy(slideline, tmp_path, gamma):
    """C0: C0^2/(2 K) are there at time zero, so that the balance has something to be measured by."""
    log, _ = log_of(slideline, tmp_path, block(("*MAT_NULL", (1, 1000.0)), (
        "*EOS_LINEAR_POLYNOMIAL", (5, 1.0e6, 2.0e9, 0.0, 0.0, gamma), (0.0, 1.0)), n=8, dt=1.0e-6))
    table = tmp_path / "r" / "job.glstat.csv"
    expected = 0.01 * 0.5e12 / (2.0e9 + gamma * 1.0e6)
    assert numbers(table, "internal")[0] == pytest.approx(expected, rel=1e-12)
    assert numbers(table, "kinetic").max() > 0.3 * expected
    assert np.abs(numbers(table, "energy_ratio") - 1.0).max() < 1.0e-3
    assert "at the end: energy ratio" not in log


def test_gas_keeps_its_energy(slideline, tmp_path):
    """Where E0 holds more than p^2/(2 K) nothing is added."""
    log_of(slideline, tmp_path, block(("*MAT_NULL", (1, 1.2)), (
        "*EOS_LINEAR_POLYNOMIAL", (5, 0.0, 0.0, 0.0, 0.0, 0.4, 0.4), (2.5e5, 1.0))))
    assert numbers(tmp_path / "r" / "job.glstat.csv", "internal")[0] == pytest.approx(2.5e3, rel=1e-12)


@pytest.mark.parametrize("form", ((13, None), (13, 4), (15, None), (15, 4)))
def test_listed_steps_of_a_fluid_are_those_of_the_run(slideline, tmp_path, form):
    steps = {}
    for viscosity in (0.0, 1.0e5):
        log, _ = log_of(slideline, tmp_path, block(("*MAT_NULL", (1, 1000.0, 0.0, viscosity)), FLUID + ((),),
                                                   end=1.0e-5, form=form))
        steps[viscosity] = float(re.search(r"stable step\n +\d+ +\d+ +(\S+)", log)[1])
        first = float(re.search(r"first time step (\S+),", log)[1])
        assert 0.9 * steps[viscosity] == pytest.approx(first, rel=1e-5)
    assert steps[1.0e5] < 0.7 * steps[0.0]


def test_pressure_without_bound_is_reported(slideline, tmp_path):
    log, said = log_of(slideline, tmp_path, block(("*MAT_NULL", (1, 8930.0)), GRUNEISEN, pull=-0.069), 2)
    for text in (log, said):
        assert re.search(r"V/V0 3\.\d+E-01, near which the pressure of equation of state 5 has no bound .* in element \d of "
                         r"part 1 at cycle", text)


def test_less_is_no_error(slideline, tmp_path):
    log_of(slideline, tmp_path, block(("*MAT_NULL", (1, 8930.0)), GRUNEISEN, pull=-0.06))


@pytest.mark.parametrize("heat, text", (
    ((383.0, 0.0, 3.0), '(SPALL): "3.0" has no effect without PC: there is no failure in tension'), ((383.0, 0.0, 1.0), '(SPALL): "1.0" has no effect'),
    ((383.0, 0.0, 2.0), ""), ((383.0, -1.0e9, 3.0), "")))
def test_spall_without_a_cutoff(slideline, tmp_path, heat, text):
    log, _ = log_of(slideline, tmp_path, block(("*MAT_JOHNSON_COOK", *COPPER, heat, (0.0,)), GRUNEISEN, end=1.0e-6))
    assert ("warning: " in log) == bool(text) and text in log


def test_equation_that_no_part_names(slideline, tmp_path):
    log, _ = log_of(slideline, tmp_path, block(("*MAT_ELASTIC", (1, 1000.0, 1.0e9, 0.3)), GRUNEISEN, eos=0, end=1.0e-6))
    assert "warning: " in log and "no part uses equation of state 5 (EOSID of *PART)" in log


@pytest.mark.parametrize("shear, warned", ((46.0e9, False), (50.0e9, True)))
def test_shear_modulus_beside_young(slideline, tmp_path, shear, warned):
    law = ("*MAT_JOHNSON_COOK", (1, 8930.0, shear, *COPPER[0][3:]), COPPER[1], (383.0,), (0.0,))
    log, _ = log_of(slideline, tmp_path, block(law, eos=0, end=1.0e-6))
    assert ("is not E/(2 (1 + PR)) = 4.62" in log) == warned


def test_failing_points_are_reported(slideline, tmp_path):
    """While it happens and at the end; a run that goes on does not tell the first one again."""
    deck = block(("*MAT_PLASTIC_KINEMATIC", (1, 7850.0, 2.1e11, 0.3, 3.0e8, 1.0e9), (0.0, 0.0, 0.01)), eos=0, pull=4.0e-3, n=4,
                 end=4.0e-4)
    log, _ = log_of(slideline, tmp_path, deck)
    first = re.search(r"first failed point (in element \d+ of part 1 at cycle \d+, time \S+)\n", log)[1]
    assert 1 <= len(re.findall(r"first failed point |failed points: \d+ of \d+ by cycle", log)) <= 3
    reported = re.search(r"failed points: (\d+) of 16, the first (.*)\n", log)
    assert int(reported[1]) == 16 and reported[2] == first
    at = float(first.split()[-1])
    assert 1.0e-4 < at < 4.0e-4


def test_no_failure_is_reported_too(slideline, tmp_path):
    log, _ = log_of(slideline, tmp_path, block(("*MAT_PLASTIC_KINEMATIC", (1, 7850.0, 2.1e11, 0.3, 3.0e8), (0.0, 0.0, 0.5)),
                                               eos=0, end=1.0e-6))
    assert "failed points: none" in log


def test_check_counts_in_words(exe, tmp_path):
    deck = block(("*MAT_ELASTIC", (1, 1000.0, 1.0e9, 0.3)), GRUNEISEN, eos=0, n=1)
    deck.node_set(1, [1, 2]).node_set(2, [4, 3]).contact(1, 2, 1, 1.0e8)
    (tmp_path / "one.k").write_text(deck.text())
    done = subprocess.run([exe, "check", "one.k"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "1 element, 4 nodes, 1 interface, 1 warning\n" in done.stdout, done.stdout


@pytest.mark.parametrize("form", (13, 15))
@pytest.mark.parametrize("control", (2, 4))
def test_hourglass_work_leaves_with_its_elements(slideline, tmp_path, form, control):
    """The works of single elements add up to that of all: none is left where every element is gone."""
    deck = block(("*MAT_ELASTIC", (1, 7850.0, 2.1e11, 0.3)), ("*CONTROL_HOURGLASS", (control, 0.1)),
                 ("*MAT_ADD_EROSION", (1,), (None,) * 7 + (3.0e-5,)), eos=0, n=1, end=4.0e-5, form=(form, None))
    deck.curve(1, [(0.0, 0.0), (4.0e-5, 2.0e-3)]).prescribe(1, 1, 2, 1).prescribe(4, 1, 2, 1)
    log_of(slideline, tmp_path, deck)
    time, work, gone = (numbers(tmp_path / "r" / "job.glstat.csv", name) for name in ("time", "hourglass", "eroded"))
    assert gone[-1] > 0.0 and time[gone > 0.0][0] >= 3.0e-5
    assert abs(work[-1]) < 1.0e-9 * work.max()


@pytest.mark.parametrize("form", (13, 15))
@pytest.mark.parametrize("control", (1, 4, 6))
def test_what_has_failed_resists_nothing(slideline, tmp_path, form, control):
    """EROD 1: an element that has failed in shear (t 2) and is square again (t 3) is moved in its hourglass pattern:
    nothing but its inertia, neither force nor energy of hourglass control."""
    damage = (1, 1.0, 0.4, 1.0, 0.25), (0.001, 0.0, 1.0, 0.0, 1.0, 1000.0, 300.0, 1.0), (0.0, 0.0, 2.0, 0.0, 0.01), (0.0, 0.0, 1.0)
    deck = block(("*MAT_JOHNSON_COOK", *damage), ("*CONTROL_HOURGLASS", (control, 0.1)), eos=0, n=1, end=6.0, dt=0.025,
                 form=(form, None))
    for node, (shear, pattern) in enumerate(((0.0, 5e-3), (0.0, -5e-3), (0.02, -5e-3), (0.02, 5e-3)), 1):
        deck.curve(node, [(0.0, 0.0), (2.0, shear), (3.0, 0.0), (9.0, 2.0 * pattern)])
        deck.prescribe(node, 1, 2, node).fix([node], y=1)
    log_of(slideline, tmp_path, deck)
    table = {name: numbers(tmp_path / "r" / "job.glstat.csv", name) for name in (
        "time", "kinetic", "internal", "hourglass", "external_work", "leapfrog")}
    after = (table["time"] > 3.2) & (table["time"] < 5.9)
    assert np.ptp(table["internal"][after]) == np.ptp(table["hourglass"][after]) == 0.0
    inertia = table["kinetic"] + table["leapfrog"]
    assert np.ptp((table["external_work"] - inertia)[after]) < 1.0e-9 * inertia[after].max()
