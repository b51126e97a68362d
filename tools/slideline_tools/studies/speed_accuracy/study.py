# SPDX-License-Identifier: MIT
"""Speed against accuracy: what each contact type, and implicit penalty (PUNIT 4), costs in each
scene, and how large its error is.

Every run is timed and judged; contact time and computing time are medians over rounds in which all
variants run in turn. See scenes.py for the scenes and their measures.
"""
import pandas as pd

from slideline_tools import UserError
from slideline_tools.contact_types import HARD, IMPLICIT, SERIES
from slideline_tools.results import read
from slideline_tools.studies.common import label, markdown_table, page_of
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.rules import RUN_FACTOR, between, geometric_mean, least
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.framework.times import phases
from slideline_tools.studies.speed_accuracy.charts import chart, sorted_types
from slideline_tools.studies.speed_accuracy.points import COSTS, errors_of, geometric, over, points_of
from slideline_tools.studies.speed_accuracy.reference import REFERENCE_TYPE, add_errors, reference_series
from slideline_tools.studies.speed_accuracy.scenes import SCENES, contact_options, net_moment

COMPARED = {"profile_error": "Hertz profile", "force_error": "sliding force",
            "roughness": "sliding roughness", "total_work_error": "plastic work"}
TARGETS = (0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0003)
BALANCED = 1.0e-9  # a net moment that is round-off


def jobs(options):
    """Each scene, level and type; before them, once, the finer meshes of the references."""
    references, listed = [], []
    for name, scene in SCENES.items():
        levels = [level for level in (scene.quick_levels if options.quick else scene.levels)
                  if level in options.levels]
        swept = {(ctype, level) for level in levels for ctype in options.types}
        wanted = scene.quick_references if options.quick else scene.references
        extra = {(reference_series(ctype), level) for ctype in options.types
                 for level in wanted if levels} - swept
        decks = {level: scene.deck(level) for _, level in swept | extra}
        references += [job(name, decks[level], level, ctype, "reference")
                       for ctype in SERIES for level in wanted if (ctype, level) in extra]
        listed += [job(name, decks[level], level, ctype, "sweep")
                   for level in levels for ctype in options.types]
    return references + listed


def job(name, deck, level, ctype, role):
    """One run; `role`: sweep or reference."""
    scene, swept = SCENES[name], role == "sweep"
    options = [*contact_options(scene, level, ctype), "ncpu=1", *scene.options(level)]
    return Job(f"{name}_{level}_type_{ctype}" + ("" if swept else "_reference"), deck, name, options,
               {"scene": name, "level": level, "type": ctype, "role": role}, alone=swept,
               group=f"{name}_{level}", turns=scene.turns if swept else 1, once=not swept,
               cost=scene.cost * level ** scene.power)


def measure(one, folder):
    """Seconds by phase, errors that need no reference, the net moment of the contact forces, and
    how the program was built."""
    level, ctype = one.labels["level"], one.labels["type"]
    scene = SCENES[one.labels["scene"]]
    results = read(folder / f"{one.jobid}.vtkhdf")
    return {**phases(folder / f"{one.jobid}.timing.csv"), **scene.judge(folder, level, ctype),
            "moment": net_moment(results, scene.lengths[0] / level),
            "build": f"slideline {results.run['version']}, {results.run['build']}"}


# ---- page --------------------------------------------------------------------------------------

def title_of(scene, key):
    """Scene and words of a measure."""
    words, = (one.title for one in SCENES[scene].measures if one.key == key)
    return f"{SCENES[scene].title}: {words}"


def number(value):
    """Two digits; an empty text for what is not known."""
    return "" if value != value else f"{value:.2f}" if value >= 0.095 else f"{value:.1g}"


def moment_text(value):
    """A net moment; round-off by its bound."""
    return "" if value != value else f"{value:.1g}" if value > BALANCED else f"< {BALANCED:.0e}"


def overall_table(points, errors, base=1, types=None):
    """A row for each type: times and errors over those of `base`, exactness and net moment."""
    rows = pd.DataFrame(index=sorted_types(points) if types is None else types)
    pressure = errors[errors["measure"] == "pressure_error"].groupby("type", observed=True)
    rows["exact pressure"] = pressure["resolved"].any().map({True: "no", False: "yes"})
    for cost, title in COSTS.items():
        by_scene = geometric(over(points, cost, base), [points["type"], points["scene"]])
        of_type = by_scene.groupby(level="type", observed=True)
        rows[title] = geometric(by_scene, by_scene.index.get_level_values("type")).map(
            "{:.2f}".format) + of_type.agg(between).map(" ({})".format)
    ratios = geometric(over(errors, "judged", base), [errors["type"], errors["measure"]])
    for key, title in COMPARED.items():
        if key in ratios.index.get_level_values("measure"):
            rows[title] = ratios.xs(key, level="measure").map(number)
    if "moment" in points:
        moments = points.groupby("type", observed=True)["moment"].max()
        rows["net moment"] = moments.map(moment_text)
    return markdown_table(rows.rename(index=label).reset_index(names="type"))


