# SPDX-License-Identifier: MIT
"""Speed against accuracy: what each contact type, and implicit penalty (PUNIT 4), costs in each
scene, and how large its error is.

Every run is timed and judged; contact time and computing time are medians over rounds in which all
variants run in turn. See scenes.py for the scenes and their measures.
"""
from slideline_tools.contact_types import SERIES
from slideline_tools.results import read
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.times import phases
from slideline_tools.studies.speed_accuracy.charts import chart
from slideline_tools.studies.speed_accuracy.page import page
from slideline_tools.studies.speed_accuracy.reference import add_errors, reference_series
from slideline_tools.studies.speed_accuracy.scenes import SCENES, contact_options, net_moment


def jobs(options):
    """Each scene, level and type; before them, once, the finer meshes of the references."""
    references, listed = [], []
    for name, scene in SCENES.items():
        levels = [level for level in (scene.quick_levels if options.quick else scene.levels)
                  if level in options.levels]
        swept = {(ctype, level) for level in levels for ctype in options.types}
        wanted = scene.quick_references if options.quick else scene.references
        extra = {(reference_series(ctype), level) for ctype in options.types
                 for level in wanted if levels} - swept
        decks = {level: scene.deck(level) for _, level in swept | extra}
        references += [job(name, decks[level], level, ctype, "reference")
                       for ctype in SERIES for level in wanted if (ctype, level) in extra]
        listed += [job(name, decks[level], level, ctype, "sweep")
                   for level in levels for ctype in options.types]
    return references + listed


def job(name, deck, level, ctype, role):
    """One run; `role`: sweep or reference."""
    scene, swept = SCENES[name], role == "sweep"
    options = [*contact_options(scene, level, ctype), "ncpu=1", *scene.options(level)]
    return Job(f"{name}_{level}_type_{ctype}" + ("" if swept else "_reference"), deck, name, options,
               {"scene": name, "level": level, "type": ctype, "role": role}, alone=swept,
               group=f"{name}_{level}", turns=scene.turns if swept else 1, once=not swept,
               cost=scene.cost * level ** scene.power)


def measure(one, folder):
    """Seconds by phase, errors that need no reference, the net moment of the contact forces, and
    how the program was built."""
    level, ctype = one.labels["level"], one.labels["type"]
    scene = SCENES[one.labels["scene"]]
    results = read(folder / f"{one.jobid}.vtkhdf")
    return {**phases(folder / f"{one.jobid}.timing.csv"), **scene.judge(folder, level, ctype),
            "moment": net_moment(results, scene.lengths[0] / level),
            "build": f"slideline {results.run['version']}, {results.run['build']}"}


STUDY = Study("speed-accuracy", jobs, measure, chart, derive=add_errors, page=page,
              levels=(1, 2, 3, 4), types=tuple(SERIES), repeats=3, quick_levels=(1, 2))
