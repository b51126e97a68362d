# SPDX-License-Identifier: MIT
"""A collision modelled with more than it needs, and the same without one of the needless things."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import ALUMINIUM, STEEL, elastic, part, perfectly_plastic, plane_strain

# What the wasteful deck has, each by the topic of the advice that should find it.
WASTE = ("never yielded", "never touched", "symmetry", "long flight", "written too often", "bulk viscosity")
# Time step in s at level 1.
STEP = 1.22e-7
SPEED, END, FLIGHT = 10.0, 2.0e-4, 1.0e-4


def deck(waste, level=2):
    """The deck with the needless things named in `waste` (of WASTE)."""
    left, columns = (-1.0, 2) if "symmetry" in waste else (0.0, 1)
    flight = FLIGHT if "long flight" in waste else 0.0
    gap = 1.0e-5 + SPEED * flight
    plate = Grid(spaced((left * 0.065, 0.065, columns * 40 * level)), spaced((-0.005, 0.0, 4 * level)))
    block = Grid(spaced((left * 0.020, 0.020, columns * 24 * level)), spaced((gap, gap + 0.005, 4 * level)),
                 first_node=20001, first_element=20001)
    text = Deck("a collision with more than it needs")
    text.keyword("CONTROL_TERMINATION").card("endtim", END + flight)
    text.constant_step(1, STEP / level, 1.0)
    text.keyword("CONTROL_HOURGLASS").card("ihq qh", 4, 0.05)
    if "bulk viscosity" in waste:
        text.keyword("CONTROL_BULK_VISCOSITY").card("q1 q2", 1.5, 1.0e-6)
    text.database(glstat=1.0e-7 if "written too often" in waste else 2.0e-7, matsum=1.0e-6, rcforc=1.0e-6, nodout=1.0e-6,
                  binary_d3plot=1.0e-5)
    text.history_nodes([plate.node[-1, 0], block.node[-1, -1]])
    part(text, 1, "plate", 1, 1)
    part(text, 2, "block", 1, 2)
    plane_strain(text, 1)
    if "never yielded" in waste:
        perfectly_plastic(text, 1, **{**ALUMINIUM, "yield_stress": 1.0e12})
    else:
        elastic(text, 1, **{name: value for name, value in ALUMINIUM.items() if name != "yield_stress"})
    elastic(text, 2, **STEEL)
    text.keyword("INITIAL_VELOCITY_GENERATION").card("id styp omega vx vy vz", 2, 2, 0.0, 0.0, -SPEED, 0.0)
    text.card("xc yc zc nx ny nz", *[0.0] * 6)
    if "symmetry" not in waste:
        text.node_set(1, "symmetry plane", np.concatenate([plate.left, block.left])).spc_set(1, True, False)
    clamped = np.concatenate([plate.left, plate.right]) if "symmetry" in waste else plate.right
    text.node_set(2, "clamped ends", clamped).spc_set(2, True, True)
    pairs = [("lower face of the block", block.lower, "upper face of the plate", plate.upper),
             ("upper face of the block", block.upper, "lower face of the plate", plate.lower)]
    for number, (slave, upper, master, lower) in enumerate(pairs if "never touched" in waste else pairs[:1]):
        first, second = 3 + 2 * number, 4 + 2 * number
        text.node_set(first, slave, upper).node_set(second, master, lower)
        text.keyword("CONTACT_2D_SLIDELINE")
        text.card("surfa surfb ctype ngauss pen fs fd dc", -first, -second, 2, 2, 5.0e8, 0.0, 0.0, 0.0)
    plate.write(text, 1)
    block.write(text, 2)
    return text.text()
