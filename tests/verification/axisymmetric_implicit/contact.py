# SPDX-License-Identifier: MIT
"""Contact patch tests of discs and rings, flat and conical; a shaft in a hub; Newton's method with friction."""
import itertools

import numpy as np

import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid
from patch_layouts import MESHES, SLOPE, inclined_block, lines, load_edges, outer_chains, ring_areas

RADII = {"disc": 0.0, "ring": 0.5}
PENALTIES = (1.0e3, 1.0e6, 1.0e8)
LAYOUTS = ("5/4", "7/5 non-uniform", "slave segments over three and four master segments, 2/7")


def axisymmetric_deck(title, end, step, parts=1):
    deck = Deck(title).add("*CONTROL_TERMINATION", (end,))
    deck.add("*CONTROL_IMPLICIT_GENERAL", (1, step)).add("*SECTION_SHELL", (1, 15, None, 4), (1.0,))
    for part in range(1, parts + 1):
        deck.part(part, section=1)
    return deck


def patch_deck(title, meshes, poisson, size, inner, columns):
    deck = axisymmetric_deck(title, 1.0, 1.0, 2)
    for part in (1, 2):
        deck.elastic(1000.0, 1.0e6, poisson, part)
    ids = [deck.mesh(points + np.array([inner, 0.0]), quads, part=k + 1)
           for k, (points, quads) in enumerate(meshes)]
    deck.curve(1, [(0.0, 0.0), (1.0, size)])
    deck.output(plot=1.0, glstat=1.0, rcforc=1.0)
    return deck, [outer_chains(one, len(x) - 1) for one, x in zip(ids, columns)]


def flat_errors(run, kind, layout, body, poisson, penalty):
    """Largest |p/p0 - 1| of slave and master, of the stresses, and the iterations."""
    columns = MESHES[layout][:2]
    meshes = [static_patch.block_grid(x, bottom) for x, bottom in zip(columns, (0.0, -1.0))]
    deck, (upper, lower) = patch_deck(f"{body}, type {kind}", meshes, poisson, 1.0, RADII[body], columns)
    load_edges(deck, upper[2])
    deck.node_set(1, upper[0]).node_set(2, lower[2])
    deck.fix(lower[0], y=1)
    result = run.program(deck.contact(1, 2, kind, penalty, gauss=4))
    place, force = result.points("Points")[-1], result.points("contact_force")[-1]
    errors = [np.max(np.abs(sign * force[ids - 1, 1] / ring_areas(place[ids - 1, :2]) - 1.0))
              for ids, sign in ((upper[0], 1.0), (lower[2], -1.0))]
    stress = result.cells("stress")[-1]
    errors.append(max(np.max(np.abs(stress[:, 1] + 1.0)), np.max(np.abs(stress[:, [0, 2, 3]]))))
    return (*errors, len(result.newton()[-1]))


def check_flat(run, kind):
    rows = run.cover(RADII, LAYOUTS if kind in PASS_PATCH else LAYOUTS[:1], (0.0, 0.3), PENALTIES)
    for (body, layout, poisson), group in itertools.groupby(rows, lambda row: row[:3]):
        name = f"{TYPES[kind]}, {body}, {layout}, nu {poisson}"
        worst = np.max([flat_errors(run, kind, layout, body, poisson, row[3]) for row in group], axis=0)
        run.check(f"{name}: Newton iterations", worst[3], 4)
        if kind not in PASS_PATCH:
            run.report(f"{name}: max |p/p0 - 1| on both sides", max(worst[:2]))
            continue
        for text, error in zip(("max |p/p0 - 1| on the slave side", "max |p/p0 - 1| on the master side",
                                "stresses in all elements / p0"), worst):
            run.check(f"{name}: {text}", error, 0.0)


