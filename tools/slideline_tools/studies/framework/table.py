# SPDX-License-Identifier: MIT
"""Rows of a study: one per run, in one CSV file, and what is often made of them."""
import csv
import io

import numpy as np

from slideline_tools import UserError, counting
from slideline_tools.studies.framework.job import write_whole

FINISHED, COUNTED, FAILED, MISSING = "finished", "counted", "failed", "missing"
RECORDED = ("status", "message", "seconds", "processor", "load")


def rows_of(study, jobs, sweep):
    """One dict per job: run, repeat, labels, state, what `RECORDED` names, then measures.

    A measure that can not be read leaves its row with the message why, and counts as failed.
    """
    rows = []
    for job in jobs:
        record = sweep.record(job)
        row = {"run": job.folder_name, "repeat": job.repeat, **job.labels}
        if record is None:
            rows.append({**row, "state": MISSING})
            continue
        row["state"] = FAILED if record["status"] else COUNTED if job.counted else FINISHED
        row.update({name: record[name] for name in RECORDED if name in record})
        try:
            if row["state"] == COUNTED:
                row.update(counting.columns(sweep.run_folder(job)))
            elif not job.counted:
                row.update(study.measure(job, sweep.run_folder(job)))
        except (UserError, OSError) as problem:
            if row["state"] != FAILED:
                row.update(state=FAILED, message=f"not measured: {problem}")
        rows.append(row)
    return rows


def write_rows(path, rows):
    """The rows as CSV; a column is empty where a row lacks it."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    stream = io.StringIO()
    writer = csv.DictWriter(stream, names, lineterminator="\n", restval="")
    writer.writeheader()
    writer.writerows({name: repr(float(value)) if isinstance(value, (float, np.floating)) else value
                      for name, value in row.items()} for row in rows)
    write_whole(path, stream.getvalue())


def read_rows(path):
    """Rows as written by `write_rows`: integers, reals, else text; empty columns left out."""
    try:
        with open(path, newline="", encoding="utf-8") as stream:
            return [{name: parsed(text) for name, text in row.items() if text != ""}
                    for row in csv.DictReader(stream)]
    except OSError as problem:
        raise UserError(f"cannot read {path}: {problem}") from problem


def parsed(text):
    """The number in a text, or the text."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def finished(rows):
    """The rows of runs that ended normally and were measured; not those that were counted."""
    return [row for row in rows if row["state"] == FINISHED]


def counted(rows):
    """The rows of runs whose instructions were counted."""
    return [row for row in rows if row["state"] == COUNTED]


def grouped(rows, *names):
    """Rows by the values of these columns, in order of appearance: {(value, ...): [row, ...]}."""
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[name] for name in names), []).append(row)
    return groups


def median(rows, name):
    """Median of a column over rows (repeats)."""
    return float(np.median([row[name] for row in rows]))
