# SPDX-License-Identifier: MIT
"""The table of a study, a `pandas.DataFrame` with one row for each run: columns `run`, `repeat`, the labels of the job,
`state`, what its record says and what was measured. A cell is missing where a run lacks that column.
"""
import pandas as pd

from slideline_tools import UserError, counting

FINISHED, COUNTED, FAILED, MISSING = "finished", "counted", "failed", "missing"
RECORDED = ("status", "message", "seconds", "processor", "load")


def table_of(study, jobs, sweep):
    """The table of these jobs."""
    names = ["run", "repeat", *dict.fromkeys(name for job in jobs for name in job.labels), "state", *RECORDED]
    rows = [row_of(study, job, sweep) for job in jobs]
    return pd.DataFrame(rows, columns=[*dict.fromkeys([*names, *(name for row in rows for name in row)])])


def row_of(study, job, sweep):
    """The columns of one run; one that cannot be measured counts as failed, with the message why."""
    record, folder = sweep.record(job), sweep.run_folder(job)
    row = {"run": job.folder_name, "repeat": job.repeat, **job.labels}
    if record is None:
        return {**row, "state": MISSING}
    row["state"] = FAILED if record["status"] else COUNTED if job.counted else FINISHED
    row.update({name: record[name] for name in RECORDED if name in record})
    try:
        if row["state"] == COUNTED:
            row.update(counting.columns(folder))
        elif not job.counted:
            row.update(study.measure(job, folder))
    except (UserError, OSError) as problem:
        if row["state"] != FAILED:
            row.update(state=FAILED, message=f"not measured: {problem}")
    return row


def finished(table):
    """The runs that ended normally and were measured; not those that were counted."""
    return table[table["state"] == FINISHED]


def counted(table):
    """The runs whose instructions were counted."""
    return table[table["state"] == COUNTED]


def who_counted(table):
    """'Counted by ...', with what was cut short and what a count is good for."""
    runs = counted(table)
    if runs.empty:
        return "No instructions were counted: valgrind was not installed."
    text = (f"Counted by {', '.join(sorted(set(runs['counted_by'])))}, which emulates the program built for that "
            "processor. Two counts of a run agree to 1e-4, on a busy machine too. Instructions differ in what they "
            "cost: a count tells work, not time.")
    short = dict(zip(runs["scene"], runs["shortened"])) if "scene" in runs and "shortened" in runs else {}
    short = {scene: words for scene, words in short.items() if words}
    if short:
        text += " Cut short: " + ", ".join(f"{scene} ({words})" for scene, words in short.items()) + "."
    return text