def share_table(points):
    """Contact over computing time, from mesh to mesh and type to type."""
    shares = 100.0 * points["contact"] / points["computing"]
    found = shares.groupby(points["scene"], sort=False).agg(between, form="{:.0f}")
    return markdown_table(found.rename(index=lambda name: SCENES[name].title).reset_index(
        name="contact, % of computing time"))


def target_table(errors):
    """The cheapest types and mesh, by computing time, for each measure and target."""
    lines = []
    for (scene, key), rows in errors.groupby(["scene", "measure"], sort=False):
        lines.append([title_of(scene, key),
                      *(target_cell(rows[rows["judged"] <= target]) for target in TARGETS)])
    return markdown_table(["error at most", *(f"{100 * one:g} %" for one in TARGETS)], lines)


def target_cell(rows):
    """'4 5 7/1, 0.017 s': all points whose computing time is alike, and the shortest time."""
    if rows.empty:
        return "-"
    alike = rows.loc[least(dict(rows["computing"]), RUN_FACTOR)]
    parts = [" ".join(map(str, same["type"])) + f"/{level}"
             for level, same in alike.groupby("level")]
    return f"{', '.join(parts)}, {rows['computing'].min():.2g} s"


def mesh_table(errors):
    """Smallest, largest and mean error of the types on each mesh."""
    groups = errors.groupby(["scene", "measure", "level"], sort=False)["judged"]
    found = groups.agg(min="min", max="max", mean=geometric_mean).reset_index()
    found.insert(0, "error", [title_of(*pair) for pair in zip(found["scene"], found["measure"])])
    return markdown_table(found.drop(columns=["scene", "measure"]))


def reference_table(table):
    """What the references are and how far they are known."""
    runs, lines = finished(table), []
    for name, scene in SCENES.items():
        for key in (one.key for one in scene.measures if f"{one.key}_floor" in runs):
            mine = runs[runs["scene"] == name].dropna(subset=f"{key}_floor")
            for series in (REFERENCE_TYPE, HARD):
                known = mine[mine["type"].map(reference_series) == series]
                if len(known):
                    lines.append(reference_cells(title_of(name, key), known.iloc[0], key, series))
    return markdown_table(["reference", "type", "meshes, the last is the reference", "order",
                           "own error", "the two references apart"], lines)


def reference_cells(title, row, key, series):
    """One row of that table."""
    apart = row.get(f"{key}_springs")
    return [title, str(series), f"N_r = {row['reference_levels']}", f"{row[f'{key}_order']:.2f}",
            f"{100.0 * row[f'{key}_floor']:.2g} %",
            "" if apart is None or apart != apart else f"{100.0 * apart:.2g} %"]


def percent(row):
    """An error in per cent; in brackets, or by its bound, if it is not resolved."""
    if row.resolved:
        return f"{100.0 * row.error:.2g}"
    if row.floor < 1e-6:
        return f"< {100.0 * row.floor:.0e}".replace("e-0", "e-")
    return f"({100.0 * row.error:.2g})"


def scene_section(name, points, errors):
    """A row for each type: on each mesh the times, and the errors in per cent."""
    texts = errors.assign(text=[percent(row) for row in errors.itertuples()])
    cells = texts.groupby(["type", "level"], observed=True)["text"].agg(", ".join)
    seconds = points.set_index(["type", "level"])[list(COSTS)].map("{:.2g}".format)
    cells = seconds["contact"] + " / " + seconds["computing"] + " s; " + cells + " %"
    rows = cells.unstack("level", fill_value="").rename(index=label, columns="N_r = {}".format)
    named = "; ".join(title_of(name, key).split(": ")[1] for key in errors["measure"].unique())
    return (f"## {SCENES[name].title}\n\n![Error over cost](../pictures/speed_accuracy_{name}.png)"
            f"\n\nContact / computing time, and errors in per cent "
            f"({named}):\n\n" + markdown_table(rows.reset_index()))


def page(table):
    """Text of DOC/studies/speed_accuracy.md."""
    points = points_of(table)
    if points.empty:
        raise UserError("no finished runs")
    errors = errors_of(points)
    return page_of(
        "# Speed against accuracy",
        f"{'; '.join(sorted(set(points['build'])))}. Medians of {points['rounds'].min()} or more rounds; quartiles of contact times "
        f"at most {points['spread'].max():.0%} apart.",
        "## Over type 1", "Geometric means over meshes, then over scenes (from scene to scene); errors as far as they are known; net "
        "moment over contact force times a slave segment.", overall_table(points, errors),
        "## Over type 7", overall_table(points, errors, REFERENCE_TYPE, [IMPLICIT, HARD]),
        "## Share of contact", share_table(points),
        "## Cheapest types and mesh for an error, by computing time", target_table(errors),
        "## What the mesh changes", mesh_table(errors), "## References", reference_table(table),
        *(scene_section(name, points[points["scene"] == name], rows) for name, rows in errors.groupby("scene", sort=False)))


STUDY = Study("speed-accuracy", jobs, measure, chart, derive=add_errors, page=page,
              levels=(1, 2, 3, 4), types=tuple(SERIES), repeats=3, quick_levels=(1, 2))
