# SPDX-License-Identifier: MIT
"""The automatic step at TSSFAC 0.9: single elements, bodies one element thick, gases in shock, all against closed forms."""
import math
import re

import numpy as np
import pytest
from conftest import columns, numbers
from meshes import Deck, grid

#: Limit of a row of two free squares by eigenvalue, the smallest of all rows of squares (units of L/c): 1/sqrt(3/4 + sqrt(1/16 + k^2/2)).
def row_limit(nu):
    k = nu / (1.0 - nu)
    return 1.0 / math.sqrt(0.75 + math.sqrt(0.0625 + 0.5 * k * k))


def modulus(nu):
    """K + 4G/3 of E 1."""
    return (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))


def first_step(tmp_path):
    """Of a run in folder o: dt of the first cycle."""
    return numbers(tmp_path / "o" / "job.glstat.csv", "dt")[0]


def squares(nu, n_x, n_y=1, end=200.0, hourglass=None, extra=()):
    """Free squares of side and density 1 with random velocities."""
    deck = Deck("squares").control(end).part().elastic(1.0, 1.0, nu)
    if hourglass:
        deck.hourglass(hourglass, 0.1)
    for keyword, *cards in extra:
        deck.add(keyword, *cards)
    nodes = deck.mesh(*grid(n_x, n_y, n_x, n_y))
    speed = 1.0e-7 * np.random.default_rng(3).standard_normal((len(nodes), 2))
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), *v) for node, v in zip(nodes, speed)])
    return deck.output(glstat=end / 50.0)


@pytest.mark.parametrize("nu, n_x, hourglass", [(0.3, 1, 0), (0.49, 1, 4), (0.45, 1, 6), (0.3, 8, 0), (0.49, 8, 4), (0.49, 2, 0)])
def test_free_squares_keep_their_energy(slideline, tmp_path, nu, n_x, hourglass):
    """L/c is above the stable step of one free square, sqrt(1 - nu) L/c, and of a row of squares."""
    done = slideline("d=o", deck=squares(nu, n_x, hourglass=hourglass))
    assert done.returncode == 0
    table = tmp_path / "o" / "job.glstat.csv"
    limit = math.sqrt(1.0 - nu) if n_x == 1 else row_limit(nu)
    assert first_step(tmp_path) == pytest.approx(0.9 * limit / math.sqrt(modulus(nu)), rel=1.0e-6)
    assert max(numbers(table, "kinetic")) <= 1.001 * numbers(table, "kinetic")[0]
    assert max(abs(numbers(table, "energy_ratio") - 1.0)) < 0.01
    assert re.search(r"^ +1 +1 ", (tmp_path / "o" / "job.log").read_text(), re.M)   # the list of smallest steps names it


@pytest.mark.parametrize("form, points, nu", [(13, None, 0.4), (13, 4, 0.49), (15, None, 0.49), (15, 4, 0.4)])
def test_bulk_viscosity_of_one_free_square(slideline, tmp_path, form, points, nu):
    """Its fastest mode is in compression every other step, so that the damping counts in expansion too."""
    deck = Deck("square").control(100.0)
    deck.add("*SECTION_SHELL", (1, form, None, points)).part().elastic(1.0, 1.0, nu).add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    nodes = deck.mesh(*grid(1, 1, origin=(2.0, 0.0)))
    speed = 1.0e-6 * np.random.default_rng(7).standard_normal((len(nodes), 2))
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), *v) for node, v in zip(nodes, speed)])
    assert slideline("d=o", deck=deck.output(glstat=1.0)).returncode == 0
    table = tmp_path / "o" / "job.glstat.csv"
    assert max(numbers(table, "kinetic")) <= 1.001 * numbers(table, "kinetic")[0]
    assert max(abs(numbers(table, "energy_ratio") - 1.0)) < 0.05


@pytest.mark.parametrize("nu, n_x, n_y, dense, ratio", [
    (0.49, 2, 2, range(4), 1.0), (0.3, 5, 5, [12], 0.01), (0.45, 5, 5, [12], 0.1), (0.45, 5, 5, [12], 0.2),
    (0.49, 6, 2, range(6, 12), 1.0 / 3.0), (0.499, 4, 4, [5, 6, 9, 10], 0.02), (0.49, 2, 2, "pinned", 1.0)])
