# SPDX-License-Identifier: MIT
"""The implicit method where it must fail: what it says, how it ends, what it leaves."""
import json
import math
import re
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
from conftest import numbers
from meshes import Deck, grid

from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.scenes.patch import even_lines, patch, patch_grids

NORMAL = "N o r m a l    t e r m i n a t i o n"
YIELD = 1.0e3


def implicit(end_time, dt, dynamic=False, automatic=None, most_iterations=None):
    """automatic: (DTMIN, DTMAX) of IAUTO = 1."""
    deck = Deck("implicit")
    deck.add("*CONTROL_TERMINATION", (end_time,)).add("*CONTROL_IMPLICIT_GENERAL", (1, dt))
    if dynamic:
        deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1,))
    if automatic:
        deck.add("*CONTROL_IMPLICIT_AUTO", (1, 11, 5, *automatic))
    if most_iterations:
        deck.add("*CONTROL_IMPLICIT_SOLUTION", (12, None, most_iterations))
    return deck


def pulled(force, plastic=False, **control):
    """A block of 3 x 2 quads on rollers whose right end is pulled by `force` per height, reached at time 1."""
    deck = implicit(1.0, control.pop("dt"), **control).part(points=4)
    if plastic:
        deck.plastic(1000.0, 1.0e6, 0.3, YIELD)
    else:
        deck.elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(3, 2, 1.5, 1.0))
    deck.fix(nodes[::4], x=1).fix(nodes[:4], y=1)
    deck.curve(1, [(0.0, 0.0), (1.0, force)])
    for node, share in zip(nodes[3::4], (0.25, 0.5, 0.25)):
        deck.add("*LOAD_NODE_POINT", (int(node), 1, 1, share))
    return deck.output(glstat=1.0e-9, plot=1.0e9)


def last_state(folder):
    """Times of the last plot state and of the last row of energies."""
    with h5py.File(folder / "job.vtkhdf") as stream:
        plot = stream["VTKHDF/Steps/Values"][-1]
    return plot, numbers(folder / "job.glstat.csv", "time")[-1]


@pytest.mark.parametrize("form", [13, 15])
def test_one_point_quads_are_fully_integrated(slideline, tmp_path, form):
    """NIP 1 without IHQ 6 is NIP 4, with one warning that names the parts; the same bits."""
    for points in (1, 4):
        text = pulled(100.0, dt=0.5).text().replace("1,13,,4", f"1,{form},,{points}")
        done = slideline(f"d=nip{points}", deck=text)
        assert done.returncode == 0, done.stderr
        assert done.stderr.count("warning: ") == (points == 1), done.stderr
        assert ("the implicit method integrates these parts fully, as with NIP 4 (one-point elements need IHQ 6 and no rubber):" in done.stderr) == (points == 1)
    assert (tmp_path / "nip1/job.glstat.csv").read_bytes() == (tmp_path / "nip4/job.glstat.csv").read_bytes()


def test_free_body_is_named(slideline, tmp_path):
    deck = implicit(1.0, 0.1).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(3, 2))
    deck.fix(nodes[:4], y=1).curve(1, [(0.0, 1.0), (1.0, 1.0)])
    deck.add("*LOAD_NODE_POINT", (int(nodes[-1]), 1, 1, 1.0)).output(glstat=0.1, plot=0.1)
    done = slideline("d=x", deck=deck)
    assert done.returncode == 2
    assert NORMAL not in done.stdout
    found = re.search(r"singular.*: node (\d+) is free to move in ([xy])", done.stderr)
    assert found, done.stderr
    assert int(found.group(1)) in nodes and found.group(2) == "x"
    assert last_state(tmp_path / "x") == (0.0, 0.0)


def test_the_loose_one_of_two_bodies_is_named(slideline):
    deck = implicit(1.0, 0.1).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    held = deck.mesh(*grid(2, 2))
    loose = deck.mesh(*grid(2, 2, 1.0, 1.0, (3.0, 0.0)))
    deck.fix(held[:3], x=1, y=1).fix(loose[::3], x=1)  # one side: no turn is free
    done = slideline("d=x", deck=deck.output(glstat=0.1))
    assert done.returncode == 2
    found = re.search(r"node (\d+) is free to move in ([xy])", done.stderr)
    assert found, done.stderr
    assert int(found.group(1)) in loose and found.group(2) == "y"


