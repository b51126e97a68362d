# SPDX-License-Identifier: MIT
"""Implicit dynamics: one element against its own recursion, spectral radius, order, energy, two bars."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid, trapezoid

RHO, YOUNG, LENGTH = 1000.0, 1.0e6, 1.0
OMEGA = np.sqrt(3.0 * YOUNG / RHO) / LENGTH     # one linear element, one end held, consistent mass
PERIOD = 2.0 * np.pi / OMEGA
SOUND = np.sqrt(YOUNG / RHO)


def generalised(radius):
    """alpha_m, alpha_f, gamma, beta of Chung & Hulbert (1993), eqs. 17, 20, 25."""
    alpha_m, alpha_f = (2.0 * radius - 1.0) / (radius + 1.0), radius / (radius + 1.0)
    return alpha_m, alpha_f, 0.5 - alpha_m + alpha_f, 0.25 * (1.0 - alpha_m + alpha_f) ** 2


def hilber(alpha):
    """The same of Hilber, Hughes and Taylor, alpha below 0."""
    return 0.0, -alpha, 0.5 - alpha, 0.25 * (1.0 - alpha) ** 2


#: name -> parameters, GAMMA, BETA and ALPHA of the deck, spectral radius of the deck
SCHEMES = {
    **{f"spectral radius {radius}": (generalised(radius), (None, None, None), radius)
       for radius in (1.0, 0.8, 0.5, 0.0)},
    "default": (generalised(0.8), (None, None, None), None),
    "Newmark, trapezoidal": ((0.0, 0.0, 0.5, 0.25), (0.5, 0.25, None), None),
    "Newmark, damped": ((0.0, 0.0, 0.6, 0.3025), (0.6, 0.3025, None), None),
    "HHT -0.1": (hilber(-0.1), (None, None, -0.1), None),
    "HHT -0.3": (hilber(-0.3), (None, None, -0.3), None),
}


def implicit(deck, dt, end_time, newmark=(None, None, None), radius=None):
    gamma, beta, alpha = newmark
    deck.add("*CONTROL_TERMINATION", (end_time,)).add("*CONTROL_IMPLICIT_GENERAL", (1, dt))
    deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1, gamma, beta, None, None, None, None, alpha))
    if radius is not None:
        deck.add("*CONTROL_IMPLICIT_SPECTRAL_RADIUS", (radius,))
    return deck


def element(title, dt, steps, newmark=(None, None, None), radius=None, speed=0.0):
    """One element, held in y and at its left end; returns the deck and a node of the right end."""
    deck = implicit(Deck(title), dt, steps * dt, newmark, radius)
    deck.part(points=4).elastic(RHO, YOUNG, 0.0)
    nodes = deck.mesh(*grid(1, 1, LENGTH, LENGTH))
    deck.fix(nodes, y=1).fix(nodes[[0, 2]], x=1)
    if speed:
        deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), speed, 0.0) for node in nodes[[1, 3]]])
    return deck.output(glstat=dt, nodout=dt, nodes=[int(nodes[1])]), nodes


def recursion(parameters, dt, steps, speed):
    """u, v, a of the right end: m = rho L/3, force = stress of the element (K = E/3, G = E/2)."""
    alpha_m, alpha_f, gamma, beta = parameters
    mass = RHO * LENGTH / 3.0
    u = a = strain = force = 0.0
    v = speed
    rows = [(u, v, a)]
    for _ in range(steps):
        new = u + dt * v
        for _ in range(30):
            middle = LENGTH + 0.5 * (u + new)
            new_strain = strain + (new - u) / middle
            new_force = YOUNG / 3.0 * np.log1p(new / LENGTH) + 2.0 / 3.0 * YOUNG * new_strain
            slope = YOUNG / 3.0 / (LENGTH + new) + 2.0 / 3.0 * YOUNG * (LENGTH + u) / middle ** 2
            new_a = (new - u - dt * v) / (beta * dt ** 2) - (0.5 / beta - 1.0) * a
            residual = mass * ((1.0 - alpha_m) * new_a + alpha_m * a) \
                + (1.0 - alpha_f) * new_force + alpha_f * force
            change = -residual / ((1.0 - alpha_m) * mass / (beta * dt ** 2)
                                  + (1.0 - alpha_f) * slope)
            new += change
            if abs(change) <= 1e-16 * LENGTH:
                break
        middle = LENGTH + 0.5 * (u + new)
        strain += (new - u) / middle
        force = YOUNG / 3.0 * np.log1p(new / LENGTH) + 2.0 / 3.0 * YOUNG * strain
        new_a = (new - u - dt * v) / (beta * dt ** 2) - (0.5 / beta - 1.0) * a
        v += dt * ((1.0 - gamma) * a + gamma * new_a)
        u, a = new, new_a
        rows.append((u, v, a))
    return np.array(rows).T


def check_recursion(run):
    """Each scheme step by step, strains of 5 %."""
    dt, steps, amplitude = PERIOD / 20.0, 60, 0.05
    for name, (parameters, newmark, radius) in SCHEMES.items():
        deck, _ = element(name, dt, steps, newmark, radius, amplitude * OMEGA)
        history = run.program(deck, name="recursion_" + name.replace(" ", "_").replace(",", "")) \
            .table("nodout")
        expected = recursion(parameters, dt, steps, amplitude * OMEGA)
        for quantity, column, values in zip(("displacement", "velocity", "acceleration"),
                                            ("ux", "vx", "ax"), expected):
            run.check(f"{name}: {quantity} of 60 steps", history[column], values, 1e-8,
                      source="recursion of its own")


def check_closed_form(run):
    """Trapezoidal rule on the linear oscillator: u = v0/w sin(n theta), tan(theta/2) = w dt/2."""
    dt, steps, speed = PERIOD / 20.0, 200, 1e-7 * OMEGA
    deck, _ = element("closed form", dt, steps, radius=1.0, speed=speed)
    result = run.program(deck, name="closed_form")
    moved = result.table("nodout")["ux"]
    angle = 2.0 * np.arctan(0.5 * OMEGA * dt)
    run.check("spectral radius 1: ten periods of the element, w^2 = 3 E/(rho L^2)", moved,
              speed / OMEGA * np.sin(angle * np.arange(steps + 1)), 1e-6, source="closed form")
    run.check("spectral radius 1: energy of the element", result.table("glstat")["energy_ratio"], 1.0,
              1e-8, "abs", "the trapezoidal rule keeps the energy")


def check_order(run):
    """Error after one period against the exact oscillation."""
    speed = 1e-6 * OMEGA
    for name, order in (("spectral radius 1.0", 2), ("spectral radius 0.5", 2),
                        ("spectral radius 0.0", 2), ("HHT -0.3", 2), ("Newmark, damped", 1)):
        _, newmark, radius = SCHEMES[name]
        counts, errors = (40, 80, 160), []
        for count in counts:
            deck, _ = element(name, PERIOD / count, count, newmark, radius, speed)
            history = run.program(deck, name=f"order_{name.replace(' ', '_').replace(',', '')}"
                                  f"_{count}").table("nodout")
            exact = speed / OMEGA * np.sin(OMEGA * history["time"])
            errors.append(np.max(np.abs(history["ux"] - exact)) / (speed / OMEGA))
        run.check(f"{name}: order in the step", np.log2(errors[-2] / errors[-1]), order, 0.05, "abs",
                  "theory")
        run.report(f"{name}: error at 160 steps a period", errors[-1])


def check_radius(run):
    """Steps of 1600 periods: a displaced end that is let go changes by -rho a step."""
    dt, held = 1.0e4 / OMEGA, 1e-6
    for radius in (1.0, 0.8, 0.5, 0.2):
        deck, nodes = element(f"spectral radius {radius}", dt, 8, radius=radius)
        deck.curve(1, [(0.0, 0.0), (dt, held), (1.0e3 * dt, held)])
        for node in nodes[[1, 3]]:
            deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", (int(node), 1, 2, 1, 1.0, 0, 2.5 * dt, 0.0))
        moved = run.program(deck, name=f"radius_{radius}").table("nodout")["ux"]
        run.check(f"spectral radius {radius}: held displacement", moved[2], held, 1e-9, source="curve")
        run.check(f"spectral radius {radius}: steps after the release / held displacement",
                  moved[2:] / held, (-radius) ** np.arange(7.0), 1e-5, "abs",
                  "(-rho)^n where stiffness is all")


def node_masses(coordinates, quads):
    """Row sums of the consistent mass matrix: integrals of rho N_i, 2 x 2 Gauss points."""
    masses = np.zeros(len(coordinates))
    sign = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    for quad in quads:
        corner = coordinates[list(quad)]
        for xi, eta in sign / np.sqrt(3.0):
            shape = 0.25 * (1.0 + sign[:, 0] * xi) * (1.0 + sign[:, 1] * eta)
            slope = 0.25 * np.array([sign[:, 0] * (1.0 + sign[:, 1] * eta),
                                     sign[:, 1] * (1.0 + sign[:, 0] * xi)])
            masses[list(quad)] += RHO * shape * np.linalg.det(slope @ corner)
    return masses


def check_energy(run):
    """A free block with scattered velocities: energy and momentum."""
    rng = np.random.default_rng(7)
    coordinates, quads = grid(4, 3)
    coordinates = coordinates + 0.05 * rng.uniform(-1.0, 1.0, coordinates.shape)
    speeds = 1e-6 * rng.uniform(-1.0, 1.0, coordinates.shape)
    ratios = {}
    for radius in (1.0, 0.5):
        deck = implicit(Deck(f"free block, radius {radius}"), 0.01, 1.0, radius=radius)
        deck.part(points=4).elastic(RHO, YOUNG, 0.3)
        nodes = deck.mesh(coordinates, quads)
        deck.add("*INITIAL_VELOCITY_NODE",
                 *[(int(node), *speed) for node, speed in zip(nodes, speeds)])
        deck.output(glstat=0.01, matsum=0.01, plot=0.01)
        result = run.program(deck, name=f"free_block_{radius}")
        energy, parts = result.table("glstat"), result.table("matsum")
        ratios[radius] = energy["energy_ratio"]
        ids = result.points("node_id")[0].astype(int)
        velocity = result.points("velocity")[:, np.argsort(ids), :2]
        momentum = np.einsum("i,tik->tk", node_masses(coordinates, quads), velocity)
        run.check(f"free block, radius {radius}: momentum with consistent mass", momentum,
                  np.broadcast_to(momentum[0], momentum.shape), 1e-9, source="constant")
        of_parts = np.stack([parts["momentum_x"], parts["momentum_y"]], axis=1)
        run.check(f"free block, radius {radius}: momentum of the part", of_parts, momentum, 1e-9,
                  source="consistent mass, computed here")
        run.check(f"free block, radius {radius}: kinetic energy of the part", parts["kinetic"],
                  energy["kinetic"], 1e-12, source="one part")
    run.check("free block, radius 1: energy", ratios[1.0], 1.0, 1e-7, "abs",
              "kept where the problem is linear")
    run.check("free block, radius 0.5: energy left", ratios[0.5][-1], 0.9, 0.0, "max",
              "short waves are damped")
    run.report("free block, radius 1: largest change of the energy ratio",
               np.max(np.abs(ratios[1.0] - 1.0)))
    run.report("free block, radius 0.5: energy ratio at the end", ratios[0.5][-1])


def check_bars(run, kind):
    """Two equal bars meet end to end, steps of one element passage."""
    name, n, speed = TYPES[kind], 100, 0.1
    size, duration = LENGTH / n, 2.0 * LENGTH / SOUND
    dt = size / SOUND
    deck = implicit(Deck(f"two bars, type {kind}"), dt, 2.0 * duration)
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, 0.0, part)
    left = deck.mesh(*grid(n, 1, LENGTH, size, (-LENGTH, 0.0)), part=1)
    right = deck.mesh(*grid(n, 1, LENGTH, size), part=2)
    deck.node_set(1, left).node_set(2, left[n::n + 1]).node_set(3, right[::n + 1][::-1])
    deck.add("*INITIAL_VELOCITY", (1,), (speed, 0.0))
    deck.contact(2, 3, kind, 0.25 * YOUNG).output(glstat=dt, matsum=dt, rcforc=dt)
    result = run.program(deck, name=f"bars_{kind}")
    slave = result.table("rcforc").where(side="slave")
    time, force = slave["time"], np.abs(slave["fx"])
    plateau, momentum = 0.5 * RHO * SOUND * speed * size, RHO * LENGTH * size * speed
    middle = np.abs(time - 0.5 * duration) < 0.3 * duration
    run.check(f"{name}: contact force", force[middle].mean(), plateau, 2e-3, source="rho c v/2")
    pressed = time[force > 0.5 * plateau]
    run.check(f"{name}: contact time", pressed[-1] - pressed[0] + dt, duration, 0.01, source="2 L/c")
    run.check(f"{name}: impulse", trapezoid(force, time), momentum, 5e-3, source="rho L v")
    parts = [result.table("matsum").where(part=part)["momentum_x"] for part in (1, 2)]
    run.check(f"{name}: momentum of the second bar", parts[1][-1], momentum, 5e-3,
              source="full exchange")
    run.check(f"{name}: total momentum", parts[0] + parts[1], momentum, 1e-9, source="constant")
    run.check(f"{name}: no force at the end", force[-1] / plateau, 0.0, 1e-12, "abs", "separated")
    energy = result.table("glstat")
    run.check(f"{name}: energy ratio at the end", energy["energy_ratio"][-1], 1.0, 2e-3, "abs",
              "balance; the scheme damps the shortest waves")
    run.report(f"{name}: energy ratio at the end", energy["energy_ratio"][-1])


def driven(title, kind, points, dt, steps, radius=1.0, birth=0.0, death=0.0):
    """One element, free at its left end, its right end on a curve of speeds or places of 1e-7 m."""
    deck = implicit(Deck(title), dt, steps * dt, radius=radius)
    deck.part(points=4).elastic(RHO, YOUNG, 0.0)
    nodes = deck.mesh(*grid(1, 1, LENGTH, LENGTH))
    deck.fix(nodes, y=1).curve(1, points)
    for node in nodes[[1, 3]]:
        deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", (int(node), 1, kind, 1, 1e-7, 0, death, birth))
    deck.output(glstat=dt, nodout=dt, nodes=[int(nodes[0]), int(nodes[1])])
    return deck, int(nodes[0]), int(nodes[1])


VELOCITY, ACCELERATION, DISPLACEMENT = 0, 1, 2


def check_driven(run):
    """The driven end moves with speed 1 from the start: w = u_free - u_driven is a free oscillation from w' = -1."""
    dt, steps = PERIOD / 20.0, 200
    angle = 2.0 * np.arctan(0.5 * OMEGA * dt)
    expected = -np.sin(angle * np.arange(steps + 1)) / OMEGA
    for kind, name, points in ((DISPLACEMENT, "displacement", [(0.0, 0.0), (1e3, 1e3)]),
                               (VELOCITY, "velocity", [(0.0, 1.0), (1e3, 1.0)])):
        deck, free, moved = driven(f"driven by {name}", kind, points, dt, steps)
        result = run.program(deck, name=f"driven_{name}")
        end, other = result.node(moved), result.node(free)
        run.check(f"{name} curve of speed 1: displacement", end["ux"] / 1e-7, end["time"], 1e-12,
                  source="curve")
        run.check(f"{name} curve of speed 1: velocity of its end", end["vx"] / 1e-7, 1.0, 1e-10, "abs",
                  "curve")
        run.check(f"{name} curve of speed 1: acceleration of its end", end["ax"] / 1e-7, 0.0, 1e-8, "abs",
                  "curve")
        run.check(f"{name} curve of speed 1: swinging of the free end",
                  (other["ux"] - end["ux"]) / 1e-7, expected, 1e-6, source="closed form")
        run.check(f"{name} curve of speed 1: energy", result.table("glstat")["energy_ratio"], 1.0, 1e-8,
                  "abs", "the work of the reactions")


