# SPDX-License-Identifier: MIT
"""Speed against accuracy with friction: partial slip against its closed form, ironing against a finer mesh."""
import numpy as np

from slideline_tools.studies.framework.charts import save, styled
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.framework.times import phases
from slideline_tools.studies.speed_accuracy.reference import REFERENCE_TYPE, force_distance, own_error
from slideline_tools.studies.speed_accuracy_friction.decks import ironing, rolled_aside
from slideline_tools.studies.speed_accuracy_friction.measures import forces_along, judge_ironing, judge_rolled
from slideline_tools.studies.speed_accuracy_friction.page import draw_points, write_friction_page

REFERENCE_LEVELS = (1, 2, 3)   # of type 7
#: Scene: deck, levels, seconds of a run at level 1, power of the level by which they grow.
SCENES = {"partial_slip": (rolled_aside, (1, 2, 3), 0.5, 2.8), "ironing": (ironing, (1, 2), 1.2, 2.8)}
TIMED = {"partial_slip": 0, "ironing": 2}  # finest level that is timed more than once: static runs cost by their iterations


def jobs(options):
    """Each scene, level and type; the reference of ironing once."""
    listed = []
    for scene, (_, levels, _, _) in SCENES.items():
        chosen = [level for level in levels if level in options.levels]
        for level in chosen:
            listed += [job(scene, level, ctype, "sweep") for ctype in options.types]
        if scene == "ironing" and chosen and not options.quick:
            listed.append(job(scene, REFERENCE_LEVELS[-1], REFERENCE_TYPE, "reference"))
    return listed


def job(scene, level, ctype, role):
    """One run."""
    write, _, seconds, power = SCENES[scene]
    return Job(f"{scene}_{level}_type_{ctype}", write(ctype, level), "run", ("ncpu=1",),
               {"scene": scene, "level": level, "type": ctype, "role": role}, alone=role == "sweep",
               group=f"{scene}_{level}", once=role != "sweep" or level > TIMED[scene], cost=seconds * level ** power)


def measure(one, folder):
    """Errors of one run, seconds by phase, how the program was built."""
    level = one.labels["level"]
    if one.labels["scene"] == "ironing":
        return judge_ironing(folder, one.jobid, level)
    return {**judge_rolled(folder, one.jobid), **phases(folder / f"{one.jobid}.timing.csv")}


def derive(rows, folder):
    """`force_error` of ironing against type 7 on the finest mesh, and what that is itself known to."""
    mine = [row for row in finished(rows) if row["scene"] == "ironing"]
    forces = {}
    for row in mine:
        forces.setdefault((row["type"], row["level"]), forces_along(folder / "runs" / row["run"], "run")[0])
    if not all((REFERENCE_TYPE, level) in forces for level in REFERENCE_LEVELS):
        return rows
    chain = [forces[REFERENCE_TYPE, level] for level in REFERENCE_LEVELS]
    _, floor = own_error(REFERENCE_LEVELS, [force_distance(one, other, chain[-1]) for one, other in zip(chain[:-1], chain[1:])])
    for row in mine:
        if row["role"] == "sweep":
            found = forces[row["type"], row["level"]]
            row["force_error"], row["force_error_floor"] = force_distance(found, chain[-1], chain[-1]), floor
            row["mean_error"] = float(abs(np.mean(found) / np.mean(chain[-1]) - 1.0))
    return rows


def chart(rows, folder):
    """Error over cost of both scenes."""
    if finished(rows):
        with styled():
            save(draw_points(rows), folder, "friction_speed_accuracy")


def page(rows, doc):
    """doc/studies/speed_accuracy_friction.md and its picture."""
    write_friction_page(rows, doc)


STUDY = Study("speed-accuracy-friction", jobs, measure, chart, derive, page, levels=(1, 2, 3), repeats=2, quick_levels=(1,))
