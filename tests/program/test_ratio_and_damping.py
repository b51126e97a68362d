# SPDX-License-Identifier: MIT
"""The energy ratio where nothing can be expected, and global damping that a step can not follow."""
import math
import re

import numpy as np
import pytest
from conftest import numbers
from meshes import Deck, grid

STEP = 1.0e-4


def driven(factor):
    """A rigid square that an acceleration from zero drives: after one step v(1/2) = 0, and with it initial energy and work."""
    deck = Deck("driven").control(0.5 * STEP, dt=STEP).part()
    deck.add("*MAT_RIGID", (1, 1000.0, 2.1e11, 0.3)).mesh(*grid(1, 1, 1.0, 1.0, (-0.5, -0.5)))
    deck.curve(1, [(0.0, 0.0), (0.1, 1.0)])
    return deck.add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", (1, 1, 1, 1, factor), (1, 7, 1, 1, 1.5707963)).output(glstat=STEP)


@pytest.mark.parametrize("factor", [0.2, 0.3, 0.37, 0.7, 1.1, 1.3])
def test_what_rounding_leaves_is_no_energy(slideline, tmp_path, factor):
    """total = kinetic + leapfrog is zero here but for its last bits, and so is what it is compared with."""
    assert slideline("d=o", deck=driven(factor)).returncode == 0
    table = tmp_path / "o" / "job.glstat.csv"
    kinetic, total, work = (numbers(table, name)[-1] for name in ("kinetic", "total", "external_work"))
    assert kinetic > 0.0 and abs(total) < 1.0e-14 * kinetic and work == 0.0
    assert list(numbers(table, "energy_ratio")) == [1.0, 1.0]
    assert "energy ratio is" not in (tmp_path / "o" / "job.log").read_text()


def test_energy_from_nowhere_is_no_round_off(slideline, tmp_path):
    """What is small against one may be all there is: a slow body that is stopped by damping keeps its ratio."""
    deck = Deck("slow").control(20 * STEP, dt=STEP).part().elastic(1000.0, 1.0e6, 0.25)
    nodes = deck.mesh(*grid(1, 1, 1.0, 1.0))
    deck.node_set(1, nodes).add("*INITIAL_VELOCITY", (1,), (1.0e-12, 0.0)).add("*DAMPING_GLOBAL", (0, 20.0))
    assert slideline("d=o", deck=deck.output(glstat=STEP)).returncode == 0
    table = tmp_path / "o" / "job.glstat.csv"
    assert numbers(table, "total")[0] < 1.0e-20
    assert all(abs(ratio - 1.0) < 1.0e-12 for ratio in numbers(table, "energy_ratio"))


def damped(rate, factors=(0.0, 0.0), curve=None):
    """A free block that flies under global damping."""
    deck = Deck("damped").control(10.5 * STEP, dt=STEP).part().elastic(1000.0, 1.0e6, 0.25)
    nodes = deck.mesh(*grid(1, 1, 1.0, 1.0))
    deck.node_set(1, nodes).add("*INITIAL_VELOCITY", (1,), (1.0, 1.0))
    if curve:
        deck.curve(7, curve)
    deck.add("*DAMPING_GLOBAL", (7 if curve else 0, rate, *factors))
    return deck.output(glstat=STEP, nodout=STEP, nodes=[1])