def test_body_let_go_keeps_the_last_converged_state(slideline, tmp_path):
    """Held by a prescribed motion that ends inside the third step, which is divided there; the rest of it is singular."""
    deck = implicit(1.0, 0.1).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(2, 2))
    deck.fix(nodes[:3], y=1).curve(1, [(0.0, 0.0), (1.0, 0.1)])
    for node in nodes[::3]:
        deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", (int(node), 1, 2, 1, 1.0, 0, 0.25, 0.0))
    done = slideline("d=x", deck=deck.output(glstat=1.0, plot=1.0))
    assert done.returncode == 2
    assert "is free to move in x" in done.stderr
    assert last_state(tmp_path / "x") == pytest.approx((0.25, 0.25))


@pytest.mark.parametrize("dynamic", [False, True])
def test_body_pulled_off_what_it_rests_on(slideline, tmp_path, dynamic):
    """Only contact holds the upper block in y; its load turns round at half time."""
    deck = implicit(1.0, 0.1, dynamic=dynamic).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    lower, upper = deck.mesh(*grid(2, 2)), deck.mesh(*grid(3, 2, 1.0, 1.0, (0.0, 1.0)))
    deck.fix(lower[:3], x=1, y=1).fix(upper[::4], x=1)
    deck.node_set(1, upper[:4]).node_set(2, lower[-3:][::-1]).contact(1, 2, 7, 1.0e6)
    deck.curve(1, [(0.0, -100.0), (0.45, -100.0), (0.55, 100.0), (1.0, 100.0)])
    for node in upper[-4:]:
        deck.add("*LOAD_NODE_POINT", (int(node), 2, 1, 1.0))
    done = slideline("d=x", deck=deck.output(glstat=0.1, plot=1.0))
    if dynamic:
        assert done.returncode == 0, done.stderr
        return
    assert done.returncode == 2
    found = re.search(r"node (\d+) is free to move in ([xy])", done.stderr)
    assert found, done.stderr
    assert int(found.group(1)) in upper and found.group(2) == "y"
    assert last_state(tmp_path / "x") == pytest.approx((0.5, 0.5))


@pytest.mark.parametrize("dynamic", [False, True])
def test_nothing_free_to_move(slideline, dynamic):
    deck = implicit(1.0, 0.5, dynamic=dynamic).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    deck.fix(deck.mesh(*grid(2, 2)), x=1, y=1)
    done = slideline("d=x", deck=deck.output(glstat=0.1))
    assert done.returncode == 0, done.stderr
    assert NORMAL in done.stdout


def test_inertia_holds_a_free_body(slideline):
    deck = implicit(1.0, 0.1, dynamic=True).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    deck.mesh(*grid(3, 2))
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0, done.stderr
    assert NORMAL in done.stdout


def overlapping(dynamic, kind=2):
    """A block that starts 0.004 inside another and reaches 0.02 over its end, and is pressed down."""
    deck = implicit(1.0, 0.1, dynamic=dynamic).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    lower, upper = deck.mesh(*grid(4, 2)), deck.mesh(*grid(3, 2, 1.0, 1.0, (0.02, 0.996)))
    deck.fix(lower[:5], x=1, y=1).fix(upper[::4], x=1)
    deck.node_set(1, upper[:4]).node_set(2, lower[-5:][::-1]).contact(1, 2, kind, 1.0e6)
    deck.curve(1, [(0.0, -100.0), (1.0, -100.0)])
    for node in upper[-4:]:
        deck.add("*LOAD_NODE_POINT", (int(node), 2, 1, 1.0))
    return deck.output(glstat=0.1).add("*DATABASE_BINARY_D3DUMP", (3,))


