# SPDX-License-Identifier: MIT
"""The sections of a report. Each is a function of the run that gives the blocks of a section (see
page.py), none when the run has nothing for it."""
import os
import re
import time

import numpy as np

from slideline_tools import UserError, plots
from slideline_tools.advise import advise
from slideline_tools.advise.report import saving_text, select
from slideline_tools.fields import ROUND_OFF, default_field, scalar_field
from slideline_tools.histories import History, trapezoid
from slideline_tools.report import charts
from slideline_tools.report.gather import Gathered
from slideline_tools.report.page import Block, Section, Table, figures, picture
from slideline_tools.walls import walls_of
from slideline_tools.zones import zones_figure

MOST_LOG_LINES, MOST_WARNINGS, MOST_NODES = 600, 200, 24
KINDS = {"normal": "normal termination", "error": "error termination",
         "unfinished": "not finished"}
UNITS = ("All numbers are in the units of the deck; forces, energies, masses and momenta are per "
         "unit of depth.")
#: tables that a deck asks for by name: title, and the columns that are drawn
ASKED = {"nodout": ("Nodes", "ux uy vx vy"), "elout": ("Elements", "sxx syy sxy plastic_strain"),
         "rbdout": ("Rigid bodies", "ux uy rotation vx vy spin"),
         "bndout": ("Loads and prescribed motion", "fx fy moment work"),
         "nodfor": ("Groups of nodes", "fx fy work"), "secforc": ("Cross sections", "fx fy moment")}


def all_sections(run: Gathered, names: list[str], states: list[str], scale: float) -> list[Section]:
    """Those that have something. Fields that were asked for by name must be there; where a table
    lacks a column, the section says so."""
    chosen = chosen_states(run, states)
    found: dict[str, tuple] = {"Summary": (summary,), "Warnings": (warnings,), "Energies": (energies,),
             "Contact": (contact, chosen), "Rigid walls": (walls,),
             "Fields": (fields, names, chosen, scale),
             "Nodes, elements, bodies and boundaries": (asked,),
             "Parts, materials, interfaces": (model,), "Timing": (timing,),
             "What this run did not need": (advice,), "Files, deck, log": (files,)}
    sections = []
    for title, (make, *more) in found.items():
        try:
            blocks = make(run, *more)
        except UserError as problem:
            if make is fields and names:
                raise
            blocks = [("note", f"This section could not be made: {problem}.")]
        if blocks:
            sections.append(Section(make.__name__, title, blocks))
    return sections


def summary(run: Gathered) -> list[Block]:
    """Which run this is, on which machine, and how it ended."""
    end, results, options, build = run.ending, run.results, run.attribute("options"), run.attribute("build")
    threads = re.findall(r"ncpu=(\d+)", options)
    stamps = [time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(stamp)) for stamp in
              sorted(os.stat(run.path(ending)).st_mtime for ending in run.sizes)]
    mesh = (f"{figures(len(run.model.points))} nodes, {figures(len(run.model.cells))} elements, "
            f"{len(run.model.parts)} parts" if run.model
            else f"{figures(results.n_node)} nodes, {figures(results.n_cell)} elements" if results
            else "")
    rows = [["title", run.title], ["deck", run.attribute("deck")], ["command line", options],
            ["program", f"slideline {run.attribute('version')}" + (f" ({build})" if build else "")],
            ["source", run.attribute("source")],
            ["machine", run.attribute("machine") or "unknown: only the results file names it"],
            ["threads", threads[-1] if threads else "1" if options else ""],
            ["ended", KINDS[end.kind] + (f": {end.reason}" if end.reason else "")],
            ["mesh", mesh],
            ["states", f"{results.n_state}, time {results.times[0]:g} to {results.times[-1]:g}"
             if results is not None and results.n_state else ""],
            ["files written", " to ".join(dict.fromkeys([stamps[0], stamps[-1]]))]]
    return [("table", Table([], [row for row in rows if row[1]])),
            *(("note", note) for note in [*run.notes, UNITS])]


