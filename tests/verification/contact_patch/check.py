# SPDX-License-Identifier: MIT
"""Contact patch test: damped to rest, of node sets and of whole outlines; static (static.py) and of ties (ties.py)."""
import functools

import numpy as np

import static
import ties
import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck, quad_areas
from patch_layouts import MESHES, consistent_forces, inclined_blocks, inclined_patch, lines, load_edges

YOUNG, RHO, PRESSURE, HOURGLASS, POINTS = 1.0e6, 1000.0, 1.0, 0.1, 4
DECAY = 34.0  # of the slowest mode, in powers of e: 2e-15 left
SOFT, MIDDLE, STIFF = 1.0e4, 1.0e6, 1.0e8  # penalties in N/m per contact node
PENALTIES = {"5/4": (SOFT, MIDDLE, STIFF)}  # MIDDLE alone in the other layouts
#: Of outlines, N/m of a node. Nodes of the inclined interface are on their line to 1e-17 m: softer.
FLAT, INCLINED = 2.0e5, 2.0e4


def wide(n, left, right):
    return np.linspace(left, right, n + 1)


#: Lines of the upper and of the lower block whose outlines are in contact.
OUTLINES = {
    "matching, flush": (lines(4), lines(4)),
    "5/4, flush": (lines(5), lines(4)),
    "non-uniform, flush": (lines(5, 0.3), lines(4, -0.3)),
    "matching, lower block wider": (lines(4), wide(6, -0.25, 1.25)),
    "upper block wider by parts of a segment": (wide(6, -0.13, 1.21), lines(4)),
    "each overhangs at one end": (wide(5, 0.1, 1.2), wide(4, 0.0, 1.0)),
}


def longest_sides(coordinates, quads):
    corner = np.asarray(coordinates)[np.asarray(quads)]
    return np.max(np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=-1), axis=1)


def damped_deck(title, bodies, poisson, relaxation, load):
    """Deck damped to rest; relaxation = angular frequency: (lowest, highest, highest of the contact springs alone).
    `load`: (time, pressure) points of curve 1 with the time over the end time."""
    low, high, springs = relaxation
    sound = np.sqrt(YOUNG * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) / RHO)
    thin = min(np.min(quad_areas(*body) / longest_sides(*body)) for body in bodies)
    # Springs that open and close have a bound of their own: above it the energy law would hold forces back.
    steps = int(np.ceil(DECAY / low / min(1.6 / high, 1.0 / springs, 0.7 * thin / sound)))
    end = DECAY / low
    deck = Deck(title).control(end, dt=end / steps).hourglass(4, HOURGLASS)
    deck.curve(1, [(share * end, p) for share, p in load])
    deck.add("*DAMPING_GLOBAL", (0, 2.0 * low))  # critical for the slowest mode
    return deck.output(plot=end / 2, glstat=end / 20, rcforc=end / 20)


def pressed_blocks(kind, penalty, blocks, relaxation):
    deck = damped_deck(f"patch test, type {kind}", ((blocks.upper, blocks.upper_quads), (blocks.lower, blocks.lower_quads)),
                       0.0, relaxation, [(0.0, PRESSURE), (2.0, PRESSURE)])
    ids = blocks.put(deck, RHO, (YOUNG, 0.0), (YOUNG, 0.0))
    blocks.hang(deck, ids)
    load_edges(deck, ids[blocks.top])
    return deck.contact(1, 2, kind, penalty, gauss=POINTS)


def check_rest(run, name, result):
    energy = result.table("glstat")
    run.check(f"{name}: kinetic / internal energy at the end", energy["kinetic"][-1] / energy["internal"][-1], 0.0)


def check_layout(run, layout, kind, penalty, blocks, relaxation):
    name = f"{TYPES[kind]}, {layout}, eps {penalty:.0e}"
    result = run.program(pressed_blocks(kind, penalty, blocks, relaxation))
    force = result.points("contact_force")[-1, :, 1]
    slave, master = force[blocks.slave], force[blocks.master]
    check_rest(run, name, result)
    # Where pressure is not uniform the loaded face changes its width, by the order of p/E.
    run.check(f"{name}: sum of the forces on slave and master", [slave.sum(), -master.sum()], PRESSURE,
              scale=1.0 if kind in PASS_PATCH else 1e3)
    pressures = {"slave": slave / blocks.lengths(0), "master": -master / blocks.lengths(1)}
    if kind in PASS_PATCH:
        stress = result.cells("stress")[-1]
        for side, pressure in pressures.items():
            run.check(f"{name}: pressure on the {side} side", pressure, PRESSURE)
        run.check(f"{name}: stress yy in all elements", stress[:, 1], -PRESSURE)
        run.check(f"{name}: other stresses", stress[:, [0, 2, 3]], 0.0)
        sink = -result.points("displacement")[-1, blocks.top, 1]
        run.check(f"{name}: top sinks", sink, 2.0 * PRESSURE / YOUNG + PRESSURE / (penalty * (len(blocks.slave) - 1)))
    else:
        expected = static_patch.solve(blocks, kind, penalty, PRESSURE, POINTS, HOURGLASS)
        for side, found, wanted in zip(pressures, (slave, master), expected):
            run.check(f"{name}: nodal forces on the {side} side", found, wanted)
            run.report(f"{name}: max |p/p0 - 1| on the {side} side", np.max(np.abs(pressures[side] / PRESSURE - 1.0)))


@functools.cache
def inclined_frequencies(penalty, matching):
    low, *high = static_patch.frequencies(static_patch.Blocks(*inclined_blocks(matching)[:2], YOUNG), RHO, penalty)
    return 0.3 * low, *(1.5 * value for value in high)


