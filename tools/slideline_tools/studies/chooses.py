# SPDX-License-Identifier: MIT
"""CTYPE 0 beside the contact types by name: what it costs in retired instructions, and how large
its error is.

Each scene of speed-accuracy runs on its coarsest mesh with every type and with CTYPE 0 (without and
with targets): whole, and cut short and counted. Errors are those that the study speed-accuracy,
whose folder lies beside that of this one, has found for the type that CTYPE 0 took, whose files it
has to make byte for byte.
"""
import re

import pandas as pd

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.studies.common import label, markdown_table, page_of
from slideline_tools.studies.framework.job import Job, Study, counted_job
from slideline_tools.studies.framework.table import counted, finished, who_counted
from slideline_tools.studies.speed_accuracy.points import errors_of
from slideline_tools.studies.speed_accuracy.scenes import SCENES, node_penalty

CUT = {"patch": "endtim=0.4", "block": "endtim=0.05", "hertz": "endtim=5.0e-6",
       "sliding": "endtim=2.0e-4", "collision": "endtim=1.0e-4"}
QUICK = ("patch", "block")  # scenes
TARGETS = ("none", "0.6", "0.01")
SAME_ERROR = 1.05  # errors that differ by less count as equal
FILES = ("rcforc", "matsum", "contact")
CHOICE = re.compile(r"\(type (\d)\), chosen by the program")


def jobs(options):
    """Each scene with each type and with CTYPE 0, whole, and cut short and counted."""
    listed = []
    for scene in QUICK if options.quick else SCENES:
        variants = [(ctype, "none") for ctype in ALL_TYPES] + [(0, target) for target in TARGETS]
        deck = SCENES[scene].deck(1)
        listed += [job(scene, deck, *variant) for variant in variants]
    return listed + [counted_job(one, (CUT[one.labels["scene"]],)) for one in listed]


def job(scene, deck, ctype, target):
    """One run; the penalty of CTYPE 0 is that of the types with one pass."""
    penalty = node_penalty(SCENES[scene], 1, ctype)
    words = [f"ctype={ctype}", f"p:pen={penalty:.17g}", *SCENES[scene].options(1)]
    if target != "none":
        words.append(f"target={target}")
    return Job(f"{scene}_{ctype}_{target}", deck, options=words,
               labels={"scene": scene, "type": ctype, "target": target})


def measure(one, folder):
    """The type that CTYPE 0 took, by its log."""
    if one.labels["type"]:
        return {}
    chosen = CHOICE.search((folder / f"{one.jobid}.log").read_text(encoding="utf-8"))
    if not chosen:
        raise UserError("the log tells of no choice")
    return {"chosen": int(chosen[1])}


def known_errors(folder):
    """{scene: [{type: error in per cent with two digits} of each measure]}, coarsest mesh."""
    path = folder.with_name(folder.name.replace("chooses", "speed-accuracy")) / "speed-accuracy.csv"
    if not path.exists():
        raise UserError(f"{path} is missing: run tools/study.sh speed-accuracy")
    runs = finished(pd.read_csv(path))
    runs = runs[(runs["role"] == "sweep") & (runs["level"] == 1) & (runs["repeat"] == 1)]
    runs = runs[runs["type"].astype(str).isin(map(str, ALL_TYPES))]
    errors = errors_of(runs.astype({"type": int}))
    errors["judged"] = (100.0 * errors["judged"]).map(lambda error: float(f"{error:.2g}"))
    return {name: [dict(zip(same["type"], same["judged"])) for _, same in rows.groupby("measure", sort=False)]
            for name, rows in errors.groupby("scene")}


def over_front(cost, chosen, costs, errors):
    """How many times what the cheapest type costs that has none of these errors larger than the
    type `chosen`; 1 or less: on the front. `errors`: a list of {type: error}."""
    return cost / min(costs[ctype] for ctype in ALL_TYPES
                      if all(error[ctype] <= SAME_ERROR * error[chosen] for error in errors))


def same_files(folder, run):
    """Whether the files of a run of CTYPE 0 are those of the type that it took."""
    mine = [folder / run.run / f"run.{kind}.csv" for kind in FILES]
    other = folder / f"{run.scene}_{int(run.chosen)}_none"
    return all(path.read_bytes() == (other / path.name).read_bytes()
               for path in mine if path.exists())


def derive(table, folder):
    """The table with what each choice costs; `alone`: over the front for each error alone."""
    errors, found = known_errors(folder), []
    counts = counted(table).set_index(["scene", "type", "target"])["instructions"].to_dict()
    for run in finished(table[table["type"] == 0]).itertuples():
        costs = {ctype: counts.get((run.scene, ctype, "none")) for ctype in ALL_TYPES}
        cost, known = counts.get((run.scene, 0, run.target)), errors[run.scene]
        row = {"run": run.run, "same_files": same_files(folder / "runs", run)}
        if cost and all(costs.values()):
            row["over_type"] = cost / costs[run.chosen] - 1.0
            row["over_front"] = over_front(cost, run.chosen, costs, known)
            row["alone"] = ", ".join(f"{over_front(cost, run.chosen, costs, [error]):.3f}"
                                     for error in known)
        found.append(row)
    return table.merge(pd.DataFrame(found), how="left", on="run") if found else table


def page(table):
    """Text of DOC/studies/chooses.md."""
    runs = finished(table[table["type"] == 0])
    shown = pd.DataFrame({
        "scene": [SCENES[name].title for name in runs["scene"]], "target": runs["target"],
        "took": runs["chosen"].map(lambda chosen: label(int(chosen))),
        "files of the type": runs["same_files"].map({True: "yes", False: "no"})})
    if "over_type" in runs:
        shown["over the front"] = runs["over_front"].map("{:.3f}".format)
        shown["for each error alone"] = runs["alone"]
        shown["over its type"] = runs["over_type"].map("{:+.2%}".format)
    return page_of(
        "# What leaving the type to the program costs",
        "Scenes of speed-accuracy on their coarsest meshes. Over the front: instructions over those of the cheapest type by name "
        "that has none of the errors larger, then the same for each error alone; over its type: more than the type by name "
        f"takes. {who_counted(table)}", markdown_table(shown))


STUDY = Study("chooses", jobs, measure, lambda table, folder: None, derive, page)
