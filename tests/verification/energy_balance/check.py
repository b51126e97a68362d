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


def check_walls_and_rigid(run):
    """A bar that meets a rigid wall: what nodes lose there is work of the wall."""
    deck, nodes = bar("wall")
    deck.add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0)).node_set(1, nodes)
    deck.add("*RIGIDWALL_PLANAR", (1, 0, 0, 0.0), (1.0 + 1.0e-8, 0.0, 0.0, 0.0, 0.0, 0.0))
    sums(run, "bar against a rigid wall", run.program(deck).table("glstat"), 1e-3)
    deck, nodes = bar("rigid mass", is_held=False)
    place = deck.lines.index("*MAT_ELASTIC")
    deck.lines[place] = "*MAT_RIGID"
    deck.lines[place + 2:place + 2] = ["1,0,0", "0.0,"]
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
    deck.add("*LOAD_BODY_X", (1,))
    sums(run, "rigid body under gravity", run.program(deck).table("glstat"), 1e-11)


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
