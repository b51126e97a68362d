# SPDX-License-Identifier: MIT
"""Contact springs that push by the gaps of the end of the step (PUNIT 4), at the step of the elements."""
import pathlib
import re
import sys

import numpy as np

from meshes import Deck, grid, trapezoid

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "corners"))

import scene as corners  # noqa: E402

RHO, YOUNG, LENGTH, SPEED = 1000.0, 1.0e6, 1.0, 0.1
SOUND = np.sqrt(YOUNG / RHO)
DURATION = 2.0 * LENGTH / SOUND   # of the contact of two equal bars
STOCK, IMPLICIT = 2, 4            # PUNIT
RIGID, DEFAULT = -1.0, 0.0        # PEN with PUNIT 4: no compliance, ten times K L/A
N = 50                            # elements of a bar
STEP = 1.0e-9                     # every cycle


def start(title, end, scale, young=(YOUNG, YOUNG), poisson=0.0, dt=None):
    deck = Deck(title)
    deck.control(end, dt=dt, scale=scale).hourglass(4, 0.1)
    for part in (1, 2):
        deck.part(part).elastic(RHO, young[part - 1], poisson, part)
    return deck


def bars(scale, penalty, gap=0.0, other=(N, 1), young=YOUNG, outlines=False):
    """A bar of N x 1 elements runs into one of the same height, which rests."""
    height = LENGTH / N
    deck = start("two bars", 1.6 * DURATION, scale, (YOUNG, young))
    left = deck.mesh(*grid(N, 1, LENGTH, height, (-LENGTH - gap, 0.0)), part=1)
    right = deck.mesh(*grid(*other, LENGTH, height), part=2)
    deck.node_set(1, left).add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0))
    if outlines:
        deck.add("*SET_PART_LIST", (1,), (1,)).add("*SET_PART_LIST", (2,), (2,))
        deck.add("*CONTACT_2D_SLIDELINE", (1, 2, 7, 2, penalty), (0.0, 1.0e20, IMPLICIT))
    else:
        deck.node_set(2, left[N::N + 1]).node_set(3, right[::other[0] + 1][::-1])
        deck.contact(2, 3, 7, penalty, IMPLICIT)
    return deck.output(glstat=STEP, rcforc=STEP, matsum=STEP)


def bar_at_wall(scale, penalty, led):
    """The same against one element that is held, or is led into the bar."""
    height = LENGTH / N
    deck = start("a bar and what is held", 1.3 * DURATION, scale)
    bar = deck.mesh(*grid(N, 1, LENGTH, height, (-LENGTH, 0.0)), part=1)
    wall = deck.mesh(*grid(1, 1, height, height), part=2)
    deck.node_set(1, bar).node_set(2, bar[N::N + 1]).node_set(3, wall[::2][::-1])
    deck.fix(wall, y=1)
    if led:
        deck.curve(1, [(0.0, 1.0), (1.0e3, 1.0)])
        for node in wall:
            deck.prescribe(node, 1, 0, 1, -SPEED)
    else:
        deck.fix(wall, x=1).add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0))
    return deck.contact(2, 3, 7, penalty, IMPLICIT).output(glstat=STEP, rcforc=STEP)


def blocks(sizes, penalty, load, unit=IMPLICIT, scale=0.9, end=4.0 / SOUND, poisson=0.0, young=YOUNG, damping=0.0):
    """Two blocks of 1 m with meshes that do not match; `load`: pressure over time on the upper one."""
    above, below = sizes
    deck = start("pressed blocks", end, scale, (young, YOUNG), poisson)
    upper = deck.mesh(*grid(above, above, origin=(0.0, 1.0)), part=1)
    lower = deck.mesh(*grid(below, below), part=2)
    deck.fix(lower[:below + 1], y=1).curve(1, load)
    top = upper[-above - 1:]
    deck.add("*LOAD_SEGMENT", *[(1, 1.0, 0.0, int(a), int(b)) for a, b in zip(top, top[1:])])
    if damping:
        deck.add("*DAMPING_GLOBAL", (0, damping))
    deck.node_set(1, upper[:above + 1]).node_set(2, lower[-below - 1:][::-1])
    deck.contact(1, 2, 7, penalty, unit).output(plot=end / 60, glstat=end / 60)
    return deck, upper[:above + 1] - 1, lower[-below - 1:] - 1


def plateau(table, share=1.0):
    """Mean and relative deviation of the force between the passages of the waves."""
    force = np.abs(table["fx"])
    inside = force[np.abs(table["time"] - 0.575 * DURATION) < 0.275 * DURATION]
    expected = share * RHO * SOUND * SPEED * LENGTH / N
    return inside.mean() / expected, np.sqrt(np.mean((inside / inside.mean() - 1.0)**2))


