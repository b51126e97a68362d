# SPDX-License-Identifier: MIT
"""The scenes of Kang, Lee & Shin (2023) with all contact types: what they give, and what contact costs.

Runs that are timed (role `time`) write little and run alone, in turn; those whose results are read (role `result`) run
once. Type 1 is always timed, since the others are compared with it.
"""
from slideline_tools import scenes
from slideline_tools.scenes.patch import patch
from slideline_tools.studies import block, collision, patch as patch_study, sliding
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.times import phases
from slideline_tools.studies.paper.costs import SCENES
from slideline_tools.studies.paper.page import chart, page

QUICK_PENALTIES = (1.0e6,)


def jobs(options):
    """All runs of one round."""
    return patch_jobs(options) + scene_jobs(options) + timed_jobs(options)


def patch_jobs(options):
    """Every mesh, penalty and type; the quick study has one penalty."""
    listed = []
    for layout, (*_, penalties) in patch_study.LAYOUTS.items():
        for penalty in QUICK_PENALTIES if options.quick else penalties:
            deck = patch(penalty=penalty, grids=patch_study.layout_grids(layout))
            listed += [result(f"patch_{layout}_{penalty:.0e}_type_{ctype}".replace("+", ""), deck, "patch", 1, ctype,
                              cost=0.3, mesh=layout, penalty=penalty) for ctype in options.types]
    return listed


def meshes(options):
    """Name, scene, level and deck of blocks, sliding and collision."""
    return ((name, scene, level, scene.deck(level)) for name, scene in SCENES.items() for level in scene.levels
            if level in options.levels)


def scene_jobs(options):
    """Blocks, sliding and collision with their output; the sliding with slave and master exchanged too."""
    listed = []
    for name, scene, level, deck in meshes(options):
        words = (f"p:dtforc={4.0e-7 / level:.17g}",) if name == "sliding" else ()
        listed += [result(f"{name}_{level}_type_{ctype}", deck, name, level, ctype, words,
                          cost=scene.cost * level ** 3) for ctype in options.types]
    if 5 in options.types and 1 in options.levels:
        listed.append(result("exchanged_1_type_5", scenes.sliding(exchanged=True), "exchanged", 1, 5, cost=15.0))
    return listed


def result(name, deck, scene, level, ctype, words=(), cost=1.0, **labels):
    """A run whose results are read."""
    return Job(name, deck, JOBS[scene], (f"ctype={ctype}", "ncpu=1", *words),
               {"scene": scene, "role": "result", "level": level, "type": ctype, **labels}, once=True, cost=cost)


#: Stem of the files of a scene.
JOBS = {"patch": "patch", "block": "block", "block_implicit": "block", "sliding": "sliding", "exchanged": "sliding",
        "collision": "collision"}


def timed_jobs(options):
    """Each scene, level and type with little output; the quick study cuts the sliding short."""
    return [Job(f"time_{name}_{level}_type_{ctype}", deck, JOBS[name],
                (f"ctype={ctype}", "ncpu=1", *scene.options, *(scene.quick * options.quick)),
                {"scene": name, "role": "time", "level": level, "type": ctype}, group=f"time_{name}_{level}",
                alone=True, turns=max(1, scene.turns // level), cost=scene.cost * level ** 3)
            for name, scene, level, deck in meshes(options) for ctype in sorted({1, *options.types})]


def measure(job, folder):
    """Seconds by phase of a timed run, else what the scene is judged by."""
    scene, level, ctype = (job.labels[name] for name in ("scene", "level", "type"))
    if job.labels["role"] == "time":
        return phases(folder / f"{job.jobid}.timing.csv")
    if scene == "patch":
        return patch_study.measure(folder, job.labels["mesh"])
    if scene == "collision":
        return collision.measure(folder)
    if scene == "exchanged":
        return sliding.point_counts(sliding.added_points(folder))
    if scene == "sliding":
        return sliding.measure(folder, level, ctype)
    return block.measure(folder, ctype, implicit=scene == "block_implicit")


STUDY = Study("paper", jobs, measure, chart, page=page, levels=(1, 2, 3, 4), repeats=3, quick_repeats=1)
