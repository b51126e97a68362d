# SPDX-License-Identifier: MIT
"""Static press of two plastic blocks, and of a punch, which the explicit program comes to as well; rotations (rotation.py)."""
import numpy as np

import rotation
from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid, moduli
from patch_layouts import load_edges

RHO, YOUNG, POISSON = 1000.0, 2.0e8, 0.3
BULK, SHEAR, CONFINED = moduli(YOUNG, POISSON)
YIELD, TANGENT = 1.0e6, 2.0e7
HARDENING = YOUNG * TANGENT / (YOUNG - TANGENT)
PENALTY = 10.0 * YOUNG
STEPS = 20                       # of the loading, and of the unloading

#: Segments of slave and master for types that pass a uniform pressure on matching meshes only; type 1 needs
#: equal areas of all nodes.
SEGMENTS = {1: (1, 1), 2: (3, 3), 3: (3, 3), 6: (3, 3)}
#: Springs over the area: two nodes with the whole spring each (1), two passes (3).
SPRINGS = {1: 2.0, 3: 2.0}


def press(kind, loads):
    """Unit blocks between side walls under a pressure on top: loads[0] at time 1, loads[1] at time 2."""
    n_up, n_low = SEGMENTS.get(kind, (3, 4))
    deck = Deck(f"press, type {kind}")
    deck.add("*CONTROL_TERMINATION", (2.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0 / STEPS))
    for part in (1, 2):
        deck.part(part, points=4).plastic(RHO, YOUNG, POISSON, YIELD, TANGENT, 1.0, part)
    low = deck.mesh(*grid(n_low, 2, origin=(0.0, -1.0)), part=1)
    up = deck.mesh(*grid(n_up, 2), part=2)
    deck.fix(low[:n_low + 1], y=1)
    for ids, n in ((low, n_low), (up, n_up)):
        deck.fix([*ids[::n + 1], *ids[n::n + 1]], x=1)
    load_edges(deck, up[-n_up - 1:])
    deck.curve(1, [(0.0, 0.0), (1.0, loads[0]), (2.0, loads[1])])
    deck.node_set(1, up[:n_up + 1]).node_set(2, low[-n_low - 1:][::-1]).contact(1, 2, kind, PENALTY, 1)
    return deck.output(plot=1.0, nodout=1.0, nodes=[int(up[-n_up - 1])])


def confined_press(loads):
    """(stress yy, xx, plastic strain, shortening of a block) after loading and after unloading, closed form.

    In e = -ln(height/initial height): sigma = K e + 2 q/3, q = 2 G e - 3 G p, on the way up q = Y + H p;
    the way down is elastic. The side walls keep sigma_xx = -(sigma - q).
    """
    strain = (loads[0] - 2.0 * SHEAR * YIELD / (3.0 * SHEAR + HARDENING)) \
        / (BULK + 4.0 * SHEAR * HARDENING / (3.0 * (3.0 * SHEAR + HARDENING)))
    flow = (2.0 * SHEAR * strain - YIELD) / (3.0 * SHEAR + HARDENING)
    states = []
    for load in loads:
        now = strain + (load - loads[0]) / CONFINED
        q = 2.0 * SHEAR * now - 3.0 * SHEAR * flow
        states.append((-load, q - load, flow, -np.expm1(-now)))
    return np.array(states)


def check_press(run, kind):
    name, loads = TYPES[kind], (4.0e6, 1.0e5)
    result = run.program(press(kind, loads))
    moved = result.table("nodout")["uy"]
    for at, (yy, xx, flow, shortening), text in zip((1, 2), confined_press(loads), ("pressed", "let go")):
        stress, text = result.cells("stress")[at], f"{name}, side walls, {text}"
        run.check(f"{text}: stress along the load", stress[:, 1], yy)
        run.check(f"{text}: stress on the walls", stress[:, 0] / loads[0], xx / loads[0])
        run.check(f"{text}: plastic strain", result.cells("plastic_strain")[at], flow)
        run.check(f"{text}: way of the top", moved[at], -2.0 * shortening + yy / (PENALTY * SPRINGS.get(kind, 1.0)))
    check_newton(run, name, result)


