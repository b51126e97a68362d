# SPDX-License-Identifier: MIT
"""The sections of a report. Each is a function of the run that gives a Section, or None when the
run has nothing for it."""
from __future__ import annotations

import os
import re
import time

import numpy as np

from slideline_tools import UserError, advise
from slideline_tools.advise import report as advice_report
from slideline_tools.fields import ROUND_OFF, default_field, scalar_field
from slideline_tools.files import source
from slideline_tools.report import charts
from slideline_tools.report.gather import Gathered
from slideline_tools.report.html import (Section, figures, folded, paragraph, picture, table,
                                         text)

MOST_LOG_LINES, MOST_WARNINGS, MOST_NODES = 600, 200, 24
KINDS = {"normal": "normal termination", "error": "error termination",
         "unfinished": "not finished"}


# ---- summary ------------------------------------------------------------------------------------

def summary(run: Gathered) -> Section:
    """Which run this is, on which machine, and how it ended."""
    end, model = run.ending, run.model
    rows = [["title", run.title], ["deck", run.told("deck")],
            ["command line", run.told("options")],
            ["program", " ".join(filter(None, ("slideline", run.told("version"),
                                               bracketed(run.told("build")))))],
            ["source", run.told("source")],
            ["machine", run.told("machine") or "unknown: only the results file names it"],
            ["threads", threads(run.told("options"))],
            ["ended", KINDS[end.kind] + (f": {end.reason}" if end.reason else "")],
            ["problem time", figures(end.time, 9)], ["cycles", figures(end.cycle)],
            ["wall clock", f"{figures(end.seconds)} s" if end.seconds is not None else "–"],
            ["warnings", figures(len(run.warnings))]]
    if model:
        rows.append(["mesh", f"{figures(len(model.points))} nodes, {figures(len(model.cells))} "
                             f"elements, {len(model.parts)} parts"])
    elif run.results:
        rows.append(["mesh", f"{figures(run.results.n_node)} nodes, "
                             f"{figures(run.results.n_cell)} elements"])
    if run.results is not None and run.results.n_state:
        times = run.results.times
        rows.append(["states", f"{len(times)}, time {times[0]:g} to {times[-1]:g}"])
    rows.append(["files written", written(run)])
    body = table([], [row for row in rows if row[1]])
    body += "".join(paragraph(note, "note") for note in run.notes)
    body += paragraph("All numbers are in the units of the deck; forces, energies, masses and momenta "
                      "are per unit of depth.", "note")
    return Section("summary", "Summary", body)


def bracketed(words: str) -> str:
    """Words in brackets, or nothing."""
    return f"({words})" if words else ""


def threads(options: str) -> str:
    """The number of threads that the command line asks for."""
    found = re.findall(r"ncpu=(\d+)", options)
    return found[-1] if found else ("1" if options else "")


def written(run: Gathered) -> str:
    """First and last writing of the files of the run."""
    stamps = [os.stat(run.folder / name).st_mtime for name, _ in run.files]
    first, last = (time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(stamp))
                   for stamp in (min(stamps), max(stamps)))
    return last if first == last else f"{first} to {last}"


def tiles_of(run: Gathered) -> list[tuple[str, str]]:
    """The few figures on top of the page."""
    found = [("problem time", figures(run.ending.time, 6)), ("cycles", figures(run.ending.cycle))]
    if run.ending.seconds is not None:
        found.append(("wall clock, s", figures(run.ending.seconds, 4)))
    if (glstat := run.rows("glstat")) and "energy_ratio" in glstat:
        found.append(("energy ratio at the end", figures(float(glstat["energy_ratio"][-1]), 7)))
    if (rcforc := run.rows("rcforc")) and "fx" in rcforc and "fy" in rcforc:
        size = np.hypot(rcforc["fx"], rcforc["fy"])
        found.append(("largest contact force", figures(float(size.max()), 4)))
    if (contact := run.rows("contact")) and "pressure" in contact:
        found.append(("largest contact pressure", figures(float(contact["pressure"].max()), 4)))
    found.append(("warnings", figures(len(run.warnings))))
    return found


