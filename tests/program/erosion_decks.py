# SPDX-License-Identifier: MIT
"""A plate that loses elements to a rod, whose surfaces of contact follow."""
from meshes import Deck, grid


def penetration(kind, is_axisymmetric=False, points=None, is_self=False, n=8, speed=300.0, end=60.0e-6):
    """A blunt rod on a clamped plate, both may lose elements; friction, two parts or one surface with itself."""
    deck = Deck("penetration")
    deck.add("*CONTROL_TERMINATION", (end, 0, 0.02))
    deck.add("*CONTROL_TIMESTEP", (0.0, 0.8, 0, 0.0, 0.0, 0, 1))
    deck.add("*PART", "plate", (1, 1, 1)).add("*PART", "rod", (2, 1, 2))
    deck.add("*SECTION_SHELL", (1, 15 if is_axisymmetric else 13, None, points), (1.0,))
    deck.add("*MAT_PLASTIC_KINEMATIC", (1, 7850.0, 2.1e11, 0.3, 6.0e8, 1.0e9, 1.0), (0.0, 0.0, 0.3))
    deck.add("*MAT_PLASTIC_KINEMATIC", (2, 7850.0, 2.1e11, 0.3, 9.0e8, 2.0e9, 1.0), (0.0, 0.0, 0.6))
    left = 0.0 if is_axisymmetric else -1.0
    across = (1 if is_axisymmetric else 2) * 2 * n
    plate = deck.mesh(*grid(across, n, (1.0 - left) * 0.024, 0.012, (left * 0.024, 0.0)), part=1)
    rod = deck.mesh(*grid(across // 4 + 1, n, (1.0 - left) * 0.008, 0.03, (left * 0.008, 0.012)), part=2)
    edge = list(plate[across::across + 1]) + ([] if is_axisymmetric else list(plate[::across + 1]))
    deck.fix(edge, x=1, y=1)
    deck.add("*SET_PART_LIST", (1,), (1, None)).add("*SET_PART_LIST", (2,), (2, None)).add("*SET_PART_LIST", (3,), (1, 2))
    deck.add("*CONTACT_2D_SLIDELINE", (3, 0, kind, 2, 1.0, 0.2) if is_self else (1, 2, kind, 2, 1.0, 0.2), (0.0, 1.0e20, 2))
    deck.node_set(8, rod).add("*INITIAL_VELOCITY", (8,), (0.0, -speed))
    return deck.output(plot=end / 4, glstat=end / 20, matsum=end / 20, rcforc=end / 20).text()
