# SPDX-License-Identifier: MIT
"""What an answer looks like: a table, a chart, JSON."""
import json
import math

from slideline_tools.answer.loop import Answer, Answers
from slideline_tools.contact_types import PROGRAM_NAMES
from slideline_tools.plots import COLOURS, PAGE_WIDTH, STYLE, plt


def plus_minus(one: Answer) -> str:
    """The value, its uncertainty and their ratio."""
    found = one.estimate
    if not math.isfinite(found.uncertainty):
        return f"{found.value:.6g}, uncertainty unknown"
    digits = 0 if not found.uncertainty or not found.value else math.floor(math.log10(abs(found.value))) - math.floor(
        math.log10(found.uncertainty)) + 2
    share = f" ({rounded_up(100.0 * found.relative)} %)" if math.isfinite(found.relative) else ""
    return f"{found.value:.{min(max(digits, 3), 10)}g} +- {found.uncertainty:.2g}{share}"


def rounded_up(value: float) -> str:
    """A positive number with three digits, not less than it is: what just misses a target is seen to."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2) if value else 1.0
    return f"{math.ceil(value / unit - 1e-9) * unit:.3g}"


def table(found: Answers) -> str:
    """Lines for a reader: each quantity, then all runs."""
    lines = []
    for one in found.answers:
        lines += [f"{one.quantity.text} = {plus_minus(one)}", f"  {one.reason}"]
    heads = ["mesh", "elements", "updates", "seconds", *(f"value {k}" if len(found.answers) > 1 else "value"
                                                         for k in range(1, len(found.answers) + 1))]
    rows = [[f"{run.mesh:g}", str(run.elements), f"{run.updates:.3g}", f"{run.seconds:.2g}",
             *(f"{one.values[k]:.6g}" for one in found.answers)] for k, run in enumerate(found.runs)]
    widths = [max(map(len, column)) for column in zip(heads, *rows)]
    return "\n".join(lines + ["  ".join(cell.rjust(width) for cell, width in zip(row, widths)) for row in (heads, *rows)])


def facts(found: Answers) -> dict:
    """What answer.json says: of each quantity value, uncertainty, order, runs, reason; the first also at the top."""
    answers = [{
        "quantity": one.quantity.text, "value": one.estimate.value,
        "uncertainty": one.estimate.uncertainty if math.isfinite(one.estimate.uncertainty) else None,
        "order": one.estimate.order, "within": one.within, "reason": one.reason,
        "runs": [{"mesh": run.mesh, "elements": run.elements, "updates": run.updates, "seconds": run.seconds, "value": one.values[k]}
                 for k, run in enumerate(found.runs)]} for one in found.answers]
    return {**answers[0], "reached": found.reached, "answers": answers}


def json_of(deck, found: Answers, tried=()) -> str:
    """The text of answer.json; `tried`: the answers by contact type, in the order they were tried."""
    whole = {"deck": str(deck), **facts(found)}
    if tried:
        whole["type"] = found.contact_type
        whole["tried"] = [{"type": one.contact_type, "seconds": one.seconds, **facts(one)} for one in tried]
    return json.dumps(whole, indent=1) + "\n"


def choice(found: Answers, tried) -> str:
    """A line for each contact type that was tried, and the one that was taken."""
    lines = [f"{name(one)}: {plus_minus(one.answers[0])} in {one.seconds:.2g} s{'' if one.reached else ', not reached'}" for one in tried]
    best = f"{name(found)} reached it at least cost" if found.reached else f"no type reached it; the nearest is {name(found)}"
    return "\n".join([*lines, best])


def name(found: Answers) -> str:
    """A contact type by number and name."""
    return f"type {found.contact_type} ({PROGRAM_NAMES[found.contact_type]})"


def chart(found: Answers, path) -> None:
    """Value over element updates, a panel for each quantity; the answer with its bar."""
    count = len(found.answers)
    with plt.rc_context(STYLE):
        figure, panels = plt.subplots(count, 1, squeeze=False, layout="constrained", figsize=(PAGE_WIDTH, 0.6 + 2.2 * count))
        updates = [run.updates for run in found.runs]
        for axes, one in zip(panels[:, 0], found.answers):
            axes.plot(updates, one.values, "o-", color=COLOURS[0], label="runs")
            for run, x, y in zip(found.runs, updates, one.values):
                axes.annotate(f"mesh {run.mesh:g}", (x, y), (4, 4), textcoords="offset points", fontsize=7)
            bar = one.estimate.uncertainty if math.isfinite(one.estimate.uncertainty) else 0.0
            axes.errorbar([updates[-1] * 2.0], [one.estimate.value], [bar], fmt="s", capsize=4, color=COLOURS[1],
                          label=f"answer {plus_minus(one)}")
            axes.axhline(one.estimate.value, color=COLOURS[1], linewidth=0.5)
            axes.set(xscale="log", title=one.quantity.text, ylabel="value (deck units)")
            axes.legend()
        panels[-1, 0].set_xlabel("element updates")
        figure.savefig(path)
        plt.close(figure)