def warnings(run: Gathered) -> Section:
    """Warnings of the log, and the reason of an error termination."""
    body = ""
    if run.ending.kind == "error":
        body += f'<p class="warning"><b>Error termination:</b> {text(run.ending.reason)}</p>\n'
    found = run.warnings
    body += "".join(f'<p class="warning">{text(one)}</p>\n' for one in found[:MOST_WARNINGS])
    if len(found) > MOST_WARNINGS:
        body += paragraph(f"{len(found) - MOST_WARNINGS} more stand in the log.")
    if not body:
        body = paragraph("None." if run.log_text else "Unknown: the log is empty or missing.")
    return Section("warnings", "Warnings", body)


# ---- energies -----------------------------------------------------------------------------------

def energies(run: Gathered) -> Section | None:
    """Energies, their balance and the time step."""
    glstat = run.rows("glstat")
    if glstat is None:
        return None
    times = glstat["time"]
    rows = []
    for name in (*charts.ENERGIES, "energy_ratio"):
        if name in glstat:
            values = glstat[name]
            rows.append([name.replace("_", " "),
                         *(figures(float(value), 7) for value in (values[0], values[-1])),
                         *extremes(times, values)])
    body = '<div class="grid">\n' + picture(charts.energies(glstat), "Energies over time")
    if len(glstat) > 1 and np.any(np.isfinite(glstat["energy_ratio"])):
        body += picture(charts.balance(glstat),
                        "Balance: total energy over initial total and external work, minus one")
    steps = glstat["dt"]
    constant = np.ptp(steps) <= ROUND_OFF * np.max(np.abs(steps))
    body += ("" if constant else picture(charts.step(glstat), "Time step over time")) + "</div>\n"
    if constant:
        body += paragraph(f"The time step is {figures(float(steps[0]), 7)} throughout.")
    body += table(["energy", "at the start", "at the end", "lowest", "at time", "highest", "at time"],
                  rows, set(range(1, 7)))
    return Section("energies", "Energies", body)


def extremes(times: np.ndarray, values: np.ndarray) -> list[str]:
    """Lowest and highest value, each with its time."""
    if not np.any(np.isfinite(values)):
        return ["–"] * 4
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    return [figures(float(values[low]), 7), figures(float(times[low]), 4),
            figures(float(values[high]), 7), figures(float(times[high]), 4)]


# ---- contact ------------------------------------------------------------------------------------

def contact(run: Gathered, states: list[int]) -> Section | None:
    """Force and pressure of each interface."""
    if not run.interfaces:
        return None
    body = "".join(f"<h3>{text(label(run, number))}</h3>\n" + one_interface(run, number, states)
                   for number in run.interfaces)
    return Section("contact", "Contact", body)


def label(run: Gathered, number: int) -> str:
    """Words for an interface, as far as log and deck have them."""
    if number in run.log.interfaces:
        return run.log.interfaces[number].label[0].upper() + run.log.interfaces[number].label[1:]
    for interface in run.model.interfaces if run.model else ():
        if interface.id == number:
            return interface.label[0].upper() + interface.label[1:]
    return f"Interface {number}"


def one_interface(run: Gathered, number: int, states: list[int]) -> str:
    """Charts and figures of one interface."""
    rcforc, contact_rows = run.rows("rcforc"), run.rows("contact")
    pictures, rows = "", []
    if rcforc is not None and len(slave := rcforc.where(interface=number, side="slave")):
        pictures += picture(charts.forces(slave), f"Force on the slave side of interface {number}")
        rows += force_rows(slave, rcforc.where(interface=number, side="master"))
    if contact_rows is not None and len(chain := contact_rows.where(interface=number)):
        times = chosen_times(run, chain, states)
        pictures += picture(charts.pressures(chain, times),
                            f"Contact pressure along the slave surface of interface {number}")
        rows += pressure_rows(chain)
        if "state" in chain and np.any(chain["state"]):
            pictures += picture(charts.zones(chain), f"Where interface {number} sticks and slips, over time")
            if run.results is not None and states:
                pictures += picture(charts.tractions(run.results, chain, number, states),
                                    f"Friction traction along the slave surface of interface {number}; broken: what friction allows")
    if (sleout := run.rows("sleout")) is not None and "estimate" in sleout \
            and np.any((judged := sleout.where(interface=number))["estimate"]):
        pictures += picture(charts.estimates(judged), f"How good the answer of interface {number} is")
        pictures += picture(charts.made(judged), f"Energy that contact of interface {number} has lost")
        rows += estimate_rows(judged)
    rows += friction_rows(run, number)
    if not rows:
        return paragraph("Neither forces (*DATABASE_RCFORC) nor pressures (plot states) were written.")
    return f'<div class="grid">\n{pictures}</div>\n' + table(["", "value", "at time", ""], rows,
                                                            {1, 2})