def check_acceleration_curve(run):
    """An acceleration that rises to 1 and stays: the curve integrated twice, whatever the step."""
    rise = 3.0 * PERIOD
    for dt in (PERIOD / 20.0, PERIOD / 1.7):
        deck, _, moved = driven("acceleration", ACCELERATION, [(0.0, 0.0), (rise, 1.0), (1e3, 1.0)], dt, 20)
        end = run.program(deck, name=f"acceleration_{dt / PERIOD:.2f}").node(moved)
        time, late = end["time"], np.maximum(end["time"] - rise, 0.0)
        early = np.minimum(time, rise)
        run.check(f"acceleration curve, step {dt / PERIOD:.2f} periods: displacement", end["ux"] / 1e-7,
                  early ** 3 / (6.0 * rise) + 0.5 * rise * late + 0.5 * late ** 2, 1e-12, source="integral")
        run.check(f"acceleration curve, step {dt / PERIOD:.2f} periods: velocity", end["vx"] / 1e-7,
                  0.5 * early ** 2 / rise + late, 1e-12, source="integral")


def blow(dt, steps):
    """The free end after the other was set to speed 1 in the first step: trapezoidal rule by hand."""
    own, shared, spring = RHO * LENGTH / 3.0, RHO * LENGTH / 6.0, YOUNG / LENGTH
    u = v = 0.0
    rows = [u]
    for i in range(steps):
        # own (v1 - v) + shared (1 or 0) + dt spring (mean of u - driven) = 0, u1 - u = dt (v + v1)/2
        kick = shared if i == 0 else 0.0
        stretch = u + 0.25 * dt * v - (i + 0.5) * dt
        v1 = (own * v - kick - dt * spring * stretch) / (own + 0.25 * dt ** 2 * spring)
        u, v = u + 0.5 * dt * (v + v1), v1
        rows.append(u)
    return np.array(rows)


