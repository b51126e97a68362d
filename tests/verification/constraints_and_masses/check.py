# SPDX-License-Identifier: MIT
"""Loads on rigid bodies, masses on nodes, nodes that move alike, supports and loads along skew axes."""
import numpy as np

from meshes import Deck, grid, lumped_mass

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.25


def block(title, n=1, dt=1.0e-4, end=0.02, origin=(0.0, 0.0), turn=0.0, interval=None):
    """A unit square of n x n elements, turned about its lower left corner."""
    coordinates, quads = grid(n, n)
    c, s = np.cos(turn), np.sin(turn)
    coordinates = coordinates @ np.array([[c, s], [-s, c]]) + np.array(origin)
    deck = Deck(title)
    deck.control(end, dt=dt).hourglass(4, 0.1).part().elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(coordinates, quads)
    interval = interval or end / 20.0
    deck.output(glstat=interval, matsum=interval, nodout=interval, nodes=nodes)
    return deck, nodes, coordinates, lumped_mass(coordinates, quads, RHO)


def check_rigid_load(run):
    """a = F/M, angular acceleration = moment/I, also along the axes of a coordinate system."""
    angle = np.radians(30.0)
    for name, cards, force in (
            ("x and y", [(1, 1, 1, 300.0), (1, 2, 1, -200.0), (1, 7, 1, 50.0)], (300.0, -200.0)),
            ("skew", [(1, 1, 1, 400.0, 7), (1, 7, 1, 50.0)], (400.0 * np.cos(angle), 400.0 * np.sin(angle)))):
        deck = Deck(f"rigid load, {name}")
        dt, end = 1.0e-3, 0.2
        deck.control(end, dt=dt).part()
        deck.add("*MAT_RIGID", (1, RHO, YOUNG, POISSON), "0,0,0", "0.0")
        coordinates, quads = grid(4, 4)
        nodes = deck.mesh(coordinates, quads)
        deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
        deck.add("*DEFINE_COORDINATE_SYSTEM", (7, 1.0, 2.0, 0.0, 1.0 + np.cos(angle), 2.0 + np.sin(angle), 0.0), (1.0, 5.0, 0.0))
        deck.add("*LOAD_RIGID_BODY", *cards)
        deck.output(glstat=0.01, matsum=0.01, nodout=0.01, nodes=nodes)
        result = run.program(deck)
        mass = lumped_mass(coordinates, quads, RHO)
        inertia = np.sum(mass * np.sum((coordinates - 0.5) ** 2, axis=1))
        centre = result.node(int(nodes[12]))
        time = centre["time"]
        run.check(f"rigid load, {name}: centre", np.stack([centre["ux"], centre["uy"]]),
                  0.5 * np.outer(force, time ** 2) / mass.sum())
        corner = result.node(int(nodes[24]))
        turn = 0.5 * 50.0 / inertia * time ** 2
        arm = 0.5 * np.stack([np.cos(turn) - np.sin(turn), np.sin(turn) + np.cos(turn)]) - 0.5
        run.check(f"rigid load, {name}: turn",
                  np.stack([corner["ux"] - centre["ux"], corner["uy"] - centre["uy"]]), arm)
        table = result.table("glstat")
        work = 0.5 * np.dot(force, force) / mass.sum() * time ** 2 + 0.5 * 50.0 ** 2 / inertia * time ** 2
        run.check(f"rigid load, {name}: external work", table["external_work"], work)
        run.check(f"rigid load, {name}: balance", table["energy_ratio"], 1.0)


