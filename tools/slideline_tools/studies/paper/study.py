# SPDX-License-Identifier: MIT
"""The scenes of Kang, Lee & Shin (2023) with all contact types: what they give, and what contact costs.

Runs that are timed (role `time`) write little and run alone, in turn; those whose results are read (role `result`) run
once. Type 1 is always timed, since the others are compared with it.
"""
import pandas as pd

from slideline_tools import scenes
from slideline_tools.contact_types import TYPES
from slideline_tools.fields import scalar_field
from slideline_tools.plots import PAGE_WIDTH, STYLE, colour_bar, draw_field, mark_cut, panel_height, plt
from slideline_tools.results import read
from slideline_tools.studies import block, collision, patch, peaks, sliding
from slideline_tools.studies.common import colour, label, markdown_table, page_of, save_small
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.framework.times import phases
from slideline_tools.studies.paper import costs
from slideline_tools.studies.paper.claims import claim_table

QUICK_PENALTIES = (1.0e6,)
PICTURED_MESH, PICTURED_PENALTY = "7_5", 1.0e6
ENLARGED = (3.55e-3, 4.45e-3)  # s, of the sliding force
SHIFT = 1.5  # per cent of the mean force between the types
PLATE = (-0.001, 0.066, -0.022, 0.007)  # m, of the collision


def jobs(options):
    """All runs of one round."""
    return patch_jobs(options) + scene_jobs(options) + timed_jobs(options)


def patch_jobs(options):
    """Every mesh, penalty and type; the quick study has one penalty."""
    listed = []
    for layout, (*_, penalties) in patch.LAYOUTS.items():
        for penalty in QUICK_PENALTIES if options.quick else penalties:
            deck = scenes.patch(penalty=penalty, grids=patch.layout_grids(layout))
            listed += [result(f"patch_{layout}_{penalty:.0e}_type_{ctype}".replace("+", ""), deck, "patch", 1, ctype,
                              cost=0.3, mesh=layout, penalty=penalty) for ctype in options.types]
    return listed


def meshes(options):
    """Name, scene, level and deck of blocks, sliding and collision."""
    return ((name, scene, level, scene.deck(level)) for name, scene in costs.SCENES.items() for level in scene.levels
            if level in options.levels)


def scene_jobs(options):
    """Blocks, sliding and collision with their output; the sliding with slave and master exchanged too."""
    listed = []
    for name, scene, level, deck in meshes(options):
        words = (f"p:dtforc={4.0e-7 / level:.17g}",) if name == "sliding" else ()
        listed += [result(f"{name}_{level}_type_{ctype}", deck, name, level, ctype, words,
                          cost=scene.cost * level ** 3) for ctype in options.types]
    if 5 in options.types and 1 in options.levels:
        listed.append(result("exchanged_1_type_5", scenes.sliding(exchanged=True), "exchanged", 1, 5, cost=15.0))
    return listed


def result(name, deck, scene, level, ctype, words=(), cost=1.0, **labels):
    """A run whose results are read."""
    return Job(name, deck, JOBS[scene], (f"ctype={ctype}", "ncpu=1", *words),
               {"scene": scene, "role": "result", "level": level, "type": ctype, **labels}, once=True, cost=cost)


#: Stem of the files of a scene.
JOBS = {"patch": "patch", "block": "block", "block_implicit": "block", "sliding": "sliding", "exchanged": "sliding",
        "collision": "collision"}