@pytest.mark.parametrize("dynamic", [False, True])
def test_contact_at_the_start_is_reported_once(slideline, tmp_path, dynamic):
    """Initial penetration: by the run and by its check, not by a restart."""
    deck = overlapping(dynamic)
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0, done.stderr
    # Steps this long take the work of the springs by a rule that is not exact: the dynamic run ends with warnings of that.
    reported = [line.removeprefix("warning: ") for line in done.stderr.splitlines()
            if not (dynamic and re.search("created energy|energy ratio", line))]
    assert len(reported) == 1, reported
    # Competence length 1/3 of a slave node inside; 1/6 at the first one, whose depth is the same.
    assert re.search(r"interface 1: initial penetration at 3 points, deepest at node 16: 4\.0+E-03, contact force "
                     r"there 2\.0+E\+03; the run starts with", reported[0]), reported
    log = (tmp_path / "x" / "job.log").read_text()
    assert log.count(reported[0]) == 1
    done = slideline("check", "job.k", "--json")
    assert done.returncode == 0, done.stderr
    assert [entry["message"] for entry in json.loads(done.stdout)["findings"]] == reported
    done = slideline("r=x/job.dump01.h5")
    assert done.returncode == 0 and "initial penetration" not in done.stderr, done.stderr


@pytest.mark.parametrize("kind, energy", [(1, 32.0), (2, 24.0), (3, 56.0), (4, 24.0), (5, 24.0), (6, 24.0), (7, 24.0)])
def test_springs_loaded_at_the_start_hold_energy(slideline, tmp_path, kind, energy):
    """Depth 0.004 all over the length 1: eps_hat A g^2/2 with 3e6 and, in the other pass, 4e6 N/m^2; 1e6 N/m at 4 nodes."""
    deck = implicit(1.0, 0.1).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    lower, upper = deck.mesh(*grid(4, 2)), deck.mesh(*grid(3, 2, 1.0, 1.0, (0.0, 0.996)))
    deck.fix(lower[:5], x=1, y=1).fix(upper[::4], x=1).output(glstat=0.1)
    deck.node_set(1, upper[:4]).node_set(2, lower[-5:][::-1]).contact(1, 2, kind, 1.0e6)
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0, done.stderr
    assert "created energy" not in done.stderr
    table = tmp_path / "x" / "job.glstat.csv"
    assert numbers(table, "contact")[0] == pytest.approx(energy, rel=1.0e-12)
    assert numbers(table, "total")[0] == pytest.approx(energy, rel=1.0e-12)
    # What the springs give up the elements take; the upper block stands on them then, free of force.
    assert abs(numbers(table, "contact")[-1]) < 1.0e-9 * energy


def test_contact_damping_is_warned_of(slideline, tmp_path):
    deck = implicit(0.2, 0.1, dynamic=True).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    first, second = deck.mesh(*grid(2, 2)), deck.mesh(*grid(2, 2, 1.0, 1.0, (0.0, 1.0)))
    deck.node_set(1, second[:3]).node_set(2, first[-3:][::-1]).contact(1, 2, 5, 1.0e6)
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0 and "VDC" not in done.stderr
    done = slideline("d=y", "vdc=20", deck=deck)
    assert done.returncode == 0
    assert "VDC" in done.stderr and "no effect" in done.stderr


def test_constant_step_that_does_not_converge_is_2(slideline, tmp_path):
    deck = pulled(4.0e5, dt=0.5, most_iterations=3)
    done = slideline("d=x", deck=deck)
    assert done.returncode == 2
    assert "no equilibrium" in done.stderr and "3 iterations" in done.stderr
    assert re.search(r"largest residual at node \d+ in [xy]", done.stderr)
    assert "last converged state is that of time 0" in done.stderr
    assert NORMAL not in done.stdout
    assert last_state(tmp_path / "x") == (0.0, 0.0)


def test_automatic_step_is_cut_and_goes_on(slideline, tmp_path):
    deck = pulled(4.0e5, dt=0.5, most_iterations=3, automatic=(1.0e-4, 0.5))
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0, done.stderr
    assert last_state(tmp_path / "x") == (1.0, 1.0)
    steps = numbers(tmp_path / "x" / "job.glstat.csv", "time")
    assert len(steps) > 4
    cycles = numbers(tmp_path / "x" / "job.glstat.csv", "cycle")
    assert list(cycles) == list(range(len(cycles))), "every step is due, those after a cut too"
    assert min(b - a for a, b in zip(steps, steps[1:])) < 0.26
    assert "no equilibrium after 3 iterations" in (tmp_path / "x" / "job.log").read_text()