def check_dish(run, kind, size=10.0, penalty=100.0):
    """Interface inclined by 20 degrees, the load on all outer faces; springs so soft that the slave's node on the axis is
    behind a dish by more than what counts at a chain's end."""
    columns = lines(5, 0.2), lines(4, -0.2)
    meshes = [inclined_block(columns[0], lambda x: SLOPE * x, lambda x: 1.0 + 0.0 * x),
              inclined_block(columns[1], lambda x: -1.0 + 0.0 * x, lambda x: SLOPE * x)]
    deck, (upper, lower) = patch_deck(f"cone in a dish, type {kind}", meshes, 0.3, size, 0.0, columns)
    for chain in (*upper[1:3], lower[1]):
        load_edges(deck, chain)
    deck.node_set(1, upper[0]).node_set(2, lower[2]).fix(lower[0], y=1)
    result = run.program(deck.contact(1, 2, kind, penalty, gauss=4))
    place, force = result.points("Points")[-1, upper[0] - 1, :2], result.points("contact_force")[-1, upper[0] - 1, :2]
    along = (place[-1] - place[0]) / np.linalg.norm(place[-1] - place[0])
    off = force[0, 1] / (size * ring_areas(place)[0]) - along[0]
    gap = size / (penalty * 5.0 * np.cos(np.arctan(SLOPE)))
    sideways = gap * np.sin(np.arctan(SLOPE)) / min(np.min(np.diff(x)) for x in columns)
    name = f"{TYPES[kind]}, cone in a dish, {sideways:.3f} of a segment sideways"
    run.check(f"{name}: axial force on the node on the axis over that of uniform pressure", off, 0.0)


def check_compound(run, kind):
    """A solid shaft of radius 1 in a hub of radii 1 and 2, ends held, pressed from outside; the rows do not match."""
    young, poisson, pressure, penalty = 1.0e6, 0.3, 1.0, 1.0e6
    modulus, total = young / (1.0 - poisson ** 2), []
    name = f"{TYPES[kind]}, shaft in a hub"
    for n in (4, 8):
        deck = axisymmetric_deck("shaft in a hub", 1.0, 1.0, 2)
        bodies = [deck.elastic(1000.0, young, poisson, k + 1).mesh(*grid(n, rows, 1.0, 1.0, (inner, 0.0)), part=k + 1)
                  .reshape(-1, n + 1) for k, (rows, inner) in enumerate(((7, 0.0), (5, 1.0)))]
        for body in bodies:
            deck.fix(body[0], y=1).fix(body[-1], y=1)
        slave, master, outer = bodies[0][:, -1], bodies[1][::-1, 0], bodies[1][:, -1]
        deck.node_set(1, slave).node_set(2, master).curve(1, [(0.0, 0.0), (1.0, pressure)])
        load_edges(deck, outer)
        deck.output(plot=1.0, glstat=1.0, rcforc=1.0)
        result = run.program(deck.contact(1, 2, kind, penalty, unit=1, gauss=4))
        place, force = result.points("Points")[-1], result.points("contact_force")[-1]
        sides = [sign * force[ids - 1, 0] / ring_areas(place[ids - 1, :2]) for ids, sign in ((slave, -1.0), (master, 1.0))]
        if kind not in PASS_PATCH:
            run.report(f"{name}: max |p/mean - 1| on both sides",
                       max(np.max(np.abs(p / np.mean(p) - 1.0)) for p in sides))
            return
        for side, found in zip(("slave", "master"), sides):
            run.check(f"{name}, {n} quads: pressure on the {side} side over its mean", found, np.mean(found))
        total.append(0.5 * (np.mean(sides[0]) + np.mean(sides[1])))
    # u/r of the shaft: -(1 - 2 nu)(1 + nu) p/E; the hub's at its bore by Lame with p_c within and p outside.
    ratio = poisson / (1.0 - poisson)
    shaft = (1.0 - ratio) / modulus
    bore = (5.0 / 3.0 + ratio) / modulus     # ((b^2 + a^2)/(b^2 - a^2) + nu')/E'
    outside = (8.0 / 3.0) / modulus          # 2 b^2/(b^2 - a^2)/E'
    wanted = outside * pressure / (shaft + bore + 1.0 / penalty)
    errors = np.array(total) / wanted - 1.0
    run.check(f"{name}: contact pressure", total[-1], wanted)
    run.check(f"{name}: order", run.order([1.0 / 4, 1.0 / 8], np.abs(errors)), 2.0)


