# SPDX-License-Identifier: MIT
"""The loop: runs on finer meshes until every quantity is within its uncertainty, or the budget or the mesh says no."""
import dataclasses
import math
import time
import typing

import numpy as np

from slideline_tools import UserError
from slideline_tools.answer.estimate import Estimate, estimate
from slideline_tools.answer.meshes import AdaptedMeshes, Meshes, MeshRun
from slideline_tools.answer.quantity import Quantity
from slideline_tools.names import counted
from slideline_tools.program import STOPPED, RunError

FIRST = (1, 2, 3)          # meshes that are always run, as far as the budget goes
EXPLICIT = 3.0             # seconds go with this power of the mesh factor where two runs cannot tell
SHORT = 0.1                # seconds of a run that tell nothing of that
MOST = 2                   # times finer than the finest at a step, since no prediction is sure
MANY = 1000                # more than any mesh that is run
BUDGET = 600.0             # seconds, where none are given
PATIENCE = 1.5             # times the seconds left after which a run is stopped


@dataclasses.dataclass
class Answer:
    """What is known of one quantity: its estimate, its value in each run, and why the loop ended."""

    quantity: Quantity
    values: list[float]
    estimate: Estimate
    within: bool | None
    reason: str = ""


@dataclasses.dataclass
class Answers:
    """The answers of one loop; `reached` where all are within what was asked for, `failure` where a run ended it."""

    answers: list[Answer]
    runs: list[MeshRun]
    contact_type: int | None = None
    failure: RunError | None = None

    @property
    def reached(self) -> bool:
        """Whether all are within."""
        return all(one.within is not False for one in self.answers) and all(math.isfinite(one.estimate.uncertainty) for one in self.answers)

    @property
    def seconds(self) -> float:
        """Seconds of all runs."""
        return sum(run.seconds for run in self.runs)


def find(meshes: Meshes, quantities: typing.Sequence[Quantity], within: float | None, budget: float | None,
         most: float = math.inf) -> Answers:
    """Run until all `quantities` are known to the share `within`, or for `budget` seconds, or on `most` meshes."""
    runs: list[MeshRun] = []
    spent, limit = 0.0, budget if budget is not None else BUDGET
    factor, reason = FIRST[0], ""
    while factor:
        about = f": about {seconds_of(runs, factor):.2g} s" if runs and not isinstance(meshes, AdaptedMeshes) else ""
        meshes.tell(f"mesh {factor}{about}")
        begin = time.monotonic()
        try:
            run = meshes.run(factor, PATIENCE * (limit - spent))
        except (RunError, KeyboardInterrupt) as problem:
            if not runs:
                raise
            found.failure = problem if isinstance(problem, RunError) and not is_stopped(problem) else None
            reason = f"mesh {factor} ended it: {problem}{' (--seconds)' * (found.failure is None)}" if str(problem) else f"stopped in mesh {factor}"
            break
        if runs and run.elements <= runs[-1].elements:
            raise UserError(f"{meshes.deck}: with {meshes.parameter} = {factor} the mesh stays as it is ({counted(run.elements, 'element')})")
        values = [quantity.of(run.outcome) for quantity in quantities]
        runs.append(run)
        spent += 0.0 if run.kept else time.monotonic() - begin  # with the division of the mesh
        meshes.tell(f"mesh {factor}: {counted(run.elements, 'element')}, {run.updates:.3g} updates, "
             + (f"kept, took {run.seconds:.2g} s" if run.kept else f"{run.seconds:.2g} s") + "; "
             + ", ".join(f"{value:.6g}" for value in values))
        found = judged(quantities, runs, within)
        further = following_adapted if isinstance(meshes, AdaptedMeshes) else following
        factor, reason = further(found, runs, within, limit - spent) if len(runs) < most else (0, "")
    for one in found.answers:
        one.reason = reason_of(one, within) if one.within else reason or reason_of(one, within)
    return found