def timed_jobs(options):
    """Each scene, level and type with little output; the quick study cuts the sliding short."""
    return [Job(f"time_{name}_{level}_type_{ctype}", deck, JOBS[name],
                (f"ctype={ctype}", "ncpu=1", *scene.options, *(scene.quick * options.quick)),
                {"scene": name, "role": "time", "level": level, "type": ctype}, group=f"time_{name}_{level}",
                alone=True, turns=max(1, scene.turns // level), cost=scene.cost * level ** 3)
            for name, scene, level, deck in meshes(options) for ctype in sorted({1, *options.types})]


def measure(job, folder):
    """Seconds by phase of a timed run, else what the scene is judged by."""
    scene, level, ctype = (job.labels[name] for name in ("scene", "level", "type"))
    if job.labels["role"] == "time":
        return phases(folder / f"{job.jobid}.timing.csv")
    if scene == "patch":
        return patch.measure(folder, job.labels["mesh"])
    if scene == "collision":
        return collision.measure(folder)
    if scene == "exchanged":
        return sliding.point_counts(sliding.added_points(folder))
    if scene == "sliding":
        return sliding.measure(folder, level, ctype)
    return block.measure(folder, ctype, implicit=scene == "block_implicit")


def results_of(table, scene):
    """The finished runs of a scene whose results are read."""
    runs = finished(table)
    return runs[(runs["role"] == "result") & (runs["scene"] == scene)]


def types_of(runs, folder, level):
    """{type: run folder} of the runs of one level."""
    return {row.type: folder / "runs" / row.run for row in runs[runs["level"] == level].itertuples()}


# ---- pictures ----------------------------------------------------------------------------------

def chart(table, folder):
    """The picture of each scene that has run, and of the costs."""
    times = costs.times_of(table)
    if not times.empty:
        save_small(costs.cost_figure(times), folder / "paper_tables.png", lines=True)
    for scene, name, draw, dpi in (("patch", "patch_pressure", patch_figure, 150), ("block", "block_pressure", block_figure, 150),
                                   ("sliding", "sliding_force", sliding_figure, 110),
                                   ("collision", "collision_plastic_strain", strain_figure, 110)):
        runs = results_of(table, scene)
        if scene == "patch" and len(runs):
            runs = runs[(runs["mesh"] == PICTURED_MESH) & (runs["penalty"] == PICTURED_PENALTY)]
        if len(runs):
            level = int(runs["level"].min())
            with plt.rc_context({**STYLE, "figure.dpi": dpi, "savefig.dpi": dpi, "axes.grid": True}):
                save_small(draw(types_of(runs, folder, level), level), folder / f"{name}.png", lines=scene != "collision")


def patch_figure(folders, _level):
    """Pressure along both sides of the interface of the patch test."""
    figure, panels = plt.subplots(1, 2, layout="constrained", sharey=True, figsize=(PAGE_WIDTH, 3.4))
    for ctype, folder in folders.items():
        for axes, (x, pressure) in zip(panels, patch.sides(folder, patch.layout_grids(PICTURED_MESH))):
            axes.plot(x, pressure, color=colour(ctype), label=label(ctype), marker="o", markersize=3)
    for axes, title in zip(panels, ("slave side", "master side")):
        axes.set(title=title, xlabel="x (m)")
    panels[0].set_ylabel("contact pressure (Pa)")
    panels[0].legend(fontsize=7)
    return figure


def block_figure(folders, _level):
    """Pressure on the slave above, deviation from the one-dimensional one on both sides at two scales below."""
    grids = scenes.block_grids(block.N_SLAVE, block.N_MASTER)
    figure = plt.figure(figsize=(PAGE_WIDTH, 7.6), layout="constrained")
    grid = figure.add_gridspec(3, 2)
    whole = figure.add_subplot(grid[0, :])
    panels = {(row, side): figure.add_subplot(grid[row, column])
              for row in (1, 2) for column, side in enumerate(("slave", "master"))}
    for ctype, folder in folders.items():
        run = block.read_pressures(folder, grids)
        style = dict(color=colour(ctype), marker="o", markersize=1.6, linewidth=0.8)
        whole.plot(run.slave_x, run.slave, label=label(ctype), **style)
        exact = block.chain_pressure(block.interface_stiffness(ctype))
        for (row, side), axes in panels.items():
            reach, percent = ((3.0, 1.5), (10.0, 0.2))[row - 1]
            x, y = getattr(run, f"{side}_x"), 100.0 * block.side_deviations(run, exact)[side]
            axes.plot(x, y, **style)
            axes.set(xlim=(-0.02 * reach, 1.02 * reach), ylim=(-percent, percent), xlabel="x (m)",
                     ylabel="$p/p_{1D} - 1$ (%)", title=f"enlarged, {side} side")
            mark_cut(axes, x, y, colour(ctype))
    whole.set(ylabel="contact pressure (Pa)", title="slave surface")
    whole.set_ylim(0.0, 1.05 * whole.dataLim.ymax)
    whole.legend(ncols=4, loc="lower center")
    return figure


def sliding_figure(folders, level):
    """Force over the whole time, enlarged, and what is left without the trend, each type shifted."""
    figure, panels = plt.subplots(3, 1, layout="constrained", height_ratios=(2, 3, 3), figsize=(PAGE_WIDTH + 1.0, 9.0))
    for place, (ctype, folder) in enumerate(folders.items()):
        time, force = sliding.vertical_force(folder)
        line = dict(color=colour(ctype), label=label(ctype), linewidth=0.8)
        near = (time >= ENLARGED[0]) & (time <= ENLARGED[1])
        rest = force - peaks.trend(time, force, sliding.WINDOW_SHARE * sliding.crossing_time(level))
        middle, reach = -SHIFT * place, 100.0 * sliding.THRESHOLD
        panels[0].plot(1e3 * time[::20], force[::20] / 1e6, **line)
        panels[1].plot(1e3 * time[near], force[near] / 1e6, **line)
        panels[2].plot(1e3 * time, 100.0 * rest / sliding.force_peaks(time, force, level).mean + middle, **line)
        panels[2].axhspan(middle - reach, middle + reach, color="#00000012", linewidth=0)
    for axes, title, unit in zip(panels, (
            "vertical contact force", "the same, enlarged", f"force without its trend, each type shifted by {SHIFT:g} %; "
            "shaded: below the threshold of a peak"), ("MN/m", "MN/m", "% of the mean force")):
        axes.set_title(title, loc="left")
        axes.set_ylabel(unit)
    panels[0].legend(ncols=2)
    panels[2].set_xlim([1e3 * time for time in sliding.judged_interval()])
    panels[2].set_xlabel("time, ms")
    return figure


def strain_figure(folders, _level):
    """Plastic strain of the collision at 0.7 ms, colours as in Fig. 31 of the paper."""
    rows = (len(folders) + 1) // 2
    height = panel_height(PLATE, 0.45 * PAGE_WIDTH)
    figure, panels = plt.subplots(rows, 2, squeeze=False, layout="constrained",
                                  figsize=(PAGE_WIDTH + 1.0, rows * (height + 0.3) + 0.2))
    for axes in panels.flat:
        axes.set_axis_off()
    for axes, (ctype, folder) in zip(panels.flat, folders.items()):
        results = read(folder / "collision.vtkhdf")
        field = scalar_field(results, "plastic_strain")
        artist = draw_field(axes, results, field, results.state_index(repr(collision.SNAPSHOT_TIME)), 1.0, (0.0, 0.25))
        axes.set_xlim(PLATE[:2])
        axes.set_ylim(PLATE[2:])
        axes.set_title(label(ctype), loc="left")
    colour_bar(artist, list(panels.flat), field.label)
    return figure


# ---- tables ------------------------------------------------------------------------------------

def percent(share):
    """Per cent with two digits; what is round-off on any machine is exact."""
    if share < 1e-9:
        return "exact"
    return f"{100.0 * share:.0f}" if share > 1.0 else f"{100.0 * share:.2g}"


def by_type(runs, columns):
    """Markdown of a table with a row for each type; `columns`: {title: values by type}."""
    there = [ctype for ctype in TYPES if ctype in set(runs["type"])]
    return markdown_table(pd.DataFrame({"type": [label(ctype) for ctype in there],
                                        **{title: [values.get(ctype, "") for ctype in there]
                                           for title, values in columns.items()}}))


def patch_tables(runs):
    """Largest deviation of a nodal pressure on the slave / master side by penalty, a table for each mesh."""
    parts = []
    for mesh, same in runs.groupby("mesh", sort=False):
        columns = {f"{penalty:.0e}".replace("+", ""): {
            row.type: f"{percent(row.slave)} / {percent(row.master)}" for row in some.itertuples()}
            for penalty, some in same.groupby("penalty")}
        parts.append(f"Meshes {patch.LAYOUTS[mesh][0]}:\n\n{by_type(same, columns)}")
    return "\n\n".join(parts)


def block_table(runs):
    """Largest deviations on both sides, and Newton iterations of implicit runs."""
    runs = runs.set_index("type", drop=False)
    columns = {f"{side}, %": runs[side].map(percent) for side in ("slave", "master")}
    for name, title in (("first_iterations", "most iterations, steps 1 to 5"), ("later_iterations", "median of the later ones")):
        if name in runs and runs[name].notna().all():
            columns[title] = runs[name].astype(int)
    return by_type(runs, columns)


def level_table(runs, measures):
    """Columns `measures` {name: (title, factor)} on every mesh."""
    return by_type(runs, {f"{title}, N_r {level}": factor * same.set_index("type")[name]
                          for name, (title, factor) in measures.items()
                          for level, same in runs.groupby("level")})


SLIDING = {"peaks": ("peaks", 1), "largest": ("largest, %", 100.0), "rms": ("rms, %", 100.0), "waviness": ("waviness, %", 100.0)}
COLLISION = {"strain_below": ("plastic strain below the block", 1.0), "strain": ("of all", 1.0),
             "rebound": ("rebound, m/s", 1.0), "peak_force": ("largest force, MN/m", 1.0e-6),
             "energy_error": ("energy ratio - 1", 1.0)}

# Title and scene of a section, the picture and the words beside its table.
SECTIONS = (
    ("Section 2: patch test", "patch", "patch_pressure", patch_tables,
     "Largest deviation |p/p0 - 1| of a nodal pressure on the slave / master side in per cent, by the penalty in N/m (the picture: "
     "meshes 7 / 5, 1e06), explicit and damped to rest."),
    ("Section 4.1, Figs. 18 to 22: blocks, explicit", "block", "block_pressure", block_table,
     "Largest deviation at 0.2 s from the one-dimensional pressure, that of a chain of masses and springs with all the springs "
     "that the interface of the type has (`tests/verification/block_to_block/chain.py`)."),
    ("The same, implicit", "block_implicit", "", block_table, "Largest deviation at 0.2 s from the mean pressure of the side."),
    ("Section 4.2, Figs. 26 to 29: sliding", "sliding", "sliding_force", lambda runs: level_table(runs, SLIDING),
     "A peak: the force is off its trend (running median, then mean, over 1/16 of the time in which the die passes a master "
     "segment) by more than 0.25 % of its mean; *largest* and *rms* of that deviation; waviness: the trend less its mean over "
     "a segment, rms. `tools/slideline_tools/studies/peaks.py`, `sliding.py`."),
    ("Section 4.3, Figs. 31 and 32: collision", "collision", "collision_plastic_strain",
     lambda runs: level_table(runs, COLLISION), "Plastic strain at 0.7 ms; the rebound at the end."))


def page(table):
    """Text of DOC/studies/paper.md."""
    times = costs.times_of(table)
    parts = [] if times.empty else cost_section(table, times)
    for title, scene, picture, tables, words in SECTIONS:
        runs = results_of(table, scene)
        if not runs.empty:
            parts += [f"## {title}", words, f"![{title}](../pictures/{picture}.png)" if picture else "", tables(runs)]
    return page_of(
        "# The paper: what the runs gave",
        "Tables of `tools/study.sh paper`: the scenes of Kang, Lee & Shin (2023) with all contact types. N_r divides the cells. "
        "The paper covers types 1, 3, 4, 5 and 6; its program and machine are others, and dimensions and motions that it does "
        "not give are ours.", *parts)


def cost_section(table, times):
    """Costs, and the claims, some of which are about them."""
    claims = claim_table(table, times)
    return ["## Tables 1 and 2, Figs. 23, 24, 29, 32: what contact costs", "![Contact time](../pictures/paper_tables.png)",
            "Contact time over that of type 1, in brackets the paper's; medians, seconds corrected by the pace of the element loop.",
            costs.cost_table(times), costs.basis_table(times), *(["## Claims", claims] if claims else [])]


STUDY = Study("paper", jobs, measure, chart, page=page, levels=(1, 2, 3, 4), repeats=3, quick_repeats=1)
