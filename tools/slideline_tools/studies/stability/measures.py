# SPDX-License-Identifier: MIT
"""What became of a run: one of six verdicts, by measures with fixed thresholds."""
import math
import re

import numpy as np

from slideline_tools.histories import energy_made, read_csv

VERDICTS = STABLE, LIMITED, LOCKED, CHATTERING, PENETRATING, BLOWN_UP = (
    "stable", "limited", "locked", "chattering", "penetrating", "blown up")

ENERGY_DRIFT = 0.05     # of the largest energy: unaccounted for
ENERGY_CREATED = 0.05   # of the largest energy: made by the contact forces
DEPTH_SIDES = 1.0       # element sides
DEPTH_APPROACH = 0.5    # of the way that the bodies are driven together
SWINGS = 4.0            # ups and downs of the contact force over its largest value
UNEVEN = 0.30           # scatter of the pressure over its mean where it should be uniform
CUT_SHARE = 0.05        # of the cycles with force: in these the energy law limited the forces
ENDS = 2                # nodes at each end of the surface that do not count for that


def energies(glstat, sleout):
    """(drift, created by contact) over the largest energy of the run; infinite if not finite."""
    work = glstat["external_work"]
    scale = np.max([np.max(np.abs(glstat["total"])), np.max(np.abs(work)), 1e-300])
    drift = np.max(np.abs(glstat["total"] - glstat["total"][0] - (work - work[0]))) / scale
    created = np.max(energy_made(sleout)) / scale
    return tuple(value if math.isfinite(value) else math.inf for value in (drift, created))


def swings(rcforc):
    """Ups and downs of the contact force in the second half of the run, over its largest value."""
    slave = rcforc.where(side="slave")
    force = np.hypot(slave["fx"], slave["fy"])
    force = force[len(force) // 2:]
    if len(force) < 2 or not np.max(force) > 0.0:
        return 0.0
    return float(np.sum(np.abs(np.diff(force))) / np.max(force))


def unevenness(contact):
    """Scatter of the pressure along the surface over its mean, in the last state."""
    last = contact.where(time=contact["time"][-1])
    pressure = last["pressure"][np.argsort(last["s"])][ENDS:-ENDS]
    mean = np.mean(pressure)
    return float(np.std(pressure) / mean) if mean > 0.0 else math.inf


def judge(status, measures, side, approach, is_uniform):
    """The verdict, from the worst down."""
    if status == 2 or measures["drift"] > ENERGY_DRIFT or measures["created"] > ENERGY_CREATED:
        return BLOWN_UP
    if measures["depth"] > min(DEPTH_SIDES * side, DEPTH_APPROACH * approach):
        return PENETRATING
    if measures["swings"] > SWINGS:
        return CHATTERING
    if is_uniform and measures["uneven"] > UNEVEN:
        return LOCKED
    return STABLE


def cut_share(log):
    """Share of the cycles with force in which contact forces were limited, as the log tells."""
    found = re.findall(r"limited to the admissible energy in (\d+) of (\d+) cycles with force", log)
    return int(found[-1][0]) / int(found[-1][1]) if found else 0.0


def measure_cell(folder, jobid, scene):
    """All measures of a run and its verdict; stable by the energy law alone is limited.

    `depth`: deepest penetration of a slave node in all states, m.
    """
    tables = {name: read_csv(folder / f"{jobid}.{name}.csv")
              for name in ("glstat", "rcforc", "sleout", "contact")}
    drift, created = energies(tables["glstat"], tables["sleout"])
    measures = {"drift": drift, "created": created,
                "depth": float(max(0.0, -np.min(tables["contact"]["gap"]))),
                "swings": swings(tables["rcforc"]), "uneven": unevenness(tables["contact"])}
    reached = tables["glstat"]["time"][-1] >= 0.99 * scene.end
    verdict = judge(0 if reached else 2, measures, scene.side, scene.approach, scene.is_uniform)
    cut = cut_share((folder / f"{jobid}.log").read_text(encoding="utf-8"))
    if verdict == STABLE and cut > CUT_SHARE:
        verdict = LIMITED
    return {**measures, "verdict": verdict, "cut": cut}
