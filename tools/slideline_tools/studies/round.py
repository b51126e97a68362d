# SPDX-License-Identifier: MIT
"""Round bodies, with arcs and with the facets as they are: error over cost of a press fit, a pin in a bore, a Hertz contact."""
import re
import types

import numpy as np

from slideline_tools import scenes
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.results import read
from slideline_tools.studies.common import colour, label, markdown_table, marker, page_of, save_small, verification
from slideline_tools.studies.estimates import line_contact, line_error
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.framework.times import phases
from slideline_tools.studies.hertz import lines

TITLES = {"fit": "Press fit", "bore": "Pin in a bore", "hertz": "Hertz"}
MEASURES = {"mean": "mean pressure", "nodal": "nodal pressures, rms"}
FORMS = {"arcs": (), "facets": ("smooth=-1",)}
#: Press fit: interference; pin: clearance, and how far its hole is moved. 24 N_r facets against 30 N_r.
INTERFERENCE, CLEARANCE, WAY, END = 1.0e-3, 1.0e-3, 4.0e-3, 60.0
REFERENCE, REFERENCE_TYPE = 8, 7


def round_fit(scene, level):
    """The rings of the verification case `arcs`, explicit and damped; whole ones."""
    fit = verification("arcs").Fit((24 * level, 30 * level), INTERFERENCE if scene == "fit" else -CLEARANCE, 3 * level)
    fit.deck.control(END, scale=0.8).add("*DAMPING_GLOBAL", (0, 1.0))
    return fit


def deck_of(scene, level, ctype):
    """Text of a deck. The springs of the press fit follow the facets, as those of its case; those of the pin stay."""
    if scene == "hertz":
        return scenes.hertz(level)
    fit, ramp = round_fit(scene, level), [(0.0, 0.0), (END / 3.0, 1.0), (2.0 * END, 1.0)]
    if scene == "bore":
        fit.springs /= level
        fit.deck.curve(2, [(t, -WAY * way) for t, way in ramp]).fix(fit.hub[:, -1], x=1, y=1).fix(fit.shaft[:, 0], x=1)
        fit.deck.node_set(3, fit.shaft[:, 0]).add("*BOUNDARY_PRESCRIBED_MOTION_SET", (3, 2, 2, 2, 1.0))
    fit.contact(ctype, ramp=ramp if scene == "fit" else None)
    return fit.deck.output(plot=END).text()


def jobs(options):
    """Each scene, mesh and type with arcs and with facets; the finest pin is the reference."""
    listed = [job(scene, level, ctype, form) for scene in TITLES for level in options.levels for ctype in options.types
              for form in FORMS]
    return [job("bore", 2 if options.quick else REFERENCE, REFERENCE_TYPE, "arcs", "_reference"), *listed]


def job(scene, level, ctype, form, ending=""):
    """One run."""
    return Job(f"{scene}_{level}_type_{ctype}_{form}{ending}", deck_of(scene, level, ctype), scene,
               (f"ctype={ctype}", "ncpu=1", *FORMS[form]),
               {"scene": scene, "level": level, "type": ctype, "form": form}, cost=level ** 3, once=bool(ending))


# ---- measures ----------------------------------------------------------------------------------

def measure(one, folder):
    """Element updates, seconds, and the errors that need no reference."""
    scene, level, ctype = (one.labels[name] for name in ("scene", "level", "type"))
    times = phases(folder / f"{scene}.timing.csv")
    elements = re.search(r" nodes, (\d+) elements", (folder / f"{scene}.log").read_text(encoding="utf-8"))
    row = {"updates": int(elements[1]) * times["element_calls"], "computing": times["computing"]}
    if scene == "hertz":
        nodes, half, _, layer = line_contact(folder, level, ctype)
        found = lines.measure(nodes["x"], nodes["length"], nodes["pressure"])
        return {**row, "mean": abs(half * layer.half_width / found.half_width - 1.0), "nodal": line_error(folder, level, ctype)}
    if scene == "fit":
        fit, results = round_fit(scene, level), read(folder / "fit.vtkhdf")
        fields = {"Points": results.points, "contact_force": results.point_field("contact_force")}
        with np.errstate(invalid="ignore"):  # flat facets may not touch
            mean, spread = fit.found(types.SimpleNamespace(points=fields.__getitem__))
        row |= {"mean": float(np.max(np.abs(mean / fit.pressure(ctype, INTERFERENCE) - 1.0))), "nodal": float(np.max(spread))}
    return row