def tiles_of(run: Gathered) -> list[tuple[str, str]]:
    """The few figures on top of the page."""
    found = [("problem time", figures(run.ending.time, 6)), ("cycles", figures(run.ending.cycle))]
    if run.ending.seconds is not None:
        found.append(("wall clock, s", figures(run.ending.seconds, 4)))
    if (glstat := run.rows("glstat")) and "energy_ratio" in glstat:
        found.append(("energy ratio at the end", figures(glstat["energy_ratio"][-1], 7)))
    if (rcforc := run.rows("rcforc")) and "fx" in rcforc and "fy" in rcforc:
        largest = np.hypot(rcforc["fx"], rcforc["fy"]).max()
        found.append(("largest contact force", figures(largest, 4)))
    if (rows := run.rows("contact")) and "pressure" in rows:
        found.append(("largest contact pressure", figures(rows["pressure"].max(), 4)))
    return [*found, ("warnings", figures(len(run.warnings)))]


def warnings(run: Gathered) -> list[Block]:
    """Warnings of the log, and the reason of an error termination."""
    found = run.warnings
    blocks = [("warning", one) for one in found[:MOST_WARNINGS]]
    if run.ending.kind == "error":
        blocks.insert(0, ("warning", f"Error termination: {run.ending.reason}"))
    if len(found) > MOST_WARNINGS:
        blocks.append(("text", f"{len(found) - MOST_WARNINGS} more stand in the log."))
    none = "None." if run.log else "Unknown: the log is empty or missing."
    return blocks or [("text", none)]


def energies(run: Gathered) -> list[Block]:
    """Energies, their balance and the time step."""
    if (glstat := run.rows("glstat")) is None:
        return []
    times, steps = glstat["time"], glstat["dt"]
    rows = [[name.replace("_", " "), figures(glstat[name][0], 7), figures(glstat[name][-1], 7),
             *extremes(times, glstat[name])]
            for name in (*charts.ENERGIES, "energy_ratio") if name in glstat]
    pictures = [picture(charts.energies(glstat), "Energies over time")]
    if len(glstat) > 1 and np.any(np.isfinite(glstat["energy_ratio"])):
        pictures.append(picture(
            charts.lines([("", times, glstat["energy_ratio"] - 1.0)], "energy ratio - 1"),
            "Balance: total energy over initial total and external work, minus one"))
    blocks: list[Block] = [("grid", pictures)]
    if np.ptp(steps) <= ROUND_OFF * np.max(np.abs(steps)):
        blocks.append(("text", f"The time step is {figures(steps[0], 7)} throughout."))
    else:
        pictures.append(picture(charts.step(glstat), "Time step over time"))
    head = ["energy", "at the start", "at the end", "lowest", "at time", "highest", "at time"]
    return [*blocks, ("table", Table(head, rows))]


def extremes(times: np.ndarray, values: np.ndarray) -> list[str]:
    """Lowest and highest value, each with its time."""
    if not np.any(np.isfinite(values)):
        return ["–"] * 4
    return [figures(column[at], digits) for at in (np.nanargmin(values), np.nanargmax(values))
            for column, digits in ((values, 7), (times, 4))]


# ---- contact ------------------------------------------------------------------------------------

def contact(run: Gathered, states: list[int]) -> list[Block]:
    """Force and pressure of each interface."""
    return [block for number in run.interfaces
            for block in [("heading", label(run, number)), *one_interface(run, number, states)]]


def label(run: Gathered, number: int) -> str:
    """Words for an interface, as far as the deck has them."""
    known = {one.id: one.described for one in run.model.interfaces} if run.model else {}
    words = known.get(number, f"interface {number}")
    return words[0].upper() + words[1:]


def of_interface(run: Gathered, table: str, number: int, **wanted) -> History | None:
    """The rows of an interface in a table, None where there are none."""
    rows = run.rows(table)
    rows = None if rows is None else rows.where(interface=number, **wanted)
    return rows if rows else None


