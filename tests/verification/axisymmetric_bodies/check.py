# SPDX-License-Identifier: MIT
"""Axisymmetric bodies: thick tube and sphere under pressure, a bar with radial inertia, the Taylor bar."""
import pathlib
import re

import numpy as np

from meshes import Deck, grid

YOUNG, POISSON, RHO, INNER, OUTER = 1000.0, 0.3, 1.0, 1.0, 2.0
#: So small that nothing but the linear part is left of the laws.
PRESSURE = 1.0e-6
TAYLOR = pathlib.Path(__file__).resolve().parents[3] / "input/taylor/taylor.k"


def axisymmetric_deck(title, end, points=1):
    deck = Deck(title)
    deck.control(end)
    deck.add("*PART", "body", (1, 1, 1))
    return deck.add("*SECTION_SHELL", (1, 15, None, points), (1.0,))


def pressed(deck, ids, pairs, damping):
    """Pressure on inner segments, damping near the critical one of breathing."""
    deck.curve(1, [(0.0, 1.0), (1.0e9, 1.0)])
    deck.add("*LOAD_SEGMENT", *[(1, PRESSURE, 0.0, *[int(ids[k]) for k in (a, b, b, b)]) for a, b in pairs])
    return deck.add("*DAMPING_GLOBAL", (0, damping))


def tube(run, n, points, form="quads"):
    """A tube of n by 2 quads, damped to rest: radii, found and exact displacements, result."""
    coordinates, quads = grid(n, 2, OUTER - INNER, 2.0 / n, (INNER, 0.0))
    if form == "triangles":
        quads = [three for a, b, c, d in quads for three in ((a, b, c, c), (a, c, d, d))]
    deck = axisymmetric_deck("Lame's tube", 4.0, points)
    deck.elastic(RHO, YOUNG, POISSON)
    ids = deck.mesh(coordinates, quads)
    deck.fix(ids, y=1)
    # Walked round the body, which lies on the left.
    pressed(deck, ids, [((j + 1) * (n + 1), j * (n + 1)) for j in range(2)], 42.0)
    result = run.program(deck.output(plot=4.0), name=f"tube_{n}_{points}_{form}")
    r = coordinates[:, 0]
    exact = (1.0 + POISSON) / YOUNG * PRESSURE * INNER ** 2 / (OUTER ** 2 - INNER ** 2) * (
        (1.0 - 2.0 * POISSON) * r + OUTER ** 2 / r)
    return r, result.points("displacement")[-1][:, 0], exact, result


def check_tube(run):
    """Lame: the one-point form is exact at the nodes of a uniform mesh, full integration of second order."""
    errors, full, sizes = [], [], (5, 10, 20)
    for n in sizes:
        r, found, exact, result = tube(run, n, 1)
        run.check(f"tube of {n}: radial displacement of all nodes", found, exact)
        centre = 0.5 * (r[:n] + r[1:n + 1])
        hoop = result.cells("stress")[-1][:n, 2] / PRESSURE
        errors.append(np.abs(hoop - (1.0 + (OUTER / centre) ** 2) / 3.0).max())
        strain = result.cells("hoop_strain")[-1][:n]
        run.check(f"tube of {n}: hoop strain of the elements", strain,
                  0.5 * (exact[:n] + exact[1:n + 1]) / centre)
        r, found, exact, result = tube(run, n, 4)
        full.append(np.abs(found / exact - 1.0).max())
    run.check("tube: error of the hoop stress in the elements", errors[-1], 0.0)
    run.check("tube: order of the hoop stress", run.order(1.0 / np.array(sizes), errors), 2.0)
    for points in (1, 4):
        r, found, exact, result = tube(run, 20, points, "triangles")
        run.check(f"tube of triangles, {points} point(s): radial displacement", found / exact,
                  np.ones_like(exact))
    run.check("tube, 2x2 points: radial displacement", full[-1], 0.0)
    run.check("tube, 2x2 points: order of the radial displacement",
              run.order(1.0 / np.array(sizes), full), 2.0)


