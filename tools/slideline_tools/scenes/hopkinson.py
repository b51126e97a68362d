# SPDX-License-Identifier: MIT
"""Split Hopkinson pressure bar: a striker, two bars and a specimen of copper between them, axisymmetric."""
from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import CONTACT_TYPES, STEEL, elastic, energies_on, part, part_contact, part_set

RADIUS, STRIKER, BAR = 8.0e-3, 0.2, 1.0
SPECIMEN_RADIUS, SPECIMEN = 6.0e-3, 5.0e-3
COPPER = dict(rho=8930.0, young=117.0e9, poisson=0.35, yield_stress=150.0e6, modulus=500.0e6)


def hopkinson_grids():
    """Striker, incident bar, specimen and transmission bar, one above the other."""
    grids, low, first = [], -STRIKER, 1
    for radius, length, columns, rows in ((RADIUS, STRIKER, 3, 50), (RADIUS, BAR, 3, 250),
                                          (SPECIMEN_RADIUS, SPECIMEN, 6, 5), (RADIUS, BAR, 3, 250)):
        grids.append(Grid(spaced((0.0, radius, columns)), spaced((low, low + length, rows)), first, first))
        low, first = low + length, first + 10000
    return grids


def hopkinson(ctype=5):
    """A steel striker at 10 m/s, two steel bars of 1 m, a specimen of copper, 12 mm thick and 5 mm long."""
    grids = hopkinson_grids()
    _, incident, _, transmission = grids
    deck = Deck("split Hopkinson pressure bar", [
        "Split Hopkinson pressure bar: a steel striker of 200 mm hits a steel bar of 1 m at 10 m/s; between this bar and "
        "another one is a specimen of copper, 12 mm thick and 5 mm long. All bars are 16 mm thick. Axisymmetric (ELFORM "
        "15): x is the radius, y the axis; forces, masses and energies are per radian. SI units (m, kg, s, N, Pa).",
        "",
        "Closed form, c = sqrt(E/rho) = 5172 m/s: incident stress rho c v/2 = 203 MPa for 2 x 0.2 m/c = 77 microseconds. "
        "Gauges half way along the bars (elout): incident 97 to 174, reflected and transmitted from 290 microseconds on. "
        "Stress of the specimen: that of the second gauge times 16^2/12^2; its strain rate: 2 c/(5 mm) times the "
        "reflected strain.",
        "",
        "The log warns that contact forces are limited: the specimen spreads under pressure, and springs on a growing area "
        "would return more energy than they took.",
        "",
        "Parameters can be set from the command line, for example",
        "  slideline i=hopkinson.k p:v0=15 ctype=1"])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("v0", 10.0, "velocity of the striker in m/s"),
        ("endtim", 450.0e-6, "end time in s: before the wave comes back from the far end of the second bar"),
        ("dtplot", 10.0e-6, "time between the states for pictures in s"),
        ("dthist", 0.5e-6, "time between the rows of the histories in s"))
    deck.block()
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.comment("the first step is computed; each is nine tenths of the stable one")
    deck.keyword("CONTROL_TIMESTEP").card("dtinit tssfac", 0.0, 0.9)
    deck.comment("viscous hourglass control: the stiffness form would resist the plastic flow of the specimen")
    deck.keyword("CONTROL_HOURGLASS").card("ihq qh", 1, 0.1)
    energies_on(deck)
    deck.block("Output: energies, contact forces, states, and the stress of the two gauges (element at the surface).")
    deck.database(glstat="&dthist", rcforc="&dthist", elout="&dthist", matsum="&dthist", binary_d3plot="&dtplot")
    deck.keyword("DATABASE_HISTORY_SHELL").card("id1 id2", incident.element[-1, 125], transmission.element[-1, 125])
    deck.block("Three bars of elastic steel and a specimen of copper.")
    for number, heading in enumerate(("striker", "incident bar", "specimen", "transmission bar"), 1):
        part(deck, number, heading, 1, 2 if heading == "specimen" else 1)
    deck.keyword("SECTION_SHELL").card("secid elform shrf nip", 1, 15, 1.0, 1)
    deck.card("t1 t2 t3 t4", 0.0, 0.0, 0.0, 0.0)
    deck.comment("steel: density, Young's modulus, Poisson's ratio")
    elastic(deck, 1, **STEEL)
    deck.comment("copper: yield stress 150 MPa, plastic modulus 500 MPa: etan = E Ep/(E + Ep)")
    deck.keyword("MAT_PLASTIC_KINEMATIC")
    young, modulus = COPPER["young"], COPPER["modulus"]
    deck.card("mid ro e pr sigy etan beta", 2, COPPER["rho"], young, COPPER["poisson"], COPPER["yield_stress"],
              young * modulus / (young + modulus), 1.0)
    deck.card("src srp fs vp", 0.0, 0.0, 0.0, 0.0)
    deck.block("The striker flies; the bodies touch each other at the start.")
    deck.keyword("INITIAL_VELOCITY_GENERATION").card("id styp omega vx vy vz", 1, 2, 0.0, 0.0, "&v0", 0.0)
    deck.card("xc yc zc nx ny nz", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    deck.block("Contact of neighbours without friction. PUNIT 2: PEN is a factor on the stiffness of the elements.")
    for number, heading in enumerate(("striker", "incident bar", "specimen", "transmission bar"), 1):
        part_set(deck, number, heading, [number])
    for slave, master in ((1, 2), (3, 2), (3, 4)):
        part_contact(deck, slave, master)
    for number, grid in enumerate(grids, 1):
        deck.block()
        grid.write(deck, number)
    return deck.text()
