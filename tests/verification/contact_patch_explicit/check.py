# SPDX-License-Identifier: MIT
"""Contact patch test by the explicit program, damped to rest: which types pass uniform pressure."""
import functools
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import static_patch  # noqa: E402
from contact_types import PASS_PATCH, TYPES  # noqa: E402
from meshes import Deck, quad_areas  # noqa: E402
from outlines import check_outlines  # noqa: E402
from patch_layouts import (MESHES, SLOPE, consistent_forces, inclined_blocks, lines,  # noqa: E402
                           load_edges, outer_chains)

YOUNG, RHO, PRESSURE, HOURGLASS = 1.0e6, 1000.0, 1.0, 0.1
POINTS = 4
DECAY = 34.0  # of the slowest mode, in powers of e: 2e-15 left


SOFT, MIDDLE, STIFF = 1.0e4, 1.0e6, 1.0e8  # penalties in N/m per contact node
PENALTIES = {"5/4": (SOFT, MIDDLE, STIFF)}  # MIDDLE alone in the other layouts


def longest_sides(coordinates, quads):
    corner = np.asarray(coordinates)[np.asarray(quads)]
    return np.max(np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=-1), axis=1)


def block_deck(title, upper, lower, poisson, relaxation, load=None):
    """Two bodies with damping to rest; relaxation = angular frequency: (lowest, highest, highest of
    the contact springs alone).

    `load`: (time, pressure) points with the time over the end time; a step of PRESSURE if None.
    """
    low, high, springs = relaxation
    deck = Deck(title)
    sound = np.sqrt(YOUNG * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) / RHO)
    thin = min(np.min(quad_areas(*part) / longest_sides(*part)) for part in (upper, lower))
    steps = int(np.ceil(DECAY / low / min(1.6 / high, 1.0 / springs, 0.7 * thin / sound)))
    end = DECAY / low
    deck.control(end, dt=end / steps).hourglass(4, HOURGLASS)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, poisson, part)
    ids = deck.mesh(*upper, part=1), deck.mesh(*lower, part=2)
    deck.curve(1, [(share * end, p) for share, p in load or [(0.0, PRESSURE), (2.0, PRESSURE)]])
    deck.add("*DAMPING_GLOBAL", (0, 2.0 * low))  # critical for the slowest mode
    deck.output(plot=end / 2, glstat=end / 20, rcforc=end / 20)
    return deck, *ids


