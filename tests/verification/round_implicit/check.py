# SPDX-License-Identifier: MIT
"""Implicit runs of axisymmetric bodies: tubes, a sphere, a breathing ring, both drivers, contact patch tests."""
import itertools
import re

import numpy as np

import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid
from patch_layouts import MESHES, inclined_block, lines, load_edges, outer_chains

YOUNG, POISSON, RHO, INNER, OUTER = 1000.0, 0.3, 1.0, 1.0, 2.0
PRESSURE = 1.0e-6   # nothing but the linear part of the laws is left
RADII = {"disc": 0.0, "ring": 0.5}
PENALTIES = (1.0e3, 1.0e6, 1.0e8)
LAYOUTS = ("5/4", "7/5 non-uniform", "slave segments over three and four master segments, 2/7")
SLOPE = np.tan(np.radians(20.0))


def round_deck(title, end, step, parts=1):
    deck = Deck(title).add("*CONTROL_TERMINATION", (end,))
    deck.add("*CONTROL_IMPLICIT_GENERAL", (1, step)).add("*SECTION_SHELL", (1, 15, None, 4), (1.0,))
    for part in range(1, parts + 1):
        deck.part(part, section=1)
    return deck


def load(deck, ids, pairs, size, end=1.0):
    """Pressure that grows to `size` over the run."""
    deck.curve(1, [(0.0, 0.0), (end, size)])
    return deck.add("*LOAD_SEGMENT", *[(1, 1.0, 0.0, *[int(ids[k]) for k in (a, b, b, b)]) for a, b in pairs])


def energy_ratios(result):
    """Energy ratios of the iterations of each step, from the log."""
    log = (result.folder / f"{result.job}.log").read_text()
    rows = re.findall(r"iteration (\d+): energy ratio (\S+),", log)
    starts = [k for k, row in enumerate(rows) if row[0] == "1"] + [len(rows)]
    return [np.array([float(row[1]) for row in rows[a:b]]) for a, b in zip(starts, starts[1:])]


def tube_deck(n, poisson=POISSON, pressure=PRESSURE, steps=1, inner=INNER):
    """A tube of n by 2 quads, ends held, pressed from within; from the outside where it is solid."""
    coordinates, quads = grid(n, 2, OUTER - inner, 2.0 / n, (inner, 0.0))
    deck = round_deck("Lame's tube", 1.0, 1.0 / steps)
    ids = deck.mesh(coordinates, quads)
    deck.fix(ids, y=1)
    pairs = [((j + 1) * (n + 1), j * (n + 1)) if inner else (j * (n + 1) + n, (j + 1) * (n + 1) + n) for j in range(2)]
    return load(deck, ids, pairs, pressure).output(plot=1.0, glstat=1.0 / steps), coordinates[:, 0]


def check_tube(run, poisson):
    """Second order at all nodes; nearly incompressible too."""
    errors, sizes = [], (5, 10, 20)
    name = f"tube, nu {poisson}"
    for n in sizes:
        deck, r = tube_deck(n, poisson)
        result = run.program(deck.elastic(RHO, YOUNG, poisson), name=f"tube_{n}_{poisson}")
        exact = (1.0 + poisson) / YOUNG * PRESSURE * INNER ** 2 / (OUTER ** 2 - INNER ** 2) * (
            (1.0 - 2.0 * poisson) * r + OUTER ** 2 / r)
        errors.append(np.abs(result.points("displacement")[-1][:, 0] / exact - 1.0).max())
        energies = result.table("glstat")
        run.check(f"{name}, {n} quads: internal energy", energies["internal"][-1], energies["external_work"][-1],
                  1e-8, source="work of the pressure")
    run.check(f"{name}: error of the radial displacement", errors[-1], 0.0, 2e-3, "abs", "Lame (1852)")
    run.check(f"{name}: order", run.order(1.0 / np.array(sizes), errors), 2.0, 0.15, "abs", "second order")


def check_solid(run):
    """A solid bar pressed from outside: the field is linear, exact on every mesh, next to the axis too."""
    deck, r = tube_deck(5, inner=0.0)
    result = run.program(deck.elastic(RHO, YOUNG, POISSON), name="solid")
    wanted = -(1.0 + POISSON) * (1.0 - 2.0 * POISSON) / YOUNG * PRESSURE * r
    found = result.points("displacement")[-1][:, 0]
    run.check("solid bar: radial displacement", found, wanted, 1e-8, source="linear")
    run.check("solid bar: radial and hoop stress in every element",
              result.cells("stress")[-1][:, [0, 2]], -PRESSURE, 1e-8, source="uniform")
    run.true("solid bar: nodes on the axis keep to it", np.all(found[r == 0.0] == 0.0))