def test_dense_among_light_keeps_its_energy(slideline, tmp_path, nu, n_x, n_y, dense, ratio):
    """Four squares, free or with a pinned corner, dense ones in foam, a dense strip on foam, of one speed of sound."""
    deck = Deck("dense").control(200.0).part(1).part(2)
    deck.elastic(1.0, 1.0, nu, 1).elastic(ratio, ratio, nu, 2)
    if dense == "pinned":
        deck.fix([1], x=1, y=1)
        dense = range(4)
    coordinates, quads = grid(n_x, n_y, n_x, n_y)
    deck.add("*NODE", *[(i + 1, *x) for i, x in enumerate(coordinates)])
    deck.add("*ELEMENT_SHELL", *[(i + 1, 1 if i in dense else 2, *[n + 1 for n in quad]) for i, quad in enumerate(quads)])
    speed = 1.0e-7 * np.random.default_rng(3).standard_normal((len(coordinates), 2))
    deck.add("*INITIAL_VELOCITY_NODE", *[(i + 1, *v) for i, v in enumerate(speed)])
    assert slideline("d=o", deck=deck.output(glstat=4.0)).returncode == 0
    table = tmp_path / "o" / "job.glstat.csv"
    assert max(numbers(table, "kinetic")) <= 1.001 * numbers(table, "kinetic")[0]
    assert max(abs(numbers(table, "energy_ratio") - 1.0)) < 0.01
    assert first_step(tmp_path) < 0.9 / math.sqrt(modulus(nu))


def test_thicker_bodies_and_held_sides_keep_their_step(slideline, tmp_path):
    """Two elements thick; a bar whose nodes all keep their y: L/c."""
    for deck in (squares(0.3, 4, 2, end=5.0), squares(0.3, 4, 1, end=5.0, extra=[
            ("*BOUNDARY_SPC_NODE", *[(node, 0, 0, 1) for node in range(1, 11)])])):
        assert slideline("d=o", deck=deck).returncode == 0
        assert first_step(tmp_path) == pytest.approx(0.9 / math.sqrt(modulus(0.3)), rel=1.0e-6)


def test_a_support_stands_for_the_other_half(slideline, tmp_path):
    """One square on rollers is half of a free row of two."""
    deck = squares(0.49, 1, extra=[("*BOUNDARY_SPC_NODE", (1, 0, 0, 1), (2, 0, 0, 1))])
    assert slideline("d=o", deck=deck).returncode == 0
    assert first_step(tmp_path) == pytest.approx(0.9 * row_limit(0.49) / math.sqrt(modulus(0.49)), rel=1.0e-6)


def test_a_free_square_that_grows_keeps_its_step(slideline, tmp_path):
    """Stretched alike along both axes its gradients fall as its sides grow, but its mass stays: so does the stable step."""
    deck = squares(0.3, 1, end=61.0).curve(1, [(0.0, 0.0), (60.0, 0.3), (70.0, 0.3)]).curve(2, [(0.0, 0.0), (70.0, 0.0)])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", *[(node, dof, 2, 1 if place else 2, 1.0, 0, 60.0) for node, places in
                                                   enumerate(((0, 0), (1, 0), (0, 1), (1, 1)), 1) for dof, place in enumerate(places, 1)])
    done = slideline("d=o", deck=deck.output(nodout=1.0, nodes=[4]))
    assert done.returncode == 0, done.stderr
    assert max(numbers(tmp_path / "o" / "job.nodout.csv", "ux")) > 0.29
    steps = numbers(tmp_path / "o" / "job.glstat.csv", "dt")[:-2]
    assert steps == pytest.approx(np.full(len(steps), 0.9 * math.sqrt(0.7 / modulus(0.3))), rel=1.0e-6)


