# SPDX-License-Identifier: MIT
"""Damping of parts by mass and by stiffness: decay of rigid motion, of an oscillator, of modes."""
import numpy as np

from meshes import Deck, grid

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.25
SPEED = np.sqrt(1.2 * YOUNG / RHO)


def bar(title, n=1, points=None, form=13, poisson=POISSON, left=0.0, dt=2.0e-4, end=0.05, rate_of_output=None):
    """A row of n unit squares, of plane strain along x, or a round disc that moves along y."""
    coordinates, quads = grid(n, 1, width=float(n), height=1.0, origin=(left, 0.0))
    deck = Deck(title)
    deck.control(end, dt=dt).hourglass(4, 0.1)
    deck.add("*PART", "bar", (1, 1, 1)).add("*SECTION_SHELL", (1, form, None, points), (1.0,))
    deck.elastic(RHO, YOUNG, poisson)
    nodes = deck.mesh(coordinates, quads)
    deck.output(glstat=rate_of_output or dt, nodout=rate_of_output or dt, nodes=nodes)
    return deck, nodes


def roots(stiffness_rate, dt, damping=0.0, retardation=0.0):
    """Amplification z per step of u'' + (D) u' + w^2 (u + beta u') = 0 in leap-frog: D acts on the mean of the
    two half-step velocities, beta on the one behind."""
    square = stiffness_rate * dt ** 2
    return np.roots([1.0 + 0.5 * damping * dt, square - 2.0 + square * retardation / dt,
                     1.0 - 0.5 * damping * dt - square * retardation / dt])


def rate_and_frequency(time, motion):
    """Fit of two samples before and after: z from u(n+1) + p u(n) + q u(n-1) = 0, least squares."""
    a = np.column_stack([motion[1:-1], motion[:-2]])
    p, q = np.linalg.lstsq(a, -motion[2:], rcond=None)[0]
    return np.roots([1.0, p, q])


def implicit(deck, dt, radius):
    """The same deck with implicit steps of a spectral radius and inertia; NIP 1 is taken as 4."""
    deck.add("*CONTROL_IMPLICIT_GENERAL", (1, dt)).add("*CONTROL_IMPLICIT_DYNAMICS", (1,))
    return deck.add("*CONTROL_IMPLICIT_SPECTRAL_RADIUS", (radius,))


def check_rigid_motion(run):
    """Velocities of two parts with rates of their own; the curve, SF and the factors of the directions. Both methods
    multiply by (2 - D dt)/(2 + D dt) in a step."""
    dt, end = 1.0e-4, 0.1
    for method in ("explicit", "implicit"):
        deck = Deck(f"two parts, {method}")
        deck.add("*PART", "one", (1, 1, 1)).add("*PART", "two", (2, 1, 1)).add("*SECTION_SHELL", (1, 13, None, 4), (1.0,))
        deck.elastic(RHO, YOUNG, POISSON)
        for part, left in ((1, 0.0), (2, 5.0)):
            deck.mesh(*grid(1, 1, origin=(left, 0.0)), part=part)
        if method == "explicit":
            deck.control(end, dt=dt)
        else:
            implicit(deck, dt, 1.0).add("*CONTROL_TERMINATION", (end,))
        deck.curve(1, [(0.0, 10.0), (1.0, 10.0)]).curve(2, [(0.0, 0.0), (0.1, 40.0)])
        deck.add("*DAMPING_PART_MASS", (1, 1, 2.0, 1), (1.0, 0.0), (2, 2))
        deck.add("*INITIAL_VELOCITY", (0,), (2.0, -1.0))
        deck.output(glstat=0.01, nodout=0.01, nodes=[1, 5])
        result = run.program(deck)
        one, two, table = result.node(1), result.node(5), result.table("glstat")
        inner = slice(1, -1)
        run.check(f"{method}: part 1: velocity x", one["vx"][inner],
                  2.0 * np.exp(-20.0 * one["time"][inner]))
        run.check(f"{method}: part 1: velocity y", one["vy"], -1.0)
        run.check(f"{method}: part 2: velocity", two["vx"][inner],
                  2.0 * np.exp(-200.0 * two["time"][inner] ** 2))
        lost = 0.5 * RHO * (4.0 * (1.0 - np.exp(-40.0 * 0.1)) + 5.0 * (1.0 - np.exp(-400.0 * 0.01)))
        run.check(f"{method}: what damping has taken", table["damping"][-1], lost)
        run.check(f"{method}: balance", table["energy_ratio"], 1.0)


