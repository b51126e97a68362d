# SPDX-License-Identifier: MIT
"""Contact of bodies of revolution: what each type errs by, and takes, in a press fit, between spheres and in their collision.

The decks and the closed forms are those of the verification cases press_fit, hertz_spheres and hertz_impact.
"""
from __future__ import annotations

import functools
import importlib.util
import pathlib
import sys

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.plots import PAGE_WIDTH, plt
from slideline_tools.results import read
from slideline_tools.studies.common import colour, label, markdown_table, marker, save_small, write_page
from slideline_tools.studies.framework.charts import save, styled
from slideline_tools.studies.framework.counted import counted_job, instruction_section
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.rules import COST_FACTOR, ERROR_FACTOR, least, names
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.round_contact.texts import PAGE
from slideline_tools.studies.speed_accuracy.charts import plain_ticks

VERIFICATION = pathlib.Path(__file__).resolve().parents[4] / "tests" / "verification"
#: Times are told over those of this type.
BASE = 5
ROWS, LEVELS = "7/5", (1, 2)
COUNTED = {"press_fit": "Press fit", "spheres": "Spheres"}
PHASES = ("contact_search", "contact_pairing", "contact_force")


@functools.lru_cache(maxsize=None)
def case(name):
    """The check of a verification case, as a module; `spheres` is its module of closed forms."""
    sys.path.insert(0, str(VERIFICATION))
    try:
        spec = importlib.util.spec_from_file_location(f"round_{name}", VERIFICATION / name / "check.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module
    except OSError as problem:
        raise UserError(f"cannot read {VERIFICATION / name}: {problem}") from problem
    finally:
        sys.path.remove(str(VERIFICATION))


def jobs(options):
    """Each type: the press fit, spheres on two meshes, the collision; `quick` without the finer mesh and the collision.
    Press fit and spheres on the first mesh are counted too."""
    listed = []
    for ctype in options.types:
        scenes = [("press_fit", 1, case("press_fit").press_fit(ctype, case("press_fit").ROWS[ROWS],
                                                               case("press_fit").SMALL, True)[0].text())]
        scenes += [("spheres", level, case("hertz_spheres").pressed(ctype, level, False).text())
                   for level in (LEVELS[:1] if options.quick else LEVELS)]
        if not options.quick:
            scenes.append(("collision", 1, case("hertz_impact").collision(ctype).text()))
        listed += [Job(f"{scene}_{level}_type_{ctype}", deck, "run", ("ncpu=1",),
                       {"scene": scene, "level": level, "type": ctype}, group=f"{scene}_{level}", alone=True,
                       cost={"press_fit": 0.2, "spheres": float(level ** 3), "collision": 4.0}[scene])
                   for scene, level, deck in scenes]
    return listed + [counted_job(one) for one in listed
                     if one.labels["scene"] in COUNTED and one.labels["level"] == 1 and not options.quick]


def measure(one, folder):
    """Errors of one run and its times per cycle, s."""
    rows = read_csv(folder / f"{one.jobid}.timing.csv")
    seconds = dict(zip(rows["phase"].tolist(), rows["seconds"].tolist()))
    cycles = dict(zip(rows["phase"].tolist(), rows["calls"].tolist()))["elements"]
    contact = sum(seconds[phase] for phase in PHASES)
    return {"contact": contact / cycles, "computing": (contact + seconds["elements"] + seconds["nodes"]) / cycles,
            **{"press_fit": judge_fit, "spheres": judge_spheres, "collision": judge_collision}[one.labels["scene"]](
                one, folder)}


def judge_fit(one, folder):
    """Largest deviation of a nodal pressure from Lame's, on both sides."""
    check = case("press_fit")
    _, shaft, hub = check.press_fit(one.labels["type"], check.ROWS[ROWS], check.SMALL, True)
    results = read(folder / f"{one.jobid}.vtkhdf")

    class Fields:
        """What `pressures` asks of a run."""

        @staticmethod
        def points(name):
            return results.points if name == "Points" else results.point_field(name)

    expected = check.lame(check.SMALL, True, check.springs_of(one.labels["type"], check.PENALTY))[0]
    return {f"error_{side}": float(np.max(np.abs(check.pressures(Fields, nodes) / expected - 1.0)))
            for side, nodes in (("slave", shaft[:, -1]), ("master", hub[:, 0]))}


def judge_spheres(one, folder):
    """Radius and peak over those of Hertz on the springs of the penalty, and the profile's error (L2 by area)."""
    check = case("hertz_spheres")
    table = read_csv(folder / f"{one.jobid}.contact.csv")
    table = table.where(time=table["time"].max())
    r, share, pressure = table["x"], table["length"], table["pressure"]
    found = check.spheres.measure(r, share, pressure)
    a, peak = check.spheres.hertz(2.0 * np.pi * found.force, 0.5 * check.RADIUS, check.MODULUS)
    soft = check.spheres.layer(check.MODULUS / (a * check.PENALTY * (2.0 if one.labels["type"] == 3 else 1.0)))
    exact = soft[1] * peak * np.sqrt(np.clip(1.0 - (r / (soft[0] * a)) ** 2, 0.0, None))
    error = np.sqrt(np.sum(share * (pressure - exact) ** 2) / np.sum(share * exact ** 2))
    return {"radius": found.radius / a / soft[0], "peak": found.peak / peak / soft[1], "profile": float(error)}


def judge_collision(one, folder):
    """Contact time and largest force over those of Hertz on the springs of the penalty."""
    check = case("hertz_impact")
    side = read_csv(folder / f"{one.jobid}.rcforc.csv").where(side="slave")
    force = 2.0 * np.pi * np.abs(side["fy"])
    mass = 2.0 / 3.0 * np.pi * check.BALL ** 3 * check.DENSITY
    stiff = check.PENALTY * (2.0 if one.labels["type"] == 3 else 1.0)
    duration, _, largest = check.spheres.impact_on_springs(mass, 0.5 * check.BALL, check.MODULUS, check.SPEED, stiff)
    touched = np.flatnonzero(force > 1e-3 * largest)
    return {"time": float(side["time"][touched[-1]] - side["time"][touched[0]]) / duration,
            "force": float(force.max() / largest)}


# ---- figures ----------------------------------------------------------------------------------------

def by_type(rows, scene, level=1):
    """{type: row} of one scene and mesh; with repeats the quickest run."""
    found = {}
    for row in finished(rows):
        if (row["scene"], row["level"]) == (scene, level):
            best = found.get(row["type"])
            found[row["type"]] = row if best is None or row["contact"] < best["contact"] else best
    return dict(sorted(found.items()))


def small(value):
    """A deviation: round-off of the interference by its bound, else per cent."""
    return "below 1e-6" if value < 1.0e-6 else f"{100.0 * value:.2g} %"


def error_table(rows):
    """Errors of all scenes, a line for each type."""
    fit, *spheres, impact = (by_type(rows, *which) for which in (
        ("press_fit", 1), *(("spheres", level) for level in LEVELS), ("collision", 1)))
    lines = []
    for ctype, row in fit.items():
        line = [label(ctype), small(row["error_slave"]), small(row["error_master"])]
        for there in spheres:
            one = there.get(ctype)
            line += [f"{one['radius']:.3f}", f"{one['peak']:.3f}", f"{one['profile']:.3f}"] if one else ["", "", ""]
        one = impact.get(ctype)
        lines.append([*line, *([f"{one['time']:.3f}", f"{one['force']:.3f}"] if one else ["", ""])])
    heads = [head for level in LEVELS for head in (f"spheres N_r {level}: radius", "peak", "profile, L2")]
    return markdown_table(["type", "press fit: shaft", "hub", *heads, "collision: time", "largest force"], lines)


def cost_table(rows):
    """Contact time per cycle over that of type BASE and its share of the computing time."""
    scenes = (("press_fit", 1), *(("spheres", level) for level in LEVELS), ("collision", 1))
    lines = []
    for ctype in by_type(rows, "press_fit"):
        line = [label(ctype)]
        for which in scenes:
            there = by_type(rows, *which)
            base = there.get(BASE)
            line += ([f"{there[ctype]['contact'] / base['contact']:.2f}",
                      f"{100.0 * there[ctype]['contact'] / there[ctype]['computing']:.0f} %"] if base and ctype in there else ["", ""])
        lines.append(line)
    heads = [head for scene, level in scenes for head in (f"{scene.replace('_', ' ')} {level}", "share")]
    return markdown_table(["type", *heads], lines)


def draw(rows):
    """Error of the spheres' profile over contact time, both meshes."""
    figure, axes = plt.subplots(layout="constrained", figsize=(PAGE_WIDTH, 3.6))
    for ctype in by_type(rows, "spheres"):
        points = [(1e6 * one[ctype]["contact"], one[ctype]["profile"]) for one in (by_type(rows, "spheres", n) for n in LEVELS)
                  if ctype in one]
        axes.plot(*zip(*points), color=colour(ctype), marker=marker(ctype), markersize=5, linewidth=0.7, label=label(ctype))
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("contact time per cycle, microseconds")
    axes.set_ylabel("pressure of spheres, L2 error")
    axes.grid(True, which="both", linewidth=0.3, color="#bbbbbb")
    for axis in (axes.xaxis, axes.yaxis):
        plain_ticks(axis)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=7)
    return figure


