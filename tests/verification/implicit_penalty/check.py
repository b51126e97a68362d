# SPDX-License-Identifier: MIT
"""Contact springs that push by the gaps of the end of the step (PUNIT 4): blocks pressed, rubbed, on a slope and in an overlap,
meshes that do not match; polygons; waves in bars (bars.py)."""
import pathlib
import re
import sys

import numpy as np

import bars
from bars import DEFAULT, IMPLICIT, LENGTH, RHO, RIGID, SOUND, SPEED, STEP, STOCK, YOUNG, start
from meshes import grid, trapezoid
from patch_layouts import ring_areas
from static_patch import hat_areas

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "corners"))

import scene as corners  # noqa: E402

GRAVITY = 1.0
ALWAYS = [(0.0, 1.0), (1.0e3, 1.0)]


def contact(deck, penalty, unit, friction=0.0):
    return deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, 7, 2, penalty, friction, friction), (0.0, 1.0e20, unit))


def pressed(sizes, penalty, load, unit=IMPLICIT, end=4.0 / SOUND, poisson=0.0, young=YOUNG, damping=0.0, led=0.0, friction=0.0):
    """Two blocks of 1 m; `load`: pressure over time on the upper one. `led`: its speed along the interface, that of the
    lower one is zero then."""
    above, below = sizes
    deck = start("pressed blocks", end, 0.9, (young, YOUNG), poisson)
    upper = deck.mesh(*grid(above, above, origin=(0.0, LENGTH)), part=1)
    lower = deck.mesh(*grid(below, below), part=2)
    deck.fix(lower[:below + 1], y=1).curve(1, load)
    top = upper[-above - 1:]
    deck.add("*LOAD_SEGMENT", *[(1, 1.0, 0.0, int(a), int(b)) for a, b in zip(top, top[1:])])
    if damping:
        deck.add("*DAMPING_GLOBAL", (0, damping))
    if led:
        deck.fix(lower, x=1).curve(2, [(0.0, led), (1.0e3, led)])
        for node in upper:
            deck.prescribe(node, 1, 0, 2)
    deck.node_set(1, upper[:above + 1]).node_set(2, lower[-below - 1:][::-1])
    contact(deck, penalty, unit, friction).output(plot=end / (40 if led else 60), glstat=STEP if led else end / 60)
    return deck, upper[:above + 1] - 1, lower[-below - 1:] - 1


def on_base(title, end, poisson=0.0, plot=None, x=0.0, ramp=None):
    """A block of 1 m on a wider one, whose base is held; weight, and a pull along x, that grow within `ramp`."""
    above, below = 5, 8
    deck = start(title, end, poisson=poisson)
    upper = deck.mesh(*grid(above, above), part=1)
    lower = deck.mesh(*grid(below, 2, 2.0, 0.5, (-0.5, -0.5)), part=2)
    deck.fix(lower[:below + 1], x=1, y=1).node_set(1, upper[:above + 1]).node_set(2, lower[-below - 1:][::-1])
    deck.curve(1, [(0.0, 0.0), (ramp, 1.0), (1.0e3, 1.0)] if ramp else ALWAYS)
    if x:
        deck.add("*LOAD_BODY_X", (1, -x))
    return deck, upper


def stresses(result, nodes, areas, sign):
    """Contact force over area of the nodes of a side in each state, (state, node, 2), and its means over the nodes."""
    stress = sign * result.points("contact_force")[:, nodes, :2] / areas[:, None]
    return stress, stress.mean(axis=1)


def check_uniform(run):
    """A wave through the interface: the pressure stays uniform on both sides, in each state; of discs over the parts of the
    circle that nodes have."""
    for sizes, penalty, young, is_axisymmetric in (((5, 4), RIGID, YOUNG, False), ((4, 7), DEFAULT, YOUNG, False),
                                            ((8, 3), RIGID, 10.0 * YOUNG, False), ((3, 8), DEFAULT, 0.1 * YOUNG, False),
                                            ((5, 4), RIGID, YOUNG, True), ((3, 8), DEFAULT, 0.1 * YOUNG, True)):
        deck, slave, master = pressed(sizes, penalty, ALWAYS, young=young)
        text, count = re.subn(r"(\*SECTION_SHELL\n1,)13", r"\g<1>15" if is_axisymmetric else r"\g<1>13", deck.text())
        assert count == 1
        result = run.program(text)
        name = f"{'discs' if is_axisymmetric else 'blocks'} {sizes[0]}/{sizes[1]}, PEN {penalty:g}, E {young:g}"
        for side, nodes, n, sign in (("slave", slave, sizes[0], 1.0), ("master", master, sizes[1], -1.0)):
            x = np.linspace(0.0, 1.0, n + 1)
            areas = ring_areas(np.column_stack([x, 0.0 * x])) if is_axisymmetric else hat_areas(x)
            stress, mean = (values[..., 1] for values in stresses(result, nodes, areas, sign))
            run.check(f"{name}, {side}: largest mean pressure", mean.max(), 1.0)
            run.check(f"{name}, {side}: deviation", np.abs(stress - mean[:, None]).max() / mean.max(), 0.0)