def check_bars(run):
    energy = 0.5 * RHO * LENGTH**2 / N * SPEED**2
    forces = {}
    for name, scale, penalty, gap in (("0.9 L/c, no compliance", 0.9, RIGID, 0.0), ("0.9 L/c, default", 0.9, DEFAULT, 1.0e-4),
                                      ("0.5 L/c, no compliance", 0.5, RIGID, 1.0e-4), ("0.995 L/c, no compliance", 0.995, RIGID, 1.0e-3),
                                      ("0.995 L/c, default", 0.995, DEFAULT, 1.0e-3)):
        result = run.program(bars(scale, penalty, gap))
        table, slave = result.table("glstat"), result.table("rcforc").where(side="slave")
        kept = (table["kinetic"] + table["internal"] + table["hourglass"])[-1] / energy
        mean, deviation = plateau(slave, 0.5)
        forces[name] = slave["fx"]
        run.check(f"bars, {name}: energy kept", kept, 1.0 - 0.25 / N, 5.0e-3, "abs", "1 - h/4L: what the first row loses")
        run.check(f"bars, {name}: force / plateau", mean, 1.0, 1.0e-3, source="rho c v/2 x height")
        run.check(f"bars, {name}: rms of the force about it", deviation, 0.0, 6.0e-4, "abs")
        run.check(f"bars, {name}: energy ratio", table["energy_ratio"][-1], 1.0, 2.0e-5)
        run.check(f"bars, {name}: impulse", trapezoid(np.abs(slave["fx"]), slave["time"]), result.table("matsum").where(part=2)["momentum_x"][-1],
                  1.0e-10, source="momentum of the second bar")
    result = run.program(bars(0.9, RIGID, 0.0, outlines=True))
    other = result.table("rcforc").where(side="slave")["fx"]
    run.check("bars: whole outlines against open chains, force", np.abs(other - forces["0.9 L/c, no compliance"]).max() / np.abs(other).max(), 0.0, 1.0e-12, "abs")


def check_momentum(run):
    """Unlike bars whose meshes do not match, nearly at the limit of the elements."""
    result = run.program(bars(0.995, RIGID, 1.0e-3, (40, 1), 3.0 * YOUNG))
    parts, force = result.table("matsum"), result.table("rcforc")
    total = sum(parts.where(part=part)["momentum_x"] for part in (1, 2))
    run.check("unlike bars: momentum / initial", np.ptp(total) / total[0], 0.0, 1.0e-13, "abs")
    both = force.where(side="slave")["fx"] + force.where(side="master")["fx"]
    run.check("unlike bars: force of both sides / largest", np.abs(both).max() / np.abs(force["fx"]).max(), 0.0, 1.0e-14, "abs")


def check_held(run):
    for name, scale, penalty, led in (("held", 0.9, RIGID, False), ("held", 0.995, DEFAULT, False), ("led", 0.9, DEFAULT, True), ("led", 0.995, RIGID, True)):
        result = run.program(bar_at_wall(scale, penalty, led))
        name = f"bar and {name} element, {scale} L/c, PEN {penalty:g}"
        mean, deviation = plateau(result.table("rcforc").where(side="slave"))
        run.check(f"{name}: force / plateau", mean, 1.0, 1.5e-3, source="rho c v x height")
        run.check(f"{name}: rms of the force about it", deviation, 0.0, 6.0e-4, "abs")
        run.check(f"{name}: energy ratio", result.table("glstat")["energy_ratio"][-1], 1.0, 1.0e-4)


def check_uniform(run):
    """A wave through the interface: the pressure stays uniform on both sides, in each state."""
    for sizes, penalty, young in (((5, 4), RIGID, YOUNG), ((4, 7), DEFAULT, YOUNG), ((8, 3), RIGID, 10.0 * YOUNG), ((3, 8), DEFAULT, 0.1 * YOUNG)):
        deck, slave, master = blocks(sizes, penalty, [(0.0, 1.0), (1.0e3, 1.0)], young=young)
        force = run.program(deck).points("contact_force")[:, :, 1]
        name = f"blocks {sizes[0]}/{sizes[1]}, PEN {penalty:g}, E {young:g}"
        for side, nodes, n, sign in (("slave", slave, sizes[0], 1.0), ("master", master, sizes[1], -1.0)):
            pressure = sign * n * force[:, nodes]
            pressure[:, [0, -1]] *= 2.0
            mean = pressure.mean(axis=1)
            run.check(f"{name}: largest mean pressure of the {side}", mean.max(), 1.0, 0.3, "min")
            run.check(f"{name}: deviation of the {side}", np.abs(pressure - mean[:, None]).max() / mean.max(), 0.0, 1.0e-10, "abs")


