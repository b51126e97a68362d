# SPDX-License-Identifier: MIT
"""Constraints, prescribed motion and initial velocity of rigid bodies against closed forms."""
import numpy as np

from meshes import Deck, grid, rotate

RHO, SIZE, CORNER = 1000.0, (2.0, 1.0), (3.0, -1.0)
CELLS = (4, 2)
CENTRE = np.array(CORNER) + 0.5 * np.array(SIZE)
MASS = RHO * SIZE[0] * SIZE[1]
INERTIA = MASS / 12.0 * (SIZE[0] ** 2 + SIZE[1] ** 2 + 2.0 * sum((s / n) ** 2 for s, n in zip(SIZE, CELLS)))
DT, N_STEP = 1.0e-3, 200


def block(title, hold=(0, 0)):
    """A deck with one rigid rectangle, and its nodes; all in nodout."""
    deck = Deck(title)
    deck.control(DT * N_STEP, dt=DT).part()
    deck.add("*MAT_RIGID", (1, RHO, 1.0e6, 0.3), (1, *hold), (0.0,))
    nodes = deck.mesh(*grid(*CELLS, *SIZE, CORNER))
    return deck.output(glstat=DT, matsum=DT, nodout=DT, nodes=nodes), nodes


def places(result, nodes):
    """Times and places (row, node, 2) of all nodes."""
    table = result.table("nodout")
    order = np.lexsort((table["node"], table["time"]))
    place = np.stack([table["x"][order], table["y"][order]], axis=-1)
    return table["time"][order][::len(nodes)], place.reshape(-1, len(nodes), 2)


def expected(path):
    """Places of all nodes when centre and angle follow path (row, 3)."""
    start, _ = grid(*CELLS, *SIZE, CORNER)
    return np.array([rotate(start, angle, CENTRE) + (x, y) for x, y, angle in path])


def check_codes(run):
    """CON1 and CON2, codes 0 to 7."""
    g, start = np.array([2.0, 3.0]), np.array([1.0, -2.0, 1.5])
    held = {0: "", 1: "x", 2: "y", 3: "z", 4: "xy", 5: "yz", 6: "zx", 7: "xyz"}
    for code, directions in held.items():
        deck, nodes = block(f"constraint code {code}", (code, code))
        deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
        deck.add("*LOAD_BODY_X", (1, -g[0])).add("*LOAD_BODY_Y", (1, -g[1]))
        deck.add("*INITIAL_VELOCITY_RIGID_BODY", (1, start[0], start[1], 0.0, 0.0, 0.0, start[2]))
        time, place = places(run.program(deck), nodes)
        path = time[:, None] * start + 0.5 * time[:, None] ** 2 * np.array([*g, 0.0])
        free = [axis not in directions for axis in "xyz"]
        run.check(f"CON1 = CON2 = {code}: places of all nodes", place, expected(path * free))


def check_driven(run):
    """Each degree of freedom by each kind of curve."""
    rate, scale, start = 4.0, 0.5, np.array([0.3, -0.2, 0.7])
    times = DT * np.arange(N_STEP + 2)
    curves = {0: ("velocity", [(0.0, 0.0), (1.0, rate / scale)]),
              1: ("acceleration", [(0.0, rate / scale), (1.0, rate / scale)]),
              2: ("displacement", [(t, 0.5 * rate / scale * t * t) for t in times])}
    for dof, axis in ((1, 0), (2, 1), (7, 2)):
        for vad, (kind, points) in curves.items():
            deck, nodes = block(f"{kind} of degree of freedom {dof}")
            deck.curve(1, points).add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", (1, dof, vad, 1, scale))
            first = [v * (k != axis) for k, v in enumerate(start)]
            deck.add("*INITIAL_VELOCITY_RIGID_BODY", (1, *first[:2], 0.0, 0.0, 0.0, first[2]))
            result = run.program(deck)
            time, place = places(result, nodes)
            path = time[:, None] * np.array(first)
            path[:, axis] = 0.5 * rate * time ** 2
            run.check(f"DOF {dof} by {kind}: places of all nodes", place, expected(path))
            energy = result.table("glstat")
            inertia = (MASS, MASS, INERTIA)[axis]
            run.check(f"DOF {dof} by {kind}: external work", energy["external_work"][-1],
                      0.5 * inertia * (rate * time[-1]) ** 2)
            run.check(f"DOF {dof} by {kind}: energy ratio", energy["energy_ratio"][2:], 1.0)


def check_start(run):
    """Velocity by body, by part and by node."""
    own, spin, point, drift = np.array([3.0, -2.0, 5.0]), 4.0, np.array([1.0, 2.0]), np.array([0.5, 0.25])
    arm = CENTRE - point
    turned = np.array([*(drift + spin * np.array([-arm[1], arm[0]])), spin])
    generation = ("*INITIAL_VELOCITY_GENERATION", (1, 2, spin, *drift), (*point,))
    by_body = ("*INITIAL_VELOCITY_RIGID_BODY", (1, *own[:2], 0.0, 0.0, 0.0, own[2]))
    plain = ("*INITIAL_VELOCITY", (0,), (0.5, 0.25))
    for name, cards, velocity in (("by body", [by_body], own), ("by part", [generation], turned),
                                  ("all nodes", [plain], np.array([*drift, 0.0])),
                                  ("by body, then by part", [by_body, generation], own),
                                  ("by part, then by body", [generation, by_body], own)):
        deck, nodes = block(f"initial velocity {name}")
        for card in cards:
            deck.add(*card)
        result = run.program(deck)
        time, place = places(result, nodes)
        run.check(f"velocity {name}: places of all nodes", place,
                  expected(time[:, None] * velocity))
        run.check(f"velocity {name}: kinetic energy", result.table("glstat")["kinetic"],
                  0.5 * MASS * velocity[:2] @ velocity[:2] + 0.5 * INERTIA * velocity[2] ** 2)


def check(run):
    check_codes(run)
    check_driven(run)
    check_start(run)
