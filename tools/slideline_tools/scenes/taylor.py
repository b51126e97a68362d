# SPDX-License-Identifier: MIT
"""Taylor bars: a rod as a body of revolution hits a rigid wall, of copper, or of steel that warms."""
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
    deck = begin("Taylor bar", [
        "Taylor bar: a copper rod 6.4 mm thick and 32.4 mm long hits a rigid wall at 227 m/s. Its impact end stays on the wall "
        "and slides on it without friction. Axisymmetric (ELFORM 15): x is the radius, y the axis; forces, masses and energies "
        "are per radian. SI units (m, kg, s, N, Pa).",
        "",
        "Result at 80 microseconds: radius of the impact end 7.16 mm, length 21.42 mm."],
        "slideline i=taylor.k p:v0=-150", -227.0, (("qh", 0.1, "hourglass coefficient of the viscous form"),))
    grid = control(deck, columns, rows, "&qh", "copper rod")
    deck.comment("yield stress 400 MPa, plastic modulus 100 MPa: etan = E Ep/(E + Ep)")
    deck.keyword("MAT_PLASTIC_KINEMATIC")
    deck.card("mid ro e pr sigy etan beta", 1, 8930.0, YOUNG, 0.35, 400.0e6,
              YOUNG * PLASTIC_MODULUS / (YOUNG + PLASTIC_MODULUS), 1.0)
    deck.card("src srp fs vp", 0.0, 0.0, 0.0, 0.0)
    return flying_rod(deck, grid)


def taylor_johnson_cook(columns=5, rows=50):
    """A rod of 42CrMo4 at 287 m/s whose law has strain rate and heat, `columns` x `rows` quads of ELFORM 15."""
    deck = begin("Taylor bar with Johnson-Cook", [
        "Taylor bar with Johnson-Cook: a rod of steel 42CrMo4, 6.4 mm thick and 32.4 mm long, hits a rigid wall at 287 m/s. Its "
        "impact end slides on the wall without friction. The law has strain rate and heat. Axisymmetric (ELFORM 15): x is the "
        "radius, y the axis; forces, masses and energies are per radian. SI units (m, kg, s, N, Pa), temperatures in degrees Celsius.",
        "",
        "Published for this mesh (documentation of DynELA, Pantale, with Abaqus beside it), at 80 microseconds: length 26.52 and 26.56 mm, "
        "diameter of the impact end 11.15 and 11.16 mm, in its middle 582 and 591 degrees and a plastic strain of 1.78 and "
        "1.81. Here 26.54 mm, 11.12 mm, 588 degrees, 1.81."],
        "slideline i=taylor_johnson_cook.k p:v0=-200", -287.0)
    grid = control(deck, columns, rows, 0.1, "rod of 42CrMo4")
    deck.comment("E 206 GPa, nu 0.3. Flow stress (806 + 614 p^0.168) MPa times 1 + 0.0089 ln r, r the plastic strain rate in 1/s "
                 "(VP 1), times 1 - T*^1.1 between 20 and 1540 degrees. Nine tenths of the plastic work heat the steel: the law "
                 "heats by all of it, so that cp is 460/0.9 J/(kg K). D1 to D5 are 0: no damage.")
    deck.keyword("MAT_JOHNSON_COOK")
    deck.card("mid ro g e pr dtf vp rateop", 1, 7830.0, 206.0e9 / 2.6, 206.0e9, 0.3, 0.0, 1.0, 0.0)
    deck.card("a b n c m tm tr epso", 806.0e6, 614.0e6, 0.168, 0.0089, 1.1, 1540.0, 20.0, 1.0)
    deck.card("cp pc spall it d1 d2 d3 d4", 460.0 / 0.9, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    deck.card("d5", 0.0)
    return flying_rod(deck, grid)


def begin(title, about, command, speed, more=()):
    """The deck of a rod up to its parameters."""
    deck = Deck(title, [*about, "", "Parameters can be set from the command line, for example", f"  {command}"])
    deck.block("The numbers to play with.")
    return deck.parameters(
        ("v0", speed, "speed along the axis in m/s"),
        ("endtim", 80.0e-6, "end time in s"),
        *more,
        ("dtplot", 4.0e-6, "time between the states for pictures in s"),
        ("dthist", 0.4e-6, "time between the rows of the histories in s"))


def control(deck, columns, rows, coefficient, heading):
    """Control, output and section of a rod; gives its mesh."""
    if columns < 1 or rows < 1:
        raise ValueError("taylor: columns and rows must be at least 1")
    grid = taylor_grid(columns, rows)
    deck.block()
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.keyword("CONTROL_TIMESTEP").card("dtinit tssfac", 0.0, 0.9)
    deck.comment("the viscous form: the stiffness form would keep the impact end from spreading")
    deck.keyword("CONTROL_HOURGLASS").card("ihq qh", 1, coefficient)
    energies_on(deck)
    deck.block("Output: energies, force of the wall, states, the edge of the impact end and the free end.")
    deck.database(glstat="&dthist", spcforc="&dthist", nodout="&dthist")
    deck.history_nodes([grid.node[-1, 0], grid.node[0, -1]])
    deck.database(binary_d3plot="&dtplot")
    deck.block()
    part(deck, 1, heading, 1, 1)
    deck.keyword("SECTION_SHELL").card("secid elform shrf nip", 1, 15, 1.0, 1)
    deck.card("t1 t2 t3 t4", 0.0, 0.0, 0.0, 0.0)
    return grid


def flying_rod(deck, grid):
    """Support, velocity and mesh of a rod; the text of the deck."""
    deck.block("The impact end stays on the wall and slides on it without friction.")
    deck.node_set(1, "impact end", grid.lower)
    deck.spc_set(1, False, True)
    deck.keyword("INITIAL_VELOCITY").card("nsid nsidex", 0, 0)
    deck.card("vx vy", 0.0, "&v0")
    deck.block()
    deck.nodes(grid.node.T.ravel(), grid.points.transpose(1, 0, 2).reshape(-1, 2))
    deck.quads(grid.element.T.ravel(), 1, grid.quads.transpose(1, 0, 2).reshape(-1, 4))
    return deck.text()