def one_interface(run: Gathered, number: int, states: list[int]) -> list[Block]:
    """Charts and figures of one interface."""
    pictures, rows = [], []
    if slave := of_interface(run, "rcforc", number, side="slave"):
        pictures.append(picture(charts.columns(slave, ("fx", "fy"), "contact force on the slave"),
                                f"Force on the slave side of interface {number}"))
        rows += force_rows(slave, of_interface(run, "rcforc", number, side="master"))
    if chain := of_interface(run, "contact", number):
        pictures.append(picture(charts.pressures(chain, chosen_times(run, chain, states)),
                                f"Contact pressure along the slave surface of interface {number}"))
        rows += pressure_rows(chain)
        if slips := zones_figure(chain, chosen_times(run, chain, states), run.model):
            pictures.append(picture(
                slips,
                f"Where interface {number} sticks and slips, over time, and its friction traction; "
                "broken: mu times the pressure"))
    judged = of_interface(run, "sleout", number)
    if judged and "estimate" in judged and np.any(judged["estimate"]):
        pictures.append(picture(charts.estimates(judged),
                                f"How good the answer of interface {number} is"))
        pictures.append(picture(
            charts.lines([("", judged["time"], judged["energy"] - judged["stored"])],
                         "energy lost by contact"),
            f"Energy that contact of interface {number} has lost"))
        rows += [at_row(words, judged, column, judged["estimate"], 4,
                        "pressure against the stress behind it")
                 for words, column in (("estimate at the largest energy of the springs", "stored"),
                                       ("largest estimate", "estimate"))]
    rows += friction_rows(run, number, judged)
    if not rows:
        return [("text", "Neither forces (*DATABASE_RCFORC) nor pressures (plot states) were "
                         "written.")]
    return [("grid", pictures), ("table", Table(["", "value", "at time", ""], rows))]


def at_row(words: str, table: History, column: str | np.ndarray, values: np.ndarray, digits: int,
           more: str = "") -> list[str]:
    """A row: `values` and time where `column` is largest; `{name}` in `more` is a value there."""
    at = int(np.argmax(table[column] if isinstance(column, str) else column))
    there = {name: values[at] for name, values in table.columns.items()}
    value = values[at] if values.dtype.kind == "f" else int(values[at])
    return [words, figures(value, digits), figures(table["time"][at], 4), more.format(**there)]


def force_rows(slave: History, master: History | None) -> list[list[str]]:
    """Peak, impulse, contact points, and how well the two sides balance."""
    size = np.hypot(slave["fx"], slave["fy"])
    rows = [at_row("largest force", slave, size, size, 6, "fx {fx:.5g}, fy {fy:.5g}")]
    rows += [[f"impulse on the slave in {axis}",
              figures(trapezoid(slave[f"f{axis}"], slave["time"]), 6), "", ""] for axis in "xy"]
    rows.append(at_row("most contact points at once", slave, "n_active", slave["n_active"], 0))
    if master is not None and len(master) == len(slave) and size.max() > 0.0:
        rest = np.hypot(slave["fx"] + master["fx"], slave["fy"] + master["fy"]).max()
        rows.append(["largest sum of both sides over the largest force",
                     figures(rest / size.max(), 2), "", ""])
    return rows


def pressure_rows(chain: History) -> list[list[str]]:
    """Largest pressure and deepest penetration at plot states."""
    rows = [at_row("largest pressure at plot states", chain, "pressure", chain["pressure"], 6,
                   "node {node}")]
    if chain["gap"].min() < 0.0:
        rows.append(at_row("deepest penetration at plot states", chain, -chain["gap"],
                           -chain["gap"], 4, "node {node}"))
    return rows


def friction_rows(run: Gathered, number: int, sleout: History | None) -> list[list[str]]:
    """Work that friction of an interface has dissipated, by sleout; of a single one else by glstat."""
    table = sleout if sleout and "friction" in sleout else run.rows("glstat") if len(run.interfaces) == 1 else None
    if table is None or "friction" not in table or not table["friction"][-1]:
        return []
    known = [one.friction for one in run.model.interfaces if one.id == number] if run.model else []
    return [["frictional work", figures(table["friction"][-1], 6), figures(table["time"][-1], 4),
             f"coefficient {known[0]:g}" if known else ""]]


def chosen_times(run: Gathered, chain: History, states: list[int]) -> list[float]:
    """Times of the table nearest to the chosen states, each once."""
    known = np.unique(chain["time"])
    wanted = run.results.times[states] if run.results is not None and states else [known[-1]]
    return sorted({float(known[np.argmin(np.abs(known - one))]) for one in wanted})