def check_rubbing(run, kind):
    """The shaft, pressed by its hub, is pushed through it until all slips; it starts back by the way, so that the ends are flush
    at the end. Axial forces are then mu times the radial ones at every node of both sides, and uniform where these are."""
    friction, way, pressure, penalty = 0.3, 3.0e-3, 1.0, 1.0e4
    deck = axisymmetric_deck("shaft pushed through a hub", 2.0, 0.25, 2)
    bodies = [deck.elastic(1000.0, 1.0e6, 0.3, k + 1).mesh(*grid(2, rows, 1.0, 1.0, (inner, -way * (k == 0))), part=k + 1)
              .reshape(-1, 3) for k, (rows, inner) in enumerate(((7, 0.0), (5, 1.0)))]
    deck.fix(bodies[1].ravel(), y=1)
    slave, master, outer = bodies[0][:, -1], bodies[1][::-1, 0], bodies[1][:, -1]
    deck.curve(1, [(0.0, 0.0), (1.0, pressure), (2.0, pressure)]).curve(2, [(0.0, 0.0), (1.0, 0.0), (2.0, way)])
    for node in bodies[0].ravel():
        deck.prescribe(int(node), 2, 2, 2)
    load_edges(deck, outer)
    deck.node_set(1, slave).node_set(2, master).output(plot=1.0, glstat=0.25)
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, penalty, friction), (0.0, 1.0e20, 1))
    result = run.program(deck)
    place, force = result.points("Points")[-1], result.points("contact_force")[-1]
    name = f"{TYPES[kind]}, shaft pushed through a hub"
    for side, ids, sign in (("slave", slave, -1.0), ("master", master, 1.0)):
        radial, axial = sign * force[ids - 1, 0], sign * force[ids - 1, 1]
        # The others press unevenly, so that their normals lean.
        run.check(f"{name}: axial over radial force of each node, {side} side", axial / radial, friction,
                  scale=1.0 if kind in PASS_PATCH else 1e3)
        if kind in PASS_PATCH:
            traction = axial / ring_areas(place[ids - 1, :2])
            run.check(f"{name}: traction on the {side} side over its mean", traction, np.mean(traction))
    table = result.table("contact")
    table = table.where(time=table["time"][-1])
    run.check(f"{name}: table, traction over pressure", np.abs(table["traction"]), friction * table["pressure"])


def check_sinking(run, kind, friction):
    """A conical ring is pushed down a cone and slides outwards on it: order of Newton's method."""
    columns = lines(5, 0.2), lines(8, -0.2)
    meshes = [inclined_block(columns[0], lambda x: -SLOPE * x, lambda x: 1.0 - SLOPE * x),
              inclined_block(columns[1], lambda x: -1.0 + 0.0 * x, lambda x: -SLOPE * x)]
    meshes[0][0][:, 0] = 0.3 + 0.4 * meshes[0][0][:, 0]
    meshes[0][0][:, 1] = meshes[0][0][:, 1] * 0.4 - SLOPE * 0.3
    deck, (upper, lower) = patch_deck("sinking", meshes, 0.3, 1.0, 0.2, columns)
    position = deck.lines.index("*CONTROL_IMPLICIT_GENERAL") + 1
    deck.lines[position] = "1,0.1"
    deck.curve(2, [(0.0, 0.0), (1.0, -0.05)])
    for node in upper[2]:
        deck.prescribe(int(node), 2, 2, 2)
    deck.node_set(1, upper[0]).node_set(2, lower[2]).fix(lower[0], x=1, y=1)
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, 1.0e6, friction), (0.0, 1.0e20, 0))
    result = run.program(deck)
    orders = [np.log(b) / np.log(a) for step in result.newton() for a, b in zip(step[:, 0], step[1:, 0])
              if 1e-10 < a < 1e-3 and b > 1e-26]
    name = f"{TYPES[kind]}, ring on a cone, mu {friction}"
    run.report(f"{name}: iterations", sum(map(len, result.newton())))
    run.check(f"{name}: order of Newton's method, median of {len(orders)}", np.median(orders), 1.7)


def check(run):
    for kind in TYPES:
        check_flat(run, kind)
        check_compound(run, kind)
        check_dish(run, kind)
        check_rubbing(run, kind)
        for friction in (0.0, 0.3):
            check_sinking(run, kind, friction)
