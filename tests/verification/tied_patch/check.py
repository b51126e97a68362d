# SPDX-License-Identifier: MIT
"""Patch tests of ties, static, by the implicit program: tension, shear and both; bending."""
import numpy as np

import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck
from patch_layouts import MESHES, lines

YOUNG, RHO = 1.0e6, 1000.0
#: Strains of 1e-10: what the change of the geometry does is of their order.
LOAD = 1.0e-4
LOADS = {"tension": (0.0, LOAD), "shear": (LOAD, 0.0), "tension and shear": (0.5 * LOAD, LOAD),
         "pressure and shear": (0.5 * LOAD, -LOAD)}
#: Bending: columns of both blocks, and a penalty that does not change with them, N/m^2.
FIXED = 1.0e7
SIZES = ((3, 2), (6, 4), (12, 8), (24, 16))


def tied_deck(blocks, kind, penalty, unit, title):
    """Both blocks of 2 x 2 points, tied; the caller loads and holds them."""
    deck = Deck(title)
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, 0.0, part)
    upper = deck.mesh(blocks.upper, blocks.upper_quads, part=1)
    lower = deck.mesh(blocks.lower, blocks.lower_quads, part=2)
    ids = np.concatenate([upper, lower])
    deck.node_set(1, ids[blocks.slave]).node_set(2, ids[blocks.master][::-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, penalty), (0.0, 1.0e20, unit), (0.0, 1.0, 1))
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0)])
    deck.output(plot=1.0, glstat=1.0)
    return deck, ids, upper, lower


def outer_forces(x, columns, stress, keep):
    """Nodal forces of a stress on the edges of a block (0 bottom, 1 right, 2 top, 3 left), body on the left."""
    rows = np.arange(len(x)).reshape(-1, columns)
    total = np.zeros_like(x)
    for k, chain in enumerate((rows[0], rows[:, -1], rows[-1, ::-1], rows[::-1, 0])):
        if k not in keep:
            continue
        edge = np.diff(x[chain], axis=0)
        half = 0.5 * np.stack([edge[:, 1], -edge[:, 0]], axis=1) @ stress
        np.add.at(total, chain[:-1], half)
        np.add.at(total, chain[1:], half)
    return total


def load(deck, ids, forces):
    cards = [(node, dof + 1, 1, forces[k, dof]) for k, node in enumerate(ids.tolist())
             for dof in (0, 1) if forces[k, dof] != 0.0]
    if cards:
        deck.add("*LOAD_NODE_POINT", *cards)


def tied_forces(result, blocks):
    """Forces of the tie on both sides at the end."""
    force = result.points("contact_force")[-1][:, :2]
    return force[blocks.slave], force[blocks.master]


def check_patch(run, kind, name, factor, title):
    blocks = static_patch.Blocks(*MESHES[name][:2], YOUNG, MESHES[name][2])
    worst, (shear, normal) = 0.0, LOADS[title]
    stress = np.array([[0.0, shear], [shear, normal]])
    deck, ids, upper, lower = tied_deck(blocks, kind, 10.0 * factor, 2, f"tied patch, {title}, type {kind}")
    load(deck, upper, outer_forces(blocks.upper, len(blocks.slave), stress, (1, 2, 3)))
    load(deck, lower, outer_forces(blocks.lower, len(blocks.master), stress, (1, 3)))
    deck.fix(ids[blocks.bottom], 1, 1)
    result = run.program(deck)
    for side, sign, found in zip((0, 1), (-1.0, 1.0), tied_forces(result, blocks)):
        area = blocks.lengths(side)
        worst = max(worst, np.max(np.abs(found / area[:, None] - sign * stress[1])) / LOAD)
    row = result.table("contact").where(time=1.0)
    if kind in PASS_PATCH:
        worst = max(worst, np.max(np.abs([row["pressure"] + normal, row["traction"] + shear])) / LOAD)
        worst = worst if np.all(row["state"] == 3) else np.inf
    return worst


def disc_error(run, name, kind, inner, pull):
    """Discs (or rings) tied at a flat face, drawn or pressed along their axis: largest deviation of the tractions on
    either side, over the load."""
    blocks = static_patch.Blocks(*MESHES[name][:2], YOUNG, MESHES[name][2])
    deck = Deck(f"tied discs, type {kind}")
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    deck.add("*SECTION_SHELL", (1, 15, None, 4), (1.0,))
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
    upper = deck.mesh(blocks.upper + [inner, 0.0], blocks.upper_quads, part=1)
    lower = deck.mesh(blocks.lower + [inner, 0.0], blocks.lower_quads, part=2)
    ids = np.concatenate([upper, lower])
    deck.node_set(1, ids[blocks.slave]).node_set(2, ids[blocks.master][::-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4), (0.0, 1.0e20), (0.0, 1.0, 1))
    deck.fix(ids[blocks.bottom], y=1).curve(1, [(0.0, 0.0), (1.0, 1.0)])
    forces = np.zeros_like(blocks.upper)
    forces[-len(blocks.slave):, 1] = pull * ring_areas(inner + blocks.lines[0])
    load(deck, upper, forces)
    result = run.program(deck.output(plot=1.0, glstat=1.0))
    return max(np.max(np.abs(found / ring_areas(inner + lines_of)[:, None] - [0.0, sign * pull])) / LOAD
               for lines_of, sign, found in zip(blocks.lines, (-1.0, 1.0), tied_forces(result, blocks)))


