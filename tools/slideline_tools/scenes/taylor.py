# SPDX-License-Identifier: MIT
"""Taylor bar: a copper rod as a body of revolution hits a rigid wall."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import energies_on, part

RADIUS, LENGTH = 3.2e-3, 32.4e-3
YOUNG, PLASTIC_MODULUS = 117.0e9, 100.0e6


def taylor_grid(columns=10, rows=100):
    """Right half of the rod, numbered row by row from the impact end upward."""
    grid = Grid(spaced((0.0, RADIUS, columns)), spaced((0.0, LENGTH, rows)))
    grid.node = 1 + np.arange(grid.node.size).reshape(grid.node.shape[::-1]).T
    grid.element = 1 + np.arange(grid.element.size).reshape(grid.element.shape[::-1]).T
    return grid


def taylor(columns=10, rows=100):
    """A copper rod at 227 m/s, `columns` x `rows` quads of ELFORM 15."""
    if columns < 1 or rows < 1:
        raise ValueError("taylor: columns and rows must be at least 1")
    grid = taylor_grid(columns, rows)
    deck = Deck("Taylor bar", [
        "Taylor bar: a copper rod 6.4 mm thick and 32.4 mm long hits a rigid wall at 227 m/s. Its impact end stays on the wall "
        "and slides on it without friction. Axisymmetric (ELFORM 15): x is the radius, y the axis; forces, masses and energies "
        "are per radian. SI units (m, kg, s, N, Pa).",
        "",
        "Result at 80 microseconds: radius of the impact end 7.16 mm, length 21.42 mm.",
        "",
        "Parameters can be set from the command line, for example",
        "  slideline i=taylor.k p:v0=-150"])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("v0", -227.0, "speed along the axis in m/s"),
        ("endtim", 80.0e-6, "end time in s"),
        ("qh", 0.1, "hourglass coefficient of the viscous form"),
        ("dtplot", 4.0e-6, "time between the states for pictures in s"),
        ("dthist", 0.4e-6, "time between the rows of the histories in s"))
    deck.block()
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.keyword("CONTROL_TIMESTEP").card("dtinit tssfac", 0.0, 0.9)
    deck.comment("the viscous form: the stiffness form would keep the impact end from spreading")
    deck.keyword("CONTROL_HOURGLASS").card("ihq qh", 1, "&qh")
    energies_on(deck)
    deck.block("Output: energies, force of the wall, states, the edge of the impact end and the free end.")
    deck.database(glstat="&dthist", spcforc="&dthist", nodout="&dthist")
    deck.history_nodes([grid.node[-1, 0], grid.node[0, -1]])
    deck.database(binary_d3plot="&dtplot")
    deck.block()
    part(deck, 1, "copper rod", 1, 1)
    deck.keyword("SECTION_SHELL").card("secid elform shrf nip", 1, 15, 1.0, 1)
    deck.card("t1 t2 t3 t4", 0.0, 0.0, 0.0, 0.0)
    deck.comment("yield stress 400 MPa, plastic modulus 100 MPa: etan = E Ep/(E + Ep)")
    deck.keyword("MAT_PLASTIC_KINEMATIC")
    deck.card("mid ro e pr sigy etan beta", 1, 8930.0, YOUNG, 0.35, 400.0e6,
              YOUNG * PLASTIC_MODULUS / (YOUNG + PLASTIC_MODULUS), 1.0)
    deck.card("src srp fs vp", 0.0, 0.0, 0.0, 0.0)
    deck.block("The impact end stays on the wall and slides on it without friction.")
    deck.node_set(1, "impact end", grid.lower).spc_set(1, False, True)
    deck.keyword("INITIAL_VELOCITY").card("nsid nsidex", 0, 0)
    deck.card("vx vy", 0.0, "&v0")
    deck.block()
    deck.nodes(grid.node.T.ravel(), grid.points.transpose(1, 0, 2).reshape(-1, 2))
    deck.quads(grid.element.T.ravel(), 1, grid.quads.transpose(1, 0, 2).reshape(-1, 4))
    return deck.text()
