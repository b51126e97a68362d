# SPDX-License-Identifier: MIT
"""Penetration: a blunt steel rod punches a plug out of a steel plate, axisymmetric, with erosion."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import CONTACT_TYPES, energies_on, part, part_contact, part_set

RADIUS, LENGTH, THICK, SPAN = 10.0e-3, 80.0e-3, 12.0e-3, 0.1
MASS = 0.197


def growing(start, end, size, ratio=1.2):
    """Grid lines from `start` to `end` whose distances grow by `ratio` from `size` on."""
    steps = size * ratio ** np.arange(1, 200)
    steps = steps[:1 + int(np.searchsorted(np.cumsum(steps), abs(end - start)))]
    return start + (end - start) * np.cumsum(steps) / np.sum(steps)


def penetration_grids(size):
    """Plate, fine where it shears, and rod."""
    inner, outer = RADIUS - 6 * size, RADIUS + 12 * size
    x = np.concatenate([growing(inner, 0.0, size)[::-1], spaced((inner, outer, 18)), growing(outer, SPAN, size)])
    x[0] = 0.0
    plate = Grid(x, spaced((0.0, THICK, round(THICK / size))))
    rod = Grid(spaced((0.0, RADIUS, round(RADIUS / (2.0 * size)))),
               spaced((THICK, THICK + LENGTH, round(LENGTH / (4.0 * size)))), 100001, 100001)
    return plate, rod


def penetration(ctype=5):
    """A rod of 197 g at 300 m/s on a plate of Weldox 460 E, 12 mm thick, in elements of 0.5 mm."""
    plate, rod = penetration_grids(0.5e-3)
    deck = Deck("penetration of a plate", [
        "Penetration: a rod of hardened steel, 20 mm thick, 80 mm long and 197 g heavy, hits a clamped plate of Weldox 460 E, "
        "12 mm thick, at 300 m/s and punches a plug out of it. Elements whose damage reaches 1 leave the mesh; contact "
        "follows the new edges. Axisymmetric (ELFORM 15): x is the radius, y the axis; forces, masses and energies are per "
        "radian. SI units (m, kg, s, N, Pa).",
        "",
        "Tests of Borvik et al. (Int. J. Impact Eng. 27 (2002) 19): the rod leaves at 0.76 (v^2.36 - 184.5^2.36)^(1/2.36), "
        "194 m/s here. Shear concentrates in one row of elements: the result depends on their size (0.5 mm).",
        "",
        "Parameters can be set from the command line, for example",
        "  slideline i=penetration.k p:v0=-400"])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("v0", -300.0, "velocity of the rod in m/s"),
        ("endtim", 150.0e-6, "end time in s"),
        ("dtplot", 5.0e-6, "time between the states for pictures in s"),
        ("dthist", 0.5e-6, "time between the rows of the histories in s"))
    deck.block("ERODE 1: an element that would bring the step below 1 % of the first one (DTMIN) leaves the mesh too.")
    deck.keyword("CONTROL_TERMINATION").card("endtim endcyc dtmin", "&endtim", 0, 0.01)
    deck.keyword("CONTROL_TIMESTEP").card("dtinit tssfac isdo tslimt dt2ms lctm erode", 0.0, 0.8, 0, 0.0, 0.0, 0, 1)
    deck.comment("viscous hourglass control, half of the default: the stiffness form would resist the plastic flow")
    deck.keyword("CONTROL_HOURGLASS").card("ihq qh", 1, 0.05)
    energies_on(deck)
    deck.block("Output: energies, contact forces, parts (momentum over mass is the velocity), states.")
    deck.database(glstat="&dthist", rcforc="&dthist", matsum="&dthist", binary_d3plot="&dtplot")
    deck.block()
    part(deck, 1, "plate", 1, 1)
    part(deck, 2, "rod", 1, 2)
    deck.keyword("SECTION_SHELL").card("secid elform shrf nip", 1, 15, 1.0, 1)
    deck.card("t1 t2 t3 t4", 0.0, 0.0, 0.0, 0.0)
    deck.comment("Weldox 460 E: E 200 GPa, nu 0.33. Flow stress (490 + 383 p^0.45) MPa times (1 + 0.0114 ln r), r the "
                 "plastic strain rate over 5e-4/s, times 1 - T*^0.94 between 293 and 1800 K. Nine tenths of the plastic work "
                 "heat: the law heats by all of it, so that cp is 452/0.9 J/(kg K). Fracture strain 0.0705 + 1.732 exp(-0.54 "
                 "s), s the mean over the von Mises stress, times 1 - 0.015 ln r.")
    deck.keyword("MAT_JOHNSON_COOK")
    deck.card("mid ro g e pr dtf vp rateop", 1, 7850.0, 200.0e9 / 2.66, 200.0e9, 0.33, 0.0, 1.0, 0.0)
    deck.card("a b n c m tm tr epso", 490.0e6, 383.0e6, 0.45, 0.0114, 0.94, 1800.0, 293.0, 5.0e-4)
    deck.card("cp pc spall it d1 d2 d3 d4", 452.0 / 0.9, 0.0, 0.0, 0.0, 0.0705, 1.732, -0.54, -0.015)
    deck.card("d5", 0.0)
    deck.comment("the rod: yield stress 1.9 GPa, tangent modulus 15 GPa, density from its mass")
    deck.keyword("MAT_PLASTIC_KINEMATIC")
    deck.card("mid ro e pr sigy etan beta", 2, MASS / (np.pi * RADIUS**2 * LENGTH), 204.0e9, 0.33, 1.9e9, 15.0e9, 1.0)
    deck.card("src srp fs vp", 0.0, 0.0, 0.0, 0.0)
    deck.block("The plate is clamped at its rim; the rod flies.")
    deck.node_set(1, "rim of the plate", plate.right)
    deck.spc_set(1, True, True)
    deck.keyword("INITIAL_VELOCITY_GENERATION").card("id styp omega vx vy vz", 2, 2, 0.0, 0.0, "&v0", 0.0)
    deck.card("xc yc zc nx ny nz", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    deck.block("Contact of the plate with the rod. PUNIT 2: PEN is a factor on the stiffness of the elements.")
    part_set(deck, 1, "plate", [1])
    part_set(deck, 2, "rod", [2])
    part_contact(deck, 1, 2)
    deck.block()
    plate.write(deck, 1)
    deck.block()
    rod.write(deck, 2)
    return deck.text()