def check_sphere(run):
    errors, sizes = [], (4, 8, 16)
    for n in sizes:
        coordinates, quads = sphere(n)
        deck = round_deck("hollow sphere", 1.0, 1.0).elastic(RHO, YOUNG, POISSON)
        ids = deck.mesh(coordinates, quads)
        deck.fix(ids[:n + 1], y=1)
        load(deck, ids, [((j + 1) * (n + 1), j * (n + 1)) for j in range(2 * n)], PRESSURE)
        result = run.program(deck.output(plot=1.0), name=f"sphere_{n}")
        place = np.hypot(*coordinates.T)
        exact = PRESSURE * INNER ** 3 / (YOUNG * (OUTER ** 3 - INNER ** 3)) * (
            (1.0 - 2.0 * POISSON) * place + (1.0 + POISSON) * OUTER ** 3 / (2.0 * place ** 2))
        radial = np.sum(result.points("displacement")[-1][:, :2] * coordinates, axis=1) / place
        errors.append(np.abs(radial / exact - 1.0).max())
    run.check("sphere: largest error of the radial displacement", errors[-1], 0.0, 5e-3, "abs", "Lame (1852)")
    run.check("sphere: order", run.order(1.0 / np.array(sizes), errors), 2.0, 0.3, "abs", "second order")


def sphere(n):
    """A quarter of the section of a hollow sphere, n by 2 n quads."""
    radius = INNER + (OUTER - INNER) * np.arange(n + 1) / n
    angle = 0.5 * np.pi * np.arange(2 * n + 1) / (2 * n)
    coordinates = np.array([(a * np.cos(t), a * np.sin(t)) for t in angle for a in radius])
    coordinates[np.abs(coordinates) < 1e-12] = 0.0
    row = n + 1
    return coordinates, [(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i)
                         for j in range(2 * n) for i in range(n)]


def quadratic(run, name, result, fewest=3):
    """Each iteration squares what is left: where one ends between 1e-10 and 1e-3 of the energy of the first."""
    orders = []
    for ratios in energy_ratios(result):
        for a, b in zip(ratios, ratios[1:]):
            if 1e-10 < a < 1e-3 and b > 1e-26:
                orders.append(np.log(b) / np.log(a))
    run.check(f"{name}: pairs of iterations that were judged", len(orders), fewest, 0, "min")
    run.check(f"{name}: iterations of a step", max(len(one) for one in energy_ratios(result)), 6, 0, "max")
    run.check(f"{name}: order of Newton's method, worst pair", min(orders), 1.5, 0.0, "min",
              "2 where the constant is 1")


def check_large(run):
    """Pressures of strains of 10 %: the load follows its edge and radius."""
    for poisson in (POISSON, 0.45):
        deck, _ = tube_deck(10, poisson, 0.12 * YOUNG, 4)
        result = run.program(deck.elastic(RHO, YOUNG, poisson), name=f"large_{poisson}")
        quadratic(run, f"tube at large strain, nu {poisson}", result)
        run.report(f"tube at large strain, nu {poisson}: radius within",
                   1.0 + result.points("displacement")[-1][0, 0])
    # Incompressible: r^2 - R^2 is one number c, axes do not turn, so that s_t - s_r = 4 G ln(r/R) and
    # p = integral of that over r.
    poisson, pressure, errors, sizes = 0.4999, 0.12 * YOUNG, [], (5, 10, 20)
    shear = 0.5 * YOUNG / (1.0 + poisson)

    def held(bore):
        r = np.linspace(bore, np.sqrt(OUTER ** 2 + bore ** 2 - INNER ** 2), 4001)
        value = 4.0 * shear * np.log(r / np.sqrt(r ** 2 - bore ** 2 + INNER ** 2)) / r
        return np.sum(0.5 * (value[1:] + value[:-1]) * np.diff(r))

    low, high = INNER, 1.8 * INNER
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if held(middle) < pressure else (low, middle)
    for n in sizes:
        deck, r = tube_deck(n, poisson, pressure, 32)
        result = run.program(deck.elastic(RHO, YOUNG, poisson), name=f"incompressible_{n}")
        now = result.points("Points")[-1][:, 0]
        errors.append(now[0] / low - 1.0)
    run.check("incompressible tube: r^2 - R^2 of all nodes", now ** 2 - r ** 2, low ** 2 - INNER ** 2, 2e-3,
              source="volume, to p/K")
    run.check("incompressible tube: radius within", now[0], low, 1e-3, source="integral of 4 G ln(r/R)/r")
    run.report("incompressible tube: order of that", run.order(1.0 / np.array(sizes), np.abs(errors)))