def walls(run: Gathered) -> list[Block]:
    """Every rigid wall that the deck or rwforc tells of, and its force."""
    known = {wall.id: wall for wall in walls_of(run.deck)}
    rwforc = run.rows("rwforc")
    series = {} if rwforc is None else {entity[0]: rows for entity, rows in rwforc.series()}
    rows, pictures = [], []
    for number in sorted({**known, **series}):
        wall, forces = known.get(number), series.get(number)
        rows.append([number, *([figures(value, 5) for value in (*wall.point, *wall.normal)]
                               if wall else ["–"] * 4),
                     *(wall_row(forces) if forces else ["–"] * 5)])
        if forces:
            pictures.append(picture(
                charts.columns(forces, ("fx", "fy"), "force of the wall on the nodes"),
                f"Force of wall {number} on the nodes"))
    head = ["wall", "through x", "y", "normal in x", "y", "largest force",
            "at time", "impulse", "work on the nodes", "most nodes at once"]
    if rwforc is None:
        head, rows = head[:5], [row[:5] for row in rows]
    blocks: list[Block] = [("grid", pictures), ("table", Table(head, rows))]
    if rwforc is None:
        blocks.append(("note", "Their forces were not written (*DATABASE_RWFORC)."))
    return blocks if rows else []


def wall_row(rows: History) -> list[str]:
    """Largest force and its time, impulse and work at the end, most nodes at once."""
    size = np.hypot(rows["fx"], rows["fy"])
    top = int(np.argmax(np.nan_to_num(size)))
    return [figures(value, 6) for value in (size[top], rows["time"][top], rows["impulse"][-1],
                                            rows["work"][-1], np.nanmax(rows["n_active"]))]


# ---- fields and curves --------------------------------------------------------------------------

