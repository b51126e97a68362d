# SPDX-License-Identifier: MIT
"""Whole outlines (part sets) in contact give what the two faces alone (node sets) give."""
import numpy as np

import static_patch
from contact_types import TYPES
from patch_layouts import lines

YOUNG, RHO = 1.0e6, 1000.0
#: N/m of a node. The inclined interface is softer: its nodes are on their line to 1e-17 m.
FLAT, INCLINED = 2.0e5, 2.0e4
N_SEGMENT = 5    # PEN of types 2 to 7 is this many times as much in N/m^2, whatever the mean segment is
SAME = 1.0e-9    # of the largest nodal force


def wide(n, left, right):
    return np.linspace(left, right, n + 1)


#: Lines of the upper and of the lower block.
LAYOUTS = {
    "matching, flush": (lines(4), lines(4)),
    "5/4, flush": (lines(5), lines(4)),
    "non-uniform, flush": (lines(5, 0.3), lines(4, -0.3)),
    "matching, lower block wider": (lines(4), wide(6, -0.25, 1.25)),
    "upper block wider by parts of a segment": (wide(6, -0.13, 1.21), lines(4)),
    "each overhangs at one end": (wide(5, 0.1, 1.2), wide(4, 0.0, 1.0)),
}


def change_contact(deck, kind, penalty, whole, is_swapped):
    """Our contact card between parts 1 and 2, or between node sets 1 and 2, instead of the one there."""
    del deck.lines[-3:]
    sides = (-1, -2)
    if whole:
        deck.add("*SET_PART_LIST", (11,), (1,)).add("*SET_PART_LIST", (12,), (2,))
        sides = (11, 12)
    unit = int(kind > 1)
    return deck.add("*CONTACT_2D_SLIDELINE", (*(sides[::-1] if is_swapped else sides), kind, 4,
                                              penalty * N_SEGMENT ** unit), (0.0, 1.0e20, unit))


def compare(run, name, make, kind, penalty, is_swapped):
    """Forces of outlines and of faces at rest, either side the slave; make(kind) gives a deck."""
    faces, outlines = (run.program(change_contact(make(kind), kind, penalty, whole, is_swapped))
                       .points("contact_force")[-1, :, :2] for whole in (False, True))
    size = np.max(np.abs(faces))
    slave = "lower" if is_swapped else "upper"
    run.check(f"{name}, {slave} block the slave: there is force", size, 1e-3, 0.0, "min",
              "so that the comparison means something")
    run.check(f"{name}, {slave} block the slave: nodal forces of whole outlines / largest",
              outlines / size, faces / size, SAME, "abs", "the two faces alone")


def check_outlines(run, pressed_blocks, inclined_patch):
    """All types; the decks are those of the patch tests but for the surfaces."""
    makers = {}
    for layout, mesh in LAYOUTS.items():
        blocks = static_patch.Blocks(*mesh, YOUNG, 4)
        relaxation = static_patch.frequencies(blocks, RHO, FLAT)
        makers[layout] = FLAT, lambda kind, b=blocks, r=relaxation: pressed_blocks(kind, FLAT, b, r)
    for matching in (True, False):
        makers[f"{'matching' if matching else '5/4'}, inclined by 20 degrees"] = (
            INCLINED, lambda kind, m=matching: inclined_patch(kind, INCLINED, 1.0e-2, m)[0])
    for kind, layout, is_swapped in run.cover(TYPES, makers, (False, True)):
        penalty, make = makers[layout]
        compare(run, f"{TYPES[kind]}, outlines, {layout}", make, kind, penalty, is_swapped)
