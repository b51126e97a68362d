# SPDX-License-Identifier: MIT
"""How far the results of two runs of the study simplify lie apart."""
import numpy as np

from slideline_tools.histories import TABLES, read_csv
from slideline_tools.results import read


def comparison(folder, other_folder, job, factor=1.0):
    """Distances of a run from another one whose forces are multiplied by `factor`.

    `force_error`         rms of the difference of the force over the rms of the force
    `displacement_error`  largest difference over the largest displacement at the last state, of
                          the nodes that both runs have
    `strain_shift`        sum of the differences of plastic strain over its sum, of the elements
                          that both have
    `same_states`         1 if all fields of all states are the same to the last bit, else 0
    `same_bits`           1 if all histories are the same, too
    """
    found = force_distance(*(read_csv(place / f"{job}.rcforc.csv")
                             for place in (folder, other_folder)), factor)
    one, other = (read(place / f"{job}.vtkhdf") for place in (folder, other_folder))
    found.update(state_distance(one, other))
    found["same_states"] = int(same_states(one, other))
    found["same_bits"] = int(found["same_states"] and same_bits(folder, other_folder, job))
    return found


def force_distance(rows, others, factor):
    """Distances of the slave's vertical force at the times of the coarser table."""
    rows, others = rows.where(side="slave"), others.where(side="slave")
    times = min(rows["time"], others["time"], key=len)
    if len(times) < 3:
        return {}
    force, reference = (np.interp(times, table["time"], table["fy"]) for table in (rows, others))
    reference = factor * reference
    size = np.sqrt(np.mean(reference ** 2))
    return {"force_error": float(np.sqrt(np.mean((force - reference) ** 2)) / size)} if size else {}


def common(ids, others):
    """Rows of the entities that both have."""
    return np.intersect1d(ids, others, return_indices=True)[1:]


def state_distance(one, other):
    """Distances at the last states."""
    rows, others = common(one.point_field("node_id")[-1], other.point_field("node_id")[-1])
    moved = one.point_field("displacement")[-1][rows, :2]
    reference = other.point_field("displacement")[-1][others, :2]
    rows, others = common(one.cell_field("element_id")[-1], other.cell_field("element_id")[-1])
    strain = one.cell_field("plastic_strain")[-1][rows]
    expected = other.cell_field("plastic_strain")[-1][others]
    found = {"displacement_error": float(np.abs(moved - reference).max()
                                         / np.abs(reference).max())}
    if expected.sum() > 0.0:
        found["strain_shift"] = float(np.abs(strain - expected).sum() / expected.sum())
    return found


def same_bits(folder, other_folder, job):
    """Whether both have the same histories."""
    names = [f"{job}.{table}.csv" for table in TABLES]
    there = [name for name in names if (folder / name).exists()]
    return there == [name for name in names if (other_folder / name).exists()] and all(
        (folder / name).read_bytes() == (other_folder / name).read_bytes() for name in there)


def same_states(one, other):
    """Whether all fields at all states are the same."""
    return (np.array_equal(one.times, other.times) and np.array_equal(one.points, other.points)
            and all(np.array_equal(one.point_field(name), other.point_field(name))
                    for name in one.point_fields)
            and all(np.array_equal(one.cell_field(name), other.cell_field(name))
                    for name in one.cell_fields))