@pytest.mark.parametrize("share, turns", [(0.1, False), (0.99, False), (1.01, False), (1.99, False), (2.01, True), (1000.0, True)])
def test_damping_beyond_the_step_is_reported(slideline, tmp_path, share, turns):
    """Reported once where D dt passes 1; with the factor that velocities really fall by, and whether they change sign."""
    done = slideline("d=o", deck=damped(share / STEP))
    assert done.returncode == 0
    log = (tmp_path / "o" / "job.log").read_text()
    reported = [line for line in log.splitlines() if "*DAMPING_GLOBAL acts" in line]
    assert len(reported) == (share > 1.0), log
    v = numbers(tmp_path / "o" / "job.nodout.csv", "vx")
    keep = (2.0 - share) / (2.0 + share)
    # Written velocities are means of two that stand half a step apart each: these fall by the same factor.
    assert v[4] / v[3] == pytest.approx(keep, rel=1.0e-9) and abs(v[4]) < abs(v[3]) and (v[4] * v[3] < 0.0) == turns
    if reported:
        assert "VALDMP" in reported[0] and ("change sign" in reported[0]) == turns
        left, meant = (float(text) for text in re.search(r"multiplies velocities by (\S+), the exact factor exp\(-D dt\) is ([^ ,;]+)", reported[0]).groups())
        assert left == pytest.approx(keep, rel=1.0e-4) and meant == pytest.approx(math.exp(-share), rel=1.0e-4)


@pytest.mark.parametrize("factors, curve, reported", [
    ((0.0, 1.5), None, True),                                                  # STY
    ((0.5, 0.5), None, False),
    ((0.0, 0.0), [(0.0, 0.0), (4 * STEP, 1.2 / STEP), (9 * STEP, 0.0)], True),  # within the run
    ((0.0, 0.0), [(0.0, 0.0), (1.0, 10.0 / STEP)], False),                     # after it
])
def test_factors_and_curves_count(slideline, tmp_path, factors, curve, reported):
    assert slideline("d=o", deck=damped(0.9 / STEP, factors, curve)).returncode == 0
    log = (tmp_path / "o" / "job.log").read_text()
    assert log.count("*DAMPING_GLOBAL acts") == reported, log
    if reported:
        assert ("largest ordinate of curve 7" if curve else "VALDMP") in log


def test_cards_of_one_part_add_up(slideline, tmp_path):
    """Two cards of *DAMPING_PART_MASS, one with STX and STY, and global damping: velocities fall by the sum of all."""
    deck = damped(100.0).curve(8, [(0.0, 1000.0), (1.0, 1000.0)]).curve(9, [(0.0, 500.0), (1.0, 500.0)])
    deck.add("*DAMPING_PART_MASS", (1, 8, 1.0, 1), (1.0, 2.0), (1, 9))
    assert slideline("d=o", deck=deck).returncode == 0
    for direction, rate in (("x", 1600.0), ("y", 2600.0)):
        v = numbers(tmp_path / "o" / "job.nodout.csv", f"v{direction}")
        assert v[4] / v[3] == pytest.approx((2.0 - rate * STEP) / (2.0 + rate * STEP), rel=1.0e-9)


def test_energies_that_do_not_add_up_are_reported_once_while_the_run_goes_on(slideline, tmp_path):
    """Waves of two elements at a fifth of the wave speed: viscous forces are right to first order only."""
    deck = Deck("short waves").control(20.0).elastic(1.0, 1.0, 0.3).output(glstat=0.5)
    deck.add("*PART", "row", (1, 1, 1)).add("*SECTION_SHELL", (1, 13), (1.0,))
    for k, node in enumerate(deck.mesh(*grid(5, 1, 1.5, 0.3)).ravel().tolist()):
        deck.add("*INITIAL_VELOCITY_NODE", (node, 0.06 * (-1) ** (k // 2), 0.2 * (-1) ** (k % 2 + k // 2)))
    done = slideline(deck=deck)
    assert done.returncode == 0, done.stderr
    reported = re.findall(r"warning: at cycle (\d+), time \S+: energy ratio (\S+), unaccounted energy \S+:", done.stderr)
    assert len(reported) == 1
    ratio, cycles = (numbers(tmp_path / "job.glstat.csv", name) for name in ("energy_ratio", "cycle"))
    first = int(np.argmax(np.abs(ratio - 1.0) > 0.1))
    assert int(reported[0][0]) == cycles[first] and float(reported[0][1]) == pytest.approx(ratio[first], rel=1e-6)
    assert "at the end: energy ratio" in done.stderr