# ---- page -------------------------------------------------------------------------------------------

def chart(rows, folder):
    """The chart of the page."""
    if by_type(rows, "spheres"):
        with styled():
            save(draw(rows), folder, "round_contact")


def page(rows, doc):
    """doc/studies/round_contact.md and its picture."""
    finest = next((there for there in (by_type(rows, "spheres", level) for level in reversed(LEVELS)) if there), {})
    errors = {ctype: row["profile"] for ctype, row in finest.items()}
    costs = {ctype: row["contact"] for ctype, row in finest.items()}
    exact = [ctype for ctype, row in by_type(rows, "press_fit").items() if max(row["error_slave"], row["error_master"]) < 1e-6]
    with styled():
        save_small(draw(rows), doc / "pictures" / "round_contact.png", lines=True)
    write_page(doc, "round_contact", PAGE.format(
        errors=error_table(rows), costs=cost_table(rows), counts=instruction_section(rows, COUNTED), base=BASE,
        exact=names(exact), best=names(least(errors, ERROR_FACTOR)),
        cheap=names(least(costs, COST_FACTOR)), error_factor=ERROR_FACTOR, cost_factor=COST_FACTOR,
        both=names([one for one in least(errors, ERROR_FACTOR) if one in least(costs, COST_FACTOR)])))


STUDY = Study("round-contact", jobs, measure, chart, page=page)