def check_lumps(run):
    """A square and masses on its nodes, as heavy: *DAMPING_GLOBAL acts on both, that of the part on its own mass alone."""
    dt, end, part, all_masses = 1.0e-3, 0.05, 20.0, 8.0
    for method in ("explicit", "implicit"):
        deck = Deck(f"lumps, {method}").part(points=4).elastic(RHO, YOUNG, POISSON)
        nodes = deck.mesh(*grid(1, 1))
        deck.add("*ELEMENT_MASS", *[(k + 1, int(node), 0.25 * RHO) for k, node in enumerate(nodes)])
        if method == "explicit":
            deck.control(end, dt=dt)
        else:
            implicit(deck, dt, 1.0).add("*CONTROL_TERMINATION", (end,))
        deck.curve(1, [(0.0, part), (1.0, part)]).add("*DAMPING_PART_MASS", (1, 1))
        deck.add("*DAMPING_GLOBAL", (0, all_masses, 1.0, 0.5)).add("*INITIAL_VELOCITY", (0,), (2.0, -1.0))
        result = run.program(deck.output(glstat=0.01, nodout=0.01, nodes=[1]))
        history = result.node(1)
        rates = 0.5 * part + all_masses * np.array([1.0, 0.5])
        for name, start, rate in zip(("vx", "vy"), (2.0, -1.0), rates):
            run.check(f"{method}, masses on nodes: {name}", history[name][1:-1],
                      start * np.exp(-rate * history["time"][1:-1]))
        run.check(f"{method}, masses on nodes: balance", result.table("glstat")["energy_ratio"], 1.0)


def check_order(run):
    """Implicit steps of default dissipation: decay by a rate that grows, with errors of second order in the step."""
    end, errors = 0.2, []
    for n in (10, 20, 40):
        deck = implicit(Deck(f"order, {n} steps"), end / n, 0.8).add("*CONTROL_TERMINATION", (end,))
        deck.part(points=4).elastic(RHO, YOUNG, POISSON).mesh(*grid(1, 1))
        deck.curve(1, [(0.0, 5.0), (1.0, 45.0)]).add("*DAMPING_PART_MASS", (1, 1)).add("*INITIAL_VELOCITY", (0,), (2.0, -1.0))
        result = run.program(deck.output(glstat=end, nodout=end, nodes=[1]))
        errors.append(result.node(1)["vx"][-1] - 2.0 * np.exp(-5.0 * end - 20.0 * end ** 2))
    errors = np.array(errors)
    run.check("implicit: order in the step", np.log2(errors[:-1] / errors[1:]), 2.0)
    run.check("implicit: error of 40 steps", abs(errors[-1]), 0.0)


def check_drag(run):
    """A bar led at one end by implicit steps: the force there ends as D m V, and the works balance on the way."""
    dt, end, damping, speed = 4.0e-3, 1.0, 40.0, 0.01
    deck = implicit(Deck("drag"), dt, 1.0).add("*CONTROL_TERMINATION", (end,))
    deck.part(points=4).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(*grid(3, 1, 3.0, 1.0))
    deck.curve(1, [(0.0, 0.0), (0.05, 1.0), (1.0, 1.0)]).curve(2, [(0.0, damping), (1.0, damping)])
    deck.add("*DAMPING_PART_MASS", (1, 2)).fix(nodes, y=1)
    for node in nodes[::4]:
        deck.prescribe(node, 1, 0, 1, speed)
    deck.add("*DATABASE_BNDOUT", (dt,))
    result = run.program(deck.output(glstat=dt))
    table, rows = result.table("glstat"), result.table("bndout")
    force = rows["fx"].reshape(-1, 2).sum(1)
    run.check("drag: force", force[-20:].mean(), damping * 3.0 * RHO * speed)
    run.check("drag: balance", table["external_work"], table["total"])


def check_oscillator(run):
    """One element between fixed and free side: a mass on a spring, w^2 = M/(m/2), damped by its mass."""
    dt, damping = 2.0e-4, 8.0
    deck, nodes = bar("oscillator", dt=dt, end=0.2)
    deck.fix(nodes, y=1).fix(nodes[[0, 2]], x=1)
    deck.curve(1, [(0.0, damping), (1.0, damping)]).add("*DAMPING_PART_MASS", (1, 1))
    deck.add("*INITIAL_VELOCITY_NODE", (int(nodes[1]), 1e-6), (int(nodes[3]), 1e-6))
    result = run.program(deck)
    history = result.node(int(nodes[1]))
    found = rate_and_frequency(history["time"], history["ux"])
    square = 2.0 * SPEED ** 2
    run.check("oscillator: amplification of a step", np.sort_complex(found).view(float),
              np.sort_complex(roots(square, dt, damping)).view(float))
    run.check("oscillator: decay", -np.log(np.abs(found[0])) / dt, 0.5 * damping)
    run.check("oscillator: balance", result.table("glstat")["energy_ratio"], 1.0)


