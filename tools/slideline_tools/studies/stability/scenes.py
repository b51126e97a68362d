# SPDX-License-Identifier: MIT
"""The scenes of the stability maps: shortened decks, and the same meshes for the eigenvalue."""
import dataclasses
import functools
import re
from typing import Callable, Sequence

import numpy as np

from slideline_tools import scenes
from slideline_tools.scenes.common import ALUMINIUM, STEEL
from slideline_tools.scenes.patch import patch_grids
from slideline_tools.scenes.sliding import sliding_grids
from slideline_tools.studies.common import verification

SAMPLES, STATES = 300, 4  # rows of histories and states in a run
HOURGLASS = 0.1           # stiffness form in all scenes
SOFT = dict(young=1.0e6, poisson=0.0, rho=1000.0)
PRESSURE = 2.0e4          # Pa, patch: 2 % of the modulus
FASTER = 12.0             # the strokes of the sliding scene, times quicker
PATCH_DAMPING = 18.0      # 1/s
BLOCK_SPEED = -0.6        # m/s


@dataclasses.dataclass(frozen=True, eq=False)
class Scene:
    """One scene of the maps.

    `bare(ctype)`  text without its outputs; `end` simulated time in s
    `side`         shortest element side at the interface in m
    `approach`     how far the bodies are driven together in m
    `is_uniform`   the exact pressure is the same along the interface
    `parts`        grids and materials; `fixed` = (grid, face, directions)
    `options`      words of the command line
    `shifts`       places of the slave along the master, in m, for the eigenvalue
    """

    title: str
    bare: Callable[[int], str]
    end: float
    side: float
    approach: float
    is_uniform: bool
    parts: Sequence
    fixed: Sequence
    options: Sequence[str] = ()
    shifts: Sequence[float] = (0.0,)

    def deck(self, ctype):
        """The text."""
        return with_output(self.bare(ctype), self.end)

    @functools.cached_property
    def model(self):
        """The mesh at rest."""
        grids, materials = zip(*self.parts)
        constants = [[one[name] for one in materials] for name in ("young", "poisson", "rho")]
        model = verification(".", "eigen").Model(grids, *constants, HOURGLASS)
        for grid, face, directions in self.fixed:
            for direction in directions:
                model.fix(getattr(grids[grid], face), direction)
        return model

    @functools.lru_cache(maxsize=None)
    def unit_springs(self, ctype):
        """Stiffness between all nodes for 1 N/m^2, one for each shift."""
        (lower, _), (upper, _) = self.parts
        slave, master = (self.model.rows(nodes) for nodes in (upper.lower, lower.upper[::-1]))
        both, found = np.concatenate([slave, master]), []
        for shift in self.shifts:
            full = np.zeros((len(self.model.x),) * 2)
            full[np.ix_(both, both)] = verification(".", "springs").springs(
                ctype, self.model.x[slave, 0] + shift, self.model.x[master, 0])
            found.append(full)
        return found

    def limit(self, ctype, penalty, with_elements=True):
        """2/omega with contact everywhere, of elements and springs or of the springs alone;
        `penalty` in N/m^2."""
        return min(self.model.limit(penalty * unit, with_elements)
                   for unit in self.unit_springs(ctype))


def with_output(deck, end):
    """The deck with few outputs, and stiffness hourglass control."""
    cards = [(f"DATABASE_{name}", f"{end / SAMPLES!r},") for name in ("GLSTAT", "RCFORC", "SLEOUT")]
    cards.append(("DATABASE_BINARY_D3PLOT", f"{end / STATES!r},"))
    if "*CONTROL_HOURGLASS" not in deck:
        cards.append(("CONTROL_HOURGLASS", f"4,{HOURGLASS}"))
    text = "".join(f"*{keyword}\n{card}\n" for keyword, card in cards)
    deck = re.sub(r"\*DATABASE_[^*]*", "", deck)
    return deck.replace("*CONTROL_ENERGY", text + "*CONTROL_ENERGY")


def scaled_curve(deck, number, abscissa, ordinate):
    """Factors on a curve of the deck, which has none."""
    def card(*factors):
        return "".join(text.rjust(10) for text in (str(number), "0", *factors))
    if card("1.0", "1.0") not in deck:
        raise ValueError(f"no curve {number}")
    return deck.replace(card("1.0", "1.0"), card(f"{abscissa:.6g}", f"{ordinate:.6g}"))


def quicker(deck):
    """The sliding scene with quicker strokes."""
    for curve in (2, 3):
        deck = scaled_curve(deck, curve, 1.0 / FASTER, FASTER)
    return deck


SCENES = {
    "patch": Scene(  # under many times its pressure, damped
        "Patch", lambda ctype: scaled_curve(scenes.patch(ctype), 2, 1.0, PRESSURE), 1.5, 0.2, np.inf, True,
        [(grid, SOFT) for grid in patch_grids()], [(0, "lower", (1,))], (f"p:damp={PATCH_DAMPING}",)),
    "block": Scene(
        "Block", scenes.block, 0.4, 10.0 / 51.0, -BLOCK_SPEED * 0.4, True, [(grid, SOFT) for grid in scenes.block_grids()],
        [(0, "lower", (1,)), (1, "upper", (1,))], (f"p:v0={BLOCK_SPEED}",)),
    "sliding": Scene(
        "Sliding", lambda ctype: quicker(scenes.sliding(1, ctype)), 3.0e-4, 0.5e-3, 0.15e-3, False,
        list(zip(sliding_grids(1), (ALUMINIUM, STEEL))), [(0, "lower", (0, 1)), (1, "upper", (0, 1))], ("p:ihq=4",), (0.0, 0.25e-3)),
}