def tilted_on_another(automatic):
    """One element, tilted, pressed upon three and pushed along them in two steps: Newton's method goes to and fro between
    the same states of friction (type 6, mu 0.8)."""
    deck = implicit(1.0, 0.5, automatic=automatic, most_iterations=40)
    deck.part(1, points=4).elastic(1000.0, 1.0e6, 0.45, 1).part(2, points=4).elastic(1000.0, 3.0e6, 0.3, 2)
    upper, quads = grid(1, 1, 1.4, 0.5, (0.6, 0.0))
    upper[:, 1] += 0.02 * (upper[:, 0] - 0.6)
    upper, lower = deck.mesh(upper, quads, part=1), deck.mesh(*grid(3, 1, 3.0, 0.6, (0.0, -0.6)), part=2)
    deck.fix(lower[:4], x=1, y=1).node_set(1, upper[:2]).node_set(2, lower[:-5:-1]).curve(1, [(0.0, 0.0), (1.0, 1.0)])
    for node in upper[2:]:
        deck.prescribe(int(node), 2, 2, 1, -0.04).prescribe(int(node), 1, 2, 1, -0.1)
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, 6, 3, 1.0e9, 0.8))
    return deck.output(glstat=1.0e-9, plot=1.0e9)


@pytest.mark.parametrize("automatic", [None, (1.0e-4, 0.5)])
def test_stick_and_slip_that_cycle_end_the_attempt(slideline, tmp_path, automatic):
    """Before the last of 40 iterations; a step that may be cut is, and the run goes on."""
    done = slideline("d=x", deck=tilted_on_another(automatic))
    assert done.returncode == (0 if automatic else 2), done.stderr
    reported = re.findall(r"no equilibrium after (\d+) iterations, which cycle between the same states of stick and slip",
                      (tmp_path / "x" / "job.log").read_text())
    assert reported and max(map(int, reported)) < 40
    if automatic:
        assert last_state(tmp_path / "x") == (1.0, 1.0)
        steps = numbers(tmp_path / "x" / "job.glstat.csv", "time")
        assert min(b - a for a, b in zip(steps, steps[1:])) < 0.3, "cut"


def test_a_linear_run_iterates_once(slideline, tmp_path):
    """NSOLVR = 1, whatever the tolerances ask for."""
    deck = pulled(4.0e5, dt=0.5)
    deck.add("*CONTROL_IMPLICIT_SOLUTION", (1, None, 9, 1.0e-12, None, 1.0e-12))
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0, done.stderr
    log = (tmp_path / "x" / "job.log").read_text()
    assert "iteration 1:" in log and "iteration 2:" not in log


def test_residual_is_measured_against_the_start_of_the_step(slideline, tmp_path):
    """RCTOL: the last |R| of each step is below it times the force put on in that step, that before is not."""
    tolerance, force, dt = 1.0e-5, 4.0e4, 0.5
    deck = pulled(force, dt=dt)
    deck.add("*CONTROL_IMPLICIT_SOLUTION", (12, None, 15, None, 1.0e20, tolerance))
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0, done.stderr
    log = (tmp_path / "x" / "job.log").read_text()
    steps = {}
    for step, residual in re.findall(r"step to (\S+) iteration \d+:.*\|R\| (\S+) ", log):
        steps.setdefault(step, []).append(float(residual))
    first = next(iter(steps.values()))
    start = force * dt * math.sqrt(0.25 ** 2 + 0.5 ** 2 + 0.25 ** 2)
    assert first[-1] <= tolerance * start < first[-2]


def test_contact_that_opens_in_an_iteration_cuts_the_step(slideline, tmp_path):
    """Only contact holds the upper block in y; its load vanishes at 0.5: the second iteration is singular."""
    deck = implicit(1.0, 0.08, automatic=(1.0e-4, 0.08)).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    lower, upper = deck.mesh(*grid(2, 2)), deck.mesh(*grid(3, 2, 1.0, 1.0, (0.0, 1.0)))
    deck.fix(lower[:3], x=1, y=1).fix(upper[::4], x=1)
    deck.node_set(1, upper[:4]).node_set(2, lower[-3:][::-1]).contact(1, 2, 7, 1.0e6)
    deck.curve(1, [(0.0, -100.0), (0.45, -100.0), (0.55, 100.0), (1.0, 100.0)])
    for node in upper[-4:]:
        deck.add("*LOAD_NODE_POINT", (int(node), 2, 1, 1.0))
    done = slideline("d=x", deck=deck.output(glstat=0.08, plot=1.0))
    assert done.returncode == 2
    assert "is free to move in y" in done.stderr
    assert 0.499 < last_state(tmp_path / "x")[0] < 0.5001


