# SPDX-License-Identifier: MIT
"""The balance of a sound run is constant, however short the waves in it: TSSFAC 0.9, no contact."""
import numpy as np

from eigen import quad_stiffness
from meshes import Deck, grid

RHO, YOUNG = 1000.0, 1.0e7
SOUND = np.sqrt(YOUNG / RHO)
N, SPEED = 40, 1.0e-4
STEP = 0.9 / N / SOUND
# Velocities of the nodes of 4 x 4 squares of side 1, density and modulus 1, row by row, in 1e-6.
SHORT_WAVES = np.reshape([
    -52.4, 8.85, -26, 20.8, 25.1, -86.9, -97.4, 67.5, -48.1, -53.1,
    99.1, -5.95, 67.3, -4.73, 27.8, -69.9, 27, 73.6, 4.64, 48.3,
    34.3, -87.2, 51.6, 18.2, -39.7, -93.8, 73.1, -5.45, 43.8, 75.8,
    42.8, 84.2, -21, 60.2, -11.1, 87.1, 75.8, -80.5, -72.8, -56.6,
    93.1, -12.8, 25.3, -39.8, 1.45, -22.8, -29.8, 17, 16.9, 80.8], (25, 2))


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


def sums(run, name, energy):
    """The balance, and how it follows from the columns."""
    parts = ("kinetic", "internal", "hourglass", "viscous", "damping", "contact", "leapfrog")
    scale = np.max(np.abs(energy["total"]))
    run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0)
    run.check(f"{name}: total over the sum of the columns", energy["total"] / scale,
              sum(energy[part] for part in parts) / scale)


def check_kicks(run):
    for name, speeds in (("shortest wave", highest()), ("one kicked end", one_end())):
        deck, nodes = bar(name)
        energy = run.program(kick(deck, nodes, speeds)).table("glstat")
        sums(run, name, energy)
        old = (energy["total"] - energy["leapfrog"]) / energy["total"][0]
        run.report(f"{name}: largest ratio with the mean velocities alone", np.max(old))
        run.check(f"{name}: the mean velocities alone would not do", float(np.max(old) > 1.5), 1.0)


def check_endeng(run):
    """ENDENG 5 does not end a sound run."""
    deck, nodes = bar("shortest wave, ENDENG 5")
    kick(deck, nodes, highest())
    place = deck.lines.index("*CONTROL_TERMINATION") + 1
    deck.lines[place] = deck.lines[place].rstrip(",") + ",0,0.0,5.0"
    result = run.program(deck, name="endeng")
    run.check("ENDENG 5: exit status", result.status, 0)


def check_loads(run):
    """Everything from outside, at steps of 0.9 times the limit."""
    # a force at one end, switched on at once
    deck, nodes = bar("pulled end")
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
    deck.add("*LOAD_NODE_POINT", *[(int(node), 1, 1, 1.0e-2) for node in nodes[[N, -1]]])
    sums(run, "pulled end", run.program(deck).table("glstat"))
    # gravity
    deck, nodes = bar("gravity")
    deck.curve(1, [(0.0, 1.0e-3), (1.0, 1.0e-3)])
    deck.add("*LOAD_BODY_X", (1,))
    deck.fix(nodes[[0, N + 1]], x=1)
    sums(run, "gravity, one end held", run.program(deck).table("glstat"))
    # one end driven
    for kind, points in ((0, [(0.0, SPEED), (1.0, SPEED)]), (2, [(0.0, 0.0), (1.0, SPEED)])):
        deck, nodes = bar(f"driven end, {kind}")
        deck.curve(1, points)
        for node in nodes[[0, N + 1]]:
            deck.prescribe(node, 1, kind, 1)
        sums(run, f"end driven by {'velocity' if kind == 0 else 'displacement'}",
             run.program(deck).table("glstat"))
    # damping, of each mode
    for name, speeds in (("shortest wave", highest()), ("one kicked end", one_end())):
        deck, nodes = bar(f"{name}, damped")
        kick(deck, nodes, speeds).add("*DAMPING_GLOBAL", (0, 0.05 / STEP))
        energy = run.program(deck).table("glstat")
        sums(run, f"{name}, damped", energy)
        left = energy["damping"][-1] / energy["total"][0]
        run.check(f"{name}, damped: all is dissipated", left, 1.0)