def check_gravity(run):
    """A column on the floor, nu 0: each node as far down as a rod's, though its load is that of a ring."""
    height, n, pull = 2.0, 5, 1.0e-6
    coordinates, quads = grid(3, n, 1.0, height)
    deck = round_deck("column", 1.0, 1.0).elastic(RHO, YOUNG, 0.0)
    ids = deck.mesh(coordinates, quads)
    deck.fix(ids[:4], y=1).curve(1, [(0.0, 0.0), (1.0, pull)]).add("*LOAD_BODY_Y", (1, 1.0))
    result = run.program(deck.output(plot=1.0, glstat=1.0), name="column")
    z = coordinates[:, 1]
    run.check("column under gravity: displacement of all nodes", result.points("displacement")[-1][:, 1],
              -RHO * pull / YOUNG * (height * z - 0.5 * z ** 2), 1e-8, source="rod, nodes exact")


def check_plastic(run):
    """Perfectly plastic tube, nu 0.4999, ends held: stresses and radius of the plastic zone."""
    stress, n = 1.0, 40
    shear = stress / np.sqrt(3.0)
    front = 1.5
    pressure = shear * (2.0 * np.log(front / INNER) + 1.0 - (front / OUTER) ** 2)
    deck, r = tube_deck(n, 0.4999, pressure, 10)
    result = run.program(deck.plastic(RHO, 1.0e6, 0.4999, stress), name="plastic")
    quadratic(run, "plastic tube", result, 1)
    centre = 0.5 * (r[:n] + r[1:n + 1])
    cells = result.cells("stress")[-1][:n]
    inside = centre < front
    hoop = np.where(inside, shear * (1.0 - np.log((front / np.minimum(centre, front)) ** 2) + (front / OUTER) ** 2),
                    shear * (front / OUTER) ** 2 * (1.0 + (OUTER / centre) ** 2))
    radial = np.where(inside, shear * (-1.0 - np.log((front / np.minimum(centre, front)) ** 2) + (front / OUTER) ** 2),
                      shear * (front / OUTER) ** 2 * (1.0 - (OUTER / centre) ** 2))
    run.check("plastic tube: radial stress in all elements", cells[:, 0] / stress, radial / stress, 5e-3, "abs",
              "Hill (1950), incompressible")
    run.check("plastic tube: hoop stress in all elements", cells[:, 2] / stress, hoop / stress, 5e-3, "abs",
              "Hill (1950), incompressible")
    strain = result.cells("plastic_strain")[-1][:n]
    run.check("plastic tube: radius of the plastic zone", r[:n + 1][np.count_nonzero(strain > 0.0)], front,
              1.0 / n, "abs", "Hill (1950)")


