# SPDX-License-Identifier: MIT
"""Our claims about friction, answered from runs: which types transmit a uniform shear exactly, in stick and in slip.

The decks are those of the verification case friction_patch_static; here every answer is a figure, and a verdict follows
from the figures by the rules of the page.
"""
from __future__ import annotations

import functools
import importlib.util
import pathlib
import sys

import numpy as np

from slideline_tools import UserError
from slideline_tools.plots import PAGE_WIDTH, plt
from slideline_tools.results import read
from slideline_tools.studies.claims_friction.texts import PAGE
from slideline_tools.studies.common import colour, label, markdown_table, marker, save_small, write_page
from slideline_tools.studies.framework.charts import save, styled
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.rules import ERROR_FACTOR, least, names, share_verdict
from slideline_tools.studies.framework.table import finished

VERIFICATION = pathlib.Path(__file__).resolve().parents[4] / "tests" / "verification"
CASE = "friction_patch_static"
EXACT = 1.0e-9
PENALTY, SOFT = 1.0e6, 1.0e6
CLAIMED = (4, 5, 7)
WEAK = "stick, eps_T eps_N/10"     # with the types that are claimed to be exact
SIDES, PARTS = ("slave", "master"), ("traction", "pressure")
QUICK_MESHES = ("5/4",)


@functools.lru_cache(maxsize=None)
def case():
    """The modules of the verification case: its check, static_patch, patch_layouts."""
    sys.path.insert(0, str(VERIFICATION))
    try:
        spec = importlib.util.spec_from_file_location(CASE, VERIFICATION / CASE / "check.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module, importlib.import_module("static_patch"), importlib.import_module("patch_layouts")
    except OSError as problem:
        raise UserError(f"cannot read {VERIFICATION / CASE}: {problem}") from problem
    finally:
        sys.path.remove(str(VERIFICATION))


@functools.lru_cache(maxsize=None)
def bodies():
    """Words, both bodies and the pressure, Pa: alike, and one three times as stiff under so small a load that no face tilts
    by what counts."""
    check = case()[0]
    small = 1.0e-12 * SOFT
    across = -0.3 / 0.7 * small
    return {"like": ((check.Body(SOFT, 0.3, 1.0),) * 2, 1.0),
            "unlike": ((check.Body(SOFT, 0.3, small, across), check.Body(3.0 * SOFT, 0.3, small, across)), small)}


@functools.lru_cache(maxsize=None)
def blocks(mesh):
    """The two blocks of a mesh."""
    _, patch, layouts = case()
    upper, lower, rows = layouts.MESHES[mesh]
    return patch.Blocks(upper, lower, SOFT, rows)


def jobs(options):
    """Each mesh, type and pair of bodies, in stick and in slip; with weak tangential springs the types that are claimed."""
    check, _, layouts = case()
    listed = []
    for mesh in QUICK_MESHES if options.quick else layouts.MESHES:
        for ctype in options.types:
            for rule in check.RULES:
                if rule == WEAK and ctype not in CLAIMED:
                    continue
                for words, (pair, pressure) in bodies().items():
                    deck = check.patch_deck(ctype, PENALTY, blocks(mesh), rule, pair, pressure, words == "unlike").text()
                    stem = "".join(letter if letter.isalnum() else "_" for letter in f"{mesh}_{rule}_{words}")
                    listed.append(Job(f"{stem}_type_{ctype}", deck, "run", ("ncpu=1",),
                                      {"mesh": mesh, "type": ctype, "rule": rule, "bodies": words}, limit=120.0,
                                      cost=3.0 if mesh.startswith("51") else 1.0))
    return listed


def measure(one, folder):
    """Largest deviations of nodal traction and pressure from the uniform ones, on both sides, as shares of one."""
    check, patch, _ = case()
    pressure = bodies()[one.labels["bodies"]][1]
    layout, results = blocks(one.labels["mesh"]), read(folder / f"{one.jobid}.vtkhdf")
    force, x = results.point_field("contact_force")[-1], results.points[-1][:, 0]
    row = {}
    for side, nodes, sign in (("slave", layout.slave, (-1.0, 1.0)), ("master", layout.master, (1.0, -1.0))):
        found = np.array(sign) * force[nodes, :2] / patch.hat_areas(x[nodes])[:, None]
        wanted = np.array([check.SHARE_OF_SHEAR * pressure, pressure])
        row.update({f"{part}_{side}": float(value) for part, value in
                    zip(PARTS, np.max(np.abs(found / wanted - 1.0), axis=0))})
    return row


# ---- figures ----------------------------------------------------------------------------------------

def worst(rows, part=None):
    """Largest deviation of some runs, on both sides, of both parts unless one is named."""
    return max(row[f"{name}_{side}"] for row in rows for name in PARTS if part in (None, name) for side in SIDES)


def exact_types(rows, rules):
    """Types whose deviations are round-off in every run of these rules."""
    chosen = [row for row in finished(rows) if row["rule"] in rules]
    return [ctype for ctype in sorted({row["type"] for row in chosen})
            if worst([row for row in chosen if row["type"] == ctype]) <= EXACT]


def verdict_of(found, there):
    """Whether the claimed types are exact; partly where only some of them are."""
    return share_verdict(ctype in found for ctype in CLAIMED if ctype in there)


def deviation(value):
    """A deviation: round-off by its bound, else per cent."""
    return f"{value:.0e}" if value <= EXACT else f"{float(f'{100.0 * value:.2g}'):g} %"


def short(mesh):
    """'7/5' of '7/5 non-uniform', '2/7' of '..., 2/7'."""
    return next(word for word in mesh.split() if "/" in word and word[0].isdigit())


def table_of(rows, rule):
    """Deviation of the traction by type and mesh, the larger of both sides and of both pairs of bodies."""
    chosen = [row for row in finished(rows) if row["rule"] == rule]
    meshes = list(dict.fromkeys(row["mesh"] for row in chosen))
    lines = []
    for ctype in sorted({row["type"] for row in chosen}):
        line = [label(ctype)]
        for mesh in meshes:
            there = [row for row in chosen if (row["type"], row["mesh"]) == (ctype, mesh)]
            line.append(deviation(worst(there, "traction")) if there else "no equilibrium")
        lines.append(line)
    return markdown_table(["type", *map(short, meshes)], lines)


def slip_difference(rows):
    """Largest difference between the deviations of traction and of pressure in slip, under the small load; by type."""
    chosen = [row for row in finished(rows) if row["rule"] == "slip" and row["bodies"] == "unlike"]
    return {ctype: max(abs(row[f"traction_{side}"] - row[f"pressure_{side}"]) for row in chosen if row["type"] == ctype
                       for side in SIDES) for ctype in sorted({row["type"] for row in chosen})}


def others(rows):
    """{type: (smallest, largest) deviation of the traction in stick over the meshes} of the types not claimed."""
    chosen = [row for row in finished(rows) if row["rule"] == "stick" and row["type"] not in CLAIMED]
    found = {}
    for ctype in sorted({row["type"] for row in chosen}):
        by_mesh = [worst([row for row in chosen if (row["type"], row["mesh"]) == (ctype, mesh)], "traction")
                   for mesh in {row["mesh"] for row in chosen if row["type"] == ctype}]
        found[ctype] = (min(by_mesh), max(by_mesh))
    return found


def draw(rows):
    """Deviation of the traction by mesh: stick and slip."""
    figure, panels = plt.subplots(1, 2, sharey=True, layout="constrained", figsize=(PAGE_WIDTH + 1.0, 3.4))
    for axes, rule in zip(panels, ("stick", "slip")):
        chosen = [row for row in finished(rows) if row["rule"] == rule]
        meshes = list(dict.fromkeys(row["mesh"] for row in chosen))
        for ctype in sorted({row["type"] for row in chosen}):
            points = [(place, worst([row for row in chosen if (row["type"], row["mesh"]) == (ctype, mesh)], "traction"))
                      for place, mesh in enumerate(meshes)
                      if any((row["type"], row["mesh"]) == (ctype, mesh) for row in chosen)]
            axes.plot(*zip(*points), color=colour(ctype), marker=marker(ctype), markersize=4, linewidth=0.7, label=label(ctype))
        axes.set_yscale("log")
        axes.set_xticks(range(len(meshes)), list(map(short, meshes)), fontsize=7)
        axes.axhline(EXACT, color="black", linewidth=0.6, linestyle="--")
        axes.set_title(rule, loc="left")
        axes.set_xlabel("segments of slave/master")
        axes.grid(True, which="major", linewidth=0.3, color="#bbbbbb")
    panels[0].set_ylabel("traction, largest deviation")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=7)
    return figure


