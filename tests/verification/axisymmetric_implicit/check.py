# SPDX-License-Identifier: MIT
"""Implicit runs of axisymmetric bodies: tubes, a breathing ring, both drivers."""
import numpy as np

import contact
from contact import axisymmetric_deck
from meshes import Deck, grid

YOUNG, POISSON, RHO, INNER, OUTER = 1000.0, 0.3, 1.0, 1.0, 2.0
PRESSURE = 1.0e-6   # nothing but the linear part of the laws is left


def load(deck, ids, pairs, size, end=1.0):
    """Pressure that grows to `size` over the run."""
    deck.curve(1, [(0.0, 0.0), (end, size)])
    return deck.add("*LOAD_SEGMENT", *[(1, 1.0, 0.0, *[int(ids[k]) for k in (a, b, b, b)]) for a, b in pairs])


def tube_deck(n, poisson=POISSON, pressure=PRESSURE, steps=1, inner=INNER):
    """A tube of n by 2 quads, ends held, pressed from within; from the outside where it is solid."""
    coordinates, quads = grid(n, 2, OUTER - inner, 2.0 / n, (inner, 0.0))
    deck = axisymmetric_deck("Lame's tube", 1.0, 1.0 / steps)
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
        result = run.program(deck.elastic(RHO, YOUNG, poisson))
        exact = (1.0 + poisson) / YOUNG * PRESSURE * INNER ** 2 / (OUTER ** 2 - INNER ** 2) * (
            (1.0 - 2.0 * poisson) * r + OUTER ** 2 / r)
        errors.append(np.abs(result.points("displacement")[-1][:, 0] / exact - 1.0).max())
        energies = result.table("glstat")
        run.check(f"{name}, {n} quads: internal energy", energies["internal"][-1], energies["external_work"][-1])
    run.check(f"{name}: error of the radial displacement", errors[-1], 0.0)
    run.check(f"{name}: order", run.order(1.0 / np.array(sizes), errors), 2.0)


def check_solid(run):
    """A solid bar pressed from outside: the field is linear, exact on every mesh, next to the axis too."""
    deck, r = tube_deck(5, inner=0.0)
    result = run.program(deck.elastic(RHO, YOUNG, POISSON))
    wanted = -(1.0 + POISSON) * (1.0 - 2.0 * POISSON) / YOUNG * PRESSURE * r
    found = result.points("displacement")[-1][:, 0]
    run.check("solid bar: radial displacement", found, wanted)
    run.check("solid bar: radial and hoop stress in every element", result.cells("stress")[-1][:, [0, 2]], -PRESSURE)
    run.true("solid bar: nodes on the axis keep to it", np.all(found[r == 0.0] == 0.0))


def quadratic(run, name, result, fewest=3):
    """Each iteration squares what is left: where one ends between 1e-10 and 1e-3 of the energy of the first."""
    orders = [np.log(b) / np.log(a) for step in result.newton() for a, b in zip(step[:, 0], step[1:, 0])
              if 1e-10 < a < 1e-3 and b > 1e-26]
    run.check(f"{name}: pairs of iterations that were judged", len(orders), fewest)
    run.check(f"{name}: iterations of a step", max(map(len, result.newton())), 6)
    run.check(f"{name}: order of Newton's method, worst pair", min(orders), 1.5)


def check_large(run):
    """Pressures of strains of 10 %: the load follows its edge and radius."""
    for poisson in (POISSON, 0.45):
        deck, _ = tube_deck(10, poisson, 0.12 * YOUNG, 4)
        result = run.program(deck.elastic(RHO, YOUNG, poisson))
        quadratic(run, f"tube at large strain, nu {poisson}", result)
        run.report(f"tube at large strain, nu {poisson}: radius within",
                   1.0 + result.points("displacement")[-1][0, 0])
    # Incompressible: r^2 - R^2 is one number c, axes do not turn, so that s_t - s_r = 4 G ln(r/R) and
    # p = integral of that over r.
    poisson, pressure = 0.4999, 0.12 * YOUNG
    shear = 0.5 * YOUNG / (1.0 + poisson)

    def held(bore):
        r = np.linspace(bore, np.sqrt(OUTER ** 2 + bore ** 2 - INNER ** 2), 4001)
        value = 4.0 * shear * np.log(r / np.sqrt(r ** 2 - bore ** 2 + INNER ** 2)) / r
        return np.sum(0.5 * (value[1:] + value[:-1]) * np.diff(r))

    low, high = INNER, 1.8 * INNER
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if held(middle) < pressure else (low, middle)
    deck, r = tube_deck(20, poisson, pressure, 32)
    now = run.program(deck.elastic(RHO, YOUNG, poisson)).points("Points")[-1][:, 0]
    run.check("incompressible tube: r^2 - R^2 of all nodes", now ** 2 - r ** 2, low ** 2 - INNER ** 2)
    run.check("incompressible tube: radius within", now[0], low)


def check_gravity(run):
    """A column on the floor, nu 0: each node as far down as a rod's, though its load is that of a ring."""
    height, n, pull = 2.0, 5, 1.0e-6
    coordinates, quads = grid(3, n, 1.0, height)
    deck = axisymmetric_deck("column", 1.0, 1.0).elastic(RHO, YOUNG, 0.0)
    ids = deck.mesh(coordinates, quads)
    deck.fix(ids[:4], y=1).curve(1, [(0.0, 0.0), (1.0, pull)]).add("*LOAD_BODY_Y", (1, 1.0))
    result = run.program(deck.output(plot=1.0, glstat=1.0))
    z = coordinates[:, 1]
    run.check("column under gravity: displacement of all nodes", result.points("displacement")[-1][:, 1],
              -RHO * pull / YOUNG * (height * z - 0.5 * z ** 2))