def is_stopped(problem: RunError) -> bool:
    """Whether a run was stopped, as one that takes too long."""
    return problem.outcome is not None and problem.outcome.status == STOPPED


def judged(quantities, runs, within) -> Answers:
    """The estimates from these runs."""
    answers = []
    for quantity in quantities:
        values = [quantity.of(run.outcome) for run in runs]
        found = estimate([run.mesh for run in runs], values)
        answers.append(Answer(quantity, values, found, None if within is None else bool(len(values) >= FIRST[-1] and found.relative <= within)))
    return Answers(answers, runs)


def following(found: Answers, runs, within, left) -> tuple[int, str]:
    """The next mesh, 0 for none, and why there is none."""
    last = runs[-1].mesh
    affordable = finest_affordable(runs, left)
    if last < FIRST[-1]:
        if affordable > last:
            return last + 1, ""
        return 0, f"the budget ends with mesh {last}: mesh {last + 1} takes about {seconds_of(runs, last + 1):.2g} s, {max(left, 0.0):.2g} s are left"
    if within is None:
        step = min(affordable, MOST * last)
        return (step, "") if step > last else (0, f"the budget is used: mesh {last + 1} takes about {seconds_of(runs, last + 1):.2g} s")
    open_ones = [one for one in found.answers if not one.within]
    if not open_ones:
        return 0, ""
    if any(one.estimate.value == 0.0 for one in open_ones):
        return 0, "its value is 0, of which there is no share"
    wanted = [one.estimate.needed(within, last) for one in open_ones]
    unsure = any(mesh is None or not one.estimate.is_sure for one, mesh in zip(open_ones, wanted))
    target = last * MOST if None in wanted else max(last + 1, math.ceil(min(max(wanted), MANY) - 1e-6))
    needs = seconds_of(runs, target)
    step = min(target, MOST * last, affordable)
    if step > last and (unsure or needs <= left):
        return step, ""
    return 0, (f"{'perhaps ' * unsure}mesh {target} would do, in about {needs:.2g} s "
               f"({runs[-1].updates * (target / last) ** EXPLICIT:.2g} element updates); {max(left, 0.0):.2g} s are left (--seconds)")


def following_adapted(found: Answers, runs, within, left) -> tuple[int, str]:
    """The number of the next run on a mesh that is finer where it pays, 0 for none, and why there is none."""
    if len(runs) >= FIRST[-1] and within is not None and all(one.within for one in found.answers):
        return 0, ""
    growth = max(runs[-1].seconds / runs[-2].seconds, 1.0) if len(runs) > 1 else EXPLICIT
    needs = growth * runs[-1].seconds
    if needs > left:
        return 0, f"the budget ends: the next mesh takes about {needs:.2g} s, {max(left, 0.0):.2g} s are left (--seconds)"
    return len(runs) + 1, ""


def reason_of(one: Answer, within) -> str:
    """Why the answer is what it is."""
    if not math.isfinite(one.estimate.uncertainty):
        return "one mesh tells no uncertainty"
    how = (f"order {one.estimate.order:.2g} on {len(one.values)} meshes" if one.estimate.order is not None else
           "two meshes, whose order is not known" if len(one.values) < FIRST[-1] else
           "the values of the last three meshes go to and fro: their range")
    return f"within {100.0 * within:g} %: {how}" if one.within else how


def seconds_of(runs, factor) -> float:
    """Seconds that a run on a mesh will take, by those before."""
    if not runs:
        return 0.0
    last, power = runs[-1], EXPLICIT
    if len(runs) > 1 and runs[-2].seconds > SHORT:
        power = float(np.clip(math.log(last.seconds / runs[-2].seconds) / math.log(last.mesh / runs[-2].mesh), 1.0, 4.0))
    return last.seconds * (factor / last.mesh) ** power


def finest_affordable(runs, left) -> int:
    """The finest mesh that a run can have in the seconds left; the last where none is."""
    factor = runs[-1].mesh
    while seconds_of(runs, factor + 1) <= left and factor < MANY:
        factor += 1
    return factor
