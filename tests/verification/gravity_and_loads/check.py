# SPDX-License-Identifier: MIT
"""Loads, damping and prescribed motion of a single block."""
import numpy as np

from meshes import Deck, distorted_patch, grid, lumped_mass

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.3
DT, N_STEP = 0.001, 200


def block(title, dt=DT, end_time=DT * N_STEP, shape=None):
    """Distorted 2 x 2 patch (or the given mesh) with a constant step; all nodes in nodout."""
    coordinates, quads = shape or distorted_patch()
    deck = Deck(title)
    deck.control(end_time, dt=dt).part().elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(coordinates, quads)
    deck.node_set(1, nodes)
    deck.output(plot=end_time / 4, glstat=dt, matsum=dt, nodout=dt, nodes=nodes)
    return deck, nodes, lumped_mass(coordinates, quads, RHO)


def check_free_fall(run):
    for keyword, axis in (("*LOAD_BODY_X", "x"), ("*LOAD_BODY_Y", "y")):
        deck, nodes, mass = block("free fall")
        deck.curve(1, [(0.0, 9.81), (1.0, 9.81)]).add(keyword, (1, 1.0))
        result = run.program(deck)
        history = result.node(5)
        run.check(f"{keyword}: displacement", history[f"u{axis}"],
                  -0.5 * 9.81 * history["time"] ** 2)
        run.check(f"{keyword}: velocity", history[f"v{axis}"], -9.81 * history["time"])
        run.check(f"{keyword}: acceleration", history[f"a{axis}"], -9.81)
        other = "y" if axis == "x" else "x"
        run.check(f"{keyword}: nothing along {other}", history[f"u{other}"], 0.0)
        energy = result.table("glstat")
        run.check(f"{keyword}: external work", energy["external_work"],
                  0.5 * mass.sum() * (9.81 * energy["time"]) ** 2)
        run.check(f"{keyword}: energy ratio", energy["energy_ratio"], 1.0)


def check_ramp(run):
    """Body force growing with time: the curve is read between its points."""
    deck, nodes, mass = block("ramped body force")
    deck.curve(1, [(0.0, 0.0), (0.2, 40.0)]).add("*LOAD_BODY_Y", (1, 0.5))
    history = run.program(deck).node(5)
    time = history["time"]
    # v(n+1/2) = sum of dt a(k): u(n) = -(100/6) (t^3 - t dt^2)
    run.check("ramped body force: displacement", history["uy"],
              -100.0 / 6.0 * (time ** 3 - time * DT ** 2))


def check_nodal_force(run):
    """Forces in proportion to the nodal masses move the block rigidly."""
    deck, nodes, mass = block("nodal forces")
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
    deck.add("*LOAD_NODE_POINT", *[(node, 1, 1, 3.0 * m) for node, m in zip(nodes, mass)])
    deck.add("*LOAD_NODE_POINT", *[(node, 2, 1, -2.0 * m) for node, m in zip(nodes, mass)])
    result = run.program(deck)
    for node in (1, 5, 9):
        history = result.node(node)
        run.check(f"nodal force: node {node}", np.stack([history["ux"], history["uy"]]),
                  np.stack([1.5 * history["time"] ** 2, -history["time"] ** 2]))
    deck, nodes, mass = block("node set force")
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)]).add("*LOAD_NODE_SET", (1, 1, 1, 7.0))
    result = run.program(deck)
    part = result.table("matsum")
    run.check("node set force: momentum", part["momentum_x"], 9 * 7.0 * part["time"])


def check_pressure(run):
    """Resultant of a pressure on a skew edge, against the outward normal."""
    coordinates, quads = distorted_patch()
    coordinates = coordinates @ np.array([[1.0, 0.2], [-0.3, 1.0]]).T
    deck, nodes, mass = block("pressure", dt=1.0e-4, end_time=0.01, shape=(coordinates, quads))
    deck.curve(1, [(0.0, 50.0), (1.0, 50.0)])
    for a, b in ((2, 5), (5, 8)):  # the right side, counter-clockwise: upwards
        deck.add("*LOAD_SEGMENT", (1, 1.0, 0.0, nodes[a], nodes[b], nodes[b], nodes[b]))
    result = run.program(deck)
    side = coordinates[8] - coordinates[2]
    force = -50.0 * np.array([side[1], -side[0]])
    part = result.table("matsum")
    row = 1
    run.check("pressure: first impulse", [part["momentum_x"][row], part["momentum_y"][row]],
              force * part["time"][row])
    start = result.node(1)["time"] == 0.0
    pushed = [[result.node(int(nodes[k]))["ax"][start][0] * mass[k],
               result.node(int(nodes[k]))["ay"][start][0] * mass[k]] for k in (2, 5, 8)]
    lower, upper = (coordinates[5] - coordinates[2]), (coordinates[8] - coordinates[5])
    shares = [-25.0 * np.array([d[1], -d[0]]) for d in (lower, lower + upper, upper)]
    run.check("pressure: nodal shares at the start", pushed, np.array(shares))
    deck, nodes, _ = block("pressure on a set", dt=1.0e-4, end_time=0.01, shape=(coordinates, quads))
    deck.curve(1, [(0.0, 50.0), (1.0, 50.0)])
    deck.add("*SET_SEGMENT", (1,), (nodes[2], nodes[5], nodes[5], nodes[5]),
             (nodes[5], nodes[8], nodes[8], nodes[8]))
    deck.add("*LOAD_SEGMENT_SET", (1, 1, 1.0))
    again = run.program(deck).table("matsum")
    run.check("pressure on a segment set: momentum", again["momentum_x"], part["momentum_x"])


