# SPDX-License-Identifier: MIT
"""The balance of a sound run is constant, however short the waves in it: TSSFAC 0.9, no contact."""
import numpy as np

from meshes import Deck, grid

RHO, YOUNG = 1000.0, 1.0e7
SOUND = np.sqrt(YOUNG / RHO)
N, SPEED = 40, 1.0e-4
STEP = 0.9 / N / SOUND


def bar(title, cycles=400, step=STEP, scale=None, is_held=True):
    """N square elements (nu = 0) in a row, free in x alone: a chain of springs."""
    deck = Deck(title)
    if scale:
        deck.control(cycles * step, scale=scale)
    else:
        deck.control(cycles * step, dt=step)
    deck.part().elastic(RHO, YOUNG, 0.0)
    coordinates, quads = grid(N, 1, 1.0, 1.0 / N)
    nodes = deck.mesh(coordinates, quads)
    if is_held:
        deck.fix(nodes, y=1)
    return deck.output(glstat=0.5 * step), nodes


def kick(deck, nodes, speeds):
    """Initial velocities along x, by column of nodes."""
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), float(speeds[k % (N + 1)]), 0.0)
                                         for k, node in enumerate(nodes)])
    return deck


def highest():
    return SPEED * (-1.0) ** np.arange(N + 1)


def one_end():
    return SPEED * (np.arange(N + 1) == 0)


def sums(run, name, energy, tolerance):
    """The balance, and how it follows from the columns."""
    parts = ("kinetic", "internal", "hourglass", "viscous", "damping", "contact", "leapfrog")
    scale = np.max(np.abs(energy["total"]))
    run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0, tolerance, "abs",
              "v(n-1/2).M v(n+1/2)/2 + U is constant")
    run.check(f"{name}: total over the sum of the columns", energy["total"] / scale,
              sum(energy[part] for part in parts) / scale, 1e-14, "abs", "sum of all energies")


def check_kicks(run):
    for name, speeds in (("shortest wave", highest()), ("one kicked end", one_end())):
        deck, nodes = bar(name)
        energy = run.program(kick(deck, nodes, speeds)).table("glstat")
        sums(run, name, energy, 1e-3)
        old = (energy["total"] - energy["leapfrog"]) / energy["total"][0]
        run.report(f"{name}: largest ratio with the mean velocities alone", np.max(old))
        run.check(f"{name}: the mean velocities alone would not do", float(np.max(old) > 1.5), 1.0, 0.0,
                  "abs", "what leapfrog is for")


def check_endeng(run):
    """ENDENG 5 does not end a sound run."""
    deck, nodes = bar("shortest wave, ENDENG 5")
    kick(deck, nodes, highest())
    place = deck.lines.index("*CONTROL_TERMINATION") + 1
    deck.lines[place] = deck.lines[place].rstrip(",") + ",0,0.0,5.0"
    result = run.program(deck, name="endeng")
    run.check("ENDENG 5: exit status", result.status, 0, 0.0, "abs", "sound")


def check_loads(run):
    """Everything from outside, at steps of 0.9 times the limit."""
    # a force at one end, switched on at once
    deck, nodes = bar("pulled end")
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
    deck.add("*LOAD_NODE_POINT", *[(int(node), 1, 1, 1.0e-2) for node in nodes[[N, -1]]])
    sums(run, "pulled end", run.program(deck).table("glstat"), 1e-3)
    # gravity
    deck, nodes = bar("gravity")
    deck.curve(1, [(0.0, 1.0e-3), (1.0, 1.0e-3)])
    deck.add("*LOAD_BODY_X", (1,))
    deck.fix(nodes[[0, N + 1]], x=1)
    sums(run, "gravity, one end held", run.program(deck).table("glstat"), 1e-3)
    # one end driven
    for kind, points in ((0, [(0.0, SPEED), (1.0, SPEED)]), (2, [(0.0, 0.0), (1.0, SPEED)])):
        deck, nodes = bar(f"driven end, {kind}")
        deck.curve(1, points)
        for node in nodes[[0, N + 1]]:
            deck.prescribe(node, 1, kind, 1)
        sums(run, f"end driven by {'velocity' if kind == 0 else 'displacement'}",
             run.program(deck).table("glstat"), 1e-3)
    # damping, of each mode
    for name, speeds in (("shortest wave", highest()), ("one kicked end", one_end())):
        deck, nodes = bar(f"{name}, damped")
        kick(deck, nodes, speeds).add("*DAMPING_GLOBAL", (0, 0.05 / STEP))
        energy = run.program(deck).table("glstat")
        sums(run, f"{name}, damped", energy, 1e-3)
        left = energy["damping"][-1] / energy["total"][0]
        run.check(f"{name}, damped: all is dissipated", left, 1.0, 1e-2, "abs", "end of the motion")


def check_exact(run):
    """Linear and without elements that strain: round-off."""
    deck, nodes = bar("flight under gravity")
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
    deck.add("*LOAD_BODY_X", (1,))
    kick(deck, nodes, np.full(N + 1, 0.3))
    sums(run, "flight under gravity", run.program(deck).table("glstat"), 1e-11)
    # a force that grows, damping of D dt = 0.5 that is there at time zero, and damping that grows
    for name, loads, damping in (("a force that grows", (0.0, 1.0e3), None), ("damped, loaded at time zero", (1.0, 1.0), (0, 0.5)),
                                 ("damping that grows", (1.0, 1.0e3), (2, 1.0))):
        deck, nodes = bar(f"flight, {name}")
        end = 400 * STEP
        deck.curve(1, [(0.0, loads[0]), (end, loads[1])]).add("*LOAD_BODY_X", (1,))
        if damping:
            deck.curve(2, [(0.0, 0.05 / STEP), (end, 0.5 / STEP)])
            deck.add("*DAMPING_GLOBAL", (damping[0], damping[1] / STEP if damping[0] == 0 else 1.0))
        kick(deck, nodes, np.full(N + 1, 0.3))
        sums(run, f"flight, {name}", run.program(deck).table("glstat"), 1e-11)