def check_share(run):
    """COEF is the share of critical damping of the fastest mode of an element, in all four element kinds."""
    share = 0.2
    for name, points, form, poisson, left in (
            ("one point", None, 13, 0.25, 0.0), ("four points", 4, 13, 0.25, 0.0),
            ("mean dilatation", 4, 13, 0.45, 0.0), ("round", None, 15, 0.25, 3.0), ("round, four points", 4, 15, 0.25, 3.0),
            ("round, mean dilatation", 4, 15, 0.45, 3.0)):
        dt = 1.0e-4
        deck, nodes = bar(f"share, {name}", points=points, form=form, poisson=poisson, left=left, dt=dt, end=0.05)
        deck.add("*DAMPING_PART_STIFFNESS", (1, share))
        # stretched along y, no motion along x: an oscillator of the modulus M
        deck.fix(nodes, x=1).fix(nodes[[0, 1]], y=1)
        deck.add("*INITIAL_VELOCITY_NODE", (int(nodes[2]), 0.0, 1e-6), (int(nodes[3]), 0.0, 1e-6))
        result = run.program(deck)
        history = result.node(int(nodes[3]))
        found = rate_and_frequency(history["time"], history["uy"])
        modulus = YOUNG * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
        log = (result.folder / f"{result.job}.log").read_text()
        line = log.split("part   stable step")[1].splitlines()[1]
        damped = float(line.split()[2])
        own = damped / (np.sqrt(1.0 + share ** 2) - share)
        square = 2.0 * modulus / RHO
        if form == 15:  # lumped masses of the upper nodes together are half of the body in the mean of the motion
            square = 2.0 * modulus / RHO
        expected = roots(square, dt, retardation=share * own)
        run.check(f"{name}: amplification of a step", np.sort_complex(found).view(float),
                  np.sort_complex(expected).view(float))
        if form == 13 and points is None:
            run.check("one point: step in the log", damped, (np.sqrt(1.04) - 0.2) / SPEED)
        run.check(f"{name}: balance", result.table("glstat")["energy_ratio"], 1.0)


def check_time(run):
    """A negative COEF is the retardation time itself; what damping takes is what the body loses."""
    dt, beta = 2.0e-5, 1.0e-4
    deck, nodes = bar("time", dt=dt, end=0.05, rate_of_output=dt)
    deck.fix(nodes, y=1).fix(nodes[[0, 2]], x=1).add("*DAMPING_PART_STIFFNESS", (1, -beta))
    deck.add("*INITIAL_VELOCITY_NODE", (int(nodes[1]), 1e-6), (int(nodes[3]), 1e-6))
    result = run.program(deck)
    history = result.node(int(nodes[1]))
    found = rate_and_frequency(history["time"], history["ux"])
    square = 2.0 * SPEED ** 2
    run.check("time: amplification of a step", np.sort_complex(found).view(float),
              np.sort_complex(roots(square, dt, retardation=beta)).view(float))
    run.check("time: decay", -np.log(np.abs(found[0])) / dt, 0.5 * beta * square)
    table = result.table("glstat")
    run.check("time: balance", table["energy_ratio"], 1.0)
    w, end = np.sqrt(square), table["time"][-1]
    run.check("time: work of damping", table["damping"][-1],
              beta * square * (0.5 * end + 0.25 * np.sin(2.0 * w * end) / w) * 500.0e-12)


def check_stability(run):
    """At TSSFAC 0.9 a bar with COEF 0.25 decays; without the bound it would not stand."""
    for points in (None, 4):
        deck, nodes = bar("bound", n=4, points=points, end=0.5)
        text = deck.text().replace("*CONTROL_TIMESTEP\n0.0,0.9,0,0.0,0.0,9001", "*CONTROL_TIMESTEP\n0.0,0.9")
        text = text.replace("*END", "*DAMPING_PART_STIFFNESS\n1,0.25\n*INITIAL_VELOCITY_NODE\n2,0.0001,0.0002\n*END")
        table = run.program(text).table("glstat")
        run.check(f"{points or 1} points: kinetic energy falls", table["kinetic"][-1] < 0.9 * table["kinetic"][0], True)
        run.check(f"{points or 1} points: balance", table["energy_ratio"], 1.0)


def check(run):
    check_rigid_motion(run)
    check_lumps(run)
    check_order(run)
    check_drag(run)
    check_oscillator(run)
    check_share(run)
    check_time(run)
    check_stability(run)