def pushed_through(kind, n_steps):
    """A block of height 1.5 is pushed by 0.2 towards a plate 0.05 thick, 0.1 below it: in one step without contact, it
    would come out at the far side."""
    deck = implicit(1.0, 1.0 / n_steps, automatic=(1.0e-3, 1.0 / n_steps)).part(points=4).elastic(1000.0, 1.0e6, 0.0)
    lower, upper = deck.mesh(*grid(8, 1, 1.2, 0.05, (-0.1, 0.0))), deck.mesh(*grid(6, 12, 1.0, 1.5, (0.0, 0.15)))
    deck.fix(lower[:9], x=1, y=1).fix(upper[-7:], x=1)
    deck.curve(1, [(0.0, 0.0), (1.0, -0.2)])
    for node in upper[-7:]:
        deck.prescribe(node, 2, 2, 1)
    deck.node_set(1, upper[:7]).node_set(2, lower[-9:][::-1]).contact(1, 2, kind, 1.0e7)
    return deck.output(rcforc=1.0)


@pytest.mark.parametrize("kind", ALL_TYPES)
def test_one_step_does_not_lead_through_a_body(slideline, tmp_path, kind):
    """Contact forces after one step and after twenty are the same, about those of bars of equal stress."""
    forces = []
    for n_steps in (1, 20):
        done = slideline(f"d={n_steps}", deck=pushed_through(kind, n_steps))
        assert done.returncode == 0, done.stderr
        forces.append(abs(numbers(tmp_path / str(n_steps) / "job.rcforc.csv", "fy")[-1]))
    assert forces[0] == pytest.approx(forces[1], rel=2.0e-3)
    assert forces[0] == pytest.approx(1.0e6 * math.log(1.55 / 1.45), rel=0.05)


@pytest.mark.parametrize("kind", ALL_TYPES)
def test_contact_that_closes_in_the_first_iteration(slideline, tmp_path, kind):
    """A plate moves 0.3 m and pushes a free block that nothing else acts on: it does not stay where it is."""
    deck = implicit(1.0, 1.0, dynamic=True).part(1, points=4).elastic(1000.0, 1.0e6, 0.0)
    deck.part(2, points=4).elastic(1000.0, 1.0e6, 0.0, 2)
    block = deck.mesh(*grid(4, 2, 1.0, 0.5), part=1)
    plate = deck.mesh(*grid(3, 1, 1.2, 0.2, (-0.1, -0.3)), part=2)
    deck.node_set(1, block[:5]).node_set(2, plate[4:][::-1]).contact(1, 2, kind, 1.0e6).curve(1, [(0.0, 0.0), (1.0, 0.3)])
    for node in plate:
        deck.prescribe(node, 2, 2, 1)
    done = slideline("d=x", deck=deck.fix(plate, x=1).output(glstat=1.0, nodout=1.0, nodes=block[:1].tolist()))
    assert done.returncode == 0, done.stderr
    assert numbers(tmp_path / "x/job.nodout.csv", "uy")[-1] == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize("n_steps", [2, 5, 8])
def test_one_step_does_not_lead_through_a_moving_body(slideline, tmp_path, n_steps):
    """A block that flies at 3 m/s against a held one, up to 1.5 m a step, turns round."""
    deck = implicit(1.0, 1.0 / n_steps, dynamic=True).part(1, points=4).elastic(1000.0, 1.0e6, 0.0)
    deck.part(2, points=4).elastic(1000.0, 1.0e6, 0.0, 2)
    lower = deck.mesh(*grid(6, 4, 1.5, 1.0, (0.0, -1.0)), part=1)
    upper = deck.mesh(*grid(3, 3, 0.6, 0.6, (0.4, 0.05)), part=2)
    deck.fix(lower[:7], x=1, y=1).node_set(1, upper[:4]).node_set(2, lower[-7:][::-1]).node_set(3, upper)
    deck.contact(1, 2, 7, 5.0e6).add("*INITIAL_VELOCITY", (3,), (0.0, -3.0))
    done = slideline("d=x", deck=deck.output(matsum=1.0))
    assert done.returncode == 0, done.stderr
    assert numbers(tmp_path / "x" / "job.matsum.csv", "momentum_y")[-1] > 0.0


