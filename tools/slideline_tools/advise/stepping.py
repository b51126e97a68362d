# SPDX-License-Identifier: MIT
"""Advice on the time step, the penalty and the number of threads (explicit runs)."""
from __future__ import annotations

import re

import numpy as np

from slideline_tools.advise import geometry
from slideline_tools.advise.report import Advice
from slideline_tools.advise.surfaces import read_surfaces, spring_limit

SAFETY = 0.9
# Step that the limits allow over the step of the run from which a longer step is worth a word.
LONGER_STEP = 1.1
# Springs dictate the step when elements alone would allow so many times more.
PENALTY_RULES = 1.3
# Deepest penetration over the shorter mean segment that a softer penalty may give.
DEEPEST = 0.01
# Elements a thread below which a further thread hardly pays (two threads took 0.7 of the time of
# one at 300 elements and 0.5 at 4000).
ELEMENTS_A_THREAD = 250


def mean_step(run) -> float:
    """End time over cycles, s; 0 when unknown."""
    glstat = run.tables.get("glstat")
    if glstat is None or len(glstat) < 2 or glstat["cycle"][-1] <= glstat["cycle"][0]:
        return 0.0
    return float((glstat["time"][-1] - glstat["time"][0])
                 / (glstat["cycle"][-1] - glstat["cycle"][0]))


def unknown_limits(run) -> str:
    """Why the step limits of elements or springs cannot be known; empty when they can."""
    interfaces = run.log.interfaces.values()
    if automatic := [str(one.id) for one in interfaces if one.stable_share]:
        return f"the penalty follows the step (PUNIT 3, interface {', '.join(automatic)})"
    if run.results is None:
        return "no states of the run"
    if run.log.element_limit <= 0.0:
        return "the log has no smallest L/c of the elements"
    if moving := [str(number) for number in run.log.own_speeds]:
        return f"the wave speed follows the equation of state (material {', '.join(moving)})"
    if unread := [str(one.id) for one in interfaces if not one.slave_penalty > 0.0]:
        return f"the log has no penalty of interface {', '.join(unread)}"
    if len(read_surfaces(run)) < len(run.log.interfaces):
        return "the surfaces of some interface are not known (it touches itself, or no program reads the deck as run)"
    if not np.isfinite(geometry.smallest_limit_ratio(run)):
        return "the log has no wave speed of some material"
    mass = geometry.lumped_mass(run)
    if not np.all(np.isfinite(mass)) or not mass.min() > 0.0:
        return "the mass of some node is unknown or zero"
    return ""


def limits(run) -> tuple[float, float] | None:
    """Smallest step limit of the elements over all states, and that of the springs of all
    interfaces (inf without any); None when one of them cannot be known."""
    if run.is_implicit or unknown_limits(run):
        return None
    shrunk, mass = geometry.smallest_limit_ratio(run), geometry.lumped_mass(run)
    surfaces = read_surfaces(run)
    springs = [spring_limit(run, run.log.interfaces[number], pair, mass)
               for number, pair in surfaces.items()]
    # Squares of frequencies add up at most.
    together = 1.0 / np.sqrt(sum(1.0 / limit ** 2 for limit in springs)) if springs else np.inf
    return min(shrunk, 1.0) * run.log.element_limit, float(together)


def combined(elements: float, springs: float) -> float:
    """Step limit of elements and springs together, s: springs that stay closed, and springs that
    open and close (half of 2/omega)."""
    return min(1.0 / np.sqrt(1.0 / elements ** 2 + 1.0 / springs ** 2), 0.5 * springs)


def how_to_step(run, step: float) -> str:
    """What to write for a longer step."""
    if run.log.capped:
        return f"the curve LCTM of *CONTROL_TIMESTEP (command line: dt={step:.3g})"
    return f"TSSFAC of *CONTROL_TIMESTEP (command line: tssfac={step / run.log.element_limit:.2g})"


def short_steps(run) -> list[Advice]:
    """Steps that stay far below what elements and springs allow."""
    known, step = limits(run), mean_step(run)
    if known is None or step <= 0.0:
        return []
    elements, springs = known
    allowed = SAFETY * combined(elements, springs)
    if allowed < LONGER_STEP * step:
        return []
    with_springs = "" if springs == np.inf else f", of the contact springs {springs:.3g}"
    return [Advice(
        "short steps", f"The time step could be {allowed / step:.2f} times longer.",
        f"mean step {step:.3g}; smallest limit of the elements at {len(run.results.times)} states "
        f"{elements:.3g}{with_springs}, together {allowed / SAFETY:.3g}",
        f"a step of {allowed:.3g}: {how_to_step(run, allowed)}",
        run.seconds_of("loop") * (1.0 - step / allowed),
        f"fewer cycles, with {1.0 - SAFETY:.0%} of the limit to spare")]


def ruling_penalty(run) -> list[Advice]:
    """A penalty that forbids the step of the elements and could be softer."""
    known, step, table = limits(run), mean_step(run), run.tables.get("contact")
    if known is None or step <= 0.0 or table is None:
        return []
    elements, springs = known
    present = combined(elements, springs)
    if elements < PENALTY_RULES * present:
        return []
    limit = elements / PENALTY_RULES ** 0.5
    factor = springs ** 2 * min(1.0 / limit ** 2 - 1.0 / elements ** 2, 0.25 / limit ** 2)
    shortest = min(min(one.slave_length, one.master_length) for one in run.log.interfaces.values())
    pressed = table["pressure"] != 0.0
    if not pressed.any():
        return []
    deepest = float(-table["gap"][pressed].min()) / factor
    allowed = SAFETY * limit
    if allowed < LONGER_STEP * max(step, SAFETY * present) or deepest > DEEPEST * shortest:
        return []
    return [Advice(
        "penalty rules the step", f"A penalty {factor:.2g} times the present one would allow a "
        f"step {allowed / step:.2f} times longer.",
        f"mean step {step:.3g}; limit of the elements {elements:.3g}, of the contact springs "
        f"{springs:.3g}; the deepest penetration at a state would grow to {deepest:.2g}, "
        f"{deepest / shortest:.1%} of a segment",
        f"PEN times {factor:.2g} on the contact card and a step of {allowed:.3g}: "
        f"{how_to_step(run, allowed)}",
        run.seconds_of("loop") * (1.0 - step / allowed), "fewer cycles")]


def many_threads(run) -> list[Advice]:
    """More threads than the mesh feeds."""
    found = re.search(r"\bncpu=(\d+)", run.options)
    threads = int(found[1]) if found else 1
    enough = max(1, -(-run.n_element // ELEMENTS_A_THREAD))
    if threads <= enough:
        return []
    return [Advice(
        "threads", f"{threads} threads are more than this mesh feeds.",
        f"{run.n_element} elements, {run.n_element // threads} a thread",
        f"ncpu={enough} on the command line; the results have the same bits", None,
        f"{threads - enough} cores free for {run.total:.2g} s")]


CHECKS = (short_steps, ruling_penalty, many_threads)
