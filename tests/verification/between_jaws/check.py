# SPDX-License-Identifier: MIT
"""A body between two plates of one surface leaves the one and bounces off the other, with all types."""
from contact_types import TYPES
from meshes import Deck, grid

RHO, YOUNG, POISSON = 1000.0, 1.0e9, 0.3
WIDTH, HEIGHT, SPEED = 3.0, 0.3, 100.0
BELOW, ABOVE = 0.65, 1.2  # gaps at the start; segments are 1 m long
MOMENTUM = RHO * WIDTH * HEIGHT * SPEED


def jaws(kind):
    end = 2.0 * ABOVE / SPEED
    deck = Deck("body between two jaws")
    deck.control(end, dt=2.0e-5).hourglass(4, 0.1)
    meshes = (grid(8, 1, 8.0, 1.0, (-4.0, -1.0)),
              grid(8, 1, 8.0, 1.0, (-4.0, BELOW + HEIGHT + ABOVE)),
              grid(3, 1, WIDTH, HEIGHT, (-1.45, BELOW)))
    for part, mesh in enumerate(meshes, 1):
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
        nodes = deck.mesh(*mesh, part=part)
        if part < 3:
            deck.fix(nodes, 1, 1)
    deck.node_set(3, nodes).add("*INITIAL_VELOCITY", (3,), (0.0, SPEED))
    deck.add("*SET_PART_LIST", (1,), (1, 2)).add("*SET_PART_LIST", (3,), (3,))
    deck.add("*CONTACT_2D_SLIDELINE", (3, 1, kind, 2, 1.0e8), (0.0, 1.0e20, 1, 0.0, 0.0))
    return deck.output(plot=end, glstat=end / 20, matsum=end / 20)


def check(run):
    for kind, name in TYPES.items():
        result = run.program(jaws(kind), name=f"type{kind}")
        body = result.table("matsum").where(part=3)
        run.check(f"{name}: momentum at the start", body["momentum_y"][0], MOMENTUM)
        run.check(f"{name}: momentum after the bounce / m v", body["momentum_y"][-1] / MOMENTUM,
                  -1.0)
        run.check(f"{name}: energy ratio", result.table("glstat")["energy_ratio"], 1.0)
