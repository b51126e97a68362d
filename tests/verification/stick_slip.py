# SPDX-License-Identifier: MIT
"""A block on a belt, held by a soft bar: it sticks until the bar pulls with FS p, and slips under FD p until the belt takes it
along again."""
import math

import numpy as np
from meshes import Deck, grid

AT_REST, SLIDING, SPEED, GRAVITY = 0.5, 0.2, 0.1, 10.0


def block_on_belt(kind):
    """A block of 40 kg/m on a bar of 1.6e4 N/m2, with friction that falls within 2 mm/s."""
    deck = Deck("stick and slip").control(2.0, scale=0.8).hourglass(4, 0.1)
    deck.part(1).elastic(1000.0, 1.0e7, 0.0, 1).part(2).elastic(5.0, 8.0e4, 0.0, 2).part(3).elastic(1000.0, 1.0e8, 0.0, 3)
    (block, block_quads), (bar, bar_quads) = grid(4, 2, 0.2, 0.2), grid(4, 2, 1.0, 0.2, (-1.0, 0.0))
    block = deck.mesh(block, block_quads, part=1)
    free = [k for k in range(len(bar)) if k % 5 != 4]
    number = {k: i for i, k in enumerate(free)}
    number |= {4: -15, 9: -10, 14: -5}
    first = deck.n_node
    ids = np.arange(len(free)) + first + 1
    deck.add("*NODE", *[(int(i), *bar[k]) for i, k in zip(ids, free)])
    name = [int(ids[number[k]]) if number[k] >= 0 else int(block[number[k]]) for k in range(len(bar))]
    deck.add("*ELEMENT_SHELL", *[(deck.n_element + 1 + j, 2, *(name[k] for k in quad)) for j, quad in enumerate(bar_quads)])
    deck.n_node += len(free)
    deck.n_element += len(bar_quads)
    belt = deck.mesh(*grid(23, 1, 2.0, 0.1, (-1.5, -0.1)), part=3)
    deck.fix([name[0], name[5], name[10]], x=1, y=1).fix(belt[:24], y=1)
    deck.curve(1, [(0.0, SPEED), (10.0, SPEED)]).curve(2, [(0.0, GRAVITY), (10.0, GRAVITY)]).curve(3, [(0.0, 60.0), (10.0, 60.0)])
    for node in belt[:24]:
        deck.prescribe(node, 1, 0, 1)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), SPEED, 0.0) for node in (*belt, *block)])
    deck.add("*LOAD_BODY_Y", (2, 1.0)).add("*DAMPING_PART_MASS", (1, 3, 1.0, 1), (0.0, 1.0))
    deck.node_set(1, block[:5]).node_set(2, belt[:23:-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, 2.0, AT_REST, SLIDING, 500.0), (0.0, 1.0e20, 2))
    return deck.output(glstat=0.001, nodout=0.001, nodes=[int(block[2])])


def closed_form(weight=GRAVITY * 40.0):
    """Period and ends of the way of a rigid block with a third of the bar: it slips by a cosine about FD p from where the bar
    pulls with FS p, at the speed of the belt, until it has that again, and sticks on the way back."""
    mass, stiffness = 40.0 + 1.0 / 3.0, 1.6e4
    omega, centre = math.sqrt(stiffness / mass), SLIDING * weight / stiffness
    half = (AT_REST - SLIDING) * weight / stiffness
    swing = math.hypot(half, SPEED / omega)
    slips = (math.pi + 2.0 * math.atan2(SPEED / omega, half)) / omega
    return slips + 2.0 * half / SPEED, centre - swing, centre + swing
