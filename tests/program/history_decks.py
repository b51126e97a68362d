# SPDX-License-Identifier: MIT
"""A deck with a row for every history of elements, rigid bodies, walls and boundaries."""
from meshes import Deck, grid

#: histories that the deck asks for besides the energies
HISTORIES = ("rwforc", "elout", "rbdout", "bndout", "nodfor", "secforc")


def busy_block(end_time=0.02, interval=1.0e-3, binary="", fine=1):
    """A block that yields runs against a wall under pressure, a force and prescribed motion; a rigid square falls on
    it while a force turns it aside; another rigid square is turned. `fine`: elements over 12 and 8 along its sides."""
    deck = Deck("busy block")
    deck.control(end_time, dt=1.0e-4).hourglass(4, 0.1)
    deck.part(1).plastic(1000.0, 1.0e6, 0.3, 2.0e3, 1.0e5, 0.5, 1)
    deck.part(2).part(3)
    for part in (2, 3):
        deck.add("*MAT_RIGID", (part, 3000.0, 1.0e6, 0.3), (0.0,), (0.0,))
    n, m = 12 * fine, 8 * fine
    block = deck.mesh(*grid(n, m, 0.6, 0.4), part=1)
    falling = deck.mesh(*grid(3, 3, 0.2, 0.2, (0.2, 0.401)), part=2)
    deck.mesh(*grid(2, 2, 0.2, 0.2, (1.0, 0.0)), part=3)
    top, bottom = block[-(n + 1):], block[:n + 1]
    deck.node_set(1, falling[:4]).node_set(2, top[::-1]).node_set(3, bottom[-3:])
    deck.contact(1, 2, 3, 2.0e4)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), -1.0, 0.0) for node in block])
    deck.add("*INITIAL_VELOCITY_RIGID_BODY", (2, 0.0, -1.0, 0.0, 0.0, 0.0, 2.0))
    deck.add("*RIGIDWALL_PLANAR", (0,), (-0.001, 0.0, 0.0, 0.999, 0.0, 0.0))
    deck.curve(1, [(0.0, 0.0), (0.01, 0.01), (1.0, 0.01)]).curve(2, [(0.0, 2.0e3), (1.0, 2.0e3)])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (3, 2, 2, 1, 0.5))
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", (3, 7, 0, 1, 100.0))
    deck.add("*LOAD_NODE_POINT", (int(top[0]), 1, 2, 0.01))
    deck.add("*LOAD_RIGID_BODY", (2, 1, 2, 0.02))
    deck.add("*LOAD_SEGMENT", *[(2, 1.0, 0.0, int(b), int(a)) for a, b in zip(top[:3 * fine], top[1:3 * fine + 1])])
    deck.add("*SET_SHELL_LIST_GENERATE", (1,), (1, 3))
    deck.add("*DATABASE_HISTORY_SHELL", (n * m, 2)).add("*DATABASE_HISTORY_SHELL_SET", (1, 0))
    deck.node_set(4, block[n // 2::n + 1]).add("*DATABASE_NODAL_FORCE_GROUP", (3, 0), (4, 0))
    across = [j * n + n // 2 + 1 for j in range(m)]
    deck.add("*SET_SHELL_LIST", (2,), *[across[k:k + 8] for k in range(0, m, 8)])
    deck.add("*SET_SHELL_LIST_GENERATE", (3,), (1, n)).node_set(5, bottom[::-1])
    deck.add("*DATABASE_CROSS_SECTION_SET", (4, 0, 0, 2), (5, 0, 0, 3))
    for name in HISTORIES:
        deck.add(f"*DATABASE_{name.upper()}", f"{interval},{binary}")
    return deck.output(plot=5 * interval, glstat=interval, matsum=interval)
