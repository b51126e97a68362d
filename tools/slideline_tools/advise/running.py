# SPDX-License-Identifier: MIT
"""Advice on how the model was run: outputs written more often than they change, threads without work."""
import re

import numpy as np

from slideline_tools.advise.report import Advice

# Share of output in the run from which it is worth a word.
OUTPUT_MATTERS = 0.10
# Every k-th row is enough when straight lines between them miss no value in between by more than
# this part of the column's range.
COARSE_ERROR = 0.01
FACTORS = (2, 5, 10)
FEWEST_ROWS = 50
# Weights of what is written, microseconds on one core: only their ratios count, since the
# measured output time is shared out by them.
START, STATE, STATE_ELEMENT, CYCLE, CYCLE_ELEMENT, NUMBER = 4000.0, 300.0, 0.19, 5.0, 0.0017, 0.25
# Sums over elements that a row of these needs.
ROW_ELEMENT = {"glstat": 0.018, "matsum": 0.04}
CARDS = {"states": "*DATABASE_BINARY_D3PLOT", "glstat": "*DATABASE_GLSTAT",
         "matsum": "*DATABASE_MATSUM", "rcforc": "*DATABASE_RCFORC", "nodout": "*DATABASE_NODOUT"}
NOT_JUDGED_BY = ("cycle", "dt", "n_active", "energy_ratio", "mass", "length", "s")
# Elements a thread below which a further thread hardly pays (two threads took 0.7 of the time of
# one at 300 elements and 0.5 at 4000).
ELEMENTS_A_THREAD = 250


def written(run) -> dict[str, np.ndarray]:
    """Times at which each output was written."""
    times = {name: np.unique(run.tables[name]["time"]) for name in CARDS if name in run.tables}
    if run.results is not None:
        times["states"] = run.results.times
    return times


def weight(run, times: dict[str, np.ndarray]) -> float:
    """Weight of writing these times."""
    n_element = run.n_element
    cycles = len(np.unique(np.concatenate([*times.values(), [0.0]])))
    total = START + cycles * (CYCLE + CYCLE_ELEMENT * n_element)
    for name, when in times.items():
        if name == "states":
            total += len(when) * (STATE + STATE_ELEMENT * n_element)
        else:
            table = run.tables[name]
            rows = len(table) / max(len(np.unique(table["time"])), 1)
            total += len(when) * (rows * len(table.columns) * NUMBER
                                  + ROW_ELEMENT.get(name, 0.0) * n_element)
    return total


def saving(run, name: str, fewer: np.ndarray) -> float:
    """Seconds saved when `name` is written at the times `fewer` only."""
    times = written(run)
    before = weight(run, times)
    return run.seconds_of("output") * (before - weight(run, {**times, name: fewer})) / before


def coarse_error(times: np.ndarray, values: np.ndarray, factor: int) -> float:
    """Largest error of straight lines through every `factor`-th row (and the last), over the
    range of each column; `values` (n, columns)."""
    kept = np.unique(np.append(np.arange(0, len(times), factor), len(times) - 1))
    lines = np.stack([np.interp(times, times[kept], column[kept]) for column in values.T], axis=1)
    span = np.ptp(values, axis=0)
    moving = span > 1.0e-12 * np.abs(values).max(initial=0.0)
    if not moving.any():
        return 0.0
    return float((np.abs(lines - values).max(axis=0)[moving] / span[moving]).max())


def table_error(table, factor: int) -> float:
    """Error of every `factor`-th row in all series of a history."""
    names = [name for name in table.value_columns if name not in NOT_JUDGED_BY]
    return max(coarse_error(rows["time"], np.stack([rows[name] for name in names], axis=1), factor)
               for _, rows in table.series())


def states_error(results, factor: int) -> float:
    """Error of every `factor`-th state in displacement and Mises stress, over their ranges."""
    fields = [results.point_field("displacement")]
    fields += [results.cell_field("mises")] if "mises" in results.cell_fields else []
    kept = np.unique(np.append(np.arange(0, results.n_state, factor), results.n_state - 1))
    largest = 0.0
    for field in fields:
        span = float(np.ptp(field)) or 1.0
        place = np.interp(results.times, results.times[kept], np.arange(len(kept)))
        low = np.minimum(place.astype(int), len(kept) - 2)
        part = (place - low).reshape((-1,) + (1,) * (field.ndim - 1))
        line = (1.0 - part) * field[kept[low]] + part * field[kept[low + 1]]
        largest = max(largest, float(np.abs(line - field).max()) / span)
    return largest


def ordinal(number: int) -> str:
    """2nd, 5th, 10th."""
    return f"{number}{'nd' if number == 2 else 'th'}"


def too_often(run) -> list[Advice]:
    """Outputs whose every k-th row would tell the same."""
    if run.seconds_of("output") < OUTPUT_MATTERS * run.total:
        return []
    advice = []
    for name, times in written(run).items():
        if len(times) < FEWEST_ROWS:
            continue
        best, error = 1, 0.0
        for factor in FACTORS:
            found = (states_error(run.results, factor) if name == "states"
                     else table_error(run.tables[name], factor))
            if found > COARSE_ERROR:
                break
            best, error = factor, found
        if best == 1:
            continue
        fewer = times[::best]
        interval = float(np.median(np.diff(times)))
        advice.append(Advice(
            "written too often", f"{name} are written more often than they change: every "
            f"{ordinal(best)} would do.",
            f"output takes {run.seconds_of('output') / run.total:.0%} of the run; {len(times)} "
            f"times {name}, straight lines between every {ordinal(best)} miss the others "
            f"by at most {error:.1%} of the range", f"DT of {CARDS[name]} from {interval:.3g} to "
            f"{best * interval:.3g}", saving(run, name, fewer),
            "output time shared out by numbers written"))
    return advice


def many_threads(run) -> list[Advice]:
    """More threads than the mesh feeds."""
    found = re.search(r"\bncpu=(\d+)", run.options)
    threads = int(found[1]) if found else 1
    enough = max(1, -(-run.n_element // ELEMENTS_A_THREAD))
    if threads <= enough:
        return []
    return [Advice(
        "threads", f"{threads} threads are more than this mesh feeds.",
        f"{run.n_element} elements, {run.n_element // threads} a thread",
        f"ncpu={enough} on the command line; the results have the same bits", None,
        f"{threads - enough} cores free for {run.total:.2g} s")]


CHECKS = (too_often, many_threads)
