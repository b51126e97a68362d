# SPDX-License-Identifier: MIT
"""Stability maps: what becomes of each contact type, and of implicit penalty (PUNIT 4), over penalty and time step.

The penalty is given over the stiffness K L/A of the elements behind the interface (PUNIT 2, PUNIT 4), the step over
the smallest L/c of the elements (TSSFAC, a constant step being refused above it).
"""
from __future__ import annotations

import re

import numpy as np
import pandas as pd

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES, IMPLICIT
from slideline_tools.studies.framework.charts import save, styled
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.table import records
from slideline_tools.studies.stability import measures
from slideline_tools.studies.stability.failing import keep_failing
from slideline_tools.studies.stability.page import NO_COMPLIANCE, draw_maps, write_maps_page
from slideline_tools.studies.stability.scenes import SCENES

DECADES = np.arange(-2.0, 4.01, 0.5)          # log10 of penalty over K L/A; what is softer penetrates as at 1e-2
QUICK_DECADES = np.arange(-2.0, 4.01, 2.0)
STEPS = (0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0, 1.2, 1.5)  # over L/c
QUICK_STEPS = (0.2, 0.7, 1.2)
IMPLICIT_STEPS = (*STEPS[:6], 0.995, *STEPS[7:])  # below L/c, where the elements themselves are stable
QUICK_IMPLICIT_STEPS = (0.2, 0.995, 1.2)
STOCK = 0.1                                   # SLSFAC: PUNIT 2 multiplies K L/A by it
NO_CURVE = 1.0e3                              # s: a constant step that no element allows
RULE = "*CONTROL_CONTACT\n\n0,0,0,0,0,0,2\n*CONTROL_ENERGY"
LIMIT_TIME = 1.0e-9                           # s: one cycle
PATIENCE = 120.0                              # s for a run


def jobs(options):
    """Each scene and type over penalties and steps, and one cycle per penalty for the program's limit."""
    listed = []
    decades = QUICK_DECADES if options.quick else DECADES
    steps = QUICK_STEPS if options.quick else STEPS
    for name, scene in SCENES.items():
        if options.quick and name == "sliding":
            continue
        for ctype in (one for one in options.types if one != IMPLICIT):
            deck = scene.deck(ctype)
            ruled = deck.replace("*CONTROL_ENERGY", RULE)
            for decade in decades:
                common = (f"ctype={ctype}", "punit=2", f"pen={10.0 ** decade / STOCK:.10g}",
                          f"dt={NO_CURVE:g}", "ncpu=1", *scene.options)
                labels = {"scene": name, "type": ctype, "decade": float(decade)}
                stem = f"{name}_type_{ctype}_pen_1e{decade:+.1f}"
                if decade == int(decade):
                    listed.append(Job(f"{stem}_limit", ruled, name,
                                      (*common, "tssfac=1", f"endtim={LIMIT_TIME:g}"),
                                      {**labels, "kind": "limit"}, cost=0.1))
                listed += [map_job(stem, deck, common, labels, step) for step in steps]
        if IMPLICIT in options.types:
            listed += implicit_jobs(name, scene, decades, QUICK_IMPLICIT_STEPS if options.quick else IMPLICIT_STEPS)
    return listed


def map_job(stem, deck, common, labels, step):
    """One cell of a map."""
    scene = SCENES[labels["scene"]]
    return Job(f"{stem}_dt_{step:g}", deck, labels["scene"], (*common, f"tssfac={step:g}", f"endtim={scene.end:g}"),
               {**labels, "kind": "map", "step": step}, cost=0.2 / step, limit=PATIENCE)


def implicit_jobs(name, scene, decades, steps):
    """The cells of implicit penalty, those without compliance last. It has no limit of its own to ask for."""
    listed, deck = [], scene.deck(7)
    for decade in (*decades, NO_COMPLIANCE):
        pen = -1.0 if decade == NO_COMPLIANCE else 10.0 ** decade
        common = ("ctype=7", "punit=4", f"p:pen={pen:.10g}", f"dt={NO_CURVE:g}", "ncpu=1", *scene.options)
        stem = f"{name}_type_{IMPLICIT}_pen_" + ("none" if pen < 0.0 else f"1e{decade:+.1f}")
        labels = {"scene": name, "type": IMPLICIT, "decade": float(decade)}
        listed += [map_job(stem, deck, common, labels, step) for step in steps]
    return listed


def measure(job, folder):
    """The verdict of a run, or the limits that the program found."""
    scene = SCENES[job.labels["scene"]]
    if job.labels["kind"] == "map":
        return measure_cell(folder, job.jobid, scene)
    text = (folder / f"{job.jobid}.log").read_text(encoding="utf-8")
    found = [re.search(pattern, text) for pattern in
             (r"per slave node = (\S+) N/m\^2", r"smallest L/c of the elements (\S+)",
              r"stable step of elements and contact springs (\S+)")]
    if not all(found):
        raise UserError("no limits in the log")
    penalty, element, joint = (float(match.group(1)) for match in found)
    return {"penalty": penalty, "element_limit": element, "program_limit": joint / element}


def measure_cell(folder, jobid, scene):
    """The verdict of a run; one that is stable by the energy law alone is limited."""
    row = measures.measure_run(folder, jobid, scene)
    row["cut"] = measures.cut_share((folder / f"{jobid}.log").read_text(encoding="utf-8"))
    if row["verdict"] == measures.VERDICTS[measures.STABLE] and row["cut"] > measures.CUT_SHARE:
        row["verdict"] = measures.VERDICTS[measures.LIMITED]
    return row


def derive(rows, folder):
    """The limits by eigenvalue beside the program's: of all that stays closed, 2/omega of the contact
    springs alone, half of it for springs that open and close, and the smaller of the first and the last."""
    del folder
    rows = records(rows)
    for row in rows:
        if row["kind"] == "limit" and "penalty" in row:
            scene = SCENES[row["scene"]]
            limits = [scene.limit(row["type"], row["penalty"], with_elements) / row["element_limit"]
                      for with_elements in (True, False)]
            row["true_limit"], row["spring_limit"] = limits
            row["opening_limit"] = 0.5 * limits[1]
            row["both_limits"] = min(row["true_limit"], row["opening_limit"])
    return pd.DataFrame(rows)


def mark_below(rows):
    """`below_limit`: the step lies below the program's limit for that penalty; with PUNIT 4 that is L/c."""
    for row in rows:
        if row["type"] == IMPLICIT and "verdict" in row:
            row["below_limit"] = row["step"] < 1.0
    for (scene, ctype) in {(row["scene"], row["type"]) for row in rows}:
        limits = sorted((row["decade"], row["program_limit"]) for row in rows if "program_limit" in row
                        and (row["scene"], row["type"]) == (scene, ctype))
        if not limits:
            continue
        for row in rows:
            if (row["scene"], row["type"]) == (scene, ctype) and "verdict" in row:
                row["below_limit"] = row["step"] < np.interp(row["decade"], *zip(*limits))
    return rows


def chart(rows, folder):
    """Maps of each scene; decks of failing cells."""
    rows = records(rows)
    keep_failing(rows, folder)
    mark_below(rows)
    for name in SCENES:
        chosen = [row for row in rows if row["scene"] == name]
        if any("verdict" in row for row in chosen):
            with styled():
                save(draw_maps({name: chosen}), folder, f"maps_{name}")


def page(rows, doc):
    """doc/studies/stability.md and its pictures."""
    write_maps_page(mark_below(records(rows)), doc)


STUDY = Study("stability", jobs, measure, chart, derive, page, types=(*ALL_TYPES, IMPLICIT))