def force_rows(slave, master) -> list[list[str]]:
    """Peak, impulse, contact points, and how well the two sides balance."""
    times, fx, fy = slave["time"], slave["fx"], slave["fy"]
    size = np.hypot(fx, fy)
    top = int(np.argmax(size))
    rows = [["largest force", figures(float(size[top]), 6), figures(float(times[top]), 4),
             f"fx {fx[top]:.5g}, fy {fy[top]:.5g}"]]
    for name, values in (("x", fx), ("y", fy)):
        impulse = float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(times)))
        rows.append([f"impulse on the slave in {name}", figures(impulse, 6), "", ""])
    most = int(np.argmax(slave["n_active"]))
    rows.append(["most contact points at once", figures(int(slave["n_active"][most])),
                 figures(float(times[most]), 4), ""])
    if len(master) == len(slave) and size[top] > 0.0:
        rest = np.hypot(fx + master["fx"], fy + master["fy"]).max()
        rows.append(["largest sum of both sides over the largest force",
                     figures(float(rest / size[top]), 2), "", ""])
    return rows


def friction_rows(run: Gathered, number: int) -> list[list[str]]:
    """Work that friction of an interface has dissipated: at the end by the log, else by the last row of sleout; none
    without friction."""
    one, sleout = run.log.interfaces.get(number), run.rows("sleout")
    if one is not None and not one.friction:
        return []
    if one is not None and one.dissipated is not None:
        return [["frictional work", figures(one.dissipated, 6), figures(run.ending.time, 4), f"coefficient {one.friction:g}"]]
    rows = sleout.where(interface=number) if sleout is not None and "friction" in sleout else ()
    if not len(rows) or (one is None and not np.any(rows["friction"])):
        return []
    return [["frictional work", figures(float(rows["friction"][-1]), 6), figures(float(rows["time"][-1]), 4), ""]]


def estimate_rows(judged) -> list[list[str]]:
    """The estimate where springs hold the most energy, and the largest."""
    rows = []
    for name, at in (("estimate at the largest energy of the springs", int(np.argmax(judged["stored"]))),
                     ("largest estimate", int(np.argmax(judged["estimate"])))):
        rows.append([name, figures(float(judged["estimate"][at]), 4), figures(float(judged["time"][at]), 4),
                     "pressure against the stress behind it"])
    return rows


def pressure_rows(chain) -> list[list[str]]:
    """Largest pressure and deepest penetration at plot states."""
    top, deep = int(np.argmax(chain["pressure"])), int(np.argmin(chain["gap"]))
    rows = [["largest pressure at plot states", figures(float(chain["pressure"][top]), 6),
             figures(float(chain["time"][top]), 4), f"node {chain['node'][top]}"]]
    if chain["gap"][deep] < 0.0:
        rows.append(["deepest penetration at plot states", figures(float(-chain["gap"][deep]), 4),
                     figures(float(chain["time"][deep]), 4), f"node {chain['node'][deep]}"])
    return rows


def chosen_times(run: Gathered, chain, states: list[int]) -> list[float]:
    """Times of the table nearest to the chosen states, each once."""
    known = np.unique(chain["time"])
    wanted = [run.results.times[state] for state in states] if run.results is not None and states \
        else [known[-1]]
    return sorted({float(known[np.argmin(np.abs(known - time))]) for time in wanted})


# ---- fields -------------------------------------------------------------------------------------