def check_walls_and_rigid(run):
    """A bar that meets a rigid wall: what nodes lose there is work of the wall."""
    deck, nodes = bar("wall")
    deck.add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0)).node_set(1, nodes)
    deck.add("*RIGIDWALL_PLANAR", (1, 0, 0, 0.0), (1.0 + 1.0e-8, 0.0, 0.0, 0.0, 0.0, 0.0))
    sums(run, "bar against a rigid wall", run.program(deck).table("glstat"), 1e-3)
    # damped as strongly as here, what the mean of v(0) and v(1/2) says of the first cycle is a tenth of a node's energy
    deck, nodes = bar("wall, damped")
    deck.add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0)).node_set(1, nodes).add("*DAMPING_GLOBAL", (0, 0.5 / STEP))
    deck.add("*RIGIDWALL_PLANAR", (1, 0, 0, 0.0), (1.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    sums(run, "damped bar, at a rigid wall from time zero", run.program(deck).table("glstat"), 1e-5)
    for name, loads in (("gravity", (1.0, 1.0)), ("gravity that grows", (0.0, 1.0e3))):
        deck, nodes = rigid_bar(name)
        deck.curve(1, [(0.0, loads[0]), (400 * STEP, loads[1])]).add("*LOAD_BODY_X", (1,))
        kick(deck, nodes, np.full(N + 1, 0.3))
        sums(run, f"rigid body under {name}", run.program(deck).table("glstat"), 1e-11)
    check_pendulum(run)


def rigid_bar(title):
    deck, nodes = bar(title, is_held=False)
    place = deck.lines.index("*MAT_ELASTIC")
    deck.lines[place] = "*MAT_RIGID"
    deck.lines[place + 2:place + 2] = ["1,0,0", "0.0,"]
    return deck, nodes


def check_pendulum(run):
    """A rigid bar that is pulled at both ends turns to and fro, with omega dt = 0.5."""
    deck, nodes = rigid_bar("pendulum")
    omega, angle, inertia = 0.5 / STEP, 0.05, RHO / N * (1.0 + 2.0 / N ** 2) / 12.0 + RHO / N * (0.5 / N) ** 2
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
    for column, sign in ((0, -1.0), (N, 1.0)):
        deck.add("*LOAD_NODE_POINT", *[(int(node), 1, 1, sign * 0.5 * omega ** 2 * inertia) for node in nodes[[column, column + N + 1]]])
    places, _ = grid(N, 1, 1.0, 1.0 / N)
    x, y = (places - (0.5, 0.5 / N)).T
    deck.add("*INITIAL_VELOCITY_NODE", *zip(nodes.tolist(), (-omega * angle * y).tolist(), (omega * angle * x).tolist()))
    energy = run.program(deck).table("glstat")
    start = energy["total"][0]
    run.check("rigid pendulum: kinetic energy at the start", energy["kinetic"][0], 0.5 * inertia * (omega * angle) ** 2, 1e-10,
              source="I w^2/2")
    run.check("rigid pendulum: largest part of leap-frog / energy", np.max(-energy["leapfrog"]) / start, 0.0625 / (1.0 - 0.0625), 1e-3,
              "abs", "q/(1 - q) with q = (omega dt)^2/4")
    run.check("rigid pendulum: (total - work of the forces) / energy", (energy["total"] - energy["external_work"]) / start, 1.0,
              3e-4, "abs", "constant; a chord is shorter than its arc by (w dt)^2/24")


def check_jumps(run):
    """A step that halves and doubles: the balance jumps as leap-frog says, and the step is that of the curve."""
    deck, nodes = bar("jumps of the step", cycles=20)
    place = deck.lines.index("*DEFINE_CURVE")
    points = [(0.0, 1.0), (9.4, 1.0), (9.6, 0.5), (14.6, 0.5), (14.9, 1.0), (100.0, 1.0)]
    deck.lines[place + 2:place + 4] = [f"{float(time * STEP)!r},{float(step * STEP)!r}" for time, step in points]
    gravity = 1.0e3
    deck.curve(1, [(0.0, gravity), (1.0, gravity)]).add("*LOAD_BODY_X", (1,))
    energy = run.program(kick(deck, nodes, np.full(N + 1, 0.3))).table("glstat")
    steps = energy["dt"] / STEP
    run.check("jumps: steps / the first", steps[:-1], np.array([1.0] * 10 + [0.5] * 10 + [1.0] * (len(steps) - 21)), 1e-12, "abs",
              "the curve")
    unit = RHO / N * (gravity * STEP) ** 2 / 8.0
    found = (energy["total"] - energy["external_work"] - energy["total"][0]) / unit
    run.check("jumps: change of the balance / (m a^2 dt^2/8)", found[1:], 1.0 - steps[:-1] ** 2, 1e-8, "abs",
              "m a^2 (dt_before^2 - dt^2)/8 at each change of the step")


def check_variable_steps(run):
    """Steps that follow the elements: the balance stays, while the steps change little."""
    for name, speeds in (("shortest wave", highest()), ("one kicked end", one_end())):
        deck, nodes = bar(f"{name}, TSSFAC", scale=0.9)
        sums(run, f"{name}, TSSFAC 0.9", run.program(kick(deck, nodes, speeds)).table("glstat"), 1e-3)


def check(run):
    check_kicks(run)
    check_endeng(run)
    check_loads(run)
    check_exact(run)
    check_walls_and_rigid(run)
    check_variable_steps(run)
    check_jumps(run)