def test_far_bending_in_one_step(slideline):
    """A slender cantilever under ten times the load that linear theory allows: full iterations get there."""
    deck = implicit(1.0, 1.0).part(points=4).elastic(1000.0, 1.2e7, 0.0)
    nodes = deck.mesh(*grid(40, 1, 10.0, 0.25))
    deck.fix(nodes[::41], x=1, y=1).curve(1, [(0.0, 0.0), (1.0, 10.0 * 1.2e7 * 0.25 ** 3 / 12.0 / 10.0 ** 2)])
    for node in nodes[40::41]:
        deck.add("*LOAD_NODE_POINT", (int(node), 2, 1, 0.5))
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0, done.stderr


def test_step_floor_of_the_explicit_method_is_warned_of(slideline):
    deck = pulled(1.0, dt=0.5)
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0 and "DTMIN" not in done.stderr
    place = deck.lines.index("*CONTROL_TERMINATION")
    deck.lines[place + 1] = "1.0, 0, 0.1"
    done = slideline("d=y", deck=deck)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("DTMIN has no effect") == 1


def test_automatic_penalty_of_the_command_line_is_refused(slideline):
    deck = implicit(1.0, 0.1).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    upper = deck.mesh(*grid(3, 2, 0.6, 0.4, (0.2, 0.0)))
    lower = deck.mesh(*grid(5, 2, 1.0, 0.4, (0.0, -0.4)))
    deck.node_set(2, upper[:4]).node_set(3, lower[-6:][::-1]).fix(lower[:6], x=1, y=1)
    done = slideline("d=a", "punit=3", "pen=0.5", deck=deck.contact(2, 3, 1, 2.0e5))
    assert done.returncode == 1
    assert '"punit=3" on the command line asks for a share' in done.stderr


def test_step_of_the_command_line(slideline, tmp_path):
    done = slideline("d=x", "dt=0.25", deck=pulled(1.0e3, dt=0.01))
    assert done.returncode == 0, done.stderr
    assert list(numbers(tmp_path / "x" / "job.glstat.csv", "time")) == [0.0, 0.25, 0.5, 0.75, 1.0]
    effective = next((tmp_path / "x").glob("*.effective.k"))
    done = slideline(f"i={effective}", "d=y", "jobid=again")
    assert done.returncode == 0, done.stderr
    assert len(numbers(tmp_path / "y" / "again.glstat.csv", "time")) == 5


def test_a_first_step_outside_its_limits_is_warned_of(slideline, tmp_path):
    done = slideline("d=x", deck=pulled(1.0e3, dt=0.05, automatic=(0.001, 0.01)))
    assert done.returncode == 0, done.stderr
    assert "first step 5.0" in done.stderr and "DTMAX" in done.stderr
    assert numbers(tmp_path / "x" / "job.glstat.csv", "time")[1] == pytest.approx(0.01)


def test_growing_steps_end_at_plot_states(slideline, tmp_path):
    deck = pulled(1.0e3, dt=0.02, automatic=(0.001, 0.5))
    deck.lines[deck.lines.index("*DATABASE_BINARY_D3PLOT") + 1] = "0.15,"
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "x" / "job.vtkhdf") as stream:
        times = list(stream["VTKHDF/Steps/Values"])
    assert times == pytest.approx([0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0])


def test_easy_steps_grow(slideline, tmp_path):
    done = slideline("d=x", deck=pulled(1.0e3, dt=0.01, automatic=(0.001, 0.2)))
    assert done.returncode == 0, done.stderr
    steps = numbers(tmp_path / "x" / "job.glstat.csv", "time")
    lengths = [b - a for a, b in zip(steps, steps[1:])]
    assert lengths[0] == pytest.approx(0.01) and lengths[1] == pytest.approx(0.015)
    assert max(lengths) == pytest.approx(0.2) or max(lengths) == pytest.approx(0.01 * 1.5 ** 7)
    assert steps[-1] == 1.0