def check_plastic(run):
    """Perfectly plastic tube, nu 0.4999, ends held: stresses and radius of the plastic zone."""
    stress, n = 1.0, 40
    shear = stress / np.sqrt(3.0)
    front = 1.5
    pressure = shear * (2.0 * np.log(front / INNER) + 1.0 - (front / OUTER) ** 2)
    deck, r = tube_deck(n, 0.4999, pressure, 10)
    result = run.program(deck.plastic(RHO, 1.0e6, 0.4999, stress))
    quadratic(run, "plastic tube", result, 1)
    centre = 0.5 * (r[:n] + r[1:n + 1])
    cells = result.cells("stress")[-1][:n]
    inside = centre < front
    log = np.log((front / np.minimum(centre, front)) ** 2)
    for text, column, sign in (("radial", 0, -1.0), ("hoop", 2, 1.0)):
        wanted = shear * np.where(inside, sign - log + (front / OUTER) ** 2,
                                  (front / OUTER) ** 2 * (1.0 + sign * (OUTER / centre) ** 2))
        run.check(f"plastic tube: {text} stress in all elements", cells[:, column] / stress, wanted / stress)
    strain = result.cells("plastic_strain")[-1][:n]
    run.check("plastic tube: radius of the plastic zone", r[:n + 1][np.count_nonzero(strain > 0.0)], front)


def check_breathing(run):
    """A thin ring let go with a radial speed: u = v0/w sin(w t), w = sqrt(E/rho)/R."""
    mean, thick, speed = 10.0, 0.02, 1.0e-6
    omega = np.sqrt(YOUNG / RHO) / mean
    period = 2.0 * np.pi / omega
    counts, errors = (40, 80, 160), []
    for count in counts:
        deck = axisymmetric_deck("breathing ring", 2.0 * period, period / count).elastic(RHO, YOUNG, 0.0)
        deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1,)).add("*CONTROL_IMPLICIT_SPECTRAL_RADIUS", (1.0,))
        ids = deck.mesh(*grid(1, 1, thick, thick, (mean - 0.5 * thick, 0.0)))
        deck.fix(ids, y=1)
        deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), speed, 0.0) for node in ids])
        deck.output(glstat=period / count, nodout=period / count, nodes=[int(ids[0])])
        result = run.program(deck)
        node = result.table("nodout")
        # The trapezoidal rule: tan(angle/2) = w dt/2.
        angle = 2.0 * np.arctan(np.pi / count)
        run.check(f"breathing ring, {count} steps a period: radial displacement w/v0", node["ux"] * omega / speed,
                  np.sin(angle * np.arange(2 * count + 1)))
        errors.append(np.abs(node["ux"] * omega / speed - np.sin(omega * node["time"])).max())
        run.check(f"breathing ring, {count} steps: energy ratio", result.table("glstat")["energy_ratio"], 1.0)
    run.check("breathing ring: order in the step", np.log2(errors[0] / errors[1]), 2.0)
    run.check("breathing ring: kinetic energy at the start, per radian", result.table("glstat")["kinetic"][0],
              0.5 * RHO * mean * thick ** 2 * speed ** 2)


def disc_let_go(run, n, is_implicit, end=0.1, steps=400):
    """A disc of 3 n by 2 n quads on a smooth floor, let go with radial and axial speed; its outer upper corner."""
    coordinates, quads = grid(3 * n, 2 * n, 1.5, 1.0)
    if is_implicit:
        deck = axisymmetric_deck("disc", end, end / steps)
        deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1,)).add("*CONTROL_IMPLICIT_SPECTRAL_RADIUS", (1.0,))
    else:
        deck = Deck("disc").control(end, dt=end / steps)
        deck.add("*SECTION_SHELL", (1, 15, None, 4), (1.0,)).part(1, section=1)
    ids = deck.elastic(RHO, YOUNG, POISSON).mesh(coordinates, quads)
    deck.fix(ids[:3 * n + 1], y=1)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(i), 0.01 * np.sin(np.pi * r / 3.0), 0.01 * np.sin(np.pi * z / 2.0))
                                         for i, (r, z) in zip(ids, coordinates)])
    deck.output(nodout=end / 40, glstat=end / 40, nodes=[int(ids[-1])])
    result = run.program(deck)
    run.check(f"disc of {3 * n} by {2 * n} let go, {'im' if is_implicit else 'ex'}plicit: energy ratio",
              result.table("glstat")["energy_ratio"], 1.0)
    return np.stack([result.table("nodout")[name] for name in ("ux", "uy")])


def check_drivers(run):
    """The drivers differ by their masses, consistent and lumped: an error of second order in h each."""
    sizes, gaps = (2, 4, 8) if run.is_full else (2, 4, 6), []
    for n in sizes:
        one, other = disc_let_go(run, n, True), disc_let_go(run, n, False)
        gaps.append(np.abs(one - other).max() / np.abs(other).max())
    run.check("disc let go: largest difference of both drivers at the corner", gaps[-1], 0.0)
    run.check("disc let go: order of that in the mesh", run.order(1.0 / np.array(sizes), gaps), 2.0)


def check(run):
    for poisson in (POISSON, 0.4999):
        check_tube(run, poisson)
    check_solid(run)
    check_large(run)
    check_gravity(run)
    check_plastic(run)
    check_breathing(run)
    check_drivers(run)
    contact.check(run)
