# SPDX-License-Identifier: MIT
"""What the runs with friction are judged by: the traction of a cylinder drawn aside, the forces of ironing."""
import re

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.scenes.common import STEEL
from slideline_tools.scenes.hertz import RADIUS
from slideline_tools.studies.framework.times import phases
from slideline_tools.studies.speed_accuracy_friction.decks import ALONG, DRAW, FRICTION, PRESS, SLAB, UNIT

STICKS, SAMPLES = 1, 20001
MODULUS = 0.5 * STEEL["young"] / (1.0 - STEEL["poisson"] ** 2)
#: Part of the way along in which forces are judged, places there, and cells of the slab at level 1.
JUDGED, PLACES, CELLS = (0.25, 0.975), 1001, 60


# ---- Cattaneo and Mindlin ---------------------------------------------------------------------------

def ellipse(x):
    """sqrt(1 - x^2) where it is real."""
    return np.sqrt(np.maximum(0.0, 1.0 - x ** 2))


def exact_traction(x, load, shear):
    """Traction of Cattaneo (1938) at places x for the forces P and Q per length, and the half widths of contact and stick."""
    a = np.sqrt(4.0 * load * RADIUS / (np.pi * MODULUS))
    c = a * np.sqrt(max(0.0, 1.0 - shear / (FRICTION * load)))
    peak = 2.0 * load / (np.pi * a)
    return FRICTION * peak * (ellipse(x / a) - (c / a * ellipse(x / c) if c > 0.0 else 0.0)), a, c


def nodal_means(x, load, shear):
    """Means of the exact traction over the hat functions of nodes at x (walked to the right), and both half widths: what
    nodal forces over lengths should be, where the slope is infinite too (at a and c)."""
    places = np.linspace(x[0], x[-1], SAMPLES)
    traction, a, c = exact_traction(places, load, shear)
    hats = np.stack([np.interp(places, x, one) for one in np.eye(len(x))])
    return hats @ traction / np.sum(hats, axis=1), a, c


def judge_rolled(folder, jobid):
    """Errors of traction (L2) and of the stick zone's half width (over a), the tractions that pressing alone has left
    (`pressed`, over the norm of the exact ones), and Newton's iterations."""
    table = read_csv(folder / f"{jobid}.contact.csv")
    rows = table.where(time=table["time"].max())
    before = table.where(time=min(table["time"], key=lambda time: abs(time - 1.0)))
    weight = rows["pressure"] * rows["length"]
    load, shear = np.sum(weight), np.sum(np.abs(rows["traction"]) * rows["length"])
    x = rows["x"] - np.sum(rows["x"] * weight) / load
    exact, a, c = nodal_means(x, load, shear)
    stuck = x[rows["state"] == STICKS]
    if not len(stuck):
        raise UserError(f"{folder}: nothing sticks")

    def norm(values):
        return float(np.sqrt(np.sum(values ** 2 * rows["length"])))

    size = norm(exact)
    timing = read_csv(folder / f"{jobid}.timing.csv")
    iterations = dict(zip(timing["phase"].tolist(), timing["calls"].tolist()))["solver"]
    return {"traction_error": norm(np.abs(rows["traction"]) - exact) / size, "pressed": norm(before["traction"]) / size, "edge_error": float(abs(0.5 * (stuck.max() - stuck.min()) - c) / a), "segments": float(a / np.median(rows["length"])), "shear": float(shear / (FRICTION * load)),
            "iterations": int(iterations)}


# ---- ironing ----------------------------------------------------------------------------------------

def forces_along(folder, jobid):
    """(horizontal, vertical) force of the die at even places of the judged part of the way, N/m."""
    rows = read_csv(folder / f"{jobid}.rcforc.csv").where(side="slave")
    share = np.linspace(*JUDGED, PLACES)
    times = (PRESS + DRAW * share) * UNIT
    if rows["time"][-1] < times[-1]:
        raise UserError(f"{folder}: ended before the way did")
    return np.array([np.interp(times, rows["time"], sign * rows[name]) for sign, name in ((-1.0, "fx"), (1.0, "fy"))])


def roughness(force, level):
    """Standard deviation from the running mean over one element of the slab, over the mean; the largest deviation too."""
    window = int(round(SLAB / (CELLS * level) / (ALONG * (JUDGED[1] - JUDGED[0])) * (PLACES - 1))) | 1
    mean = np.convolve(force, np.full(window, 1.0 / window), mode="valid")
    rest = force[window // 2:][:len(mean)] - mean
    return float(np.std(rest) / abs(np.mean(force))), float(np.max(np.abs(rest)) / abs(np.mean(force)))


def judge_ironing(folder, jobid, level):
    """Roughness of both forces, their means, what friction took over the work of what it should be, balance, releases."""
    horizontal, vertical = forces_along(folder, jobid)
    energy = read_csv(folder / f"{jobid}.glstat.csv")
    log = (folder / f"{jobid}.log").read_text(encoding="utf-8")
    rough, largest = roughness(horizontal, level)
    return {"roughness": rough, "largest": largest, "vertical_roughness": roughness(vertical, level)[0],
            "horizontal": float(np.mean(horizontal)), "vertical": float(np.mean(vertical)),
            "energy_error": float(np.abs(energy["energy_ratio"] - 1.0).max()), "friction": float(energy["friction"][-1]),
            "released": bool(re.search(r"deeper than|released", log)), **phases(folder / f"{jobid}.timing.csv")}
