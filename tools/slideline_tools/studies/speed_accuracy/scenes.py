# SPDX-License-Identifier: MIT
"""The scenes of the study speed-accuracy: decks by level, and what each run is judged by.

A scene with a closed form or a separate solution is judged run by run (`judge`). The others are
judged against a converged reference, see reference.py.
"""
import dataclasses
from typing import Callable, Sequence

import numpy as np

from slideline_tools import scenes
from slideline_tools.contact_types import HARD, IMPLICIT, IMPLICIT_PENALTIES
from slideline_tools.histories import read_csv
from slideline_tools.scenes.hertz import BLOCK_CELL, CYLINDER_CELL, PENALTY as HERTZ_PENALTY
from slideline_tools.scenes.patch import patch, patch_grids
from slideline_tools.studies import block as block_study
from slideline_tools.studies import hertz as hertz_study
from slideline_tools.studies import patch as patch_study
from slideline_tools.studies import sliding as sliding_study
from slideline_tools.studies.common import verification

BLOCK_STEP, BLOCK_END = 1.0e-4, 0.2  # s; a tenth of the deck's step, for a time to measure
SLIDING_STEP = 40.0e-9  # s at level 1
TWO_PASS = 3
ROUND_OFF = 1.0e-9
FINITE_STRAIN = 1.0e-3  # what Hertz's closed form leaves out here: the size of the strains
NO_STATES = "p:dtplot=1"  # but the first and the last


@dataclasses.dataclass(frozen=True)
class Measure:
    """An error, as a share of one, in the column `key` of the table.

    `known`: error below which the exact answer itself is not known; a reference has the column
    `<key>_floor` instead.
    """

    key: str
    title: str
    known: float = 0.0


@dataclasses.dataclass(frozen=True)
class Scene:
    """A scene; the first measure is its headline.

    `deck`        text by level
    `penalty`     of a contact node by level, N/m
    `lengths`     mean segments of slave and master at level 1, m
    `judge`       (folder, level, series) -> columns
    `levels`, `quick_levels` those that are swept
    `references`, `quick_references` levels of type 7 the reference is made of, the finest last
    `options`     of the program by level
    `turns`, `cost` as in Job, at level 1; `power`: the cost grows with this power of the level
    """

    title: str
    deck: Callable[[int], str]
    penalty: Callable[[int], float]
    lengths: tuple[float, float]
    judge: Callable
    measures: Sequence[Measure]
    levels: Sequence[int]
    quick_levels: Sequence[int] = (1,)
    options: Callable[[int], Sequence[str]] = lambda _: (NO_STATES,)
    references: Sequence[int] = ()
    quick_references: Sequence[int] = ()
    turns: int = 1
    cost: float = 1.0
    power: float = 3.0


def node_penalty(scene, level, ctype):
    """Penalty of a contact node, N/m, so that every type has an interface of the same stiffness.

    The springs of the two passes of type 3 lie side by side: e/l_sl + e/l_ms is to be what one
    pass of the others has, penalty/l_sl (doc/theory/contact.md, section 5).
    """
    slave, master = scene.lengths
    return scene.penalty(level) * (master / (slave + master) if ctype == TWO_PASS else 1.0)


def contact_options(scene, level, series):
    """What gives a run its contact: type and penalty."""
    if series in IMPLICIT_PENALTIES:
        return ("ctype=7", "punit=4", f"p:pen={IMPLICIT_PENALTIES[series]:g}")
    return (f"ctype={series}", f"p:pen={node_penalty(scene, level, series):.17g}")


def net_moment(results, segment):
    """|sum x x f| of all contact forces at the last state, over the force on one side times the
    length `segment` in m; None where nothing touches."""
    place, force = results.points[-1][:, :2], results.point_field("contact_force")[-1][:, :2]
    pressing = 0.5 * np.sum(np.hypot(force[:, 0], force[:, 1]))
    if not pressing > 0.0:
        return None
    place = place - place.mean(axis=0)
    moment = np.sum(place[:, 0] * force[:, 1] - place[:, 1] * force[:, 0])
    return float(abs(moment) / (pressing * segment))


def largest_deviation(sides, exact):
    """max |p/p0 - 1| over the pressures of both sides."""
    return max(float(np.abs(pressure / exact - 1.0).max()) for pressure in sides)


# ---- patch -------------------------------------------------------------------------------------

def divided(lines, level):
    """Grid lines with each interval divided into `level` equal parts."""
    count = len(lines) - 1
    return np.interp(np.arange(count * level + 1) / level, np.arange(count + 1), lines)


def patch_level(level):
    """Lower and upper block of the non-uniform 7 / 5 meshes, refined."""
    _, upper, lower, *_ = patch_study.LAYOUTS["7_5"]
    return patch_grids(divided(upper, level), divided(lower, level))


def patch_deck(level):
    """The patch test on these meshes."""
    return patch(penalty=1.0e6 / level, grids=patch_level(level))


def judge_patch(folder, level, _series):
    """Deviation from the uniform pressure of 1 Pa, at rest."""
    sides = patch_study.sides(folder, patch_level(level))
    return {"pressure_error": largest_deviation([pressure for _, pressure in sides], 1.0)}


# ---- block -------------------------------------------------------------------------------------