def chosen_states(run: Gathered, wanted: list[str]) -> list[int]:
    """States to show: those asked for, else those of the largest contact force and pressure (half
    way without contact), and the last."""
    results = run.results
    if results is None or not results.n_state:
        return []
    if wanted:
        return list(dict.fromkeys(results.state_index(one) for one in wanted))
    last = results.n_state - 1
    tops = []
    for name, columns in (("rcforc", ("fx", "fy")), ("contact", ("pressure", "pressure"))):
        if (rows := run.rows(name)) is not None:
            size = np.hypot(rows[columns[0]], rows[columns[1]])
            if np.any(size > 0.0):
                tops.append(float(rows["time"][np.argmax(size)]))
    states = {int(np.argmin(np.abs(results.times - top))) for top in tops}
    return sorted((states or {last // 2}) | {last})


def fields(run: Gathered, names: list[str], states: list[int], scale: float) -> Section | None:
    """Pictures of fields on the deformed mesh."""
    if not states:
        return None
    results = run.results
    if not names:
        names = [default_field(results)]
        if "mises" in results.cell_fields and "mises" not in names:
            names.append("mises")
    body = ""
    for name in names:
        shown = scalar_field(results, name)
        pictures = "".join(picture(charts.field(results, shown, state, states, scale),
                                   f"{shown.label} at time {results.times[state]:.4g}", "png")
                           for state in states)
        body += f'<h3>{text(shown.label[0].upper() + shown.label[1:])}</h3>\n' \
                f'<div class="grid">\n{pictures}</div>\n'
    return Section("fields", "Fields", body)


def nodes(run: Gathered) -> Section | None:
    """Motion of chosen nodes."""
    nodout = run.rows("nodout")
    if nodout is None:
        return None
    series = nodout.series()
    rows = [[entity[0], *(figures(float(one[name][-1]), 6) for name in ("ux", "uy", "vx", "vy")),
             *(figures(float(np.abs(one[name]).max()), 6) for name in ("ux", "uy"))]
            for entity, one in series[:MOST_NODES]]
    body = ('<div class="grid">\n' + picture(charts.nodes(nodout, "ux"), "Displacement in x")
            + picture(charts.nodes(nodout, "uy"), "Displacement in y") + "</div>\n"
            + table(["node", "ux at the end", "uy", "vx", "vy", "largest |ux|", "largest |uy|"], rows,
                    set(range(7))))
    if len(series) > MOST_NODES:
        body += paragraph(f"{len(series)} nodes in all; the charts show {charts.MOST_LINES}, the table "
                          f"{MOST_NODES} of them.", "note")
    return Section("nodes", "Nodes", body)


# ---- the model ----------------------------------------------------------------------------------

def understood(run: Gathered) -> Section | None:
    """Parts, materials and interfaces as the program understood them."""
    body = part_table(run) + material_table(run) + interface_table(run)
    return Section("model", "Parts, materials, interfaces", body) if body else None


def part_table(run: Gathered) -> str:
    """The parts with what they hold at the end."""
    parts = {**(run.model.parts if run.model else {}), **run.log.parts}
    matsum = run.rows("matsum")
    rows = []
    for number, part in sorted(parts.items()):
        row = [number, part.title, figures(part.n_element), part.material, law_of(run, number)]
        last = matsum.where(part=number) if matsum is not None else ()
        row += [figures(float(last[name][-1]), 5) if len(last) else "–"
                for name in ("mass", "kinetic", "internal", "hourglass", "momentum_x", "momentum_y")]
        rows.append(row)
    if not rows:
        return ""
    return "<h3>Parts</h3>\n" + table(
        ["part", "title", "elements", "material", "law", "mass", "kinetic", "internal", "hourglass",
         "momentum x", "momentum y"], rows, {2, 5, 6, 7, 8, 9, 10}) + (
        paragraph("Energies and momenta are those of the last row of matsum.", "note")
        if matsum is not None else "")


def law_of(run: Gathered, number: int) -> str:
    """Name of the law of a part."""
    part = run.model.parts.get(number) if run.model else None
    return part.law if part else ""


def material_table(run: Gathered) -> str:
    """The materials as the log has them."""
    if not run.log.materials:
        return ""
    names = list(dict.fromkeys(name for one in run.log.materials.values() for name in one))
    rows = [[number, *(figures(one.get(name), 5) for name in names)]
            for number, one in sorted(run.log.materials.items())]
    return "<h3>Materials</h3>\n" + table(["material", *names], rows,
                                          set(range(1, len(names) + 1)))


def interface_table(run: Gathered) -> str:
    """The interfaces with their surfaces and penalties."""
    if run.log.interfaces:
        rows = [[number, one.name, one.ctype, one.n_slave, figures(one.slave_length, 4), one.n_master,
                 figures(one.master_length, 4), figures(one.slave_penalty, 4),
                 figures(one.master_penalty, 4) if one.master_penalty else ""]
                for number, one in sorted(run.log.interfaces.items())]
        head = ["interface", "formulation", "type", "slave nodes", "mean length", "master nodes",
                "mean length", "penalty per length", "of the master pass"]
        return "<h3>Interfaces</h3>\n" + table(head, rows, {3, 4, 5, 6, 7, 8})
    if run.model and run.model.interfaces:
        rows = [[one.id, one.formulation, len(one.slave.nodes), len(one.master.nodes)] for one in run.model.interfaces]
        return "<h3>Interfaces</h3>\n" + table(["interface", "formulation", "slave nodes", "master nodes"], rows, {2, 3})
    return ""


# ---- timing, advice, log ------------------------------------------------------------------------

def timing(run: Gathered) -> Section | None:
    """Wall clock by phase."""
    if run.timing is None or not len(run.timing):
        return None
    rows = [[str(phase).replace("_", " "), f"{seconds:.4f}", f"{100.0 * share:.2f}",
             figures(int(calls))]
            for phase, seconds, share, calls in zip(*(run.timing[name] for name in
                                                      ("phase", "seconds", "share", "calls")))]
    body = ""
    if len(rows) > 1:
        chart = picture(charts.timing(run.timing), "Wall clock by phase")
        body = f'<div class="grid">\n{chart}</div>\n'
    body += table(["phase", "seconds", "share, %", "calls"], rows, {1, 2, 3})
    return Section("timing", "Timing", body)


def savings(run: Gathered) -> Section | None:
    """What the run did not need, where that can be told (see the command advise)."""
    if run.ending.kind != "normal" or run.timing is None:
        return None
    try:
        finished, found, _ = advise.advise(run.folder / f"{run.job}.log")
    except UserError:
        return None
    shown = advice_report.select(found, finished.total)
    if not shown:
        return None
    body = "".join(
        f"<h3>{text(item.what)}</h3>\n"
        + table([], [["saving", f"{advice_report.saving_text(item.seconds, finished.total)} "
                                f"({item.basis})"],
                     ["evidence", item.evidence], ["change", item.change]]) for item in shown)
    return Section("advice", "What this run did not need", body)


def files(run: Gathered) -> Section:
    """The files, the deck without its mesh, and the log."""
    body = table(["file", "bytes"], [[name, figures(size)] for name, size in run.files], {1})
    body += paragraph(f"Folder: {run.folder.resolve()}", "note")
    if deck := deck_text(run):
        body += folded("The deck as run, without its mesh", f"<pre>{text(deck)}</pre>\n")
    if run.log_text:
        body += folded("The log", f"<pre>{text(shortened(run.log_text))}</pre>\n")
    return Section("files", "Files, deck, log", body)


def deck_text(run: Gathered) -> str:
    """The effective deck with the lines of nodes and elements counted, not shown."""
    path = run.folder / f"{run.job}.effective.k"
    whole = source(path).read_text(encoding="utf-8", errors="replace") if path.exists() else (
        run.results.run.get("effective_deck", "") if run.results else "")
    kept, hidden = [], 0
    in_mesh = False
    for line in whole.splitlines():
        if line.startswith("*"):
            if hidden:
                kept.append(f"$ ({hidden} lines)")
            in_mesh, hidden = line.upper().startswith(("*NODE", "*ELEMENT")), 0
        if in_mesh and not line.startswith("*"):
            hidden += 1
        else:
            kept.append(line)
    return shortened("\n".join(kept))


def shortened(words: str) -> str:
    """A long text without its middle."""
    found = words.splitlines()
    if len(found) <= MOST_LOG_LINES:
        return words
    half = MOST_LOG_LINES // 2
    return "\n".join(found[:half] + [f"... {len(found) - 2 * half} lines ..."] + found[-half:])