def check_exact(run):
    """Linear and without elements that strain: round-off."""
    deck, nodes = bar("flight under gravity")
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
    deck.add("*LOAD_BODY_X", (1,))
    kick(deck, nodes, np.full(N + 1, 0.3))
    sums(run, "flight under gravity", run.program(deck).table("glstat"))
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
        sums(run, f"flight, {name}", run.program(deck).table("glstat"))


def check_walls_and_rigid(run):
    """A bar that meets a rigid wall: what nodes lose there is work of the wall."""
    deck, nodes = bar("wall")
    deck.add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0)).node_set(1, nodes)
    deck.add("*RIGIDWALL_PLANAR", (1, 0, 0, 0.0), (1.0 + 1.0e-8, 0.0, 0.0, 0.0, 0.0, 0.0))
    sums(run, "bar against a rigid wall", run.program(deck).table("glstat"))
    # damped as strongly as here, what the mean of v(0) and v(1/2) says of the first cycle is a tenth of a node's energy
    deck, nodes = bar("wall, damped")
    deck.add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0)).node_set(1, nodes).add("*DAMPING_GLOBAL", (0, 0.5 / STEP))
    deck.add("*RIGIDWALL_PLANAR", (1, 0, 0, 0.0), (1.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    sums(run, "damped bar, at a rigid wall from time zero", run.program(deck).table("glstat"))
    for name, loads in (("gravity", (1.0, 1.0)), ("gravity that grows", (0.0, 1.0e3))):
        deck, nodes = rigid_bar(name)
        deck.curve(1, [(0.0, loads[0]), (400 * STEP, loads[1])]).add("*LOAD_BODY_X", (1,))
        kick(deck, nodes, np.full(N + 1, 0.3))
        sums(run, f"rigid body under {name}", run.program(deck).table("glstat"))
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
    run.check("rigid pendulum: kinetic energy at the start", energy["kinetic"][0],
              0.5 * inertia * (omega * angle) ** 2)
    run.check("rigid pendulum: largest part of leap-frog / energy",
              np.max(-energy["leapfrog"]) / start, 0.0625 / (1.0 - 0.0625))
    run.check("rigid pendulum: (total - work of the forces) / energy",
              (energy["total"] - energy["external_work"]) / start, 1.0)


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
    run.check("jumps: steps / the first", steps[:-1],
              np.array([1.0] * 10 + [0.5] * 10 + [1.0] * (len(steps) - 21)))
    unit = RHO / N * (gravity * STEP) ** 2 / 8.0
    found = (energy["total"] - energy["external_work"] - energy["total"][0]) / unit
    run.check("jumps: change of the balance / (m a^2 dt^2/8)", found[1:], 1.0 - steps[:-1] ** 2)


def check_variable_steps(run):
    """Steps that follow the elements: the balance stays, while the steps change little."""
    for name, speeds in (("shortest wave", highest()), ("one kicked end", one_end())):
        deck, nodes = bar(f"{name}, TSSFAC", scale=0.9)
        sums(run, f"{name}, TSSFAC 0.9", run.program(kick(deck, nodes, speeds)).table("glstat"))


def squares(title, form=13, points=None, hourglass=(1, 0.1), bulk=None, law=None):
    """4 x 4 free squares with velocities of short waves, TSSFAC 0.9, or under bulk viscosity a constant step (one that
    jumps moves the balance); of axisymmetric bodies the inner radius is 4."""
    deck = Deck(title).control(200 * 0.7757, dt=0.3 if bulk else None).hourglass(*hourglass)
    if bulk:
        deck.add("*CONTROL_BULK_VISCOSITY", bulk)
    deck.add("*SECTION_SHELL", (1, form, None, points), (1.0,)).part(section=1)
    deck.add(*law or ("*MAT_ELASTIC", (1, 1.0, 1.0, 0.3)))
    nodes = deck.mesh(*grid(4, 4, 4.0, 4.0, (4.0 if form == 15 else 0.0, 0.0)))
    deck.add("*INITIAL_VELOCITY_NODE", *zip(nodes.tolist(), *(1.0e-6 * SHORT_WAVES.T).tolist()))
    return deck.output(glstat=4.0)


def linear_hourglass_work(step, cycles, coefficient=0.1):
    """The same by small displacements: the trapezoidal work of viscous forces of v(n-1/2)."""
    places, quads = grid(4, 4, 4.0, 4.0)
    stiffness, damping, mass = np.zeros((50, 50)), np.zeros((50, 50)), np.zeros(50)
    sound = np.sqrt(0.7 / (1.3 * 0.4))
    for quad in np.asarray(quads):
        dofs = np.stack([2 * quad, 2 * quad + 1], axis=1).ravel()
        stiffness[np.ix_(dofs, dofs)] += quad_stiffness(places[quad], 1.0, 0.3, 0.0)[0]
        pattern = np.array([1.0, -1.0, 1.0, -1.0])
        damping[np.ix_(dofs, dofs)] += 0.25 * coefficient * sound * np.kron(np.outer(pattern, pattern), np.eye(2))
        mass[dofs] += 0.25
    u, v, work, last = np.zeros(50), 1.0e-6 * SHORT_WAVES.ravel(), 0.0, 0.0
    for cycle in range(cycles + 1):
        force = damping @ v
        work += 0.5 * step * (last + force) @ v if cycle else 0.0
        v = v - (1.0 if cycle else 0.5) * step * (stiffness @ u + force) / mass
        last, u = force, u + step * v
    return work


def check_short_waves(run):
    """Viscous forces act over half of the step that they are formed from and half of the next: none of their work lags."""
    energy = run.program(squares("short waves")).table("glstat")
    run.check("short waves: hourglass energy / 1e-8", 1e8 * energy["hourglass"][-1], 4.69)
    run.check("short waves: hourglass energy / that of small displacements",
              energy["hourglass"][-1] / linear_hourglass_work(energy["dt"][0], int(energy["cycle"][-1])), 1.0)
    fails = "*MAT_PLASTIC_KINEMATIC", (1, 1.0, 1.0, 0.3, 1.0), (0.0, 0.0, 10.0)
    for name, layout in (("", {}), (", stiffness form", {"hourglass": (4, 0.1)}), (", assumed strain", {"hourglass": (6, 1.0)}),
                         (", bulk viscosity", {"bulk": (1.5, 0.3)}), (", bulk viscosity, may fail", {"bulk": (1.5, 0.3), "law": fails}),
                         (", bulk viscosity, NIP 4", {"bulk": (1.5, 0.3), "points": 4})):
        for form in (13, 15):
            energy = run.program(squares("short waves" + name, form, **layout)).table("glstat")
            sums(run, f"short waves, ELFORM {form}{name}", energy)


def check_thin_layers(run):
    """A round plate of layers of aspect 50, whose upper face gets a pulse: what public decks are like."""
    places, quads = grid(12, 8, 12.0, 0.16)
    deck = Deck("thin layers").control(1.0, scale=0.67)
    deck.add("*SECTION_SHELL", (1, 15), (1.0,)).part(section=1).elastic(2.0, 100.0, 0.28)
    nodes = deck.mesh(places, quads)
    deck.fix(nodes[places[:, 0] == 0.0], x=1)
    speeds = -1.0e-3 * np.exp(-(places[-13:, 0] / 3.0) ** 2)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), 0.0, float(speed)) for node, speed in zip(nodes[-13:], speeds)])
    energy = run.program(deck.output(glstat=0.02)).table("glstat")
    sums(run, "thin layers", energy)
    run.check("thin layers: hourglass energy counts", float(energy["hourglass"][-1] > 0.2 * energy["total"][0]), 1.0)


def check(run):
    check_kicks(run)
    check_short_waves(run)
    check_thin_layers(run)
    check_endeng(run)
    check_loads(run)
    check_exact(run)
    check_walls_and_rigid(run)
    check_variable_steps(run)
    check_jumps(run)
