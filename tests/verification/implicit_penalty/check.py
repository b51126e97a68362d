# SPDX-License-Identifier: MIT
"""Contact springs that push by the gaps of the end of the step (PUNIT 4), at the step of the elements."""
import pathlib
import re
import sys

import bars
import blocks

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "corners"))

import scene as corners  # noqa: E402


def check_corners(run):
    """Pairs of polygons, corners first: without a limit they made 0.19 and 0.20 of their energy."""
    for seed, penalty in ((9001, bars.RIGID), (9032, 10.0)):
        pair = corners.Scene("pair", seed)
        text, count = re.subn(r"(\*CONTACT_2D_SLIDELINE\n\d+,\d+,7,4,)[^\n]*\n([^\n]*),\d+\n",
                              rf"\g<1>{penalty}\n\g<2>,{bars.IMPLICIT}\n", pair.deck(7).text())
        text, other = re.subn(r"(\*CONTROL_TIMESTEP\n0.0,)[^\n]*", r"\g<1>0.9", text)
        assert count == other == 1
        result = run.program(text)
        name = f"pair of polygons {seed}, PEN {penalty:g}"
        run.check(f"{name}: energy made / E0", corners.made_and_lost(result)[0], 0.015)
        run.check(f"{name}: shared area", max(corners.overlap_area(places, pair.bodies())
                                              for places in result.points("Points")[..., :2]), 0.01)


def check(run):
    check_corners(run)
    bars.check(run)
    blocks.check(run)
