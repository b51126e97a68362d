# SPDX-License-Identifier: MIT
"""Contact patch test: two blocks with non-matching meshes under a uniform pressure, damped to rest."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import (CONTACT_TYPES, elastic, energies_on, part,
                                           plane_strain, roles, slideline)


def patch_grids(n_upper=5, n_lower=4):
    """Lower and upper block of 1 m x 1 m with so many quads along each side."""
    lower = Grid(spaced((0.0, 1.0, n_lower)), spaced((-1.0, 0.0, n_lower)))
    upper = Grid(spaced((0.0, 1.0, n_upper)), spaced((0.0, 1.0, n_upper)),
                 first_node=10001, first_element=10001)
    return lower, upper


def patch(ctype=2, ngauss=4, exchanged=False):
    """The contact patch test with meshes 5 / 4; `exchanged`: the lower block is the slave."""
    lower, upper = patch_grids()
    deck = Deck("contact patch test" + (" exchanged" if exchanged else ""), [
        "Two blocks of 1 m x 1 m with non-matching meshes under a pressure of 1 Pa, damped to rest. SI "
        "units (m, kg, s, N, Pa), plane strain, per metre of depth.",
        "",
        "The exact answer is a uniform pressure of 1 Pa all over the interface.",
    ])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("ngauss", ngauss, "Gauss points of a slave segment of type 6"),
        ("pen", 1.0e6, "penalty of a contact node in N/m"),
        ("damp", 19.0, "mass damping in 1/s: critical for the slowest mode"),
        ("dt", 2.0e-3, "time step in s"),
        ("endtim", 4.0, "end time in s: exp(-38) of the motion is left"))
    deck.block("When to stop, and a constant time step (the curve LCTM caps the step).")
    deck.keyword("CONTROL_TERMINATION")
    deck.card("endtim", "&endtim")
    deck.constant_step(1, "&dt", 10.0)
    deck.block("The stiffness form of hourglass control: the viscous form lets hourglasses creep.")
    deck.keyword("CONTROL_HOURGLASS")
    deck.card("ihq qh", 4, 0.1)
    energies_on(deck)
    deck.keyword("DAMPING_GLOBAL")
    deck.card("lcid valdmp", 0, "&damp")
    deck.block("Output.")
    deck.database(glstat=0.1, rcforc=0.1, binary_d3plot=1.0)
    deck.block("Two bodies of one-point plane-strain quads (ELFORM 13), one material.")
    part(deck, 1, "lower block", 1, 1)
    part(deck, 2, "upper block", 1, 1)
    plane_strain(deck, 1)
    elastic(deck, 1, rho=1000.0, young=1.0e6, poisson=0.0)
    deck.block("The lower face rests (u_y = 0); u_x = 0 at one lower and one upper node.")
    deck.node_set(1, "lower face of the lower block", lower.lower)
    deck.spc_set(1, False, True)
    pins = [lower.lower[len(lower.lower) // 2], upper.upper[len(upper.upper) // 2]]
    deck.node_set(2, "held in x", pins)
    deck.spc_set(2, True, False)
    deck.block("The pressure on the upper face.")
    deck.curve(2, "pressure", [(0.0, 1.0), (10.0, 1.0)])
    deck.keyword("LOAD_SEGMENT")
    top = np.asarray(upper.upper)
    deck.table("lcid sf at n1 n2 n3 n4", [10] * 7,
               [(2, 1.0, 0.0, int(a), int(b), int(b), int(b)) for a, b in zip(top[:-1], top[1:])])
    deck.block("The two surfaces as node sets in walking order.")
    first, second = roles(exchanged)
    deck.node_set(3, f"{first}: lower face of the upper block", upper.lower)
    deck.node_set(4, f"{second}: upper face of the lower block", lower.upper)
    slideline(deck, 3, 4, exchanged)
    deck.block("Mesh of the lower block: 4 x 4 quads.")
    lower.write(deck, 1)
    deck.block("Mesh of the upper block: 5 x 5 quads.")
    upper.write(deck, 2)
    return deck.text()
