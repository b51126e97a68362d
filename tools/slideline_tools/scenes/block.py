# SPDX-License-Identifier: MIT
"""Block-to-block: two soft blocks with non-matching meshes are pressed together."""
from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import (CONTACT_TYPES, elastic, energies_on, implicit_dynamic,
                                           meshes, part, plane_strain, contact_surfaces)


def block_grids(n_slave=51, n_master=50, rows=2):
    """Lower (master) and upper (slave) block, so many quads wide and high."""
    lower = Grid(spaced((0.0, 10.0, n_master)), spaced((-0.5, 0.0, rows)))
    upper = Grid(spaced((0.0, 10.0, n_slave)), spaced((0.0, 0.5, rows)),
                 first_node=10001, first_element=10001)
    return lower, upper


def block(ctype=2, ngauss=4, n_slave=51, n_master=50, exchanged=False, implicit=False, level=1):
    """The block-to-block scene, explicit or implicit, 200 N_r steps of 1 ms / N_r.

    `n_slave`, `n_master`: quads along each block at level 1, 51 and 50 in the paper. `exchanged`:
    the lower block is the slave; its number of quads is still `n_master`. `implicit`:
    generalised-alpha, consistent mass and fully integrated quads. `level` = N_r >= 1.
    """
    if level < 1 or level > 8:
        raise ValueError("level of the block scene: 1 to 8")
    lower, upper = block_grids(n_slave * level, n_master * level, 2 * level)
    deck = Deck("block-to-block contact" + (" implicit" if implicit else "") + f" N_r = {level}"
                + (" exchanged" if exchanged else ""), [
        "The upper of two soft blocks is pressed upon the lower one at 50 mm/s; their meshes "
        "do not match. SI units (m, kg, s, N, Pa), plane strain, per metre of depth. "
        + ("Implicit dynamics." if implicit else "Explicit dynamics."),
        "",
        f"Refinement level N_r = {level}: all cell and step counts times N_r, time step and "
        "penalty divided by it.",
        "",
        "Dimensions not given by the text of Kang, Lee & Shin (2023), so ours: each block "
        "10 m x 0.5 m.",
        "",
        "Result: contact pressure along the slave surface at 0.2 s.",
    ])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("ngauss", ngauss, "Gauss points of a slave segment: type 6 only"),
        ("pen", 1.0e6 / level, "penalty of a contact node in N/m: 1 MN/m over N_r"),
        ("v0", -0.05, "velocity of the upper face in y in m/s"),
        ("dt", 1.0e-3 / level, "time step in s: 1 ms over N_r"),
        ("endtim", 0.2, f"end time in s: {200 * level} steps"))
    deck.block("When to stop, and " + ("implicit dynamics in constant steps." if implicit else
               "a constant time step (the curve LCTM caps the step)."))
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    if implicit:
        implicit_dynamic(deck, "&dt")
    else:
        deck.constant_step(1, "&dt", 10.0)
    energies_on(deck)
    deck.block("Output: energies and contact force at each step, a state each 10 ms.")
    deck.database(glstat="&dt", rcforc="&dt", matsum=0.01, binary_d3plot=0.01)
    deck.block(f"Two bodies of {'fully integrated' if implicit else 'one-point'} plane-strain "
               "quads (ELFORM 13), one material.")
    part(deck, 1, "lower block", 1, 1)
    part(deck, 2, "upper block", 1, 1)
    plane_strain(deck, 1, 4 if implicit else 1)
    elastic(deck, 1, rho=1000.0, young=1.0e6, poisson=0.0)
    deck.block("The lower face rests (u_y = 0), the upper face moves with a constant velocity.")
    deck.node_set(1, "lower face of the lower block", lower.lower).spc_set(1, False, True)
    deck.node_set(2, "upper face of the upper block", upper.upper)
    deck.keyword("BOUNDARY_PRESCRIBED_MOTION_SET").card("nsid dof vad lcid sf", 2, 2, 0, 2, 1.0)
    deck.curve(2, "velocity of the upper face", [(0.0, "&v0"), (10.0, "&v0")])
    contact_surfaces(deck, ("lower face of the upper block", upper.lower),
                     ("upper face of the lower block", lower.upper), exchanged)
    return meshes(deck, (f"lower block: {n_master * level} x {2 * level} quads", lower),
                  (f"upper block: {n_slave * level} x {2 * level} quads", upper))