def check_life(run):
    """Births and deaths inside a step."""
    dt, late, steps = PERIOD / 20.0, 7.3, 100
    deck, free, moved = driven("born late", VELOCITY, [(0.0, 1.0), (1e3, 1.0)], dt, steps, birth=late * dt)
    result = run.program(deck, name="born_late")
    end = result.node(moved)
    alive = end["time"] > late * dt
    run.check("birth inside a step: displacement", end["ux"] / 1e-7,
              np.maximum(end["time"] - late * dt, 0.0), 1e-12, source="curve")
    run.check("birth inside a step: velocity from then on", end["vx"][alive] / 1e-7, 1.0, 1e-12, "abs",
              "curve")
    run.check("birth inside a step: acceleration from then on", end["ax"][alive] / 1e-7, 0.0, 1e-9, "abs",
              "curve")
    run.check("birth inside a step: energy", result.table("glstat")["energy_ratio"], 1.0, 1e-8, "abs",
              "the work of the blow is the kinetic energy that it gives")
    deck, free, _ = driven("born between steps", VELOCITY, [(0.0, 1.0), (1e3, 1.0)], dt, steps, birth=7.0 * dt)
    other = run.program(deck, name="born_between").node(free)
    run.check("birth between two steps: free end", other["ux"][7:] / 1e-7, blow(dt, steps - 7), 1e-6,
              source="trapezoidal rule by hand, blow through the shared mass")
    for kind, name, points in ((VELOCITY, "velocity", [(0.0, 1.0), (1e3, 1.0)]),
                               (DISPLACEMENT, "displacement", [(0.0, 0.0), (1e3, 1e3)])):
        deck, free, moved = driven("dies early", kind, points, dt, 8, death=2.6 * dt)
        result = run.program(deck.output(plot=1e-3 * dt), name=f"dies_early_{name}")
        order = np.argsort(result.points("node_id")[0].astype(int))
        place = result.points("displacement")[:, order, 0]
        run.check(f"death inside a step, {name}: a state at the death", np.min(np.abs(result.times / dt - 2.6)),
                  0.0, 1e-9, "abs")
        at_death = np.argmin(np.abs(result.times / dt - 2.6))
        run.check(f"death inside a step, {name}: displacement there", place[at_death].max() / 1e-7, 2.6 * dt,
                  1e-12, source="curve")
        parts = result.points("velocity")[at_death:, order, 0].mean(axis=1)
        run.check(f"death inside a step, {name}: momentum after it", parts, parts[0], 1e-9, source="free")