def check_masses(run):
    """Masses on nodes: acceleration of each, momentum of all, the frequency of an oscillator, in both methods."""
    deck, nodes, _, mass = block("masses")
    deck.add("*ELEMENT_MASS", f"{1:8d}{int(nodes[1]):8d}{70.0:16.4f}{1:8d}", f"{2:8d}{int(nodes[3]):8d}{30.0:16.4f}")
    deck.node_set(1, nodes).add("*ELEMENT_MASS_NODE_SET", f"{3:8d}{1:8d}{5.0:16.4f}")
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)]).add("*LOAD_NODE_SET", (1, 2, 1, 10.0))
    result = run.program(deck)
    whole = mass + 5.0
    whole[1] += 70.0
    whole[3] += 30.0
    for k in range(4):
        run.check(f"masses: first acceleration of node {k + 1}",
                  result.node(int(nodes[k]))["ay"][0], 10.0 / whole[k])
    # a stiff body of the masses on rollers, implicit, one step from rest
    modulus = 1.2 * YOUNG
    for method, points in (("explicit", None), ("implicit", 4)):
        lump, dt, n = 2000.0, 1.0e-3, 400
        deck = Deck(f"oscillator, {method}")
        deck.control(dt * n, dt=dt).hourglass(4, 0.1).part(points=points).elastic(RHO, YOUNG, POISSON)
        nodes = deck.mesh(*grid(1, 1))
        deck.fix(nodes, y=1).fix(nodes[[0, 2]], x=1)
        deck.add("*ELEMENT_MASS", *[f"{k:8d}{int(nodes[k]):8d}{lump:16.4f}" for k in (1, 3)])
        deck.add("*INITIAL_VELOCITY_NODE", (int(nodes[1]), 1e-6), (int(nodes[3]), 1e-6))
        deck.output(glstat=dt, nodout=dt, nodes=nodes)
        if method == "implicit":
            deck.add("*CONTROL_IMPLICIT_GENERAL", (1, dt)).add("*CONTROL_IMPLICIT_DYNAMICS", (1, 0.5, 0.25))
        history = run.program(deck).node(int(nodes[1]))
        motion = history["ux"]
        ratio = np.dot(motion[2:] + motion[:-2], motion[1:-1]) / np.dot(motion[1:-1], motion[1:-1])
        if method == "explicit":
            found, own = 2.0 * np.arcsin(0.5 * np.sqrt(2.0 - ratio)) / dt, 500.0
            expected = 2.0 * np.arcsin(0.5 * dt * np.sqrt(modulus / (own + 2.0 * lump))) / dt
        else:
            found, own = np.arccos(0.5 * ratio) / dt, 1000.0 / 3.0
            expected = 2.0 * np.arctan(0.5 * dt * np.sqrt(modulus / (own + 2.0 * lump))) / dt
        run.check(f"masses: frequency, {method}", found, expected)


def check_common(run):
    """Nodes that move alike keep momentum; two blocks coupled along x have one acceleration there."""
    for dof, along in ((1, (True, False)), (7, (True, True))):
        deck, nodes, _, mass = block(f"common motion {dof}", n=2, end=0.05)
        members = nodes[[0, 2, 4, 7]]
        deck.node_set(1, members).add("*CONSTRAINED_NODE_SET", (1, dof))
        deck.add("*INITIAL_VELOCITY_NODE", (int(nodes[2]), 3.0, 1.0), (int(nodes[7]), 0.0, -2.0), (int(nodes[5]), 1.0, 1.0))
        result = run.program(deck)
        part, table = result.table("matsum"), result.table("glstat")
        given = np.zeros((9, 2))
        given[2], given[7], given[5] = (3.0, 1.0), (0.0, -2.0), (1.0, 1.0)
        for axis, name in enumerate(("momentum_x", "momentum_y")):
            run.check(f"common motion {dof}: {name}", part[name], np.sum(mass * given[:, axis]))
        for axis, name in enumerate(("ux", "uy")):
            motions = [result.node(int(node))[name] for node in members]
            spread = np.max(np.abs(np.array(motions) - motions[0]))
            if along[axis]:
                run.check(f"common motion {dof}: {name} of all", spread, 0.0)
            else:
                run.check(f"common motion {dof}: {name} differ", spread > 1e-4, True)
        run.check(f"common motion {dof}: balance", table["energy_ratio"], 1.0)
    # a free block and a loaded one: F = (M1 + M2) a along x
    deck, nodes, _, mass = block("two coupled blocks", end=0.05)
    others = deck.mesh(*grid(1, 1, origin=(5.0, 0.0)))
    every = list(nodes) + list(others)
    deck.node_set(1, every).add("*CONSTRAINED_NODE_SET", (1, 1)).node_set(2, nodes)
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)]).add("*LOAD_NODE_SET", (2, 1, 1, 25.0), (2, 2, 1, 25.0))
    deck.add("*DAMPING_GLOBAL", (0, 2.0))
    result = run.program(deck)
    history = result.node(int(nodes[0]))
    time = history["time"]
    run.check("coupled blocks: x", history["ux"],
              0.05 / 4.0 * (2.0 * time - 1.0 + np.exp(-2.0 * time)))
    run.check("coupled blocks: y", history["uy"],
              0.1 / 4.0 * (2.0 * time - 1.0 + np.exp(-2.0 * time)))
    run.check("coupled blocks: balance", result.table("glstat")["energy_ratio"], 1.0)


