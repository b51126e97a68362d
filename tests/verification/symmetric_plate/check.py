# SPDX-License-Identifier: MIT
"""Half plate under a step load against an independent fine-mesh solution."""
import csv

import numpy as np

MESHES = ("8x4", "16x8", "32x16")
FORMS = {"viscous 0.1": (1, 0.1), "stiffness 0.05": (4, 0.05)}


def reference(folder, law):
    with open(folder / "reference" / f"{law}.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    return (np.array([float(row["time"]) for row in rows]),
            np.array([float(row["uy"]) for row in rows]))


def first_peak(time, value):
    """Largest value and its time, from the parabola through three points."""
    k = int(np.argmax(value))
    if k in (0, len(value) - 1):
        return value[k], time[k]
    a, b, c = np.polyfit(time[k - 1:k + 2] - time[k], value[k - 1:k + 2], 2)
    return c - b * b / (4.0 * a), time[k] - b / (2.0 * a)


def check_law(run, law, deck_law):
    wanted_time, wanted = reference(run.folder, law)
    peak, peak_time = first_peak(wanted_time, wanted)
    run.report(f"{law}: peak of the reference", peak, f"m, at {peak_time:.4f} s")
    found = {}
    for form, (number, coefficient) in FORMS.items():
        for mesh in MESHES:
            result = run.program(
                run.root / "input" / "symmetric_plate" / f"plate_{mesh}_{deck_law}.k",
                f"p:ihq={number}", f"p:qh={coefficient}", name=f"{law}_{mesh}_ihq{number}")
            middle = int(mesh.split("x")[1]) // 2 + 1
            history = result.node(middle)
            found[form, mesh] = history, result.table("glstat")
            value, when = first_peak(history["time"], history["uy"])
            run.report(f"{law}, {form}, {mesh}: peak / reference", value / peak,
                       f"at {when:.4f} s")
            inside = (wanted_time >= history["time"][0]) & (wanted_time <= history["time"][-1])
            tracked = np.interp(wanted_time[inside], history["time"], history["uy"])
            run.report(f"{law}, {form}, {mesh}: root mean square difference / peak",
                       np.sqrt(np.mean((tracked - wanted[inside]) ** 2)) / peak)
    history, energy = found["stiffness 0.05", "32x16"]
    value, when = first_peak(history["time"], history["uy"])
    run.check(f"{law}: peak deflection, 32x16, stiffness 0.05", value, peak)
    run.check(f"{law}: time of the peak, 32x16, stiffness 0.05", when, peak_time)
    coarse, middle, fine = (first_peak(found["stiffness 0.05", mesh][0]["time"],
                                       found["stiffness 0.05", mesh][0]["uy"])[0]
                            for mesh in MESHES)
    run.check(f"{law}: last refinement changes less than the one before",
              abs(fine - middle) / abs(middle - coarse), 1.0)
    for (form, mesh), (_, energy) in found.items():
        # the plate swings back to where the load has done no work, so the ratio itself says little
        missing = (energy["total"] - energy["external_work"]) / energy["external_work"].max()
        run.check(f"{law}, {form}, {mesh}: energy missing / largest work", missing, 0.0)
    early = history["time"] <= 0.004
    run.check(f"{law}: early acceleration of the middle",
              np.polyfit(history["time"][early] ** 2, history["uy"][early], 1)[0] * 2.0, 80.0)


def check(run):
    check_law(run, "elastic", "elastic")
    check_law(run, "elastoplastic", "elastoplastic")
