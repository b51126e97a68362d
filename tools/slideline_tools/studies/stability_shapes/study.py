# SPDX-License-Identifier: MIT
"""A block flies onto a larger one whose lower face is fixed, with half of the largest stable penalty (PUNIT 3) and TSSFAC 0.8;
mesh ratio, angle, overhang, corner, speed and hourglass control may be varied.

Where meshes are compared the interface keeps one stiffness, and the run one step: PUNIT 3 would choose a stiffer one with every
finer mesh.
"""
from __future__ import annotations

import dataclasses

import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import elastic, energies_on, part, plane_strain, slideline
from slideline_tools.studies.stability.scenes import SAMPLES, SOFT

WAVE = np.sqrt(SOFT["young"] / SOFT["rho"])   # m/s
FALL = 0.03 * WAVE                            # m/s
END = 0.12                                    # s: there and back again
GAP = 0.002                                   # m
SHARE, STEP = 0.5, 0.8
STIFFNESS, FINEST = 1.4e6, 32  # N/m^2 and segments a metre: stable at every mesh ratio and type
TWO_PASS = 3


@dataclasses.dataclass(frozen=True)
class Case:
    """One variant; lengths in m, angles in degrees.

    `ratio`   slave segments per master segment (4 master segments a metre for 1 and above)
    `turn`    of the whole scene; `tilt` of the upper block alone
    `overhang` of the upper block beyond the end of the lower one, in its own elements
    `catch`   SRCH, deepest first contact that is caught, over its default; 0: the default
    `speed`   sideways, over the wave speed
    `refine`, `hourglass`, `form` of both meshes
    `stiffness` of the interface, N/m^2, with the step of the finest mesh; 0: half of the largest
                stable one, with the step of the mesh
    """

    ratio: float = 1.25
    turn: float = 0.0
    tilt: float = 0.0
    overhang: float | None = None
    catch: float = 0.0
    speed: float = 0.0
    refine: int = 1
    hourglass: float = 0.1
    form: int = 4
    stiffness: float = 0.0

    def penalty(self, ctype):
        """Arguments of the program; the springs of the two passes of type 3 lie side by side."""
        if not self.stiffness:
            return ("punit=3",)
        passes = 2 if ctype == TWO_PASS else 1
        return ("punit=1", f"pen={self.stiffness / passes!r}")

    @property
    def step(self):
        """TSSFAC."""
        return STEP * max(self.counts) / FINEST if self.stiffness else STEP

    @property
    def counts(self):
        """Segments a metre of slave and master."""
        if self.ratio >= 1.0:
            return int(round(4 * self.ratio)) * self.refine, 4 * self.refine
        return 4 * self.refine, int(round(4 / self.ratio)) * self.refine


def turned(points, degrees):
    angle = np.radians(degrees)
    return points @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def grids_of(case):
    """Lower and upper mesh; elements about as high as they are long."""
    slave, master = case.counts
    width = 4.0 if case.speed else 2.0
    lower = Grid(spaced((0.0, width, int(width * master))), spaced((-0.5, 0.0, max(2, master // 2))))
    left = 0.5 + 0.037
    if case.overhang is not None:
        left = width - 1.0 + case.overhang / slave
    upper = Grid(spaced((left, left + 1.0, slave)), spaced((0.0, 0.5, max(2, slave // 2))),
                 first_node=20001, first_element=20001)
    upper.points[...] = turned(upper.points, case.tilt)
    upper.points[..., 1] += GAP - upper.points[..., 1].min()
    if case.tilt:
        upper.points[..., 0] += 1.0 - upper.points[..., 0].mean()
    for grid in (lower, upper):
        grid.points[...] = turned(grid.points, case.turn)
    return lower, upper


def deck_of(case, ctype):
    """The deck of a case."""
    lower, upper = grids_of(case)
    deck = Deck("two blocks", [f"A block flies onto another. {case}"])
    deck.parameters(("ctype", ctype, "contact type"), ("ngauss", 4, "Gauss points of type 6"),
                    ("pen", SHARE, "share of the largest stable penalty"))
    deck.keyword("CONTROL_TERMINATION")
    deck.card("endtim", END)
    deck.keyword("CONTROL_TIMESTEP")
    deck.card("dtinit tssfac", 0.0, case.step)
    deck.keyword("CONTROL_HOURGLASS")
    deck.card("ihq qh", case.form, case.hourglass)
    energies_on(deck)
    deck.database(glstat=END / SAMPLES, rcforc=END / SAMPLES, matsum=END / SAMPLES,
                  sleout=END / SAMPLES, binary_d3plot=END / 24)
    for number, name in ((1, "lower block"), (2, "upper block")):
        part(deck, number, name, 1, 1)
    plane_strain(deck, 1)
    elastic(deck, 1, **SOFT)
    deck.keyword("INITIAL_VELOCITY_GENERATION")
    way = turned(np.array([case.speed * WAVE, -FALL]), case.turn)
    deck.card("id styp omega vx vy vz", 2, 2, 0.0, float(way[0]), float(way[1]), 0.0)
    deck.card("xc yc zc nx ny nz", *[0.0] * 6)
    deck.node_set(1, "lower face of the lower block", lower.lower)
    deck.spc_set(1, True, True)
    face = upper.lower
    if case.tilt:
        face = np.concatenate([upper.left, upper.lower[1:], upper.right[1:]])
    deck.node_set(3, "slave", face)
    deck.node_set(4, "master", lower.upper)
    slideline(deck, 3, 4)
    if case.catch:
        default = 0.5 / max(case.counts)
        deck.card("tbirth tdeath punit pent vdc ipf freq srch", 0.0, 1.0e20, 0, 0.0, 0.0, 0, 0,
                  case.catch * default)
    lower.write(deck, 1)
    upper.write(deck, 2)
    return deck.text()