def pressed_blocks(kind, penalty, blocks, relaxation):
    """The patch test: bottom held in y, u_x held at one bottom and one top node."""
    deck, upper, lower = block_deck(f"patch test, type {kind}", (blocks.upper, blocks.upper_quads),
                                    (blocks.lower, blocks.lower_quads), 0.0, relaxation)
    ids = np.concatenate([upper, lower])
    deck.node_set(1, ids[blocks.slave]).node_set(2, ids[blocks.master][::-1])
    held = blocks.fixed()
    deck.fix(ids[held[held % 2 == 0] // 2], x=1).fix(ids[held[held % 2 == 1] // 2], y=1)
    load_edges(deck, ids[blocks.top])
    return deck.contact(1, 2, kind, penalty, gauss=POINTS)


def interface_forces(result, blocks):
    """Contact forces in y on slave and master nodes at rest."""
    force = result.points("contact_force")[-1, :, 1]
    return force[blocks.slave], force[blocks.master]


def check_layout(run, layout, kind, penalty, blocks, relaxation):
    name = f"{TYPES[kind]}, {layout}, eps {penalty:.0e}"
    result = run.program(pressed_blocks(kind, penalty, blocks, relaxation))
    slave, master = interface_forces(result, blocks)
    pressures = slave / blocks.lengths(0), -master / blocks.lengths(1)
    stress = result.cells("stress")[-1]
    energy = result.table("glstat")
    run.check(f"{name}: kinetic / internal energy at the end",
              energy["kinetic"][-1] / energy["internal"][-1], 0.0, 1e-16, "abs", "at rest")
    # Where pressure is not uniform the loaded face changes its width, by the order of p/E.
    run.check(f"{name}: sum of the forces on slave and master", [slave.sum(), -master.sum()],
              PRESSURE, 1e-9 if kind in PASS_PATCH else 1e-6, source="load times width")
    worst = [np.max(np.abs(p / PRESSURE - 1.0)) for p in pressures]
    if kind in PASS_PATCH:
        for side, pressure in zip(("slave", "master"), pressures):
            run.check(f"{name}: pressure on the {side} side", pressure, PRESSURE, 1e-9,
                      source="uniform")
        run.check(f"{name}: stress yy in all elements", stress[:, 1], -PRESSURE, 1e-9,
                  source="uniform")
        run.check(f"{name}: other stresses", stress[:, [0, 2, 3]], 0.0, 1e-9, "abs", "nu = 0")
        gap = PRESSURE / (penalty * (len(blocks.slave) - 1))
        sink = -result.points("displacement")[-1, blocks.top, 1]
        run.check(f"{name}: top sinks", sink, 2.0 * PRESSURE / YOUNG + gap, 1e-5,
                  source="2 p/E + p/eps_hat, to second order in p/E")
    else:
        expected = static_patch.solve(blocks, kind, penalty, PRESSURE, POINTS, HOURGLASS)
        for side, found, wanted in zip(("slave", "master"), (slave, master), expected):
            run.check(f"{name}: nodal forces on the {side} side", found, wanted, 1e-5,
                      source="independent small-strain static solution")
        for side, error in zip(("slave", "master"), worst):
            run.report(f"{name}: max |p/p0 - 1| on the {side} side", error)


@functools.cache
def inclined_frequencies(penalty, matching):
    return static_patch.frequencies(static_patch.Blocks(*inclined_blocks(matching)[:2], YOUNG), RHO, penalty)


def inclined_patch(kind, penalty, load, matching):
    """Interface inclined by 20 degrees, the load on every outer face: a hydrostatic state."""
    _, x_lower, upper, lower = inclined_blocks(matching)
    n_lower = len(x_lower) - 1
    low, *high = inclined_frequencies(penalty, matching)
    deck, upper_ids, lower_ids = block_deck(f"inclined patch test, type {kind}", upper, lower, 0.3,
                                            (0.3 * low, *(1.5 * value for value in high)),
                                            [(0.0, 0.0), (0.4, load), (2.0, load)])
    slave, *upper_faces = outer_chains(upper_ids, 5)
    *lower_faces, left = outer_chains(lower_ids, n_lower)
    master = lower_faces.pop()
    for chain in (*upper_faces, *lower_faces, left):
        load_edges(deck, chain)
    deck.node_set(1, slave).node_set(2, master)
    strain = load * (1.0 + 0.3) * (1.0 - 2.0 * 0.3) / YOUNG
    # p / eps_hat, eps_hat = eps / mean segment; half of it in two passes (exact if meshes match).
    gap = load / (penalty * 5.0 * np.cos(np.arctan(SLOPE))) / (2.0 if kind == 3 else 1.0)
    corner, pin = lower_ids[0], upper_ids[-1]
    deck.fix([corner], x=1, y=1).fix([lower_ids[n_lower]], y=1)
    # The top corner's u_x in the hydrostatic state (logarithmic strain), so that the pin holds nothing.
    deck.curve(2, [(0.0, 1.0), (1.0e6, 1.0)])
    deck.prescribe(pin, 1, 2, 2, np.expm1(-strain) + gap * np.sin(np.arctan(SLOPE)))
    return deck.contact(1, 2, kind, penalty, gauss=POINTS), slave, master


def check_inclined(run, kind, matching):
    """The tolerances are the round-off of the gaps, 1e-17 m in 2e-8 m, and, for the stresses, that
    of a hypoelastic stress along the way to rest."""
    load = 1.0e-2
    deck, slave, master = inclined_patch(kind, 1.0e5, load, matching)
    name = f"{TYPES[kind]}, {'matching' if matching else '5/4'}, interface inclined by 20 degrees"
    result = run.program(deck)
    energy = result.table("glstat")
    run.check(f"{name}: kinetic / internal energy at the end",
              energy["kinetic"][-1] / energy["internal"][-1], 0.0, 1e-16, "abs", "at rest")
    position = result.points("Points")[-1, :, :2]
    force = result.points("contact_force")[-1, :, :2]
    errors = [(force[ids - 1], consistent_forces(position[ids - 1], load))
              for ids in (slave, master)]
    if kind in PASS_PATCH or matching:
        for side, (found, wanted) in zip(("slave", "master"), errors):
            run.check(f"{name}: nodal forces on the {side} side", found, wanted, 2e-9,
                      source="pressure times consistent length")
        stress = result.cells("stress")[-1]
        run.check(f"{name}: in-plane stresses in all elements", stress[:, [0, 1]], -load, 1e-8,
                  source="hydrostatic: the pins hold nothing")
        run.check(f"{name}: shear stress", stress[:, 3] / load, 0.0, 1e-8, "abs", "hydrostatic")
    else:
        for side, (found, wanted) in zip(("slave", "master"), errors):
            size = np.linalg.norm(wanted, axis=1)
            run.report(f"{name}: max |p/p0 - 1| on the {side} side",
                       np.max(np.linalg.norm(found - wanted, axis=1) / size))


def check_matching(run, kind):
    """Meshes that match: what the contact table says, and PUNIT."""
    n, penalty = 4, 1.0e6
    blocks = static_patch.Blocks(lines(n), lines(n), YOUNG)
    relaxation = static_patch.frequencies(blocks, RHO, penalty)
    name = f"{TYPES[kind]}, matching meshes"
    result = run.program(pressed_blocks(kind, penalty, blocks, relaxation))
    last = result.table("contact")
    last = last.where(time=last["time"][-1])
    run.check(f"{name}: competence lengths", last["length"], np.array([0.5, 1, 1, 1, 0.5]) / n, 1e-5,
              source="half of the neighbouring segments")
    run.check(f"{name}: arc length", last["s"], np.arange(n + 1) / n, 1e-5)
    run.check(f"{name}: pressure is force over length", last["pressure"], last["fy"] / last["length"],
              1e-12, source="definition")
    force = result.table("rcforc")
    run.check(f"{name}: nodal forces add up to the resultant", last["fy"].sum(),
              force.where(side="slave")["fy"][-1], 1e-12)
    if kind > 1:
        run.check(f"{name}: pressure", last["pressure"], PRESSURE, 1e-9, source="matching meshes")
        gap = PRESSURE / n / penalty / (2.0 if kind == 3 else 1.0)
        run.check(f"{name}: penetration", last["gap"], -gap, 1e-5,
                  source="pressure / eps_hat, half of it in two passes")
    else:
        run.report(f"{name}: pressure at the end node / load", last["pressure"][0] / PRESSURE,
                   "unit weight: an end node is twice as stiff as its length asks")
    if kind == 2:
        deck = pressed_blocks(2, penalty * n, blocks, relaxation)
        deck.lines[-1] = deck.lines[-1].rsplit(",", 1)[0] + ",1"
        distributed = run.program(deck, name="distributed").table("rcforc")
        run.check(f"{name}: PUNIT 1 with eps/l_sl gives the same force", distributed["fy"],
                  force["fy"], 1e-12, source="eps_hat = eps/l_sl")


def check(run):
    for layout, mesh in MESHES.items():
        blocks = static_patch.Blocks(*mesh[:2], YOUNG, mesh[2])
        for penalty in PENALTIES.get(layout, (MIDDLE,)):
            relaxation = static_patch.frequencies(blocks, RHO, penalty)
            for kind in TYPES:
                check_layout(run, layout, kind, penalty, blocks, relaxation)
    for kind in TYPES:
        check_inclined(run, kind, matching=False)
        if kind > 1:
            check_inclined(run, kind, matching=True)
        check_matching(run, kind)
    check_outlines(run, pressed_blocks, inclined_patch)