def check_round(run):
    """The same of discs: forces over the parts of the circle that nodes have."""
    for sizes, penalty, young in (((5, 4), RIGID, YOUNG), ((3, 8), DEFAULT, 0.1 * YOUNG)):
        deck, slave, master = blocks(sizes, penalty, [(0.0, 1.0), (1.0e3, 1.0)], young=young)
        text, count = re.subn(r"(\*SECTION_SHELL\n1,)13", r"\g<1>15", deck.text())
        assert count == 1
        result = run.program(text)
        force = result.points("contact_force")[:, :, 1]
        for side, nodes, n, sign in (("slave", slave, sizes[0], 1.0), ("master", master, sizes[1], -1.0)):
            radius = np.linspace(0.0, 1.0, n + 1)
            area = np.zeros(n + 1)
            area[:-1] += (2.0 * radius[:-1] + radius[1:]) / (6.0 * n)
            area[1:] += (radius[:-1] + 2.0 * radius[1:]) / (6.0 * n)
            pressure = sign * force[:, nodes] / area
            mean = pressure.mean(axis=1)
            name = f"discs {sizes[0]}/{sizes[1]}, PEN {penalty:g}, {side}"
            run.check(f"{name}: largest mean pressure", mean.max(), 1.0, 0.3, "min")
            run.check(f"{name}: deviation", np.abs(pressure - mean[:, None]).max() / mean.max(), 0.0, 1.0e-10, "abs")


def check_stiffness(run):
    """A tenth of K L/A either way, loaded slowly: the forces of type 7 in each state, and at rest."""
    forces = []
    for unit, penalty in ((STOCK, 1.0), (IMPLICIT, 0.1)):
        deck, slave, _ = blocks((5, 4), penalty, [(0.0, 0.0), (2.0, 1000.0), (1.0e3, 1000.0)], unit, end=8.0, poisson=0.3, damping=60.0)
        forces.append(run.program(deck).points("contact_force")[:, slave, 1])
    largest = np.abs(forces[0]).max()
    difference = np.abs(forces[1] - forces[0]).max(axis=1) / largest
    run.check("equal stiffness: force against PUNIT 2, largest difference of all states", difference.max(), 0.0, 1.0e-3, "abs")
    run.check("equal stiffness: at the end", difference[-1], 0.0, 1.0e-6, "abs", "at rest")


def check_corners(run):
    """Pairs of polygons, corners first: without a limit they made 0.19 and 0.20 of their energy."""
    for seed, penalty in ((9001, RIGID), (9032, 10.0)):
        pair = corners.Scene("pair", seed)
        text = pair.deck(7).text()
        springs, count = re.subn(r"(\*CONTACT_2D_SLIDELINE\n\d+,\d+,7,4,)[^\n]*\n([^\n]*),\d+\n", rf"\g<1>{penalty}\n\g<2>,{IMPLICIT}\n", text)
        springs, other = re.subn(r"(\*CONTROL_TIMESTEP\n0.0,)[^\n]*", r"\g<1>0.9", springs)
        assert count == other == 1
        result = run.program(springs)
        made, _ = corners.made_and_lost(result)
        position = result.points("Points")[..., :2]
        run.check(f"pair of polygons {seed}, PEN {penalty:g}: energy made / E0", made, 0.015, 0.0, "max")
        run.check(f"pair of polygons {seed}, PEN {penalty:g}: shared area", max(corners.overlap_area(places, pair.bodies()) for places in position),
                  0.01, 0.0, "max", "bodies of about 2 m^2")


def check_overlap(run):
    """Without compliance a tenth of a penetration from the start is taken back in each step, whatever that makes: a block that is
    led into another one, whose base is held."""
    depth, step = 5.0e-3, 4.0e-3
    deck = start("an overlap from the start", 50 * step, 0.9, dt=step)
    upper = deck.mesh(*grid(4, 4, origin=(0.0, 1.0 - depth)), part=1)
    lower = deck.mesh(*grid(5, 5), part=2)
    deck.fix(lower[:6], y=1).curve(1, [(0.0, 1.0), (1.0e3, 1.0)])
    for node in upper:
        deck.prescribe(node, 2, 0, 1, -SPEED)
    deck.node_set(1, upper[:5]).node_set(2, lower[-6:][::-1]).contact(1, 2, 7, RIGID, IMPLICIT)
    result = run.program(deck.output(glstat=step, plot=step))
    table = result.table("contact")
    gaps = np.array([table["gap"][np.isclose(table["time"], k * step)].min() for k in (5, 10, 20, 40)])
    run.check("overlap: what is left of it after 5, 10, 20 and 40 steps", gaps, -depth * 0.9 ** np.array([5, 10, 20, 40]), 1e-12)
    run.check("overlap: energy ratio", result.table("glstat")["energy_ratio"], 1.0, 1e-3)


def check(run):
    check_corners(run)
    check_overlap(run)
    check_bars(run)
    check_momentum(run)
    check_held(run)
    check_uniform(run)
    check_round(run)
    check_stiffness(run)