def check_rubbed(run):
    """The same of a block that is led over the other one, as far as the ends that it leaves let them (twice its way over the
    last segment)."""
    for sizes, penalty, speed in (((5, 4), RIGID, 1.0e-12), ((3, 7), DEFAULT, 1.0e-6)):
        deck, slave, master = pressed(sizes, penalty, ALWAYS, led=speed, friction=0.4)
        result = run.program(deck)
        name = f"patch {sizes[0]}/{sizes[1]}, PEN {penalty:g}"
        for side, nodes, n, sign in (("slave", slave, sizes[0], 1.0), ("master", master, sizes[1], -1.0)):
            stress, mean = stresses(result, nodes, hat_areas(np.linspace(0.0, 1.0, n + 1)), sign)
            run.check(f"{name}, {side}: largest mean pressure", mean[:, 1].max(), 1.0)
            pressed_now = mean[:, 1] > 0.1
            ratio = -stress[pressed_now, :, 0] / stress[pressed_now, :, 1]
            run.check(f"{name}, {side}: traction / pressure, largest", ratio.max(), 0.4)
            if penalty == RIGID:
                run.check(f"{name}, {side}: traction / pressure", ratio, 0.4)
            run.check(f"{name}, {side}: deviation", np.abs(stress - mean[:, None]).max() / mean[:, 1].max(), 0.0)
        run.check(f"{name}: energy ratio", result.table("glstat")["energy_ratio"][-1], 1.0)


def check_stiffness(run):
    """A tenth of K L/A either way, loaded slowly: the forces of type 7 in each state, and at rest."""
    for friction in (0.0, 0.5):
        forces = []
        for unit, penalty in ((STOCK, 1.0), (IMPLICIT, 0.1)):
            if friction:
                deck, upper = on_base("pushed slowly", 8.0, 0.3, 0.4, 0.25, 3.0)
                contact(deck, penalty, unit, friction).add("*LOAD_BODY_Y", (1, GRAVITY)).add("*DAMPING_GLOBAL", (0, 30.0))
                deck.output(plot=0.4)
                nodes = upper - 1
            else:
                deck, nodes, _ = pressed((5, 4), penalty, [(0.0, 0.0), (2.0, 1000.0), (1.0e3, 1000.0)], unit, 8.0, 0.3,
                                         damping=60.0)
            forces.append(run.program(deck).points("contact_force")[:, nodes, :2])
        off = np.abs(forces[1] - forces[0]).max(axis=(1, 2)) / np.abs(forces[0]).max()
        name = f"equal stiffness{', friction' if friction else ''}"
        run.check(f"{name}: force against PUNIT 2, largest difference of all states", off.max(), 0.0)
        run.check(f"{name}: at the end", off[-1], 0.0)


def check_sliding(run):
    """A block that slides to rest under its weight."""
    speed, mu = 0.3, 0.5
    stop = speed / (mu * GRAVITY)
    for penalty in (RIGID, DEFAULT):
        deck, upper = on_base("block that slides to rest", 3.0 * stop)
        deck.node_set(3, upper).add("*INITIAL_VELOCITY", (3,), (speed, 0.0)).add("*LOAD_BODY_Y", (1, GRAVITY))
        result = run.program(contact(deck, penalty, IMPLICIT, mu).output(glstat=STEP, rcforc=STEP, matsum=STEP))
        table, parts = result.table("glstat"), result.table("matsum").where(part=1)
        slave, master = (result.table("rcforc").where(side=side) for side in ("slave", "master"))
        name = f"slides to rest, PEN {penalty:g}"
        early = slave["time"] < 0.7 * stop
        run.check(f"{name}: friction beyond mu times pressure, of the weight",
                  (np.abs(slave["fx"]) - mu * slave["fy"]).max() / RHO, 0.0)
        run.check(f"{name}: impulse of friction over that of pressure", -trapezoid(slave["fx"][early], slave["time"][early])
                  / trapezoid(slave["fy"][early], slave["time"][early]), mu)
        run.check(f"{name}: force of both sides / weight",
                  max(np.abs(slave[key] + master[key]).max() for key in ("fx", "fy")) / RHO, 0.0)
        run.check(f"{name}: momentum left / initial", np.abs(parts["momentum_x"][-20:]).max() / (RHO * speed), 0.0)
        run.check(f"{name}: energy ratio", table["energy_ratio"][-1], 1.0)
        run.check(f"{name}: dissipated / kinetic energy", table["friction"][-1] / (0.5 * RHO * speed**2), 1.0)


