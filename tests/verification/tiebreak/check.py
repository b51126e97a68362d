# SPDX-License-Identifier: MIT
"""Ties that break, explicit and implicit, against what springs with a strength must do."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid

YOUNG, RHO = 1.0e6, 1000.0
#: Penalty of the ties, N/m^2 per m, strengths in tension and in shear, N/m^2.
SPRING, STRENGTH = 1.0e6, (2.0e3, 3.0e3)
FRICTION = 0.4
STEP = 1.0e-4


def spring_of(kind):
    """Stiffness per area: type 3 has two passes."""
    return SPRING * (2.0 if kind == 3 else 1.0)


def tie(deck, kind, slave, master, friction=0.0, penalty=SPRING, strength=STRENGTH):
    deck.node_set(1, slave).node_set(2, master)
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, penalty, friction), (0.0, 1.0e20, 1),
             (0.0, 1.0, 2, *strength))


def led(run, kind, way, name):
    """Two unit blocks of unlike meshes, the upper one led as a whole along `way`: rows of time, u_x and u_y. Springs are
    all that gives way. Returns the result and, for each row of rcforc, the motion."""
    deck = Deck(f"tie that breaks, type {kind}, {name}")
    deck.control(way[-1][0], dt=STEP)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
    upper = deck.mesh(*grid(7, 1), part=1)
    lower = deck.mesh(*grid(5, 1, 3.0, 1.0, (-1.0, -1.0)), part=2)
    tie(deck, kind, upper[:8], lower[:-7:-1], FRICTION)
    deck.fix(lower, 1, 1)
    for dof in (1, 2):
        rows = [(row[0], row[dof]) for row in way]
        speed = [(time, (b[1] - a[1]) / (b[0] - a[0])) for a, b in zip(rows, rows[1:])
                 for time in (a[0] + 1e-3 * STEP, b[0] - 1e-3 * STEP)]
        deck.curve(dof, speed)
        for node in upper:
            deck.prescribe(node, dof, 0, dof)
    deck.output(plot=way[-1][0], glstat=STEP, rcforc=STEP)
    deck.add("*DATABASE_SLEOUT", (STEP,))
    result = run.program(deck, name=f"{name}_{kind}".replace(" ", "_"))
    row = result.table("rcforc").where(side="slave")
    time = np.array([row[0] for row in way])
    return result, row, [np.interp(row["time"], time, [row[dof] for row in way]) for dof in (1, 2)]


def check_ellipse(run, kind):
    """Led along a straight line: the place where it breaks, the force up to it, and what is spent."""
    k, (most_n, most_s) = spring_of(kind), STRENGTH
    places, forces, energies = [], [], []
    for degrees in (0.0, 25.0, 50.0, 75.0, 90.0):
        direction = np.array([np.sin(np.radians(degrees)), np.cos(np.radians(degrees))])
        reach = 1.0 / (k * np.hypot(direction[1] / most_n, direction[0] / most_s))
        end = 1.25 * 100.0 * STEP
        way = [(0.0, 0.0, 0.0), (end, *(1.25 * reach * direction))]
        result, row, (ux, uy) = led(run, kind, way, f"{degrees:.0f} degrees")
        held = np.hypot(row["fx"], row["fy"]) > 0.0
        places.append(row["time"][np.nonzero(held)[0][-1]] / (0.8 * end))
        before = row["time"] <= 0.799 * end
        forces += [np.max(np.abs(row["fx"] + k * ux)[before]) / most_s, np.max(np.abs(row["fy"] + k * uy)[before]) / most_n]
        forces.append(np.max(np.abs(row["fx"])[row["time"] > 0.82 * end]) / most_s)
        energies.append(result.table("sleout")["energy"][-1] / (0.5 * k * reach ** 2))
        run.check(f"type {kind}: {degrees:.0f} degrees from tension, all places are broken",
                  result.table("contact").where(time=result.times[-1])["state"], 4.0, 0.0, "abs")
    run.check(f"type {kind}: break on the ellipse, tension to shear", places, 1.0, 0.0101, "abs", "one step of a hundred")
    run.check(f"type {kind}: forces up to the break, and none after", forces, 0.0, 1.0e-9, "abs", "k u")
    run.check(f"type {kind}: energy that stays in contact", energies, 1.0, 0.011, "abs", "k u^2/2 at the break")


def check_again(run, kind):
    """Broken in tension, pressed again, and drawn along while pressed: contact with friction."""
    k, depth, way_along = spring_of(kind), 1.0e-3, 4.0e-3
    broken = 1.2 * STRENGTH[0] / k
    t = 100.0 * STEP
    way = [(0.0, 0.0, 0.0), (t, 0.0, broken), (2.0 * t, 0.0, -depth), (4.0 * t, way_along, -depth)]
    result, row, (_, uy) = led(run, kind, way, "again")
    pressed = (row["time"] > t) & (row["time"] <= 2.0 * t)
    run.check(f"type {kind}: pressed again", row["fy"][pressed], np.maximum(0.0, -k * uy[pressed]), 1.0e-9, "rel",
              "contact under the same penalty")
    run.check(f"type {kind}: drawn along", row["fx"][-1], -FRICTION * k * depth, 1.0e-9, "rel", "mu p")
    # the tangential springs stretch by mu p/k, then slip
    slipped = way_along - FRICTION * depth
    run.check(f"type {kind}: dissipated", result.table("sleout")["friction"][-1], FRICTION * k * depth * slipped, 0.011)
    rows = result.table("contact").where(time=result.times[-1])
    run.check(f"type {kind}: slip since the start", rows["slip"], -way_along, 1.0e-9, "rel")
    run.check(f"type {kind}: still broken", rows["state"], 4.0, 0.0, "abs")
    run.check(f"type {kind}: energy ratio", result.table("glstat")["energy_ratio"][2:], 1.0, 1.0e-2, "abs")


def check_pressed(run, kind):
    """Pressed, and sheared until it breaks: pressure does not help, and goes on as contact."""
    k, depth = spring_of(kind), 1.0e-3
    reach, t = STRENGTH[1] / k, 100.0 * STEP
    way = [(0.0, 0.0, 0.0), (t, 0.0, -depth), (2.25 * t, 1.25 * reach, -depth)]
    result, row, (ux, uy) = led(run, kind, way, "pressed")
    run.check(f"type {kind}: pressed and sheared, normal force throughout", row["fy"], -k * uy, 1.0e-9, "rel")
    before, after = row["time"] < 1.99 * t, row["time"] > 2.01 * t
    grip = np.minimum(FRICTION * k * depth, k * (ux - reach) + 1.0e-9)
    run.check(f"type {kind}: shear up to its strength", row["fx"][before], -k * ux[before], 1.0e-9, "rel")
    run.check(f"type {kind}: then friction, from nothing", row["fx"][after], -grip[after], 0.011 * STRENGTH[1], "abs")
    energy = result.table("sleout")["energy"][-1]
    grip = 0.5 * (FRICTION * k * depth) ** 2 / k
    run.check(f"type {kind}: what stays, with what contact holds", energy,
              0.5 * k * (reach ** 2 + depth ** 2) + grip, 0.011)


def check(run):
    for kind in TYPES:
        if kind == 1:
            continue
        check_ellipse(run, kind)
        check_again(run, kind)
        check_pressed(run, kind)
