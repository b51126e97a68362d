# SPDX-License-Identifier: MIT
"""How far the results of two runs of the study simplify lie apart, and what memory a run takes."""
from __future__ import annotations

import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import TABLES, read_csv
from slideline_tools.results import read
from slideline_tools.studies.framework.runner import RECORD

KEPT, PATIENCE, PAUSE = "memory.json", 1.5, 0.005


def files_of(folder):
    """Path of the results and the job's name."""
    found = sorted(pathlib.Path(folder).glob("*.vtkhdf"))
    if len(found) != 1:
        raise UserError(f"{folder}: no results")
    return found[0], found[0].stem


def comparison(folder, other_folder, factor=1.0, same_mesh=True):
    """Distances of a run from another one whose forces are multiplied by `factor`.

    `force_error`         rms of the difference of the force over the rms of the force
    `impulse_error`       difference of the impulses over the impulse
    `displacement_error`  largest difference over the largest displacement at the last state, of
                          the nodes that both runs have
    `strain_error`        largest difference of plastic strain, of the elements that both have
    `strain_shift`        sum of the differences of plastic strain over its sum
    `same_states`         1 if all fields of all states are the same to the last bit, else 0
    `same_bits`           1 if all histories are the same, too
    """
    (path, name), (other_path, other_name) = files_of(folder), files_of(other_folder)
    found = force_distance(read_csv(folder / f"{name}.rcforc.csv"),
                           read_csv(other_folder / f"{other_name}.rcforc.csv"), factor)
    if same_mesh:
        one, other = read(path), read(other_path)
        found.update(state_distance(one, other))
        found["same_states"] = int(same_states(one, other))
        found["same_bits"] = int(found["same_states"] and same_bits(folder, name, other_folder))
    return found


def force_distance(rows, others, factor):
    """Distances of the slave's vertical force at the times of the coarser table."""
    rows, others = rows.where(side="slave"), others.where(side="slave")
    times = min(rows["time"], others["time"], key=len)
    if len(times) < 3:
        return {}
    force, reference = (np.interp(times, table["time"], table["fy"]) for table in (rows, others))
    reference = factor * reference
    size, impulse = np.sqrt(np.mean(reference ** 2)), np.trapezoid(reference, times)
    if size == 0.0 or impulse == 0.0:
        return {}
    return {"force_error": float(np.sqrt(np.mean((force - reference) ** 2)) / size),
            "impulse_error": float(abs(np.trapezoid(force, times) / impulse - 1.0))}


def common(ids, others):
    """Rows of the entities that both have."""
    _, rows, other_rows = np.intersect1d(ids, others, return_indices=True)
    return rows, other_rows


def state_distance(one, other):
    """Distances at the last states."""
    rows, others = common(one.point_field("node_id")[-1], other.point_field("node_id")[-1])
    moved, reference = (run.point_field("displacement")[-1][part, :2]
                        for run, part in ((one, rows), (other, others)))
    rows, others = common(one.cell_field("element_id")[-1], other.cell_field("element_id")[-1])
    strain, expected = (run.cell_field("plastic_strain")[-1][part]
                        for run, part in ((one, rows), (other, others)))
    found = {"displacement_error": float(np.abs(moved - reference).max()
                                         / np.abs(reference).max()),
             "strain_error": float(np.abs(strain - expected).max())}
    if expected.sum() > 0.0:
        found["strain_shift"] = float(np.abs(strain - expected).sum() / expected.sum())
        found["largest_strain"] = float(expected.max())
    return found


def same_bits(folder, name, other_folder):
    """Whether all histories are the same."""
    for table in TABLES:
        paths = [place / f"{name}.{table}.csv" for place in (folder, other_folder)]
        if not any(path.exists() for path in paths):
            continue
        if not all(path.exists() for path in paths):
            return False
        one, other = (read_csv(path) for path in paths)
        if list(one.columns) != list(other.columns) or len(one) != len(other) or not all(
                np.array_equal(one[column], other[column])
                for column in one.columns):
            return False
    return True


def same_states(one, other):
    """Whether all fields at all states are the same."""
    if not np.array_equal(one.times, other.times) or not np.array_equal(one.points, other.points):
        return False
    return all(np.array_equal(one.point_field(name), other.point_field(name))
               for name in one.point_fields) and all(
        np.array_equal(one.cell_field(name), other.cell_field(name)) for name in one.cell_fields)


def cycle_counts(folder):
    """Rows of the force history by what the bodies did, where there is a row for each cycle."""
    _, name = files_of(folder)
    touches = read_csv(folder / f"{name}.rcforc.csv").where(side="slave")["n_active"] > 0
    first, last = np.flatnonzero(touches)[[0, -1]] if touches.any() else (len(touches), -1)
    return {"rows": len(touches), "rows_touching": int(touches.sum()), "rows_before": int(first),
            "rows_after": int(len(touches) - 1 - last)}


def memory(folder):
    """Largest memory of the process, bytes, by running it again and looking; kept in the folder.

    Nothing where the system does not tell.
    """
    kept = folder / KEPT
    if not kept.exists():
        command = json.loads((folder / RECORD).read_text(encoding="utf-8"))["command"]
        largest = watched(command)
        if not largest:
            return {}
        kept.write_text(json.dumps({"memory": largest}) + "\n", encoding="utf-8")
    return json.loads(kept.read_text(encoding="utf-8"))


def watched(command):
    """Largest resident memory that a run shows until it ends or PATIENCE is over, bytes."""
    largest, begun = 0, time.perf_counter()
    with tempfile.TemporaryDirectory() as scratch:
        command = [f"d={scratch}" if word.startswith("d=") else word for word in command]
        try:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        except OSError:
            return 0
        while process.poll() is None and time.perf_counter() - begun < PATIENCE:
            largest = max(largest, peak_memory(process.pid, command[0]))
            time.sleep(PAUSE)
        process.kill()
        process.wait()
    return largest


def peak_memory(number, program):
    """VmHWM of a process that runs the program, bytes; 0 if it can not be read."""
    process = pathlib.Path("/proc") / str(number)
    try:
        if (process / "exe").resolve() != pathlib.Path(program).resolve():
            return 0  # between fork and exec
        text = (process / "status").read_text(encoding="ascii")
    except OSError:
        return 0
    lines = [line for line in text.splitlines() if line.startswith("VmHWM:")]
    return 1024 * int(lines[0].split()[1]) if lines else 0