def test_scaled_masses_take_the_same_bound(slideline, tmp_path):
    """DT2MS of a single free square: its mass grows by (DT2MS over sqrt(1 - nu) L/c) squared."""
    deck = squares(0.3, 1)
    text = deck.text().replace("*CONTROL_TIMESTEP\n0.0,0.9", "*CONTROL_TIMESTEP\n0.0,0.9,0,0.0,-1.8")
    assert slideline("d=o", deck=text).returncode == 0
    table = tmp_path / "o" / "job.glstat.csv"
    assert max(abs(numbers(table, "energy_ratio") - 1.0)) < 0.01
    assert first_step(tmp_path) == pytest.approx(0.9 * 1.8, rel=1.0e-6)
    assert numbers(table, "added_mass")[0] == pytest.approx((1.8 / math.sqrt(0.7 / modulus(0.3)))**2 - 1.0, rel=1.0e-6)


def test_what_erosion_leaves_alone_takes_its_bound(slideline, tmp_path):
    """A 3 x 3 block loses all but one corner at t = 5: from then on the step is that of a free square, at restart too."""
    deck = Deck("erosion").control(400.0).part(1).part(2)
    for material in (1, 2):
        deck.elastic(1.0, 1.0, 0.45, material)
    deck.add("*MAT_ADD_EROSION", (2,), (None,) * 7 + (5.0,)).add("*DATABASE_BINARY_D3DUMP", (100,))
    coordinates, quads = grid(3, 3, 3.0, 3.0)
    deck.add("*NODE", *[(i + 1, *x) for i, x in enumerate(coordinates)])
    deck.add("*ELEMENT_SHELL", *[(i + 1, 1 if i == 0 else 2, *[n + 1 for n in quad]) for i, quad in enumerate(quads)])
    deck.add("*INITIAL_VELOCITY_NODE", (1, -1.0e-7, 0.0), (2, 1.0e-7, 1.0e-8)).output(glstat=4.0)
    assert slideline("d=o", deck=deck).returncode == 0
    table = tmp_path / "o" / "job.glstat.csv"
    dt = numbers(table, "dt")
    assert dt[-1] == pytest.approx(0.9 * math.sqrt(0.55 / modulus(0.45)), rel=1.0e-5)
    assert dt[0] == pytest.approx(0.9 * math.sqrt(1.0 / modulus(0.45)), rel=1.0e-5)
    assert max(abs(numbers(table, "energy_ratio") - 1.0)) < 0.01
    before = columns(table)
    assert slideline("r=o/job.dump01.h5", "d=o").returncode == 0
    assert columns(table) == before


def gas(gamma, regions, n, end, form=13, points=None, speed=0.0):
    """A tube of length 1 along y, one element thick, of gases (density, pressure, length); a piston at y = 0 where speed > 0."""
    deck = Deck("gas").control(end)
    deck.add("*SECTION_SHELL", (1, form, None, points))
    for k, (density, pressure, _) in enumerate(regions, 1):
        deck.add("*PART", f"gas {k}", (k, 1, k, k)).add("*MAT_NULL", (k, density))
        deck.add("*EOS_LINEAR_POLYNOMIAL", (k, 0.0, 0.0, 0.0, 0.0, gamma - 1.0, gamma - 1.0), (pressure / (gamma - 1.0), 1.0))
    deck.add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    nodes = [(2 * i + j + 1, j / n, i / n) for i in range(n + 1) for j in range(2)]
    bounds = np.cumsum([length for _, _, length in regions])
    part = [1 + int(np.searchsorted(bounds, (i + 0.5) / n)) for i in range(n)]
    deck.add("*NODE", *nodes)
    deck.add("*ELEMENT_SHELL", *[(i + 1, part[i], 2 * i + 1, 2 * i + 2, 2 * i + 4, 2 * i + 3) for i in range(n)])
    ends = [node for node, _, y in nodes if y in (0.0, 1.0)]
    deck.fix([node for node, _, y in nodes], x=1)
    deck.fix(ends[2:] if speed else ends, y=1)
    if speed:
        deck.curve(1, [(0.0, speed), (10.0, speed)])
        deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", *[(node, 2, 0, 1, 1.0) for node in ends[:2]])
    deck.add("*DATABASE_HISTORY_SHELL", *[tuple(range(i, min(i + 8, n + 1))) for i in range(1, n + 1, 8)])
    deck.add("*DATABASE_ELOUT", (end,))
    return deck.output(glstat=end, nodout=end, nodes=[node for node, x, _ in nodes if x == 0.0])