def check_newton(run, name, result):
    """Order of Newton's method from the last three energies of a step, as long as the residual that
    each is computed from is above its round-off."""
    histories, orders = result.newton(), []
    for history in histories:
        energy = [1.0] + [now[0] for before, now in zip(history, history[1:]) if before[1] > 10.0]
        if len(energy) > 2:
            step = np.diff(np.log(energy[-3:]))
            orders.append(step[1] / step[0])
    run.check(f"{name}: largest number of iterations", max(map(len, histories)), 5)
    run.check(f"{name}: order of Newton's method, least of all steps", np.min(orders), 1.3)


def punch(kind, plastic, load, implicit):
    """A block of 3 x 4 quads pressed into one of 10 x 5, non-matching, symmetric about x = 0."""
    modulus, sound = 1.0e6, np.sqrt(moduli(1.0e6, 0.3)[2] / RHO)
    deck = Deck(f"punch, type {kind}")
    for part, limit in ((1, 5.0e3), (2, 5.0e4)):
        deck.part(part, points=4)
        if plastic:
            deck.plastic(RHO, modulus, 0.3, limit, 0.1 * modulus, 1.0, part)
        else:
            deck.elastic(RHO, modulus, 0.3, part)
    low = deck.mesh(*grid(10, 5, 2.0, 1.0, (0.0, -1.0)), part=1)
    up = deck.mesh(*grid(3, 4, 0.7, 0.8), part=2)
    deck.fix(low[:11], y=1).fix([*low[::11], *up[::4]], x=1)
    if implicit:
        end = 1.0
        deck.add("*CONTROL_TERMINATION", (end,))
        deck.add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0 / 320.0 if plastic else 0.25))
        deck.curve(1, [(0.0, 0.0), (end, load)])
    else:
        ramp, rest = (400.0, 150.0) if plastic else (60.0, 20.0)
        end = (ramp + rest) / sound
        s = np.linspace(0.0, 1.0, 41)
        deck.control(end, scale=0.4)
        deck.curve(1, list(zip(ramp / sound * s, load * s ** 3 * (10.0 - 15.0 * s + 6.0 * s * s))))
        deck.add("*DAMPING_GLOBAL", (0, (0.2 if plastic else 1.5) * sound))
    load_edges(deck, up[-4:])
    deck.node_set(1, up[:4]).node_set(2, low[-11:][::-1]).contact(1, 2, kind, 10.0 * modulus, 1)
    return deck.output(plot=end, glstat=end)


def check_drivers(run, kind, plastic):
    """Places and stresses of both drivers: mass and path are different, the rest is one."""
    name = f"{TYPES[kind]}, punch, {'plastic' if plastic else 'elastic'}"
    implicit, explicit = (run.program(punch(kind, plastic, 8.0e3, which)) for which in (True, False))
    for quantity in ("displacement", "contact_pressure"):
        run.check(f"{name}: {quantity}, explicit at rest", explicit.points(quantity)[-1], implicit.points(quantity)[-1])
    run.check(f"{name}: stress, explicit at rest", explicit.cells("stress")[-1], implicit.cells("stress")[-1])
    energy = explicit.table("glstat")
    run.check(f"{name}: explicit kinetic energy over internal", energy["kinetic"][-1] / energy["internal"][-1], 1e-8)
    run.check(f"{name}: largest contact pressure over mean", implicit.points("contact_pressure")[-1].max() / 8.0e3, 1.2)
    if plastic:
        run.check(f"{name}: largest plastic strain", implicit.cells("plastic_strain")[-1].max(), 5e-3)


def check(run):
    for kind in TYPES:
        check_press(run, kind)
        check_drivers(run, kind, False)
    for kind in sorted(PASS_PATCH):
        check_drivers(run, kind, True)
    rotation.check(run)