def test_growing_steps_see_a_pulse(slideline, tmp_path):
    """A load that lasts a tenth of a grown step: begin, top and end of it are steps, the others stay whole."""
    deck = pulled(0.0, dt=0.05, automatic=(1.0e-3, 0.3))
    deck.curve(2, [(0.0, 0.0), (0.71, 0.0), (0.72, 10.0), (0.74, 0.0), (1.0, 0.0)])
    deck.add("*LOAD_NODE_POINT", (4, 1, 2, 1.0))
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0, done.stderr
    steps = numbers(tmp_path / "x" / "job.glstat.csv", "time")
    assert {0.71, 0.72, 0.74} <= {round(step, 9) for step in steps}
    assert max(numbers(tmp_path / "x" / "job.glstat.csv", "internal")) > 0.0


def test_load_beyond_the_limit_stops_at_the_limit(slideline, tmp_path):
    """Perfect plasticity carries 2/sqrt(3) of the yield stress in plane strain and no more."""
    limit = 2.0 / math.sqrt(3.0) * YIELD
    deck = pulled(1.5 * limit, dt=0.05, plastic=True, automatic=(1.0e-3, 0.05))
    done = slideline("d=x", deck=deck)
    assert done.returncode == 2
    assert "no equilibrium" in done.stderr
    plot, row = last_state(tmp_path / "x")
    assert plot == row
    assert 0.98 < 1.5 * row < 1.01, row
    assert f"{row:.6E}"[:6] in done.stderr


