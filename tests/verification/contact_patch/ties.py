# SPDX-License-Identifier: MIT
"""Patch tests of ties, static: tension, shear and both, discs and rings; bending."""
import numpy as np

import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck
from patch_layouts import MESHES, block_forces, hat_loads, lines, ring_areas

YOUNG, RHO = 1.0e6, 1000.0
#: Strains of 1e-10: what the change of the geometry does is of their order.
LOAD = 1.0e-4
LOADS = {"tension": (0.0, LOAD), "shear": (LOAD, 0.0), "tension and shear": (0.5 * LOAD, LOAD),
         "pressure and shear": (0.5 * LOAD, -LOAD)}
#: Bending: columns of both blocks, and a penalty that does not change with them, N/m^2.
FIXED, SIZES = 1.0e7, ((3, 2), (6, 4), (12, 8), (24, 16))


def tied(run, blocks, kind, penalty, unit, forces, x=0, inner=None):
    """Both blocks of 2 x 2 points, tied, held below in y (and in x), under nodal forces; discs or rings where `inner` is a
    radius. Returns the result and the forces of the tie on both sides."""
    deck = Deck(f"tied blocks, type {kind}").add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    if inner is not None:
        deck.add("*SECTION_SHELL", (1, 15, None, 4), (1.0,))
    ids = blocks.put(deck, RHO, (YOUNG, 0.0), (YOUNG, 0.0), points=4)
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, penalty), (0.0, 1.0e20, unit), (0.0, 1.0, 1))
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0)]).fix(ids[blocks.bottom], x, 1).fix(ids[blocks.bottom[:1]], int(inner is None), 1)
    deck.add("*LOAD_NODE_POINT", *[(node, dof + 1, 1, force[dof]) for node, force in zip(ids.tolist(), forces)
                                   for dof in (0, 1) if force[dof] != 0.0])
    result = run.program(deck.output(plot=1.0, glstat=1.0))
    force = result.points("contact_force")[-1][:, :2]
    return result, (force[blocks.slave], force[blocks.master])


def patch_error(run, kind, name, factor, title):
    """Largest error of the traction on both sides and in the table, over the load."""
    blocks = static_patch.Blocks(*MESHES[name][:2], YOUNG, MESHES[name][2])
    shear, normal = LOADS[title]
    stress = np.array([[0.0, shear], [shear, normal]])
    forces = np.vstack([block_forces(blocks.upper, len(blocks.slave), stress, (1, 2, 3)),
                        block_forces(blocks.lower, len(blocks.master), stress, (1, 3))])
    result, found = tied(run, blocks, kind, 10.0 * factor, 2, forces, x=1)
    worst = [np.max(np.abs(force / blocks.lengths(side)[:, None] - sign * stress[1])) / LOAD
             for side, sign, force in zip((0, 1), (-1.0, 1.0), found)]
    row = result.table("contact").where(time=1.0)
    if kind in PASS_PATCH:
        worst.append(np.max(np.abs([row["pressure"] + normal, row["traction"] + shear])) / LOAD)
        worst.append(0.0 if np.all(row["state"] == 3) else np.inf)
    return max(worst)


def disc_error(run, kind, name, inner, pull):
    """Discs (or rings) tied at a flat face, drawn or pressed along their axis: the same."""
    blocks = static_patch.Blocks(*MESHES[name][:2], YOUNG, MESHES[name][2])
    areas = [ring_areas(np.column_stack([inner + x, 0.0 * x])) for x in blocks.lines]
    for body in (blocks.upper, blocks.lower):
        body[:, 0] += inner
    forces = np.zeros_like(blocks.x)
    forces[blocks.top, 1] = pull * areas[0]
    _, found = tied(run, blocks, kind, None, None, forces, inner=inner)
    return max(np.max(np.abs(force / area[:, None] - [0.0, sign * pull])) / LOAD
               for area, sign, force in zip(areas, (-1.0, 1.0), found))


def bending_error(run, kind, size):
    """Unlike meshes under a linear traction s (x - 1/2): largest and mean (L2) error of the displacements over the largest
    of them, and L2 error of the normal traction of the tie. The exact solution has the spring k of the tie in it (type 3 has
    two): u_y = s (x - 1/2) ((y + 1)/E + 1/k), u_x = -s ((y + 1)^2/(2 E) + y/k), below the tie without 1/k."""
    blocks = static_patch.Blocks(lines(size[0]), lines(size[1]), YOUNG)
    slope, spring = 2.0 * LOAD, FIXED * (2.0 if kind == 3 else 1.0)
    wanted = [hat_loads(x, slope * (x - 0.5)) for x in blocks.lines]
    forces = np.zeros_like(blocks.x)
    forces[blocks.top, 1] = wanted[0]
    result, found = tied(run, blocks, kind, FIXED, 1, forces)
    x, y = blocks.x.T
    is_upper = np.arange(len(x)) < len(blocks.upper)
    given = np.where(is_upper, 1.0 / spring, 0.0)
    exact = np.column_stack([-slope * ((y + 1.0) ** 2 / (2.0 * YOUNG) + y * given),
                             slope * (x - 0.5) * ((y + 1.0) / YOUNG + given)])
    moved = result.points("displacement")[-1][:, :2] - exact
    area = np.where(is_upper, size[0], size[1])[:, None] ** -2.0
    pulls = [np.sqrt(np.sum((force[:, 1] - sign * want) ** 2 / blocks.lengths(side))) / LOAD
             for side, sign, want, force in zip((0, 1), (-1.0, 1.0), wanted, found)]
    return np.max(np.abs(moved)) / np.max(np.abs(exact)), np.sqrt(np.sum(area * moved ** 2)) / np.max(np.abs(exact)), max(pulls)


def check(run):
    for kind in TYPES:
        judge = run.check if kind in PASS_PATCH else lambda name, found, expected: run.report(name, found)
        rows = run.cover(list(MESHES)[:5], (0.1, 1.0), LOADS)
        judge(f"type {kind}: traction of both sides, all layouts, loads and penalties",
              max(patch_error(run, kind, *row) for row in rows), 0.0)
        judge(f"type {kind}: traction of both sides, discs and rings, drawn and pressed", max(
            disc_error(run, kind, name, inner, pull) for name in list(MESHES)[1:4:2] for inner in (0.0, 1.5)
            for pull in (LOAD, -LOAD)), 0.0)
        most, mean, pulls = zip(*(bending_error(run, kind, size) for size in SIZES))
        widths = [1.0 / n for n, _ in SIZES]
        run.report(f"type {kind}: bending, error of displacements on the finest mesh", most[-1])
        run.report(f"type {kind}: bending, error of the traction on the finest mesh", pulls[-1])
        for title, errors, kinds in (("displacements in the mean (L2)", mean, {3, *PASS_PATCH}),
                                     ("the largest error of displacements", most, PASS_PATCH)):
            judge = run.check if kind in kinds else lambda name, found, expected: run.report(name, found)
            judge(f"type {kind}: bending, order of {title}", run.order(widths, errors), 1.9)
