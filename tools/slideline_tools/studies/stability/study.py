# SPDX-License-Identifier: MIT
"""Stability maps: what becomes of each type, and of implicit penalty, over penalty and step.

The penalty is given over the stiffness K L/A of the elements behind the interface (PUNIT 2,
PUNIT 4), the step over the smallest L/c of the elements (TSSFAC, a constant step being refused
above it).
"""
import itertools
import re

import numpy as np

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES, IMPLICIT
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.stability import measures
from slideline_tools.studies.stability.page import NO_COMPLIANCE, chart, page
from slideline_tools.studies.stability.scenes import SCENES

DECADES = np.arange(-2.0, 4.01, 0.5)  # log10 of penalty over K L/A; the quick study has those that are a multiple of 2
STEPS = (0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0, 1.2, 1.5)  # over L/c
QUICK_STEPS = (0.2, 0.7, 1.2)
IMPLICIT_STEPS = (*STEPS[:6], 0.995, *STEPS[7:])  # below L/c, where elements themselves are stable
QUICK_IMPLICIT_STEPS = (0.2, 0.995, 1.2)
STOCK = 0.1          # SLSFAC: PUNIT 2 multiplies K L/A by it
NO_CURVE = 1.0e3     # s: a constant step that no element allows
RULE = "*CONTROL_CONTACT\n\n0,0,0,0,0,0,2\n*CONTROL_ENERGY"  # ECDT 2: the log tells the limit
LIMIT_TIME = 1.0e-9  # s: one cycle
PATIENCE = 120.0     # s for a run
IN_LOG = (r"per slave node = (\S+)", r"smallest L/c of the elements (\S+)", r"stable step of elements and contact springs (\S+)")


def jobs(options):
    """Each scene and type over penalties and steps, and a cycle a penalty for the limit, which
    implicit penalty has none of."""
    listed = []
    names = [name for name in SCENES if not (options.quick and name == "sliding")]
    for name, ctype in itertools.product(names, options.types):
        scene, is_implicit = SCENES[name], ctype == IMPLICIT
        deck = scene.deck(7 if is_implicit else ctype)
        steps = ((QUICK_IMPLICIT_STEPS if is_implicit else QUICK_STEPS) if options.quick else
                 IMPLICIT_STEPS if is_implicit else STEPS)
        for decade in (*DECADES[::4 if options.quick else 1], *[NO_COMPLIANCE] * is_implicit):
            words = (*penalty_words(ctype, decade), f"dt={NO_CURVE:g}", "ncpu=1",
                     *scene.options)
            stem = f"{name}_type_{ctype}_pen_" + (
                "none" if decade == NO_COMPLIANCE else f"1e{decade:+.1f}")
            labels = {"scene": name, "type": ctype, "decade": float(decade)}
            if decade == int(decade) and not is_implicit:
                listed.append(Job(
                    f"{stem}_limit", deck.replace("*CONTROL_ENERGY", RULE), name,
                    (*words, "tssfac=1", f"endtim={LIMIT_TIME:g}"), {**labels, "kind": "limit"},
                    cost=0.1))
            listed += [Job(f"{stem}_dt_{step:g}", deck, name,
                           (*words, f"tssfac={step:g}", f"endtim={scene.end:g}"),
                           {**labels, "kind": "map", "step": step}, cost=0.2 / step, limit=PATIENCE)
                       for step in steps]
    return listed


def penalty_words(ctype, decade):
    """Type and penalty on the command line; PEN below 0 has no compliance."""
    if ctype == IMPLICIT:
        pen = -1.0 if decade == NO_COMPLIANCE else 10.0 ** decade
        return ("ctype=7", "punit=4", f"p:pen={pen:.10g}")
    return (f"ctype={ctype}", "punit=2", f"pen={10.0 ** decade / STOCK:.10g}")


def measure(job, folder):
    """The verdict of a run, or the limit that the program found."""
    if job.labels["kind"] == "map":
        return measures.measure_cell(folder, job.jobid, SCENES[job.labels["scene"]])
    log = (folder / f"{job.jobid}.log").read_text(encoding="utf-8")
    found = [re.search(pattern, log) for pattern in IN_LOG]
    if not all(found):
        raise UserError("no limits in the log")
    penalty, element_limit, joint = (float(match[1]) for match in found)
    return {"penalty": penalty, "element_limit": element_limit, "program_limit": joint / element_limit}


def derive(table, _folder):
    """With the limits by eigenvalue over L/c, and which cells lie below the program's limit."""
    return with_below(with_limits(table))


def with_limits(table):
    """`true_limit` of all that stays closed, `spring_limit` = 2/omega of the springs alone,
    `opening_limit`, half of it, for springs that open and close, and `both_limits`, the smaller."""
    known = table[table["penalty"].notna()]
    for column, with_elements in (("true_limit", True), ("spring_limit", False)):
        limits = [SCENES[row.scene].limit(row.type, row.penalty, with_elements) / row.element_limit
                  for row in known.itertuples()]
        table.loc[known.index, column] = limits
    table["opening_limit"] = 0.5 * table["spring_limit"]
    table["both_limits"] = table[["true_limit", "opening_limit"]].min(axis=1)
    return table


def with_below(table):
    """`below_limit`: the step lies below the program's limit for that penalty, which is L/c with
    PUNIT 4; missing where the limit is not known."""
    for (_, ctype), rows in table.groupby(["scene", "type"], sort=False):
        cells = rows[rows["kind"] == "map"]
        limits = rows.set_index("decade")["program_limit"].dropna().sort_index()
        if ctype == IMPLICIT:
            table.loc[cells.index, "below_limit"] = cells["step"] < 1.0
        elif len(limits):
            bound = np.interp(cells["decade"], limits.index, limits)
            table.loc[cells.index, "below_limit"] = cells["step"] < bound
    return table


STUDY = Study("stability", jobs, measure, chart, derive, page, types=(*ALL_TYPES, IMPLICIT))