def check_breathing(run):
    """A thin ring let go with a radial speed: u = v0/w sin(w t), w = sqrt(E/rho)/R."""
    mean, thick, speed = 10.0, 0.02, 1.0e-6
    omega = np.sqrt(YOUNG / RHO) / mean
    period = 2.0 * np.pi / omega
    counts, errors = (40, 80, 160), []
    for count in counts:
        deck = round_deck("breathing ring", 2.0 * period, period / count).elastic(RHO, YOUNG, 0.0)
        deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1,)).add("*CONTROL_IMPLICIT_SPECTRAL_RADIUS", (1.0,))
        ids = deck.mesh(*grid(1, 1, thick, thick, (mean - 0.5 * thick, 0.0)))
        deck.fix(ids, y=1)
        deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), speed, 0.0) for node in ids])
        deck.output(glstat=period / count, nodout=period / count, nodes=[int(ids[0])])
        result = run.program(deck, name=f"breathing_{count}")
        node = result.table("nodout")
        # The trapezoidal rule: tan(angle/2) = w dt/2.
        angle = 2.0 * np.arctan(np.pi / count)
        run.check(f"breathing ring, {count} steps a period: radial displacement w/v0", node["ux"] * omega / speed,
                  np.sin(angle * np.arange(2 * count + 1)), 1e-4, "abs",
                  "closed form of the trapezoidal rule, thick 0.002 R")
        errors.append(np.abs(node["ux"] * omega / speed - np.sin(omega * node["time"])).max())
        run.check(f"breathing ring, {count} steps: energy ratio", result.table("glstat")["energy_ratio"], 1.0, 1e-6,
                  "abs", "the trapezoidal rule keeps the energy")
    run.check("breathing ring: order in the step", np.log2(errors[0] / errors[1]), 2.0, 0.1, "abs", "second order")
    kinetic = result.table("glstat")["kinetic"][0]
    run.check("breathing ring: kinetic energy at the start, per radian", kinetic,
              0.5 * RHO * mean * thick ** 2 * speed ** 2, 1e-12, source="m v^2/2")


def disc_let_go(run, n, is_implicit, end=0.1, steps=400):
    """A disc of 3 n by 2 n quads on a smooth floor, let go with radial and axial speed; its outer upper corner."""
    coordinates, quads = grid(3 * n, 2 * n, 1.5, 1.0)
    if is_implicit:
        deck = round_deck("disc", end, end / steps)
        deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1,)).add("*CONTROL_IMPLICIT_SPECTRAL_RADIUS", (1.0,))
    else:
        deck = Deck("disc").control(end, dt=end / steps)
        deck.add("*SECTION_SHELL", (1, 15, None, 4), (1.0,)).part(1, section=1)
    ids = deck.elastic(RHO, YOUNG, POISSON).mesh(coordinates, quads)
    deck.fix(ids[:3 * n + 1], y=1)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(i), 0.01 * np.sin(np.pi * r / 3.0), 0.01 * np.sin(np.pi * z / 2.0))
                                         for i, (r, z) in zip(ids, coordinates)])
    deck.output(nodout=end / 40, glstat=end / 40, nodes=[int(ids[-1])])
    result = run.program(deck, name=f"disc_{n}_{'implicit' if is_implicit else 'explicit'}")
    run.check(f"disc of {3 * n} by {2 * n} let go, {'im' if is_implicit else 'ex'}plicit: energy ratio",
              result.table("glstat")["energy_ratio"], 1.0, 1e-4, "abs", "balance")
    return np.stack([result.table("nodout")[name] for name in ("ux", "uy")])


def check_drivers(run):
    """The drivers differ by their masses, consistent and lumped: an error of second order in h each."""
    sizes, gaps = (2, 4, 8) if run.is_full else (2, 4, 6), []
    for n in sizes:
        one, other = disc_let_go(run, n, True), disc_let_go(run, n, False)
        gaps.append(np.abs(one - other).max() / np.abs(other).max())
    run.check("disc let go: largest difference of both drivers at the corner", gaps[-1], 0.0, 0.02, "abs",
              "explicit driver")
    run.check("disc let go: order of that in the mesh", run.order(1.0 / np.array(sizes), gaps), 2.0, 0.4, "abs",
              "masses of second order")


def patch_deck(title, meshes, poisson, size, inner, columns):
    deck = round_deck(title, 1.0, 1.0, 2)
    for part in (1, 2):
        deck.elastic(1000.0, 1.0e6, poisson, part)
    ids = [deck.mesh(points + np.array([inner, 0.0]), quads, part=k + 1)
           for k, (points, quads) in enumerate(meshes)]
    deck.curve(1, [(0.0, 0.0), (1.0, size)])
    deck.output(plot=1.0, glstat=1.0, rcforc=1.0)
    return deck, [outer_chains(one, len(x) - 1) for one, x in zip(ids, columns)]