def check_incline(run):
    """A block on rollers along an incline goes down with g sin(angle), in the axes of the incline."""
    angle = np.radians(25.0)
    along, normal = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    for name, fall in (("weight", True), ("force along the axes", False)):
        deck, nodes, _, mass = block(f"incline, {name}", n=2, end=0.2, dt=5.0e-4, turn=angle)
        deck.add("*DEFINE_COORDINATE_SYSTEM", (3, 0.0, 0.0, 0.0, *along, 0.0), (*normal, 0.0))
        # One node twice: along the same axis that is one support.
        deck.add("*BOUNDARY_SPC_NODE", *[(int(node), 3, 0, 1) for node in [*nodes, nodes[0]]])
        deck.curve(1, [(0.0, 9.81), (1.0, 9.81)])
        if fall:
            deck.add("*LOAD_BODY_Y", (1, 1.0))
            a = -9.81 * np.sin(angle)
        else:
            deck.add("*LOAD_NODE_POINT", *[(int(node), 1, 1, m, 3) for node, m in zip(nodes, mass)])
            a = 9.81
        result = run.program(deck.add("*DATABASE_SPCFORC", (0.01,)))
        for node in (nodes[0], nodes[4], nodes[8]):
            history = result.node(int(node))
            motion = np.stack([history["ux"], history["uy"]])
            run.check(f"incline, {name}: along, node {node}", along @ motion,
                      0.5 * a * history["time"] ** 2)
            run.check(f"incline, {name}: across, node {node}", normal @ motion, 0.0)
        table = result.table("glstat")
        forces = result.table("spcforc")
        rows = len(np.unique(forces["time"])), len(nodes)
        by_node = mass * (9.81 * np.cos(angle) if fall else 0.0)
        for axis, expected in ((along, 0.0 * mass), (normal, by_node)):
            found = (axis[0] * forces["fx"] + axis[1] * forces["fy"]).reshape(rows)
            run.check(f"incline, {name}: forces of the supports, {'across' if axis is normal else 'along'}", found,
                      np.broadcast_to(expected, rows), scale=9.81 * mass.sum())
        run.check(f"incline, {name}: balance", table["energy_ratio"], 1.0)
    # axes along x and y are plain supports, both axes hold the node
    texts = []
    for cid in (0, 4):
        deck, nodes, _, _ = block("plain", n=2)
        deck.add("*DEFINE_COORDINATE_SYSTEM", (4, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0), (-1.0, 0.0, 0.0))
        deck.add("*BOUNDARY_SPC_NODE", (int(nodes[0]), cid, 1, 1), (int(nodes[1]), cid, int(cid == 4), int(cid == 0)))
        deck.add("*INITIAL_VELOCITY", (0,), (1.0, -0.5))
        result = run.program(deck)
        texts.append(result.csv_path("nodout").read_text())
    run.check("axes along y and -x are plain supports", texts[0] == texts[1], True)


def check(run):
    check_rigid_load(run)
    check_masses(run)
    check_common(run)
    check_incline(run)