def inclined_deck(kind, penalty, load, matching):
    bodies = inclined_blocks(matching)[2:]
    deck = damped_deck(f"inclined patch test, type {kind}", bodies, 0.3, inclined_frequencies(penalty, matching),
                       [(0.0, 0.0), (0.4, load), (2.0, load)])
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, 0.3, part)
    ids = [deck.mesh(*body, part=part) for part, body in enumerate(bodies, 1)]
    return deck, *inclined_patch(deck, ids, kind, penalty, load)


def check_inclined(run, kind, matching):
    load = 1.0e-2
    deck, *sides = inclined_deck(kind, 1.0e5, load, matching)
    name = f"{TYPES[kind]}, {'matching' if matching else '5/4'}, interface inclined by 20 degrees"
    result = run.program(deck)
    check_rest(run, name, result)
    place, force = result.points("Points")[-1, :, :2], result.points("contact_force")[-1, :, :2]
    for side, ids in zip(("slave", "master"), sides):
        found, wanted = force[ids - 1], consistent_forces(place[ids - 1], load)
        if kind in PASS_PATCH or matching:
            run.check(f"{name}: nodal forces on the {side} side", found, wanted)
        else:
            run.report(f"{name}: max |p/p0 - 1| on the {side} side",
                       np.max(np.linalg.norm(found - wanted, axis=1) / np.linalg.norm(wanted, axis=1)))
    if kind in PASS_PATCH or matching:
        stress = result.cells("stress")[-1]
        run.check(f"{name}: in-plane stresses in all elements", stress[:, [0, 1]], -load)
        run.check(f"{name}: shear stress", stress[:, 3] / load, 0.0)


def check_matching(run, kind):
    """Meshes that match: what the contact table says, and PUNIT."""
    n, penalty = 4, 1.0e6
    blocks = static_patch.Blocks(lines(n), lines(n), YOUNG)
    relaxation = static_patch.frequencies(blocks, RHO, penalty)
    name = f"{TYPES[kind]}, matching meshes"
    deck = pressed_blocks(kind, penalty, blocks, relaxation)
    result = run.program(deck)
    last = result.table("contact")
    last = last.where(time=last["time"][-1])
    run.check(f"{name}: competence lengths", last["length"], np.array([0.5, 1, 1, 1, 0.5]) / n)
    run.check(f"{name}: arc length", last["s"], np.arange(n + 1) / n)
    run.check(f"{name}: pressure is force over length", last["pressure"], last["fy"] / last["length"])
    force = result.table("rcforc")
    run.check(f"{name}: nodal forces add up to the resultant", last["fy"].sum(), force.where(side="slave")["fy"][-1])
    if kind > 1:
        run.check(f"{name}: pressure", last["pressure"], PRESSURE)
        run.check(f"{name}: penetration", last["gap"], -PRESSURE / n / penalty / (2.0 if kind == 3 else 1.0))
    else:
        run.report(f"{name}: pressure at the end node / load", last["pressure"][0] / PRESSURE,
                   "unit weight: an end node is twice as stiff as its length asks")
    if kind == 2:
        distributed = run.program(contact_of(deck, kind, penalty * n, (-1, -2), 1)).table("rcforc")
        run.check(f"{name}: PUNIT 1 with eps/l_sl gives the same force", distributed["fy"], force["fy"])


def contact_of(deck, kind, penalty, sides, unit):
    """Our contact card instead of the one there."""
    del deck.lines[-3:]
    return deck.add("*CONTACT_2D_SLIDELINE", (*sides, kind, POINTS, penalty), (0.0, 1.0e20, unit))


def check_outlines(run):
    """Part sets against the node sets of the two faces, either side the slave."""
    makers = {}
    for layout, mesh in OUTLINES.items():
        blocks = static_patch.Blocks(*mesh, YOUNG, 4)
        makers[layout] = FLAT, functools.partial(pressed_blocks, penalty=FLAT, blocks=blocks,
                                                 relaxation=static_patch.frequencies(blocks, RHO, FLAT))
    for matching in (True, False):
        makers[f"{'matching' if matching else '5/4'}, inclined by 20 degrees"] = (
            INCLINED, lambda kind, m=matching: inclined_deck(kind, INCLINED, 1.0e-2, m)[0])
    for kind, layout, is_swapped in run.cover(TYPES, makers, (False, True)):
        penalty, make = makers[layout]
        name = f"{TYPES[kind]}, outlines, {layout}, {'lower' if is_swapped else 'upper'} block the slave"
        order, unit, forces = slice(None, None, -1 if is_swapped else 1), int(kind > 1), []
        for sides in ((-1, -2), (11, 12)):
            deck = make(kind)
            # Five segments: the same springs in N/m^2, whatever the mean segment is.
            contact_of(deck, kind, penalty * 5.0 ** unit, sides[order], unit)
            deck.add("*SET_PART_LIST", (11,), (1,)).add("*SET_PART_LIST", (12,), (2,))
            forces.append(run.program(deck).points("contact_force")[-1, :, :2])
        size = np.max(np.abs(forces[0]))
        run.check(f"{name}: there is force", size, 1e-3)
        run.check(f"{name}: nodal forces of whole outlines / largest", forces[1] / size, forces[0] / size)


def check(run):
    for layout, mesh in MESHES.items():
        blocks = static_patch.Blocks(*mesh[:2], YOUNG, mesh[2])
        for penalty in PENALTIES.get(layout, (MIDDLE,)):
            relaxation = static_patch.frequencies(blocks, RHO, penalty)
            for kind in TYPES:
                check_layout(run, layout, kind, penalty, blocks, relaxation)
    for kind in TYPES:
        for matching in (False, True) if kind > 1 else (False,):
            check_inclined(run, kind, matching)
        check_matching(run, kind)
    check_outlines(run)
    static.check(run)
    ties.check(run)
