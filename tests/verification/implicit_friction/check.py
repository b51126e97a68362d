# SPDX-License-Identifier: MIT
"""Friction of contact springs that push by the gaps of the end of the step (PUNIT 4)."""
import numpy as np

from meshes import Deck, grid, trapezoid

RHO, YOUNG, GRAVITY = 1000.0, 1.0e6, 1.0
SOUND = np.sqrt(YOUNG / RHO)
RIGID, DEFAULT = -1.0, 0.0        # PEN with PUNIT 4: no compliance, ten times K L/A
STEP = 1.0e-9                     # every cycle


def scene(title, end, sizes=(5, 8), poisson=0.0, plot=None):
    """A block of 1 m on a wider one, whose base is held; their meshes do not match."""
    deck = Deck(title)
    deck.control(end, scale=0.9).hourglass(4, 0.1)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, poisson, part)
    above, below = sizes
    upper = deck.mesh(*grid(above, above, origin=(0.0, 0.0)), part=1)
    lower = deck.mesh(*grid(below, 2, 2.0, 0.5, (-0.5, -0.5)), part=2)
    deck.fix(lower[:below + 1], x=1, y=1).node_set(1, upper[:above + 1]).node_set(2, lower[-below - 1:][::-1])
    return deck.output(plot=plot, glstat=STEP, rcforc=STEP, matsum=STEP), upper, lower


def rub(deck, penalty, coefficient, kind=7, unit=4):
    return deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 2, penalty, coefficient, coefficient), (0.0, 1.0e20, unit))


def gravity(deck, x, y, ramp=None):
    deck.curve(1, [(0.0, 0.0), (ramp, 1.0), (1.0e3, 1.0)] if ramp else [(0.0, 1.0), (1.0e3, 1.0)])
    if x:
        deck.add("*LOAD_BODY_X", (1, -x))
    return deck.add("*LOAD_BODY_Y", (1, -y))


def check_sliding(run):
    """A block that slides to rest under its weight."""
    speed, mu = 0.3, 0.5
    stop = speed / (mu * GRAVITY)
    for penalty in (RIGID, DEFAULT):
        deck, upper, _ = scene("block that slides to rest", 3.0 * stop)
        deck.node_set(3, upper).add("*INITIAL_VELOCITY", (3,), (speed, 0.0))
        gravity(deck, 0.0, -GRAVITY)
        result = run.program(rub(deck, penalty, mu))
        table, force, parts = result.table("glstat"), result.table("rcforc"), result.table("matsum").where(part=1)
        slave, master = force.where(side="slave"), force.where(side="master")
        name = f"slides to rest, PEN {penalty:g}"
        early = slave["time"] < 0.7 * stop
        run.check(f"{name}: friction beyond mu times pressure, of the weight", (np.abs(slave["fx"]) - mu * slave["fy"]).max() / RHO, 0.0, 2.0e-3, "max",
                  "surfaces tilt by the elastic strain")
        run.check(f"{name}: impulse of friction over that of pressure", -trapezoid(slave["fx"][early], slave["time"][early])
                  / trapezoid(slave["fy"][early], slave["time"][early]), mu, 5.0e-3, source="Coulomb; what swings back sticks for a moment")
        run.check(f"{name}: force of both sides / weight", max(np.abs(slave[key] + master[key]).max() for key in ("fx", "fy")) / RHO, 0.0, 1.0e-13, "abs")
        run.check(f"{name}: momentum left / initial", np.abs(parts["momentum_x"][-20:]).max() / (RHO * speed), 0.0, 0.05, "abs", "shear waves go on")
        run.check(f"{name}: energy ratio", table["energy_ratio"][-1], 1.0, 1.0e-4)
        run.check(f"{name}: dissipated / kinetic energy", table["friction"][-1] / (0.5 * RHO * speed**2), 1.0, 1.0e-2)