def sphere(n):
    """A quarter of the section of a hollow sphere, n by 2 n quads."""
    radius = INNER + (OUTER - INNER) * np.arange(n + 1) / n
    angle = 0.5 * np.pi * np.arange(2 * n + 1) / (2 * n)
    coordinates = np.array([(a * np.cos(t), a * np.sin(t)) for t in angle for a in radius])
    coordinates[np.abs(coordinates) < 1e-12] = 0.0
    row = n + 1
    quads = [(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i)
             for j in range(2 * n) for i in range(n)]
    return coordinates, quads


def check_sphere(run, points):
    errors, sizes = [], (4, 8, 16)
    name = f"sphere, {points} point(s)"
    for n in sizes:
        coordinates, quads = sphere(n)
        deck = axisymmetric_deck("hollow sphere", 4.0, points)
        deck.elastic(RHO, YOUNG, POISSON)
        ids = deck.mesh(coordinates, quads)
        deck.fix(ids[:n + 1], y=1)
        pressed(deck, ids, [((j + 1) * (n + 1), j * (n + 1)) for j in range(2 * n)], 42.0)
        result = run.program(deck.output(plot=4.0), name=f"sphere_{n}_{points}")
        place = np.hypot(*coordinates.T)
        exact = PRESSURE * INNER ** 3 / (YOUNG * (OUTER ** 3 - INNER ** 3)) * (
            (1.0 - 2.0 * POISSON) * place + (1.0 + POISSON) * OUTER ** 3 / (2.0 * place ** 2))
        found = result.points("displacement")[-1][:, :2]
        radial = np.sum(found * coordinates, axis=1) / place
        errors.append(np.abs(radial / exact - 1.0).max())
        run.true(f"{name}: nodes on the axis keep to it, {n}", np.all(found[coordinates[:, 0] == 0.0, 0] == 0.0))
    run.check(f"{name}: largest error of the radial displacement", errors[-1], 0.0)
    run.check(f"{name}: order", run.order(1.0 / np.array(sizes), errors), 2.0)


def phase_velocity(poisson, number):
    """Of the lowest longitudinal wave of a round bar of radius 1 over sqrt(E/rho) (Pochhammer and Chree)."""
    shear = 0.5 / (1.0 + poisson)
    pressure = np.sqrt(poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) + 2.0 * shear)
    angle = (np.arange(2000) + 0.5) * np.pi / 2000

    def bessel(order, x):
        return np.mean(np.cos(order * angle - x * np.sin(angle)))

    def equation(speed):
        p, q = (np.sqrt(complex((speed / c) ** 2 - 1.0)) * number for c in (pressure, np.sqrt(shear)))
        value = (2.0 * p * (q ** 2 + number ** 2) * bessel(1, p) * bessel(1, q)
                 - (q ** 2 - number ** 2) ** 2 * bessel(0, p) * bessel(1, q)
                 - 4.0 * number ** 2 * p * q * bessel(1, p) * bessel(0, q))
        return value.real

    low, high = 0.97, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if equation(low) * equation(middle) <= 0.0:
            high = middle
        else:
            low = middle
    return low