def pin_pressures(folder, level):
    """Force of the bore on the pin, angles of its nodes from the bottom, pressures there."""
    results = read(folder / "bore.vtkhdf")
    nodes = round_fit("bore", level).shaft[:, -1] - 1
    force, place = results.point_field("contact_force")[-1][nodes, :2], results.points[-1][nodes, :2]
    angle = (np.arange(len(nodes)) / len(nodes) * 2.0 * np.pi + 1.5 * np.pi) % (2.0 * np.pi) - np.pi
    order = np.argsort(angle)
    pressure = np.hypot(*force.T) * len(nodes) / (2.0 * np.pi * np.hypot(*place.T))
    return float(force[:, 1].sum()), angle[order], pressure[order]


def add_errors(table, folder):
    """Errors of the pins against the finest one."""
    runs = finished(table)
    pins, finest = runs[runs["scene"] == "bore"], runs[runs["run"].str.endswith("_reference")]
    if finest.empty:
        return table
    force, angle, pressure = pin_pressures(folder / "runs" / finest.iloc[0]["run"], finest.iloc[0]["level"])
    for row in pins.drop(finest.index).itertuples():
        mine = pin_pressures(folder / "runs" / row.run, row.level)
        exact = np.interp(mine[1], angle, pressure, period=2.0 * np.pi)
        table.loc[row.Index, ["mean", "nodal"]] = (abs(mine[0] / force - 1.0),
                                                   np.sqrt(np.sum((mine[2] - exact) ** 2) / np.sum(exact ** 2)))
    return table


# ---- picture and page --------------------------------------------------------------------------

def chart(table, folder):
    """Errors over element updates, a column for each scene: lines and full marks with arcs, broken and hollow with facets."""
    runs = finished(table).dropna(subset=["mean"])
    with plt.rc_context({**STYLE, "savefig.dpi": 110, "lines.linewidth": 0.9}):
        figure, panels = plt.subplots(len(MEASURES), len(TITLES), sharex="col", sharey="row", layout="constrained",
                                      figsize=(PAGE_WIDTH + 1.0, 5.4))
        for column, scene in zip(panels.T, TITLES):
            mine = runs[runs["scene"] == scene]
            for (ctype, form), rows in mine.groupby(["type", "form"]):
                for axes, measured in zip(column, MEASURES):
                    axes.plot(rows["updates"], rows[measured], color=colour(ctype), marker=marker(ctype), markersize=4.5,
                              **({"label": label(ctype)} if form == "arcs" else {"linestyle": "--", "markerfacecolor": "white"}))
            column[0].set_title(TITLES[scene])
            column[-1].set_xlabel("element updates")
        for axes, text in zip(panels[:, 0], MEASURES.values()):
            axes.set_ylabel(f"error, {text}")
        for axes in panels.flat:
            axes.set(xscale="log", yscale="log")
            axes.grid(True)
        figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5,
                      title="lines: arcs; broken, hollow: facets (smooth=-1)")
        save_small(figure, folder / "round.png", lines=True)


def page(table):
    """Text of DOC/studies/round.md."""
    runs = finished(table).dropna(subset=["mean"])
    texts = (runs[["mean", "nodal"]] * 100.0).map(lambda error: f"{error:.2g}" if error < 99.5 else f"{error:.0f}")
    runs = runs.assign(text=(texts["mean"] + ", " + texts["nodal"]).mask(runs["nodal"].isna(), "no contact"),
                       scene=runs["scene"].map(TITLES), type=runs["type"].map(label))
    cells = runs.pivot(index=["scene", "level", "form"], columns="type", values="text")
    costs = runs.groupby(["scene", "level", "form"])[["updates", "computing"]].agg({"updates": "max", "computing": "median"})
    costs = costs.map("{:.2g}".format).rename(columns={"computing": "seconds"})
    return page_of(
        "# Round bodies with arcs and with facets",
        "Errors in per cent of mean and nodal pressures (rms); seconds are medians of the types.",
        "![Error over element updates](../pictures/round.png)", markdown_table(costs.join(cells).reset_index()))


STUDY = Study("round", jobs, measure, chart, add_errors, page, levels=(1, 2, 4), types=(1, 2, 4, 5, 7))