def test_terminated_is_4(exe, tmp_path):
    (tmp_path / "job.k").write_text(pulled(1.0, dt=1.0e-6).text().replace("1000000000.0", "0.5"))
    process = subprocess.Popen([exe, "i=job.k", "d=out"], cwd=tmp_path, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    path = tmp_path / "out" / "job.glstat.csv"
    for _ in range(100):
        time.sleep(0.1)
        if path.exists() and path.stat().st_size > 1000:
            break
    process.send_signal(signal.SIGTERM)
    stdout, stderr = process.communicate(timeout=20)
    assert process.returncode == 4, stderr
    assert "request" in stdout
    plot, row = last_state(tmp_path / "out")
    assert plot == row > 0.0, "the last state is written on the way out"


def test_stop_in_the_last_step_is_no_stop(exe, tmp_path):
    """The only step is under way when the signal comes: the run reaches its end."""
    deck = implicit(1.0, 1.0).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(100, 60))
    deck.fix(nodes[::101], x=1, y=1).curve(1, [(0.0, 0.0), (1.0, 1.0)])
    deck.add("*LOAD_NODE_POINT", (int(nodes[-1]), 1, 1, 1.0)).output(glstat=1.0)
    (tmp_path / "job.k").write_text(deck.text())
    process = subprocess.Popen([exe, "i=job.k", "d=out"], cwd=tmp_path, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    path = tmp_path / "out" / "job.glstat.csv"
    for _ in range(500):
        time.sleep(0.01)
        if path.exists():
            break
    process.send_signal(signal.SIGTERM)
    stdout, stderr = process.communicate(timeout=60)
    assert process.returncode == 0, stderr
    assert NORMAL in stdout


def arch(drive, dynamic=False):
    """A shallow arch of radius 2 and rise 0.09, 0.008 thick, held at both ends; its crown is driven down: by a force that grows
    to 7000 at each node, or to the depth 0.16 in time 1."""
    deck = implicit(1.0, 0.02, dynamic, automatic=(1.0e-6, 0.02)).part(points=4)
    deck.elastic(1000.0, 1.0e9, 0.0)
    flat, quads = grid(20, 1, 0.6, 0.008, (-0.3, 1.996))
    places = [(y * math.sin(x), y * math.cos(x)) for x, y in flat]
    nodes = deck.mesh(np.array(places), quads)
    deck.fix(nodes[[0, 20, 21, 41]], x=1, y=1).fix(nodes[[10, 31]], x=1)
    if drive == "load":
        deck.curve(1, [(0.0, 0.0), (1.0, -7.0e3)])
        for node in nodes[[10, 31]]:
            deck.add("*LOAD_NODE_POINT", (int(node), 2, 1, 1.0))
    else:
        deck.curve(1, [(0.0, 0.0), (1.0, -0.16)])
        for node in nodes[[10, 31]]:
            deck.prescribe(node, 2, 2, 1)
    return deck.output(glstat=0.01)


def test_a_jump_past_a_limit_point_is_reported(slideline, tmp_path):
    """The load jumps the arch through: the step is named, and what would do; the works of the run do not add up."""
    done = slideline("d=x", deck=arch("load"))
    assert done.returncode == 0, done.stderr
    reported = re.findall(r"warning: step (\d+) to time (\S+) has passed a limit point", done.stderr)
    assert len(reported) == 1, done.stderr
    assert "prescribe a displacement" in done.stderr and "IMASS 1" in done.stderr
    table = tmp_path / "x" / "job.glstat.csv"
    times, ratio = numbers(table, "time"), numbers(table, "energy_ratio")
    after = times >= float(reported[0][1]) - 1.0e-6
    assert 0 < int(reported[0][0]) and np.all(np.abs(ratio[~after] - 1.0) < 0.02) and np.all(ratio[after] < 0.95)
    assert "at the end: energy ratio" in done.stderr


def test_a_prescribed_displacement_follows_the_path(slideline, tmp_path):
    """The same way down with the crown led: the force on it falls and turns round, and nothing is said."""
    deck = arch("way").add("*DATABASE_BNDOUT", (0.01,))
    done = slideline("d=x", deck=deck)
    assert done.returncode == 0, done.stderr
    assert "limit point" not in done.stderr and "energy ratio" not in done.stderr
    assert abs(numbers(tmp_path / "x" / "job.glstat.csv", "energy_ratio")[-1] - 1.0) < 0.01
    force = numbers(tmp_path / "x" / "job.bndout.csv", "fy")
    assert force.min() < 0.0 < force.max()


def test_inertia_follows_the_jump(slideline):
    done = slideline("d=x", deck=arch("load", dynamic=True))
    assert done.returncode == 0, done.stderr
    assert "limit point" not in done.stderr


def test_energies_that_do_not_add_up_end_an_implicit_run(slideline):
    """ENDENG, as in explicit runs."""
    deck = arch("load")
    deck.lines[deck.lines.index("*CONTROL_TERMINATION") + 1] = "1.0, 0, 0, 5.0"
    done = slideline("d=x", deck=deck)
    assert done.returncode == 2 and "ENDENG" in done.stderr


@pytest.mark.parametrize("ctype", (1, 2, 3))
def test_a_node_that_round_off_moves_between_two_segments_is_in_equilibrium(slideline, tmp_path, ctype):
    """Blocks of 40 and 32 columns under 1 Pa: their middle nodes lie opposite each other, and each iteration of the last turns of
    1e-7 found the node on the other segment."""
    grids = patch_grids(even_lines(40), even_lines(32))
    done = slideline("d=out", f"ctype={ctype}", deck=patch(grids=grids, static=True, penalty=1.0e6))
    assert done.returncode == 0, done.stderr
    assert abs(numbers(tmp_path / "out/job.rcforc.csv", "fy")[-1]) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("ctype", (3, 7))
def test_a_light_load_on_a_block_pushed_far_is_carried(slideline, tmp_path, ctype):
    """The first energy is that of the push. An iteration at 1e-14 of it whose springs have just closed is no equilibrium: it gave
    up to 80 times the load."""
    load = 0.01
    deck = implicit(1.0, 1.0, most_iterations=60)
    lower, upper = (deck.part(part, points=4).elastic(1000.0, 1.0e6, 0.3, part).mesh(*grid(columns, 4, width, 1.0, corner), part=part)
                    for part, (columns, width, corner) in enumerate(((40, 2.0, (0.0, 0.0)), (16, 1.6, (0.2, 1.0))), 1))
    deck.node_set(1, lower[-41:]).node_set(2, upper[:17]).fix(lower[:41], x=1, y=1).curve(1, [(0.0, 0.0), (1.0, 1.0)])
    for node, share in zip(upper[-17:], np.r_[0.5, np.ones(15), 0.5] / 16.0):
        deck.prescribe(node, 1, 2, 1, 0.05).add("*LOAD_NODE_POINT", (int(node), 2, 1, -load * share))
    deck.add("*CONTACT_2D_SLIDELINE", (-2, -1, ctype, 2, 1.0e8), (None, None, 1)).output(glstat=1.0, rcforc=1.0)
    done = slideline("d=out", deck=deck)
    assert done.returncode == 0, done.stderr
    assert abs(numbers(tmp_path / "out/job.rcforc.csv", "fy")[-1]) == pytest.approx(load, rel=1e-6)