def bar_frequency(run, n, number, guess):
    """Of a standing wave, n quads over the radius: fitted to ten periods of its middle."""
    length = np.pi / number
    coordinates, quads = grid(n, int(round(length * n)), 1.0, length)
    deck = axisymmetric_deck("bar with radial inertia", 10.2 * 2.0 * np.pi / guess)
    deck.elastic(RHO, YOUNG, POISSON)
    ids = deck.mesh(coordinates, quads)
    deck.fix([*ids[:n + 1], *ids[-n - 1:]], y=1)
    small = 1.0e-6
    deck.add("*INITIAL_VELOCITY_NODE",
             *[(int(i), -POISSON * small * number * a * np.cos(number * b), small * np.sin(number * b))
               for i, (a, b) in zip(ids, coordinates)])
    middle = int(ids[(len(coordinates) // (n + 1) // 2) * (n + 1)])
    interval = 2.0 * np.pi / guess / 100.0
    result = run.program(deck.output(nodout=interval, glstat=interval, nodes=[middle]), name=f"bar_{n}")
    energies = result.table("glstat")
    run.check(f"bar of {n}: energy ratio", energies["energy_ratio"], np.ones_like(energies["time"]))
    node = result.node(middle)

    def rest(frequency):
        waves = np.stack([np.cos(frequency * node["time"]), np.sin(frequency * node["time"])], -1)
        return np.linalg.lstsq(waves, node["vy"], rcond=None)[1][0]

    return min(guess * np.linspace(0.99, 1.01, 2001), key=rest)


def check_bar(run):
    """Radial inertia slows the wave: 0.59 % at this wave number."""
    number, sizes = 0.5, (4, 8, 16)
    expected = np.sqrt(YOUNG / RHO) * number * phase_velocity(POISSON, number)
    run.check("bar: exact speed against Rayleigh's", phase_velocity(POISSON, number),
              1.0 / np.sqrt(1.0 + 0.5 * (POISSON * number) ** 2))
    found = [bar_frequency(run, n, number, expected) for n in sizes]
    run.check("bar: frequency", found[-1], expected)
    run.check("bar: order of the frequency",
              run.order(1.0 / np.array(sizes), expected - np.array(found)), 2.0)


def volumes(places, quads):
    """Volume per radian of each quad by Green's theorem."""
    sides = [(places[quads[:, k]], places[quads[:, (k + 1) % 4]]) for k in range(4)]
    return sum((b[:, 1] - a[:, 1]) * (a[:, 0] ** 2 + a[:, 0] * b[:, 0] + b[:, 0] ** 2) / 6.0 for a, b in sides)


def check_taylor(run):
    text = TAYLOR.read_text()
    result = run.program(text, name="taylor")
    edge, end = result.node(11), result.node(1101)
    for time, radius, length in ((12.0, 5.38, 29.705), (40.0, 7.07, 24.564)):
        run.check(f"Taylor bar: radius at {time:g} microseconds, mm",
                  1e3 * np.interp(time * 1e-6, edge["time"], edge["x"]), radius)
        run.check(f"Taylor bar: length at {time:g} microseconds, mm",
                  1e3 * np.interp(time * 1e-6, end["time"], end["y"]), length)
    run.check("Taylor bar: final radius, mm", 1e3 * edge["x"][-1], 7.16)
    run.check("Taylor bar: final length, mm", 1e3 * end["y"][-1], 21.425)
    run.check("Taylor bar: largest plastic strain", result.cells("plastic_strain")[-1].max(), 3.2)
    _, quads = grid(10, 100)
    quads = np.array(quads)
    start = np.array([(3.2e-3 * i / 10, 32.4e-3 * j / 100) for j in range(101) for i in range(11)])
    now = start + result.points("displacement")[-1][:, :2]
    ratio = volumes(now, quads) / volumes(start, quads)
    run.check("Taylor bar: volume of every element", ratio, np.ones(1000))
    energies = result.table("glstat")
    run.check("Taylor bar: energy ratio", energies["energy_ratio"], np.ones_like(energies["time"]))
    mass = 8930.0 * 0.5 * 3.2e-3 ** 2 * 32.4e-3
    run.check("Taylor bar: energy at the start, per radian",
              energies["total"][0] + 0.5 * (mass / 200.0) * 227.0 ** 2, 0.5 * mass * 227.0 ** 2)
    free = re.sub(r"\*BOUNDARY_SPC_SET\n.*\n.*\n",
                  "*RIGIDWALL_PLANAR\n         0\n       0.0       0.0       0.0       0.0       1.0       0.0\n", text)
    let_go = run.program(free, name="wall")
    run.report("Taylor bar on a wall that lets go: final radius, mm", 1e3 * let_go.node(11)["x"][-1],
               "its edge lifts off")
    run.report("Taylor bar on a wall that lets go: edge above the wall, mm", 1e3 * let_go.node(11)["y"][-1])
    run.check("Taylor bar on a wall that lets go: nothing behind it",
              let_go.points("displacement")[-1][:11, 1].min(), 0.0)


def check_rates(run):
    """A disc and the ring around it are upset at a constant rate a, as incompressible bodies are: D = (a/2, -a, a/2). The
    law's rate sqrt(D:D) = a sqrt(3/2) has the hoop part in it, and so has the yield stress."""
    rate, yield_stress, slow, power, n_step, end = 2.0, 1.0, 40.0, 4.0, 200, 0.1
    step = end / n_step
    for points in (1, 4):
        deck = Deck("upset at a constant rate").control(end, dt=step)
        deck.add("*PART", "body", (1, 1, 1)).add("*SECTION_SHELL", (1, 15, None, points), (1.0,))
        deck.add("*MAT_PIECEWISE_LINEAR_PLASTICITY", (1, RHO, YOUNG, POISSON, yield_stress, 0.0, 1.0e21, 0.0),
                 (slow, power, 0, 0, 0.0))
        coordinates, quads = grid(2, 2, 2.0, 1.0)
        quads = quads[:3] + [(quads[3][0], quads[3][1], quads[3][2], quads[3][2]),
                             (quads[3][0], quads[3][2], quads[3][3], quads[3][3])]
        ids = deck.mesh(coordinates, quads)
        times = step * np.arange(n_step + 2)
        deck.curve(1, [(t, np.expm1(0.5 * rate * t)) for t in times])
        deck.curve(2, [(t, np.expm1(-rate * t)) for t in times])
        for node, (r, z) in zip(ids, coordinates):
            if r > 0.0:
                deck.prescribe(int(node), 1, 2, 1, r)
            deck.prescribe(int(node), 2, 2, 2, z)
        result = run.program(deck.output(plot=end), name=f"rates_{points}")
        # The rate of the step in its middle.
        middle = np.array([2.0 * np.tanh(0.25 * rate * step), -2.0 * np.tanh(0.5 * rate * step)]) / step
        size = np.sqrt(2.0 * middle[0] ** 2 + middle[1] ** 2)
        stress = result.cells("stress")[-1]
        name = f"upset at a constant rate, {points} point(s)"
        run.check(f"{name}: axial less radial stress", stress[:, 1] - stress[:, 0],
                  -yield_stress * (1.0 + (size / slow) ** (1.0 / power)))
        run.check(f"{name}: hoop less radial stress", stress[:, 2] - stress[:, 0], 0.0)
        run.check(f"{name}: shear stress", stress[:, 3], 0.0)


def check_ring(run):
    """A thin ring, nu 0, pushed outwards by nodal forces of F per radian, free and against a rigid cylinder about the axis."""
    radius, thick, force = 10.0, 0.02, 1.0e-5
    stiffness = YOUNG * thick ** 2 / radius      # per radian: hoop force E A u/R
    free = force / stiffness
    for points in (1, 4):
        for share in (None, 0.25):
            deck = axisymmetric_deck("pushed ring", 9.0, points).elastic(RHO, YOUNG, 0.0)
            ids = deck.mesh(*grid(1, 1, thick, thick, (radius - 0.5 * thick, 0.0)))
            deck.fix(ids, y=1).curve(1, [(0.0, 0.0), (3.0, 1.0), (1.0e9, 1.0)])
            deck.add("*LOAD_NODE_POINT", *[(int(node), 1, 1, 0.25 * force) for node in ids])
            deck.add("*DAMPING_GLOBAL", (0, 2.0 * np.sqrt(YOUNG / RHO) / radius))
            if share is not None:
                edge = radius + 0.5 * thick + share * free
                deck.add("*RIGIDWALL_PLANAR", (0,), (edge, 0.0, 0.0, edge - 1.0, 0.0, 0.0))
                deck.add("*DATABASE_RWFORC", (1.0,))
            result = run.program(deck.output(plot=9.0), name=f"ring_{points}_{share or 1}")
            name = f"pushed ring, {points} point(s)" + (", cylinder" if share else "")
            moved = result.points("displacement")[-1][:, 0]
            run.check(f"{name}: radial displacement", moved[::2].mean() if share is None else moved[1::2].mean(),
                      free * (share or 1.0))
            if share is not None:
                wall = result.table("rwforc")
                run.check(f"{name}: force on the cylinder, per radian", np.abs(wall["fx"][-1]),
                          force * (1.0 - share))


def check(run):
    check_tube(run)
    check_rates(run)
    check_ring(run)
    check_sphere(run, 1)
    check_sphere(run, 4)
    check_bar(run)
    check_taylor(run)
