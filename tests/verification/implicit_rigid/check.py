# SPDX-License-Identifier: MIT
"""Rigid bodies in implicit runs: torque, pendulum, blocks on columns, quarter turns, dies, a block that lands."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid, lumped_mass, rotate

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.3
BODY = grid(4, 2, 2.0, 1.0, (3.0, -1.0))
CENTRE = np.array([4.0, -0.5])


def inertia_of(coordinates, quads, rho=RHO):
    mass = lumped_mass(coordinates, quads, rho)
    centre = mass @ coordinates / mass.sum()
    return mass.sum(), mass @ ((coordinates - centre) ** 2).sum(axis=1)


def implicit(title, dt, end, dynamic=True, radius=1.0):
    deck = Deck(title).add("*CONTROL_TERMINATION", (end,)).add("*CONTROL_IMPLICIT_GENERAL", (1, dt))
    if dynamic:
        deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1,)).add("*CONTROL_IMPLICIT_SPECTRAL_RADIUS", (radius,))
    return deck.add("*DATABASE_RBDOUT", (dt,)).add("*DATABASE_BNDOUT", (dt,))


def rigid(deck, number=1, hold=(0, 0), rho=RHO):
    return deck.add("*MAT_RIGID", (number, rho, YOUNG, POISSON), (1, *hold), (0.0,))


def paths(result, nodes):
    table = result.table("nodout")
    order = np.lexsort((table["node"], table["time"]))
    place = np.stack([table["x"][order], table["y"][order]], axis=-1)
    return table["time"][order][::len(nodes)], place.reshape(-1, len(nodes), 2)


def quadratic(run, name, result):
    """The energy ratio is the square of the error: its exponent doubles from one iteration to the next."""
    growth = [np.log(after[0]) / np.log(before[0]) for rows in result.newton() for before, after in zip(rows, rows[1:])
              if before[0] < 1e-4 and before[1] > 1e6]
    run.check(f"{name}: growth of the exponent of the energy ratio", min(growth), 1.4)


def check_flight(run):
    """Constant torque, gravity, spin and drift: accelerations are constant, so the scheme is exact."""
    torque, start, g, dt = 300.0, np.array([0.3, -0.2, 0.7]), np.array([2.0, 3.0]), 0.01
    for radius in (1.0, 0.5):
        deck = rigid(implicit(f"free flight, radius {radius}", dt, 3.0, radius=radius).part())
        nodes = deck.mesh(*BODY)
        deck.output(glstat=dt, matsum=dt, nodout=dt, nodes=nodes)
        deck.curve(1, [(0.0, 1.0), (9.0, 1.0)]).add("*LOAD_RIGID_BODY", (1, 7, 1, torque))
        deck.add("*LOAD_BODY_X", (1, -g[0])).add("*LOAD_BODY_Y", (1, -g[1]))
        deck.add("*INITIAL_VELOCITY_RIGID_BODY", (1, *start[:2], 0.0, 0.0, 0.0, start[2]))
        result = run.program(deck)
        time, place = paths(result, nodes)
        mass, inertia = inertia_of(*BODY)
        path = time[:, None] * start + 0.5 * time[:, None] ** 2 * np.array([*g, torque / inertia])
        expected = np.array([rotate(BODY[0], angle, CENTRE) + (x, y) for x, y, angle in path])
        name = f"flight, radius {radius}"
        run.check(f"{name}: places of all nodes", place, expected)
        speed = start + time[-1] * np.array([*g, torque / inertia])
        kinetic = 0.5 * mass * speed[:2] @ speed[:2] + 0.5 * inertia * speed[2] ** 2
        energy, body = result.table("glstat"), result.table("rbdout")
        run.check(f"{name}: kinetic energy", energy["kinetic"][-1], kinetic)
        run.check(f"{name}: kinetic energy of the part", result.table("matsum")["kinetic"], energy["kinetic"])
        run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0)
        run.check(f"{name}: turn in rbdout", body["rotation"][-1], path[-1, 2])
        run.check(f"{name}: work of the torque", result.table("bndout").where(condition=2)["work"][-1],
                  torque * path[-1, 2])


def check_pendulum(run):
    """A body about its fixed centre with a dead load on an end: pendulum of amplitude 90 degrees."""
    shape, force = grid(8, 1, 2.0, 0.25, (-1.0, -0.125)), 500.0
    _, inertia = inertia_of(*shape)
    a, b = 1.0, np.cos(0.25 * np.pi)
    while abs(a - b) > 1e-15:
        a, b = 0.5 * (a + b), np.sqrt(a * b)
    period, errors = 2.0 * np.pi / a * np.sqrt(inertia / force), []
    for steps in (100, 200, 400):
        dt = period / steps
        deck = rigid(implicit(f"pendulum, {steps} steps a period", dt, period).part(), hold=(4, 0))
        nodes = deck.mesh(*shape)
        deck.curve(1, [(0.0, 1.0), (9.0, 1.0)])
        # Half of the load on both corners of the end: its moment arm is 1.
        deck.add("*LOAD_NODE_POINT", *[(int(nodes[k]), 2, 1, -0.5 * force) for k in (8, 17)]).output(glstat=dt)
        result = run.program(deck)
        body = result.table("rbdout")
        errors.append(np.abs(np.interp(0.25 * period, body["time"], body["rotation"]) + 0.5 * np.pi))
    run.check("pendulum: upright after a quarter of the period, 400 steps", errors[-1], 0.0)
    run.check("pendulum: order in the step", np.log2(errors[0] / errors[1]), 2.0)
    run.check("pendulum: energy ratio", result.table("glstat")["energy_ratio"], 1.0)


def column(title, dt, width=0.5, n=(2, 8)):
    """A column 2 high that nothing holds; a rigid block a quarter as high shares its top nodes."""
    deck = implicit(title, dt, 1.0, False).part(1).add("*CONTROL_HOURGLASS", (6, 1.0)).elastic(1e-9, YOUNG, 0.0)
    coordinates, quads = grid(n[0], n[1] + n[1] // 4, width, 2.5)
    ids = deck.mesh(coordinates, quads[:n[0] * n[1]])
    rigid(deck.part(2), 2)
    deck.add("*ELEMENT_SHELL", *[(900 + k, 2, *ids[list(quad)].tolist()) for k, quad in enumerate(quads[n[0] * n[1]:])])
    return deck, ids, coordinates


def check_column(run):
    """Small force and moment on the rigid block: EA/L and EI/L; its weight; and large turns of the same column."""
    force, moment, weight = 1e-3, 1e-4, 2e-6
    deck, ids, _ = column("small loads on a column", 1.0)
    deck.fix(ids[:3], x=1, y=1)
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0)]).add("*LOAD_RIGID_BODY", (2, 2, 1, -force), (2, 7, 1, moment))
    deck.add("*LOAD_BODY_Y", (1, weight))
    body = run.program(deck).table("rbdout")
    pressed = force + weight * RHO * 0.25
    turn = moment * 2.0 / (YOUNG * 0.5 ** 3 / 12.0)
    run.check("column: shortening", body["uy"][-1], -pressed * 2.0 / (YOUNG * 0.5))
    run.check("column: turn", body["rotation"][-1], turn)
    run.check("column: sway of the block's centre", body["ux"][-1], -turn * (1.0 + 0.25))
    # A moment that bends a slender column into a quarter of a circle.
    width = 0.05
    deck, ids, _ = column("column bent by a moment", 0.1, width, (1, 40))
    deck.fix(ids[:2], x=1, y=1)
    full = 0.5 * np.pi * YOUNG * width ** 3 / 12.0 / 2.0
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0)]).add("*LOAD_RIGID_BODY", (2, 7, 1, full)).output(glstat=0.1)
    result = run.program(deck)
    body, radius = result.table("rbdout"), 4.0 / np.pi
    run.check("bent column: turn / 90 degrees", body["rotation"][-1] / (0.5 * np.pi), 1.0)
    run.check("bent column: place of the block's centre", np.array([body["x"][-1], body["y"][-1]]),
              np.array([0.5 * width - radius - 0.25, radius]))
    run.check("bent column: energy ratio", result.table("glstat")["energy_ratio"][2:], 1.0)
    quadratic(run, "bent column", result)


def check_quarter(run):
    """A body turned by 90 degrees carries a block on its nodes along: no stress, each node on its circle."""
    deck, ids, coordinates = column("quarter turn", 0.1)
    deck.curve(1, [(0.0, 0.0), (1.0, 0.5 * np.pi)]).add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", (2, 7, 2, 1))
    for dof in (1, 2):
        deck.add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", (2, dof, 2, 1, 0.25))
    deck.output(glstat=0.1, nodout=0.1, nodes=ids)
    result = run.program(deck)
    time, place = paths(result, ids)
    expected = np.array([rotate(coordinates, a, (0.25, 2.25)) + 0.25 * a for a in 0.5 * np.pi * time])
    run.check("quarter turn: places of all nodes", place, expected)
    run.check("quarter turn: internal energy / E", result.table("glstat")["internal"] / YOUNG, 0.0)


def pressed(title, how, kind, end=1.0, dt=0.1):
    """A block 2 x 1 under a die 1 x 0.5 with friction, which moves by (0.02, -0.05); how: rigid, nodes, elastic or explicit."""
    explicit = how == "explicit"
    deck = Deck(title).add("*CONTROL_TERMINATION", (end,)) if explicit else implicit(title, dt, end, False)
    deck.part(1, points=4).elastic(RHO, YOUNG, POISSON).part(2)
    lower = deck.mesh(*grid(8, 4, 2.0, 1.0, (0.0, -1.0)))
    upper = deck.mesh(*grid(3, 2, 1.0, 0.5, (0.53, 0.0)), part=2)
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)])
    if how in ("rigid", "explicit"):
        rigid(deck, 2, (0, 7))
        for dof, way in ((1, 0.02), (2, -0.05)):
            deck.add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", (2, dof, 2, 1, way))
    else:
        deck.elastic(RHO, YOUNG * (1e5 if how == "elastic" else 1.0), POISSON, 2)
        for node in upper if how == "nodes" else upper[-4:]:
            deck.prescribe(node, 1, 2, 1, 0.02).prescribe(node, 2, 2, 1, -0.05)
    deck.fix(lower[:9], x=1, y=1).node_set(1, upper[:4]).node_set(2, lower[-9:][::-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 2, 20.0 * YOUNG), (0.0, 1.0e20, 0, 0, 0.3))
    if explicit:
        deck.add("*DAMPING_GLOBAL", (0, 60.0)).add("*CONTROL_TIMESTEP", (0.0, 0.1))
    return deck.output(glstat=dt, rcforc=dt)


def check_die(run):
    """Against the same die by its nodes, an elastic one of great stiffness, and the explicit run."""
    for kind in TYPES:
        results = {how: run.program(pressed(f"die of type {kind}, {how}", how, kind)).table("rcforc").where(side="slave")
                   for how in ("rigid", "nodes")}
        for axis in "xy":
            run.check(f"type {kind}: force {axis} of the die, by nodes", results["rigid"][f"f{axis}"],
                      results["nodes"][f"f{axis}"])
    stiff = run.program(pressed("die of great stiffness", "elastic", 4)).table("rcforc").where(side="slave")
    led = run.program(pressed("explicit die", "explicit", 4, end=2.0)).table("rcforc").where(side="slave")
    result = run.program(pressed("rigid die", "rigid", 4))
    mine = result.table("rcforc").where(side="slave")
    for axis in "xy":
        run.check(f"die: force {axis}, elastic of E x 1e5", mine[f"f{axis}"][-1], stiff[f"f{axis}"][-1])
        run.check(f"die: force {axis}, explicit", mine[f"f{axis}"][-1], led[f"f{axis}"][-1])
    work = result.table("bndout").where(condition=5)["work"][-1]
    run.check("die: work in bndout", work, result.table("glstat")["external_work"][-1])


def check_landing(run):
    """A free rigid block comes down aslant on an elastic one with friction: impulses, energy, going on from a restart."""
    dt = 0.004
    deck = implicit("landing", dt, 0.4, radius=0.8).part(1, points=4).elastic(RHO, YOUNG, POISSON).part(2)
    lower = deck.mesh(*grid(8, 4, 2.0, 1.0, (0.0, -1.0)))
    shape = grid(2, 2, 0.5, 0.5, (0.6, 0.01))
    upper = deck.mesh(rotate(shape[0], 0.1, (0.6, 0.02)), shape[1], part=2)
    rigid(deck, 2)
    deck.add("*INITIAL_VELOCITY_RIGID_BODY", (2, 0.3, -1.0))
    deck.fix(lower[:9], x=1, y=1).node_set(1, upper[[6, 3, 0, 1, 2, 5, 8]])
    deck.node_set(2, lower[-9:][::-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, 5, 2, 20.0 * YOUNG), (0.0, 1.0e20, 0, 0, 0.3))
    deck.output(glstat=dt, rcforc=dt, matsum=dt)
    result = run.program(deck)
    energy, force, body = result.table("glstat"), result.table("rcforc").where(side="slave"), result.table("rbdout")
    mass, inertia = inertia_of(*shape)
    run.check("landing: the block has met the other one", np.max(force["fy"]), 100.0)
    part = result.table("matsum").where(part=2)
    run.check("landing: momentum y", part["momentum_y"], mass * body["vy"])
    run.check("landing: kinetic energy of the block", part["kinetic"], 0.5 * mass * (body["vx"] ** 2
              + body["vy"] ** 2) + 0.5 * inertia * body["spin"] ** 2)
    run.check("landing: energy ratio, largest", np.max(energy["energy_ratio"]), 1.001)
    run.check("landing: energy ratio, least", np.min(energy["energy_ratio"]), 0.95)
    run.goes_on(deck, 40, result, "rbdout", "glstat", "rcforc", "matsum")


def check(run):
    check_flight(run)
    check_pendulum(run)
    check_column(run)
    check_quarter(run)
    check_die(run)
    check_landing(run)