def check_slope(run):
    """A block on a slope that is steeper than friction holds, and on one that is not; the weight grows from nothing."""
    mu, ramp, end = 0.3, 1.0, 2.0
    path = ramp**2 / 6.0 + 0.5 * ramp * (end - ramp) + 0.5 * (end - ramp)**2
    for slope, penalty in ((0.25, RIGID), (0.25, DEFAULT), (0.5, DEFAULT)):
        angle = np.arctan(slope)
        deck, upper, _ = scene("block on a slope", end, plot=end)
        gravity(deck, GRAVITY * np.sin(angle), -GRAVITY * np.cos(angle), ramp)
        result = run.program(rub(deck, penalty, mu))
        moved = (result.points("Points")[-1] - result.points("Points")[0])[upper - 1, 0].mean()
        expected = max(0.0, np.sin(angle) - mu * np.cos(angle)) * GRAVITY * path
        run.check(f"slope {slope}, mu {mu}, PEN {penalty:g}: way / free way", moved / (GRAVITY * np.sin(angle) * path), expected / (GRAVITY * np.sin(angle) * path),
                  6.0e-3, "abs", "g (sin - mu cos); 0 where it holds")


def check_patch(run):
    """A block that is led over another one of other elements, pressed at once: pressure and traction stay uniform on both sides, as
    far as the ends that it leaves let them (twice its way over the last segment)."""
    for sizes, penalty, speed, tolerance in (((5, 4), RIGID, 1.0e-12, 1.0e-10), ((3, 7), DEFAULT, 1.0e-6, 2.0e-6)):
        above, below = sizes
        deck = Deck("rubbed blocks")
        deck.control(4.0 / SOUND, scale=0.9).hourglass(4, 0.1)
        for part in (1, 2):
            deck.part(part).elastic(RHO, YOUNG, 0.0, part)
        upper = deck.mesh(*grid(above, above, origin=(0.0, 1.0)), part=1)
        lower = deck.mesh(*grid(below, below), part=2)
        deck.fix(lower[:below + 1], y=1).curve(1, [(0.0, 1.0), (1.0e3, 1.0)]).curve(2, [(0.0, speed), (1.0e3, speed)])
        for node in (*upper, *lower):
            deck.prescribe(node, 1, 0, 2, 1.0 if node in upper else 0.0)
        top = upper[-above - 1:]
        deck.add("*LOAD_SEGMENT", *[(1, 1.0, 0.0, int(a), int(b)) for a, b in zip(top, top[1:])])
        deck.node_set(1, upper[:above + 1]).node_set(2, lower[-below - 1:][::-1])
        result = run.program(rub(deck, penalty, 0.4).output(plot=4.0 / SOUND / 40, glstat=STEP))
        force = result.points("contact_force")
        for side, nodes, n, sign in (("slave", upper[:above + 1] - 1, above, 1.0), ("master", lower[-below - 1:] - 1, below, -1.0)):
            stress = sign * n * force[:, nodes, :2]
            stress[:, [0, -1]] *= 2.0
            mean = stress.mean(axis=1)
            name = f"patch {above}/{below}, PEN {penalty:g}, {side}"
            run.check(f"{name}: largest mean pressure", mean[:, 1].max(), 1.0, 0.3, "min")
            pressed = mean[:, 1] > 0.1
            ratio = -stress[pressed, :, 0] / stress[pressed, :, 1]
            run.check(f"{name}: traction / pressure, largest", ratio.max(), 0.4, tolerance)
            if penalty == RIGID:
                run.check(f"{name}: traction / pressure", ratio, 0.4, tolerance)
            run.check(f"{name}: deviation", np.abs(stress - mean[:, None]).max() / mean[:, 1].max(), 0.0, tolerance, "abs")
        run.check(f"patch {above}/{below}, PEN {penalty:g}: energy ratio", result.table("glstat")["energy_ratio"][-1], 1.0, 1.0e-6)


def check_stiffness(run):
    """A tenth of K L/A either way, pushed slowly while friction holds: the forces of type 7."""
    forces = []
    for unit, penalty in ((2, 1.0), (4, 0.1)):
        deck, upper, _ = scene("pushed slowly", 8.0, poisson=0.3, plot=8.0 / 20)
        gravity(deck, 0.25, -GRAVITY, 3.0).add("*DAMPING_GLOBAL", (0, 30.0))
        forces.append(run.program(rub(deck, penalty, 0.5, unit=unit)).points("contact_force")[:, upper - 1])
    difference = np.abs(forces[1] - forces[0]).max(axis=(1, 2)) / np.abs(forces[0]).max()
    run.check("equal stiffness: force against PUNIT 2, largest difference of all states", difference.max(), 0.0, 2.0e-3, "abs")
    run.check("equal stiffness: at the end", difference[-1], 0.0, 2.0e-4, "abs", "at rest; the ends have slipped on the way")


def check(run):
    check_sliding(run)
    check_slope(run)
    check_patch(run)
    check_stiffness(run)