# ---- page -------------------------------------------------------------------------------------------

def chart(rows, folder):
    """The chart of the page."""
    if finished(rows):
        with styled():
            save(draw(rows), folder, "shear")


def page(rows, doc):
    """doc/studies/claims_friction.md and its picture."""
    there = {row["type"] for row in finished(rows)}
    stick, slip = exact_types(rows, ("stick", WEAK)), exact_types(rows, ("slip",))
    rest, same = others(rows), slip_difference(rows)
    best = least({ctype: high for ctype, (_, high) in rest.items()}, ERROR_FACTOR)
    failed = [row for row in rows if row["state"] == "failed"]
    verdicts = {
        "stick": verdict_of(stick, there), "slip": verdict_of(slip, there),
        "fail": share_verdict(low > EXACT for low, _ in rest.values()) if rest else "not run",
        "same": share_verdict(value <= EXACT for value in same.values())}
    claims = (("Types 4, 5 and 7 transmit a uniform shear exactly where it sticks", "stick"),
              ("... and in full slip", "slip"), ("No other type does, on any mesh that does not fit", "fail"),
              ("In full slip the shear of every type errs as its pressure does", "same"))
    with styled():
        save_small(draw(rows), doc / "pictures" / "claims_friction.png", lines=True)
    write_page(doc, "claims_friction", PAGE.format(
        summary=markdown_table(["claim", "answer"], [[text, verdicts[name]] for text, name in claims]), **verdicts,
        exact=EXACT, penalty=PENALTY, stick_types=names(stick), slip_types=names(slip),
        worst_stick=deviation(worst([row for row in finished(rows) if row["type"] in stick and row["rule"] != "slip"]))
        if stick else "none", stick_table=table_of(rows, "stick"), weak_table=table_of(rows, WEAK), slip_table=table_of(rows, "slip"),
        ranges="; ".join(f"type {ctype} {deviation(low)} to {deviation(high)}" for ctype, (low, high) in rest.items()),
        best=names(best), factor=ERROR_FACTOR,
        differences=", ".join(f"type {ctype} {value:.0e}" for ctype, value in same.items()),
        failed=f"{len(failed)} runs found no equilibrium: " + "; ".join(
            f"type {row['type']}, {row['mesh']}, {row['rule']}, {row['bodies']} bodies" for row in failed) + "." if failed
        else "All runs found their equilibrium."))


STUDY = Study("claims-friction", jobs, measure, chart, page=page)