def areas(x):
    """Integrals of r by the hat functions of the nodes of a chain."""
    length = np.linalg.norm(np.diff(x, axis=0), axis=1)
    r = x[:, 0]
    total = np.zeros(len(r))
    total[:-1] += length * (2.0 * r[:-1] + r[1:]) / 6.0
    total[1:] += length * (r[:-1] + 2.0 * r[1:]) / 6.0
    return total


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
    errors = [np.max(np.abs(sign * force[ids - 1, 1] / areas(place[ids - 1, :2]) - 1.0))
              for ids, sign in ((upper[0], 1.0), (lower[2], -1.0))]
    stress = result.cells("stress")[-1]
    errors.append(max(np.max(np.abs(stress[:, 1] + 1.0)), np.max(np.abs(stress[:, [0, 2, 3]]))))
    return (*errors, len(energy_ratios(result)[-1]))


def check_flat(run, kind):
    rows = run.cover(RADII, LAYOUTS if kind in PASS_PATCH else LAYOUTS[:1], (0.0, 0.3), PENALTIES)
    for (body, layout, poisson), group in itertools.groupby(rows, lambda row: row[:3]):
        name = f"{TYPES[kind]}, {body}, {layout}, nu {poisson}"
        worst = np.max([flat_errors(run, kind, layout, body, poisson, row[3]) for row in group], axis=0)
        run.check(f"{name}: Newton iterations", worst[3], 4, 0, "max", "one active set")
        if kind not in PASS_PATCH:
            run.report(f"{name}: max |p/p0 - 1| on both sides", max(worst[:2]))
            continue
        for side, error in zip(("slave", "master"), worst):
            run.check(f"{name}: max |p/p0 - 1| on the {side} side", error, 0.0, 1e-9, "abs", "uniform")
        run.check(f"{name}: stresses in all elements / p0", worst[2], 0.0, 1e-9, "abs", "uniaxial")


def press_cone(run, kind, body, size, penalty=1.0e6):
    """Interface inclined by 20 degrees, the load on all outer faces. Nodal forces of slave and master over those of uniform
    pressure, and how far a slave place stands sideways of its foot, over the shortest segment."""
    columns, inner = (lines(5, 0.2), lines(4, -0.2)), RADII[body]
    meshes = [inclined_block(columns[0], lambda x: SLOPE * x, lambda x: 1.0 + 0.0 * x),
              inclined_block(columns[1], lambda x: -1.0 + 0.0 * x, lambda x: SLOPE * x)]
    deck, (upper, lower) = patch_deck(f"cone, {body}, type {kind}", meshes, 0.3, size, inner, columns)
    for chains, contact in ((upper, 0), (lower, 2)):
        for k, chain in enumerate(chains):
            if k == contact or (chains is lower and k == 0) or (inner == 0.0 and k == 3):
                continue
            load_edges(deck, chain)
    deck.node_set(1, upper[0]).node_set(2, lower[2])
    deck.fix(lower[0], y=1)
    result = run.program(deck.contact(1, 2, kind, penalty, gauss=4))
    place, force = result.points("Points")[-1], result.points("contact_force")[-1]
    gap, found = size / (penalty * 5.0 * np.cos(np.arctan(SLOPE))), []
    for ids in (upper[0], lower[2]):
        x = place[ids - 1, :2]
        t = (x[-1] - x[0]) / np.linalg.norm(x[-1] - x[0])
        found.append(force[ids - 1, :2] / (size * areas(x))[:, None] - [-t[1], t[0]])
    return found, gap * np.sin(np.arctan(SLOPE)) / min(np.min(np.diff(x)) for x in columns)


def check_cone(run, kind, body, size):
    """See ../round_contact for the limit."""
    found, sideways = press_cone(run, kind, body, size)
    name = f"{TYPES[kind]}, cone on a {body}, load {size:.0e}"
    for side, errors in zip(("slave", "master"), found):
        error = np.max(np.abs(errors))
        if kind in PASS_PATCH:
            run.check(f"{name}: nodal forces on the {side} side over those of uniform pressure", error, 0.0,
                      3.0 * sideways + 2.0e-9, "abs", "shift over length, and round-off of the gap")
        else:
            run.report(f"{name}: max |p/p0 - 1| on the {side} side", error)


def check_dish(run, kind):
    """Springs so soft that the slave's node on the axis is behind a dish by more than what counts at a chain's end."""
    found, sideways = press_cone(run, kind, "disc", 10.0, 100.0)
    name = f"{TYPES[kind]}, cone in a dish, {sideways:.3f} of a segment sideways"
    run.check(f"{name}: axial force on the node on the axis over that of uniform pressure", found[0][0, 1], 0.0, 0.5, "abs",
              "the surface does not end there; types 1 to 3 and 6 fail the patch test")