def chosen_states(run: Gathered, wanted: list[str]) -> list[int]:
    """States to show: those asked for, else those of the largest contact force and pressure (half
    way without contact), and the last."""
    results = run.results
    if results is None or not results.n_state:
        return []
    if wanted:
        return list(dict.fromkeys(results.state_index(one) for one in wanted))
    states = set()
    for name, first, second in (("rcforc", "fx", "fy"), ("contact", "pressure", "pressure")):
        if (rows := run.rows(name)) is not None:
            size = np.hypot(rows[first], rows[second])
            if np.any(size > 0.0):
                top = rows["time"][np.argmax(size)]
                states.add(int(np.argmin(np.abs(results.times - top))))
    last = results.n_state - 1
    return sorted((states or {last // 2}) | {last})


def fields(run: Gathered, names: list[str], states: list[int], scale: float) -> list[Block]:
    """Pictures of fields on the deformed mesh."""
    results = run.results
    if not states or results is None:
        return []
    usual = [default_field(results), *(["mises"] if "mises" in results.cell_fields else [])]
    times = " and ".join(f"{results.times[state]:.4g}" for state in states)
    labels = {name: scalar_field(results, name).label for name in names or dict.fromkeys(usual)}
    return [("grid", [picture(plots.field_figure(results, name, states, scale),
                              f"{label} at time {times}", "png")
                      for name, label in labels.items()])]


def asked(run: Gathered) -> list[Block]:
    """Curves of the histories that a deck asks for by name, with last and largest values."""
    return [block for name, (title, columns) in ASKED.items()
            if (rows := run.rows(name)) is not None
            for block in [("heading", title), *curves(rows, title, columns.split())]]


def curves(history: History, title: str, columns: list[str]) -> list[Block]:
    """The part of one table; columns in which nothing happens are left out."""
    found = [(history.entity_label(entity), rows.columns) for entity, rows in history.series()]
    if history.name == "nodfor":  # of groups of nodes the sums over their nodes
        sums = history.frame().groupby(["group", "time"], as_index=False).sum()
        found = [(f"group {group}", {name: rows[name].to_numpy() for name in rows})
                 for group, rows in sums.groupby("group", sort=False)]
    drawn = [name for name in columns if any(np.any(rows[name]) for _, rows in found)]
    if not drawn:
        return [("note", "All values are zero.")]
    pictures = [picture(charts.lines([(words, rows["time"], rows[name])
                                      for words, rows in found[:charts.MOST_LINES]],
                                     name.replace("_", " ")), f"{title}: {name.replace('_', ' ')}")
                for name in drawn]
    head = ["", *(f"{words} {name}" for name in drawn for words in ("last", "largest"))]
    rows = [[words, *(figures(value, 6) for name in drawn
                      for value in (rows[name][-1], np.abs(rows[name]).max()))]
            for words, rows in found[:MOST_NODES]]
    blocks: list[Block] = [("grid", pictures), ("table", Table(head, rows))]
    if len(found) > charts.MOST_LINES:
        blocks.append(("note", f"{len(found)} in all: the charts show {charts.MOST_LINES}, the "
                               f"table {len(rows)} of them."))
    return blocks


# ---- the model ----------------------------------------------------------------------------------

def model(run: Gathered) -> list[Block]:
    """Parts with their materials, and interfaces, as the program understood them."""
    return parts(run) + interfaces(run)


def parts(run: Gathered) -> list[Block]:
    """The parts with their materials and what they hold at the end."""
    known = run.model.parts if run.model else {}
    matsum = run.rows("matsum")
    sums = ("mass", "kinetic", "internal", "hourglass", "momentum_x", "momentum_y")
    rows = []
    for number, part in sorted(known.items()):
        last = matsum.where(part=number) if matsum else None
        rows.append([number, part.title, figures(part.n_element), part.material,
                     part.law, *(figures(value, 5) for value in (part.density, part.young, part.poisson)),
                     *(figures(last[name][-1], 5) if last else "–" for name in sums)])
    head = ["part", "title", "elements", "material", "law", "density", "Young's modulus", "Poisson's ratio",
            *(name.replace("_", " ") for name in sums)]
    note = ("note", "Energies and momenta are those of the last row of matsum.")
    return [("heading", "Parts"), ("table", Table(head, rows)),
            *([note] if matsum else [])] if rows else []


def interfaces(run: Gathered) -> list[Block]:
    """The interfaces with their surfaces."""
    rows = [[one.id, one.formulation, one.ctype, len(one.slave.nodes), len(one.master.nodes), figures(one.friction)]
            for one in run.model.interfaces] if run.model else []
    head = ["interface", "formulation", "type", "slave nodes", "master nodes", "friction"]
    return [("heading", "Interfaces"), ("table", Table(head, rows))] if rows else []


# ---- timing, advice, log ------------------------------------------------------------------------

def timing(run: Gathered) -> list[Block]:
    """Wall clock by phase."""
    if run.timing is None or not len(run.timing):
        return []
    columns = (run.timing[name].tolist() for name in ("phase", "seconds", "share", "calls"))
    rows = [[phase.replace("_", " "), f"{seconds:.4f}", f"{100.0 * share:.2f}", figures(int(calls))]
            for phase, seconds, share, calls in zip(*columns)]
    chart = [("grid", [picture(charts.timing(run.timing), "Wall clock by phase")])]
    return (chart if len(rows) > 1 else []) + [
        ("table", Table(["phase", "seconds", "share, %", "calls"], rows))]


def advice(run: Gathered) -> list[Block]:
    """What the run did not need, where that can be known (see the command advise)."""
    if run.ending.kind != "normal" or run.timing is None:
        return []
    try:
        finished, found, _ = advise(run.folder / f"{run.job}.log")
    except UserError:
        return []
    blocks: list[Block] = []
    for item in select(found, finished.total):
        saving = saving_text(item.seconds, finished.total)
        blocks += [("heading", item.what),
                   ("table", Table([], [["saving", f"{saving} ({item.basis})"],
                                        ["evidence", item.evidence], ["change", item.change]]))]
    return blocks


def files(run: Gathered) -> list[Block]:
    """The files, the deck without its mesh, and the log."""
    blocks: list[Block] = [
        ("table", Table(["file", "bytes"], [[run.path(ending).name, figures(size)] for ending, size in run.sizes.items()])),
        ("note", f"Folder: {run.folder.resolve()}")]
    if run.deck:
        blocks.append(("folded", ("The deck as run, without its mesh", shortened(re.sub(
            r"^(\*(?:NODE|ELEMENT).*\n)((?:[^*\n].*\n|\n)+)",
            lambda found: f"{found[1]}$ ({found[2].count(chr(10))} lines)\n", run.deck,
            flags=re.M | re.I)))))
    if run.log:
        blocks.append(("folded", ("The log", shortened(run.log))))
    return blocks


def shortened(words: str) -> str:
    """A long text without its middle."""
    found, half = words.splitlines(), MOST_LOG_LINES // 2
    if len(found) <= MOST_LOG_LINES:
        return words
    return "\n".join([*found[:half], f"... {len(found) - 2 * half} lines ...", *found[-half:]])
