# SPDX-License-Identifier: MIT
"""Contact patch test: two blocks with non-matching meshes under a uniform pressure, at rest."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import (CONTACT_TYPES, elastic, energies_on, implicit_static,
                                           meshes, part, plane_strain, contact_surfaces)


RHO, YOUNG = 1000.0, 1.0e6
SLOWEST = 9.0  # angular frequency of the pinned blocks without the interface, 1/s
SURVIVING = 38.0  # of the slowest motion, in powers of 1/e


def even_lines(n):
    """n quads over 1 m."""
    return spaced((0.0, 1.0, n))


def uneven_lines(n, skew):
    """n quads over 1 m with the inner lines moved alternately by parts of a quad."""
    x = even_lines(n)
    inner = np.arange(1, n)
    x[1:-1] += skew / n * np.where(inner % 2 == 1, 1.0, -0.6)
    return x


MESHES = {  # quads above (slave) / below (master): lines of both, rows of each block
    "3/2": (even_lines(3), even_lines(2), None),
    "5/4": (even_lines(5), even_lines(4), None),
    "7/5": (uneven_lines(7, 0.35), uneven_lines(5, -0.3), None),
    "2/7": (even_lines(2), even_lines(7), None),
    "51/50": (even_lines(51), even_lines(50), 2),
}


def patch_grids(upper_lines=None, lower_lines=None, rows=None):
    """Lower and upper block of 1 m x 1 m, columns at the given lines (4 and 5 even ones).

    `rows`: rows of quads of each block, as many as columns if None.
    """
    lower_lines = even_lines(4) if lower_lines is None else lower_lines
    upper_lines = even_lines(5) if upper_lines is None else upper_lines
    lower = Grid(lower_lines, spaced((-1.0, 0.0, rows or len(lower_lines) - 1)))
    upper = Grid(upper_lines, spaced((0.0, 1.0, rows or len(upper_lines) - 1)),
                 first_node=10001, first_element=10001)
    return lower, upper


def relaxation(lower, upper, penalty):
    """Damping (1/s) about critical for the slowest mode, a stable step and an end time (s)."""
    columns = len(upper.lower) - 1
    spring = 0.45 * np.sqrt(penalty * columns / RHO)  # the upper block rocks on the interface
    slowest = 1.0 / np.sqrt(1.0 / SLOWEST ** 2 + 1.0 / spring ** 2)
    sides = [np.diff(grid.points[:, 0, 0]).min() for grid in (lower, upper)]
    heights = [np.diff(grid.points[0, :, 1]).min() for grid in (lower, upper)]
    element = 2.0 * np.sqrt(YOUNG / RHO) / min(*sides, *heights)
    # Both passes of type 3 on the lightest nodes of both sides.
    contact = sum(2.2 * penalty / (0.5 * RHO * side * height)
                  for side, height in zip(sides, heights))
    step = 1.4 / np.sqrt(element ** 2 + contact)
    end = SURVIVING / slowest
    return float(2.0 * slowest), float(end / np.ceil(end / step)), float(end)


#: What holds the blocks together: contact of their two faces, ties of these, or contact of one part set with itself.
SURFACES = ("faces", "tied", "one-set")


def patch(ctype=2, ngauss=4, exchanged=False, penalty=1.0e6, grids=None, static=False, mesh="5/4",
          surfaces="faces"):
    """The contact patch test with a mesh of MESHES, or `grids` as from patch_grids.

    `exchanged`: the lower block is the slave; `penalty` in N/m per contact node; `static`: one
    static step of the implicit method with fully integrated quads, instead of damping to rest;
    `surfaces`: one of SURFACES.
    """
    if not 0.0 < penalty < np.inf:
        raise ValueError("penalty of the patch scene: a positive number")
    if surfaces not in SURFACES:
        raise ValueError(f"surfaces of the patch scene: one of {', '.join(SURFACES)}")
    if exchanged and surfaces == "one-set":
        raise ValueError("exchanged: a surface with itself has neither slave nor master")
    lower, upper = grids or patch_grids(*MESHES[mesh])
    columns = " / ".join(str(len(grid.lower) - 1) for grid in (upper, lower))
    deck = Deck(f"contact patch test {columns}" + (" static" if static else "")
                + (" exchanged" if exchanged else ""), [
        f"Two blocks of 1 m x 1 m with non-matching meshes, {columns} quads along the interface "
        "(upper / lower block), under a pressure of 1 Pa, "
        + ("in static equilibrium" if static else "damped to rest") + ". SI "
        "units (m, kg, s, N, Pa), plane strain, per metre of depth.",
        "",
        "The exact answer is a uniform pressure of 1 Pa all over the interface.",
    ])
    contact = (("ctype", ctype, "contact type: " + CONTACT_TYPES),
               ("ngauss", ngauss, "Gauss points of a slave segment of type 6"),
               ("pen", penalty, "penalty of a contact node in N/m"))
    if static:
        write_static(deck, contact)
    else:
        write_damped(deck, contact, *relaxation(lower, upper, penalty))
    write_bodies(deck, lower, upper, static)
    write_surfaces(deck, lower, upper, exchanged, surfaces)
    return meshes(deck, ("lower block", lower), ("upper block", upper))


def write_surfaces(deck, lower, upper, exchanged, surfaces):
    """The surfaces and what holds between them."""
    if surfaces == "one-set":
        deck.block("Both blocks as one set of parts, in contact with itself: whatever of their outlines meets.")
        deck.keyword("SET_PART_LIST").card("sid", 3)
        deck.card("pid1 pid2", 1, 2)
        deck.keyword("CONTACT_2D_SLIDELINE")
        deck.card("surfa surfb ctype ngauss pen", 3, 0, "&ctype", "&ngauss", "&pen")
        return
    contact_surfaces(deck, ("lower face of the upper block", upper.lower),
                     ("upper face of the lower block", lower.upper), exchanged, about="The two surfaces as node sets in walking order.")
    if surfaces == "tied":
        deck.card("tbirth", 0.0)
        deck.card("vc tfac tie", 0.0, 1.0, 1)


def write_static(deck, contact):
    """Parameters, the one step and output."""
    deck.block("The numbers to play with.")
    deck.parameters(*contact)
    deck.block("One static step; the load grows with the time.")
    deck.keyword("CONTROL_TERMINATION").card("endtim", 1.0)
    implicit_static(deck, 1.0)
    energies_on(deck)
    deck.block("Output.")
    deck.database(glstat=1.0, rcforc=1.0, binary_d3plot=1.0)


def write_damped(deck, contact, damping, step, end):
    """Parameters, damping, steps and output of the explicit method."""
    deck.block("The numbers to play with; damping, step and end time belong to the penalty.")
    deck.parameters(
        *contact,
        ("damp", damping, "mass damping in 1/s: about critical for the slowest mode"),
        ("dt", step, "time step in s"),
        ("endtim", end, f"end time in s: exp(-{SURVIVING:g}) of the motion is left"),
        ("dtplot", end / 4.0, "time between the states in s"))
    deck.block("When to stop, and a constant time step (the curve LCTM caps the step).")
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.constant_step(1, "&dt", 1.0e3)
    deck.block("The stiffness form of hourglass control: the viscous form lets hourglasses creep.")
    deck.keyword("CONTROL_HOURGLASS").card("ihq qh", 4, 0.1)
    energies_on(deck)
    deck.keyword("DAMPING_GLOBAL").card("lcid valdmp", 0, "&damp")
    deck.block("Output.")
    deck.database(glstat="&dtplot", rcforc="&dtplot", binary_d3plot="&dtplot")


def write_bodies(deck, lower, upper, static):
    """Parts, supports and the load."""
    deck.block(f"Two bodies of {'fully integrated' if static else 'one-point'} plane-strain quads "
               "(ELFORM 13), one material.")
    part(deck, 1, "lower block", 1, 1)
    part(deck, 2, "upper block", 1, 1)
    plane_strain(deck, 1, 4 if static else 1)
    elastic(deck, 1, rho=RHO, young=YOUNG, poisson=0.0)
    deck.block("The lower face rests (u_y = 0); u_x = 0 at one lower and one upper node.")
    deck.node_set(1, "lower face of the lower block", lower.lower).spc_set(1, False, True)
    pins = [lower.lower[len(lower.lower) // 2], upper.upper[len(upper.upper) // 2]]
    deck.node_set(2, "held in x", pins).spc_set(2, True, False)
    deck.block("The pressure on the upper face.")
    deck.curve(2, "pressure", [(0.0, 0.0 if static else 1.0), (1.0 if static else 1.0e3, 1.0)])
    deck.keyword("LOAD_SEGMENT")
    top = np.asarray(upper.upper)
    deck.table("lcid sf at n1 n2 n3 n4", [10] * 7,
               [(2, 1.0, 0.0, int(a), int(b), int(b), int(b)) for a, b in zip(top[:-1], top[1:])])
