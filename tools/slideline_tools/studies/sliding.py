# SPDX-License-Identifier: MIT
"""The sliding scene: where its force is judged, abrupt peaks and waviness of it, points of type 5."""
import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.scenes.sliding import DRAW
from slideline_tools.studies import peaks

SEGMENT = 1.0e-3  # master segment at level 1, m
WINDOW_SHARE = 1.0 / 16.0  # of the time in which the die passes a master segment: the window of the trend
THRESHOLD = 0.0025  # of the mean force: an abrupt peak
STEPS_PER_ROW = 10


def judged_interval():
    """The times between which the force is judged: the inner three quarters of the stroke."""
    start, end, _ = DRAW
    return start + (end - start) / 8.0, end - (end - start) / 8.0


def crossing_time(level):
    """Mean time in which the die moves by one master segment, s."""
    start, end, distance = DRAW
    return (end - start) * SEGMENT / level / distance


def travel(time):
    """(n,) distance of the die's upper face along x, m."""
    start, end, distance = DRAW
    share = np.clip((time - start) / (end - start), 0.0, 1.0)
    return distance * (share - np.sin(2.0 * np.pi * share) / (2.0 * np.pi))


def vertical_force(folder):
    """(time, force on the plate by metre of depth) of a run that reached its end."""
    rows = read_csv(folder / "sliding.rcforc.csv").where(side="slave")
    if not len(rows) or rows["time"][-1] < DRAW[1] * (1.0 - 1e-6):
        raise UserError(f"{folder}: the run did not reach its end")
    return rows["time"], rows["fy"]


def force_peaks(time, force, level):
    """Abrupt peaks of the vertical force."""
    return peaks.abrupt_peaks(time, force, WINDOW_SHARE * crossing_time(level), THRESHOLD, judged_interval())


def measure(folder, level, ctype):
    """Peaks of the force, its roughness and waviness, over the mean force; of type 5 the points too."""
    time, force = vertical_force(folder)
    found = force_peaks(time, force, level)
    wave = peaks.waviness(time, force, travel(time), SEGMENT / level, WINDOW_SHARE * crossing_time(level), judged_interval())
    return {"peaks": len(found.sizes), "largest": found.largest, "rms": found.rms, "waviness": wave,
            **(point_counts(added_points(folder)) if ctype == 5 else {})}


def added_points(folder):
    """(touching slave nodes, master-to-slave points) of type 5 at each state with contact."""
    contact = read_csv(folder / "sliding.contact.csv")
    force = read_csv(folder / "sliding.rcforc.csv").where(side="slave")
    counts = []
    for time in np.unique(contact["time"]):
        touching = int(np.sum(contact.where(time=time)["gap"] < 0.0))
        row = int(np.argmin(np.abs(force["time"] - time)))
        if touching:
            counts.append((touching, int(force["n_active"][row]) - touching))
    if not counts:
        raise UserError(f"{folder}: no contact")
    return np.array(counts)


def point_counts(counts):
    """States, those with more than N - 1 points for N touching nodes, and the most touching nodes of these."""
    above = counts[:, 1] > counts[:, 0] - 1
    return {"states": len(counts), "states_above": int(above.sum()),
            "nodes_above": int(np.max(counts[above, 0], initial=0))}
