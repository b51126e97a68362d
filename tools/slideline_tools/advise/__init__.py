# SPDX-License-Identifier: MIT
"""What in the model of a finished run was not needed, with the expected saving.

    from slideline_tools.advise import advise
    run, advice, notes = advise("results/collision")

Every check says nothing unless the files of the run prove its point; its thresholds stand at the
top of its module (bodies, touching, rubbing, running; doc/studies/simplify.md lists them).
"""
from slideline_tools.advise import bodies, rubbing, running, touching
from slideline_tools.advise.finished import Finished
from slideline_tools.advise.report import Advice

CHECKS = bodies.CHECKS + touching.CHECKS + rubbing.CHECKS + running.CHECKS


def advise(path) -> tuple[Finished, list[Advice], list[str]]:
    """The run at `path` (its folder or a file of it), all advice, and what was not judged."""
    run = Finished(path)
    if not run.ended:
        return run, [], ["anything: the run did not end normally"]
    if run.seconds_of("loop") == 0.0:
        return run, [], ["anything: the run was not timed by phase (timing=off)"]
    advice = [item for check in CHECKS for item in check(run)]
    return run, advice, not_judged(run)


def not_judged(run: Finished) -> list[str]:
    """What could not be looked at, and why."""
    notes = []
    if run.results is None:
        notes.append("strains, stresses and symmetry: no states of the run")
    if run.model is None:
        notes.append("parts, interfaces and bulk viscosity: no program reads the deck as run")
    if run.interfaces and "rcforc" not in run.tables:
        notes.append("interfaces: no rcforc (*DATABASE_RCFORC)")
    if "matsum" not in run.tables:
        notes.append("rigid parts: no matsum (*DATABASE_MATSUM)")
    if run.is_implicit:
        notes.append("contact types and bulk viscosity: an implicit run")
    return notes