def check_pulled_bar(run):
    """A bar pulled at its end with speed 1: d'Alembert's wave, u = c t - x behind the front."""
    n, speed = 100, 1e-6
    size = LENGTH / n
    dt = 0.5 * size / SOUND
    for kind, name, points in ((DISPLACEMENT, "displacement", [(0.0, 0.0), (1.0, speed)]),
                               (VELOCITY, "velocity", [(0.0, speed), (1.0, speed)])):
        deck = implicit(Deck(f"pulled bar, {name}"), dt, 160 * dt)
        deck.part(points=4).elastic(RHO, YOUNG, 0.0)
        nodes = deck.mesh(*grid(n, 1, LENGTH, size))
        deck.fix(nodes, y=1).curve(1, points)
        for node in nodes[[0, n + 1]]:
            deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", (int(node), 1, kind, 1))
        deck.output(glstat=dt, plot=160 * dt, nodout=dt, nodes=[int(nodes[0])])
        result = run.program(deck, name=f"pulled_{name}")
        end, energy = result.node(int(nodes[0])), result.table("glstat")
        run.check(f"pulled bar, {name}: velocity of its end", end["vx"] / speed, 1.0, 1e-10, "abs", "curve")
        order = np.argsort(result.points("node_id")[0].astype(int))
        x = result.points("Points")[0][order, 0]
        moved = result.points("displacement")[-1][order, 0]
        exact = speed / SOUND * np.maximum(SOUND * 160 * dt - x, 0.0)
        run.check(f"pulled bar, {name}: displacement along it", moved, exact, 0.01,
                  source="d'Alembert; to an element's width at the front")
        run.check(f"pulled bar, {name}: work of the pull", energy["external_work"][-1] + energy["kinetic"][0],
                  RHO * SOUND * size * speed ** 2 * 160 * dt, 0.01, source="rho c v^2 t")
        run.check(f"pulled bar, {name}: energy", energy["energy_ratio"][-1], 1.0, 5e-3, "abs", "balance")


def check(run):
    check_recursion(run)
    check_closed_form(run)
    check_order(run)
    check_radius(run)
    check_energy(run)
    check_driven(run)
    check_acceleration_curve(run)
    check_life(run)
    check_pulled_bar(run)
    for kind in (5, 7):
        check_bars(run, kind)
