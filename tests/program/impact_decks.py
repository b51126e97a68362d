# SPDX-License-Identifier: MIT
"""A deck whose materials remember energy, temperature, damage and pressure."""
from meshes import Deck, grid


def plates(kind, n=31, end=6.0e-6, points=None):
    """A plate hits another at 150 m/s: copper that warms, is damaged and spalls on steel that fails at a plastic strain;
    beside them swing a foam and two rubbers."""
    deck = Deck("plates")
    deck.add("*CONTROL_TERMINATION", (end,)).add("*CONTROL_TIMESTEP", (0.0, 0.6)).hourglass(1, 0.1)
    deck.add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    deck.add("*SECTION_SHELL", (1, 13, None, points), (1.0,))
    deck.add("*PART", "copper", (1, 1, 1, 7)).add("*PART", "steel", (2, 1, 2))
    deck.add("*MAT_JOHNSON_COOK", (1, 8930.0, 46.0e9), (9.0e7, 2.92e8, 0.31, 0.025, 1.09, 1356.0, 293.0, 1.0),
             (383.0, -1.5e9, 2.0, 0.0, 0.054, 0.49, -3.03, 0.014), (1.12,))
    deck.add("*EOS_GRUNEISEN", (7, 3940.0, 1.489, 0.0, 0.0, 1.99, 0.47), (1.0,))
    deck.add("*MAT_PLASTIC_KINEMATIC", (2, 7850.0, 2.1e11, 0.3, 3.0e8, 1.0e9, 1.0), (0.0, 0.0, 0.06))
    upper = deck.mesh(*grid(n, n // 2, 0.02, 0.01, (0.0, 0.0)), part=1)
    lower = deck.mesh(*grid(n + 6, n, 0.024, 0.02, (-0.002, -0.02)), part=2)
    swing = pads(deck)
    deck.node_set(1, upper).add("*INITIAL_VELOCITY", (1,), (0.0, -150.0))
    deck.node_set(4, swing).add("*INITIAL_VELOCITY", (4,), (20.0, -100.0))
    deck.node_set(2, upper[:n + 1]).node_set(3, lower[-(n + 7):][::-1])
    deck.contact(2, 3, kind, 0.2, unit=3)
    return deck.output(plot=end / 4, glstat=end / 20, matsum=end / 20, rcforc=end / 20).text()


def pads(deck, n=9):
    """A pad of foam and two of rubber, each held at its lower side; the nodes above."""
    deck.add("*MAT_CRUSHABLE_FOAM", (3, 100.0, 1.0e8, 0.1, 80, 1.0e5)).curve(80, [(0.0, 1.0e5), (0.3, 4.0e5), (0.8, 5.0e6)])
    deck.add("*MAT_MOONEY-RIVLIN_RUBBER", (4, 1000.0, 0.49, 4.0e6, 1.0e6), (0.0,)).add("*MAT_BLATZ-KO_RUBBER", (5, 1000.0, 1.0e7))
    above = []
    for part in (3, 4, 5):
        deck.add("*PART", "pad", (part, 1, part))
        ids = deck.mesh(*grid(n, n, 0.003, 0.003, (0.03 + 0.01 * part, 0.0)), part=part)
        deck.fix(ids[:n + 1], x=1, y=1)
        above.extend(ids[n + 1:])
    return above