def profile(tmp_path, n, density):
    """At the end: y and speed of the nodes, y, pressure and density of the elements."""
    y, v, initial = (numbers(tmp_path / "o" / "job.nodout.csv", name) for name in ("y", "vy", "y"))
    y, v, initial = y[-n - 1:], v[-n - 1:], initial[:n + 1]
    pressure = -numbers(tmp_path / "o" / "job.elout.csv", "syy")[-n:]
    return y, v, 0.5 * (y[1:] + y[:-1]), pressure, density * np.diff(initial) / np.diff(y)


def test_sod(slideline, tmp_path):
    """Sod (1978), exact Riemann solution at t = 0.2."""
    n = 100
    done = slideline("d=o", deck=gas(1.4, [(1.0, 1.0, 0.5), (0.125, 0.1, 0.5)], n, 0.2))
    assert done.returncode == 0, done.stderr
    y, v, middle, pressure, density = profile(tmp_path, n, np.where(np.arange(n) < n // 2, 1.0, 0.125))
    time = numbers(tmp_path / "o" / "job.nodout.csv", "time")[-1]
    assert y[n // 2] == pytest.approx(0.5 + 0.92745 * time, abs=0.002)
    star = (middle > 0.55) & (middle < 0.81)
    behind = (middle > 0.705) & (middle < 0.81)
    assert np.mean(pressure[star]) == pytest.approx(0.30313, rel=0.01)
    assert np.mean(v[(y > 0.55) & (y < 0.81)]) == pytest.approx(0.92745, rel=0.01)
    assert np.mean(density[behind]) == pytest.approx(0.26557, rel=0.01)
    assert numbers(tmp_path / "o" / "job.glstat.csv", "energy_ratio")[-1] == pytest.approx(1.0, abs=0.002)


@pytest.mark.parametrize("form, points", [(13, None), (13, 4), (15, None), (15, 4)])
def test_piston_into_cold_gas(slideline, tmp_path, form, points):
    """Strong shock of gamma 5/3, piston speed 1: Rankine-Hugoniot with p0 = 1e-4."""
    n = 60
    shock = (2.0 + math.sqrt(4.0 + 15.0 * 1.0e-4)) / 3.0          # (gamma + 1)/4 u + sqrt(...)
    done = slideline("d=o", deck=gas(5.0 / 3.0, [(1.0, 1.0e-4, 1.0)], n, 0.5, form, points, 1.0))
    assert done.returncode == 0, done.stderr
    y, _, middle, pressure, density = profile(tmp_path, n, 1.0)
    behind = (middle > y[0] + 0.08) & (middle < shock * 0.5 - 0.06)
    assert np.mean(pressure[behind]) == pytest.approx(1.0e-4 + shock, rel=0.01)
    assert np.mean(density[behind]) == pytest.approx(shock / (shock - 1.0), rel=0.01)
    assert numbers(tmp_path / "o" / "job.glstat.csv", "energy_ratio")[-1] == pytest.approx(1.0, abs=0.002)


def test_a_collapsed_element_is_named_with_the_remedy(slideline):
    """A tip that is driven through its own element: no step helps, and the error says what may."""
    deck = Deck("through").control(3.0).part().elastic(1.0, 1.0, 0.0)
    deck.mesh(*grid(1, 1))
    deck.fix([1, 2, 3], x=1, y=1).curve(1, [(0.0, -0.5), (10.0, -0.5)])
    deck.prescribe(4, 1, 0, 1).prescribe(4, 2, 0, 1).output(glstat=0.1)
    done = slideline("d=o", deck=deck)
    assert done.returncode == 2
    assert "element 1 of part 1 has collapsed" in done.stderr and "TSSFAC" in done.stderr


def plates(mach, contact, gap=1.0e-6, card="", end=9.0e-7):
    """Two plates of aluminium, 80 rows of 0.125 mm, that meet; the pressure of Hugoniot's jump.

    Springs this soft let them go some elements into each other, and a face that is free to bend does so from round-off on;
    nodes of a row move alike here."""
    density, sound, slope = 2785.0, 5328.0, 1.338
    speed = mach * sound
    deck = Deck("plates").control(end)
    deck.add("*SECTION_SHELL", (1, 13)).add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    for k, start in ((1, gap), (2, -0.01)):
        deck.add("*PART", f"plate {k}", (k, 1, k, k)).add("*MAT_NULL", (k, density))
        deck.add("*EOS_GRUNEISEN", (k, sound, slope, 0.0, 0.0, 2.0, 0.47, 0.0), (1.0,))
        ids = deck.mesh(*grid(2, 80, 0.0002, 0.01, (0.0, start)), k)
        deck.fix(ids, x=1).add("*SET_PART_LIST", (k,), (k,))
        for row in (0, -1):
            number = 10 * k - row
            deck.node_set(number, ids.reshape(81, 3)[row]).add("*CONSTRAINED_NODE_SET", (number, 2))
    deck.add("*INITIAL_VELOCITY_GENERATION", (1, 2, 0.0, 0.0, -speed)).add("*CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE", *contact)
    deck.add("*DATABASE_HISTORY_SHELL", (5, 9, 13)).add("*DATABASE_ELOUT", (1.0e-7,)).add("*DATABASE_BINARY_D3DUMP", (10,))
    text = deck.output(glstat=1.0e-9).text()
    if card:
        text = text.replace("*CONTROL_TIMESTEP\n0.0,0.9", f"*CONTROL_TIMESTEP\n0.0,0.9,{card}")
    return text, density * (sound + slope * speed / 2.0) * speed / 2.0


def test_plates_do_not_fly_through_each_other(slideline, tmp_path):
    """Mach 0.7: half an element in a stable step. No step is shorter than that takes, and a restart has the same bits."""
    text, jump = plates(0.7, [(1, 2)])
    assert slideline("d=o", "ctype=5", deck=text).returncode == 0
    assert np.median(-numbers(tmp_path / "o" / "job.elout.csv", "syy")[-3:]) == pytest.approx(jump, rel=0.03)
    table = tmp_path / "o" / "job.glstat.csv"
    assert min(numbers(table, "dt")) > 0.9 * 0.9 * 0.8 * 0.00005 / (0.7 * 5328.0)
    before = columns(table)
    assert slideline("r=o/job.dump01.h5", "d=o").returncode == 0
    assert columns(table) == before


@pytest.mark.parametrize("kind, gap", [(6, 0.0031), (6, 0.00325)])
def test_plates_that_come_from_afar_are_seen(slideline, tmp_path, kind, gap):
    """Mach 3, beyond what faces each other at the start: the same bound for all that may be faced later."""
    text, _ = plates(3.0, [(1, 2)], gap, end=4.0e-7)
    slideline("d=o", f"ctype={kind}", deck=text)
    assert max(numbers(tmp_path / "o" / "job.glstat.csv", "internal")) > 0.0


def test_contact_that_pauses_bounds_no_step(slideline, tmp_path):
    """Born after the end: the step is that of the elements."""
    text, _ = plates(0.7, [(1, 2), (None, 1.0e-3)], 0.01)
    assert slideline("d=o", "ctype=5", deck=text).returncode == 0
    dt = numbers(tmp_path / "o" / "job.glstat.csv", "dt")
    assert min(dt) == pytest.approx(max(dt), rel=0.01)


@pytest.mark.parametrize("card, is_bound", [("0,0.0,-1.0e-12", True), ("0,0.0,-2.5e-8", False)])
def test_steps_of_scaled_masses_stay_with_a_warning(slideline, tmp_path, card, is_bound):
    """DT2MS that scales nothing has no say; one that rules the step keeps it, and the log warns."""
    text, _ = plates(1.0, [(1, 2)], 0.001, card, end=2.0e-7)
    warned = "may pass through each other" in slideline("d=o", "ctype=5", deck=text).stderr
    dt = numbers(tmp_path / "o" / "job.glstat.csv", "dt")
    assert warned is not is_bound
    assert (max(dt) <= 0.41 * 0.000125 / 5328.0) if is_bound else dt[1] == pytest.approx(0.9 * 2.5e-8, rel=0.02)