def check_slope(run):
    """A block on a slope that is steeper than friction holds, and on one that is not; the weight grows from nothing."""
    mu, ramp, end = 0.3, 1.0, 2.0
    path = ramp**2 / 6.0 + 0.5 * ramp * (end - ramp) + 0.5 * (end - ramp)**2
    for slope, penalty in ((0.25, RIGID), (0.25, DEFAULT), (0.5, DEFAULT)):
        angle = np.arctan(slope)
        deck, upper = on_base("block on a slope", end, x=GRAVITY * np.sin(angle), ramp=ramp)
        deck.add("*LOAD_BODY_Y", (1, GRAVITY * np.cos(angle)))
        result = run.program(contact(deck, penalty, IMPLICIT, mu).output(plot=end))
        moved = (result.points("Points")[-1] - result.points("Points")[0])[upper - 1, 0].mean()
        run.check(f"slope {slope}, mu {mu}, PEN {penalty:g}: way / free way", moved / (GRAVITY * np.sin(angle) * path),
                  max(0.0, 1.0 - mu / np.tan(angle)))


def gaps(result, times):
    table = result.table("contact")
    return np.array([table["gap"][np.isclose(table["time"], time)].min() for time in times])


def check_overlap(run):
    """Without compliance a tenth of a penetration from the start is taken back in each step, whatever that makes: a block that is
    led into another one, whose base is held."""
    depth, step, after = 5.0e-3, 4.0e-3, np.array([5, 10, 20, 40])
    deck = start("an overlap from the start", 50 * step, dt=step)
    upper = deck.mesh(*grid(4, 4, origin=(0.0, 1.0 - depth)), part=1)
    lower = deck.mesh(*grid(5, 5), part=2)
    deck.fix(lower[:6], y=1).curve(1, ALWAYS)
    for node in upper:
        deck.prescribe(node, 2, 0, 1, -SPEED)
    deck.node_set(1, upper[:5]).node_set(2, lower[-6:][::-1])
    result = run.program(contact(deck, RIGID, IMPLICIT).output(glstat=step, plot=step))
    run.check("overlap: what is left of it after 5, 10, 20 and 40 steps", gaps(result, after * step), -depth * 0.9 ** after)
    run.check("overlap: energy ratio", result.table("glstat")["energy_ratio"], 1.0)


def check_born(run):
    """A block that lies 8 mm deep in a body when contact is born, rigid or like the body: all at once would be a blow, which made
    13 times as much energy and a ratio of 1.18."""
    depth, step, birth = 8.0e-3, 5.0e-4, 2.0e-2
    for rigid, exchanged in ((True, False), (True, True), (False, False)):
        deck = start("born in an overlap", birth + 50 * step, poisson=0.3, dt=step, rigid=(0, 0) if rigid else None)
        body = deck.mesh(*grid(20, 20), part=1)
        block = deck.mesh(*grid(10, 5, 0.4, 0.2, (0.3, 1.0 - depth + birth)), part=2)
        deck.fix(body[:21], x=1, y=1).node_set(3, block).add("*INITIAL_VELOCITY", (3,), (0.0, -1.0))
        deck.node_set(1, block[:11]).node_set(2, body[-21:][::-1])
        deck.add("*CONTACT_2D_SLIDELINE", (*((-2, -1) if exchanged else (-1, -2)), 7, 2, RIGID),
                 (birth - 0.5 * step, 1.0e20, IMPLICIT))
        result = run.program(deck.output(glstat=step, plot=step))
        name = f"born in an overlap, {('rigid ' if rigid else 'like ') + ('master' if exchanged else 'slave')}"
        depths = gaps(result, birth + step * np.arange(9))
        run.check(f"{name}: what a step leaves of it", depths[1:] / depths[:-1], 0.9)
        run.check(f"{name}: energy ratio", result.table("glstat")["energy_ratio"], 1.0)


def check_corners(run):
    """Pairs of polygons, corners first: without a limit they made 0.19 and 0.20 of their energy."""
    for seed, penalty in ((9001, RIGID), (9032, 10.0)):
        pair = corners.Scene("pair", seed)
        text, count = re.subn(r"(\*CONTACT_2D_SLIDELINE\n\d+,\d+,7,4,)[^\n]*\n([^\n]*),\d+\n",
                              rf"\g<1>{penalty}\n\g<2>,{IMPLICIT}\n", pair.deck(7).text())
        text, other = re.subn(r"(\*CONTROL_TIMESTEP\n0.0,)[^\n]*", r"\g<1>0.9", text)
        assert count == other == 1
        result = run.program(text)
        name = f"pair of polygons {seed}, PEN {penalty:g}"
        run.check(f"{name}: energy made / E0", corners.made_and_lost(result)[0], 0.015)
        run.check(f"{name}: shared area", max(corners.overlap_area(places, pair.bodies())
                                              for places in result.points("Points")[..., :2]), 0.01)


def check(run):
    bars.check(run)
    check_corners(run)
    check_uniform(run)
    check_rubbed(run)
    check_stiffness(run)
    check_sliding(run)
    check_slope(run)
    check_overlap(run)
    check_born(run)