def check_compound(run, kind):
    """A solid shaft of radius 1 in a hub of radii 1 and 2, ends held, pressed from outside; the rows do not match."""
    young, poisson, pressure, penalty = 1.0e6, 0.3, 1.0, 1.0e6
    modulus, total = young / (1.0 - poisson ** 2), []
    name = f"{TYPES[kind]}, shaft in a hub"
    for n in (4, 8):
        deck = round_deck("shaft in a hub", 1.0, 1.0, 2)
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
        sides = [sign * force[ids - 1, 0] / areas(place[ids - 1, :2]) for ids, sign in ((slave, -1.0), (master, 1.0))]
        if kind not in PASS_PATCH:
            run.report(f"{name}: max |p/mean - 1| on both sides",
                       max(np.max(np.abs(p / np.mean(p) - 1.0)) for p in sides))
            return
        for side, found in zip(("slave", "master"), sides):
            run.check(f"{name}, {n} quads: pressure on the {side} side over its mean", found, np.mean(found), 1e-9,
                      source="uniform")
        total.append(0.5 * (np.mean(sides[0]) + np.mean(sides[1])))
    # u/r of the shaft: -(1 - 2 nu)(1 + nu) p/E; the hub's at its bore by Lame with p_c within and p outside.
    ratio = poisson / (1.0 - poisson)
    shaft = (1.0 - ratio) / modulus
    bore = (5.0 / 3.0 + ratio) / modulus     # ((b^2 + a^2)/(b^2 - a^2) + nu')/E'
    outside = (8.0 / 3.0) / modulus          # 2 b^2/(b^2 - a^2)/E'
    wanted = outside * pressure / (shaft + bore + 1.0 / penalty)
    errors = np.array(total) / wanted - 1.0
    run.check(f"{name}: contact pressure", total[-1], wanted, 2e-3, source="Lame and the penetration")
    run.check(f"{name}: order", run.order([1.0 / 4, 1.0 / 8], np.abs(errors)), 2.0, 0.2, "abs", "second order")


def check_rubbing(run, kind):
    """The shaft, pressed by its hub, is pushed through it until all slips; it starts back by the way, so that the ends are flush
    at the end. Axial forces are then mu times the radial ones at every node of both sides, and uniform where these are."""
    friction, way, pressure, penalty = 0.3, 3.0e-3, 1.0, 1.0e4
    deck = round_deck("shaft pushed through a hub", 2.0, 0.25, 2)
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
        run.check(f"{name}: axial over radial force of each node, {side} side", axial / radial, friction,
                  1e-9 if kind in PASS_PATCH else 1e-6,
                  source="all of it slips (the others press unevenly, so that their normals lean)")
        if kind in PASS_PATCH:
            traction = axial / areas(place[ids - 1, :2])
            run.check(f"{name}: traction on the {side} side over its mean", traction, np.mean(traction), 1e-9,
                      source="uniform")
    table = result.table("contact")
    table = table.where(time=table["time"][-1])
    run.check(f"{name}: table, traction over pressure", np.abs(table["traction"]), friction * table["pressure"], 1e-9,
              source="all of it slips")


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
    orders = [np.log(b) / np.log(a) for ratios in energy_ratios(result) for a, b in zip(ratios, ratios[1:])
              if 1e-10 < a < 1e-3 and b > 1e-26]
    name = f"{TYPES[kind]}, ring on a cone, mu {friction}"
    run.report(f"{name}: iterations", sum(len(one) for one in energy_ratios(result)))
    run.check(f"{name}: order of Newton's method, median of {len(orders)}", np.median(orders), 1.7, 0.0, "min", "2")


def check(run):
    for poisson in (POISSON, 0.4999):
        check_tube(run, poisson)
    check_solid(run)
    check_sphere(run)
    check_large(run)
    check_gravity(run)
    check_plastic(run)
    check_breathing(run)
    check_drivers(run)
    for kind in TYPES:
        check_flat(run, kind)
        check_compound(run, kind)
        check_dish(run, kind)
        check_rubbing(run, kind)
        for friction in (0.0, 0.3):
            check_sinking(run, kind, friction)
        for body in RADII:
            for size in (1.0, 0.1) if kind in PASS_PATCH else (1.0,):
                check_cone(run, kind, body, size)