def ring_areas(r):
    """Integrals of the hat functions of nodes along the radius, times it."""
    length, total = np.diff(r), np.zeros(len(r))
    total[:-1] += length * (2.0 * r[:-1] + r[1:]) / 6.0
    total[1:] += length * (r[:-1] + 2.0 * r[1:]) / 6.0
    return total


def bending_error(run, kind, size):
    """Unlike meshes under a linear traction s (x - 1/2): largest and mean (L2) error of the displacements over the largest
    of them, and L2 error of the normal traction of the tie. The exact solution has the spring k of the tie in it (type 3 has
    two): u_y = s (x - 1/2) ((y + 1)/E + 1/k), u_x = -s ((y + 1)^2/(2 E) + y/k), below the tie without 1/k."""
    blocks = static_patch.Blocks(lines(size[0]), lines(size[1]), YOUNG)
    deck, ids, upper, lower = tied_deck(blocks, kind, FIXED, 1, f"tied bending, type {kind}")
    slope, spring = 2.0 * LOAD, FIXED * (2.0 if kind == 3 else 1.0)
    forces = np.zeros_like(blocks.upper)
    forces[-len(blocks.slave):, 1] = hat_forces(blocks.lines[0], slope)
    load(deck, upper, forces)
    deck.fix(ids[blocks.bottom], 0, 1).fix(ids[blocks.bottom[:1]], 1, 1)
    result = run.program(deck)
    x, y = blocks.x.T
    given = np.where(np.arange(len(x)) < len(blocks.upper), 1.0 / spring, 0.0)
    exact = np.column_stack([-slope * ((y + 1.0) ** 2 / (2.0 * YOUNG) + y * given),
                             slope * (x - 0.5) * ((y + 1.0) / YOUNG + given)])
    moved = result.points("displacement")[-1][:, :2] - exact
    area = np.where(np.arange(len(x)) < len(blocks.upper), size[0], size[1])[:, None] ** -2.0
    errors = np.array([np.max(np.abs(moved)), np.sqrt(np.sum(area * moved ** 2))]) / np.max(np.abs(exact))
    pulls = []
    for side, sign, found in zip((0, 1), (-1.0, 1.0), tied_forces(result, blocks)):
        wrong = found[:, 1] - sign * hat_forces(blocks.lines[side], slope)
        pulls.append(np.sqrt(np.sum(wrong ** 2 / blocks.lengths(side))) / LOAD)
    return *errors, max(pulls)


def hat_forces(place, slope):
    """Integrals of slope (x - 1/2) with the hat functions."""
    half, value, total = np.diff(place), slope * (place - 0.5), np.zeros(len(place))
    total[:-1] += half * (2.0 * value[:-1] + value[1:]) / 6.0
    total[1:] += half * (value[:-1] + 2.0 * value[1:]) / 6.0
    return total


def check(run):
    for kind in TYPES:
        rows = run.cover(list(MESHES)[:5], (0.1, 1.0), LOADS)
        found = max(check_patch(run, kind, *row) for row in rows)
        if kind in PASS_PATCH:
            run.check(f"type {kind}: traction of both sides, all layouts, loads and penalties", found, 0.0, 1.0e-9, "abs",
                      "the stress that the bodies carry")
        else:
            run.report(f"type {kind}: largest error of the traction on either side", found)
        found = max(disc_error(run, name, kind, inner, pull) for name in list(MESHES)[1:4:2] for inner in (0.0, 1.5)
                    for pull in (LOAD, -LOAD))
        if kind in PASS_PATCH:
            run.check(f"type {kind}: traction of both sides, discs and rings, drawn and pressed", found, 0.0, 1.0e-9, "abs",
                      "the stress that the bodies carry")
        else:
            run.report(f"type {kind}: largest error of the traction on either side, discs and rings", found)
        most, mean, pulls = zip(*(bending_error(run, kind, size) for size in SIZES))
        widths = [1.0 / n for n, _ in SIZES]
        run.report(f"type {kind}: bending, error of displacements on the finest mesh", most[-1])
        run.report(f"type {kind}: bending, error of the traction on the finest mesh", pulls[-1])
        for title, order, kinds in (("displacements in the mean (L2)", run.order(widths, mean), {3, *PASS_PATCH}),
                                    ("the largest error of displacements", run.order(widths, most), PASS_PATCH)):
            if kind in kinds:
                run.check(f"type {kind}: bending, order of {title}", order, 1.9, 0.0, "min", "second order")
            else:
                run.report(f"type {kind}: bending, order of {title}", order)