def check_damping(run):
    damping, found = 20.0, []
    for n_step in (200, 400):
        dt = 0.1 / n_step
        deck, nodes, mass = block("global damping", dt=dt, end_time=0.1)
        deck.add("*INITIAL_VELOCITY", (1,), (2.0, -1.0)).add("*DAMPING_GLOBAL", (0, damping))
        result = run.program(deck)
        history = result.node(5)
        k = len(history["time"]) - 3
        found.append(-np.log(history["vx"][k] / history["vx"][2])
                     / (history["time"][k] - history["time"][2]))
        run.report(f"damping: rate / D, D dt = {damping * dt:g}", found[-1] / damping)
    run.check("damping: rate of decay, step to zero", 2.0 * found[1] - found[0], damping)
    run.check("damping: velocity y over x", history["vy"][1:-1] / history["vx"][1:-1], -0.5)
    energy = result.table("glstat")
    run.check("damping: energy / start", energy["damping"][-1] / energy["kinetic"][0],
              1.0 - np.exp(-2.0 * damping * 0.1))
    run.check("damping: energy ratio", energy["energy_ratio"], 1.0)


def check_prescribed(run):
    """Velocity, acceleration and displacement curves on all nodes in x; y is free."""
    deck, nodes, mass = block("prescribed velocity")
    deck.curve(1, [(0.0, 0.0), (0.2, 2.0)])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (1, 1, 0, 1, 1.0))
    result = run.program(deck)
    history = result.node(5)
    cycle = np.rint(history["time"] / DT)
    run.check("prescribed velocity: displacement", history["ux"], 5.0 * history["time"] ** 2)
    inner = slice(1, -1)
    run.check("prescribed velocity: velocity", history["vx"][inner], 10.0 * history["time"][inner])
    energy = result.table("glstat")
    run.check("prescribed velocity: external work", energy["external_work"][inner],
              energy["kinetic"][inner])
    run.check("prescribed velocity: energy ratio after 10 steps", energy["energy_ratio"][10:-1],
              1.0)

    deck, nodes, mass = block("prescribed acceleration")
    deck.curve(1, [(0.0, 4.0), (1.0, 4.0)])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (1, 2, 1, 1, 1.0))
    history = run.program(deck).node(5)
    run.check("prescribed acceleration: displacement", history["uy"], 2.0 * history["time"] ** 2)

    deck, nodes, mass = block("prescribed displacement")
    deck.curve(1, [(0.0, 0.0), (0.1, 0.02), (0.2, -0.01)])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (1, 1, 2, 1, 2.0))
    history = run.program(deck).node(5)
    run.check("prescribed displacement: position", history["ux"],
              2.0 * np.interp(cycle * DT, [0.0, 0.1, 0.2], [0.0, 0.02, -0.01]))


def check_birth_and_death(run):
    """Motion that begins and ends during the run; the body flies on with what it has."""
    deck, nodes, mass = block("birth and death of a motion")
    deck.curve(1, [(0.0, 3.0), (1.0, 3.0)])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (1, 1, 0, 1, 1.0, 0, 0.15, 0.05))
    history = run.program(deck).node(5)
    cycle = np.rint(history["time"] / DT)
    # steps from cycle 50 on carry the velocity, also those after the death
    run.check("birth and death: displacement", history["ux"], 3.0 * DT * np.maximum(0, cycle - 50))
    deck, nodes, mass = block("arrival of a pressure", shape=grid(1, 1))
    deck.curve(1, [(0.0, 20.0), (1.0, 20.0)])
    deck.add("*LOAD_SEGMENT", (1, 1.0, 0.1, nodes[1], nodes[3], nodes[3], nodes[3]))
    part = run.program(deck).table("matsum")
    late = np.maximum(0.0, part["time"] - 0.1)
    run.check("arrival time: momentum", part["momentum_x"], -20.0 * late)


def check_one_direction(run):
    """Damping in x alone."""
    deck, nodes, mass = block("damping in x")
    deck.add("*INITIAL_VELOCITY", (1,), (2.0, -1.0))
    deck.add("*DAMPING_GLOBAL", (0, 10.0, 1.0, 0.0))
    history = run.program(deck).node(5)
    run.check("damping in x alone: velocity x", history["vx"],
              2.0 * np.exp(-10.0 * history["time"]))
    run.check("damping in x alone: velocity y", history["vy"], -1.0)


def check_reaction_work(run):
    """Slow stretch by prescribed displacement: the reactions' work is the energy stored."""
    deck, nodes, mass = block("slow stretch", dt=0.005, end_time=2.0, shape=grid(1, 1))
    deck.curve(1, [(0.0, 0.0), (2.0, 1.0e-3)])
    deck.fix(nodes, y=1).fix(nodes[[0, 2]], x=1)
    for node in nodes[[1, 3]]:
        deck.prescribe(node, 1, 2, 1)
    energy = run.program(deck).table("glstat")
    run.check("reaction work: external work", energy["external_work"][-1],
              energy["internal"][-1] + energy["kinetic"][-1])
    modulus = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
    run.check("reaction work: internal energy", energy["internal"][-1], 0.5 * modulus * 1.0e-6)


def check(run):
    check_free_fall(run)
    check_ramp(run)
    check_nodal_force(run)
    check_pressure(run)
    check_damping(run)
    check_prescribed(run)
    check_reaction_work(run)
    check_birth_and_death(run)
    check_one_direction(run)