def block_quads(level):
    """Columns of slave and master."""
    return block_study.N_SLAVE * level, block_study.N_MASTER * level


def block_deck(level):
    """Block-to-block on these meshes."""
    return scenes.block(n_slave=block_quads(level)[0], n_master=block_quads(level)[1])


def chain_pressure(stiffness, ahead=False):
    """Last pressure of the chain, Pa; `stiffness` in N/m^2, `ahead`: of springs by the end of the step."""
    return block_study.chain_pressure(stiffness, step=BLOCK_STEP, steps=round(BLOCK_END / BLOCK_STEP), ahead=ahead)


def block_springs(level, series):
    """Stiffness between the blocks, N/m^2, and whether it acts by the end of the step."""
    if series == HARD:
        return np.inf, True
    if series == IMPLICIT:
        blocks = verification("block_to_block", "chain").Blocks()
        row = blocks.young / 3.0 / (blocks.height / blocks.layers)
        return IMPLICIT_PENALTIES[series] * row, True
    penalty = node_penalty(SCENES["block"], level, series)
    stiffness = block_study.interface_stiffness(series, *block_quads(level))
    return stiffness * penalty / block_study.PENALTY, False


def judge_block(folder, level, series):
    """Deviation from the pressure of the chain whose interface has the springs of the series."""
    found = block_study.read_pressures(folder, scenes.block_grids(*block_quads(level)))
    return {"pressure_error": largest_deviation((found.slave, found.master),
                                                chain_pressure(*block_springs(level, series)))}


# ---- Hertz, sliding, collision -----------------------------------------------------------------

def judge_hertz(folder, _level, _series):
    """Distance of the nodal pressures from Hertz's ellipse, and of a from Hertz's. (Its layer of
    springs is not judged here.)"""
    found = hertz_study.measure(folder)
    return {"profile_error": found["inside"], "half_width_error": abs(found["half_width"] - 1.0)}


def sliding_lengths():
    """(slave, master) mean segment lengths of the sliding at level 1."""
    die, plate = scenes.sliding_grids(1)[::-1]
    arc = np.diff(die.points[:, 0], axis=0)
    return np.mean(np.linalg.norm(arc, axis=1)), 0.036 / (len(plate.lower) - 1)


def sliding_options(level):
    """Rows of the force as close as the roughness needs them."""
    rows = sliding_study.STEPS_PER_ROW * SLIDING_STEP / level
    return (NO_STATES, f"p:dtforc={rows:.17g}")


def judge_sliding(folder, level, _series):
    """Roughness of the force (see studies/sliding.py)."""
    found = sliding_study.force_peaks(*sliding_study.vertical_force(folder), level)
    return {"roughness": found.rms}


def judge_collision(folder, _level, _series):
    """Largest deviation of the energy ratio from 1."""
    ratio = read_csv(folder / "collision.glstat.csv")["energy_ratio"]
    return {"energy_error": float(np.abs(ratio - 1.0).max())}


SCENES = {
    "patch": Scene(
        "Patch test", patch_deck, lambda level: 1.0e6 / level, (1.0 / 7.0, 1.0 / 5.0), judge_patch,
        (Measure("pressure_error", "p/p0, largest deviation from 1", ROUND_OFF),),
        levels=(1, 2, 4), quick_levels=(1, 2), options=lambda _: (), turns=3, cost=0.05),
    "block": Scene(
        "Block-to-block", block_deck, lambda level: block_study.PENALTY / level,
        (10.0 / 51.0, 10.0 / 50.0), judge_block,
        (Measure("pressure_error", "p/p1D, largest deviation from 1", ROUND_OFF),),
        levels=(1, 2, 4), quick_levels=(1, 2), options=lambda _: (f"p:dt={BLOCK_STEP}",), turns=3,
        cost=0.2, power=1.0),
    "hertz": Scene(
        "Hertz", scenes.hertz, lambda _: HERTZ_PENALTY, (CYLINDER_CELL, BLOCK_CELL), judge_hertz,
        (Measure("profile_error", "distance of p from the ellipse over p0", FINITE_STRAIN),
         Measure("half_width_error", "half width, deviation from Hertz", FINITE_STRAIN)),
        levels=(1, 2, 4), cost=0.2),
    "sliding": Scene(
        "Sliding", scenes.sliding, lambda level: 10.0e9 / level, sliding_lengths(), judge_sliding,
        (Measure("force_error", "force, rms difference over the mean"),
         Measure("roughness", "roughness of the force over the mean")),
        levels=(1, 2, 3), options=sliding_options, references=(2, 3, 6), quick_references=(1, 2),
        cost=1.4, power=2.5),
    "collision": Scene(
        "Collision", scenes.collision, lambda level: 1.0e9 / level, (0.020 / 24.0, 0.025 / 20.0),
        judge_collision,
        (Measure("plastic_error", "plastic work by column, difference"),
         Measure("total_work_error", "plastic work in total, difference"),
         Measure("rebound_error", "rebound, difference over the impact"),
         Measure("energy_error", "energy ratio, largest deviation from 1")),
        levels=(1, 2, 3, 4), quick_levels=(1, 2), references=(2, 4, 6),
        quick_references=(1, 2, 4), cost=0.2, power=2.3),
}
