# SPDX-License-Identifier: MIT
"""A piece of advice, and how all of them are shown."""
import dataclasses
import json

# Savings below this share of the run, or below so many seconds, are not worth saying.
SMALLEST_SHARE, SMALLEST_SECONDS = 0.01, 0.01


@dataclasses.dataclass
class Advice:
    """What in a model was not needed.

    `topic`      short name of the check
    `what`       one sentence
    `evidence`   figures read from the run
    `change`     what to change in the deck
    `seconds`    expected saving of wall clock; None when it cannot be known
    `basis`      where the expected saving comes from
    """

    topic: str
    what: str
    evidence: str
    change: str
    seconds: float | None
    basis: str


def select(advice: list[Advice], total: float, everything: bool = False) -> list[Advice]:
    """What is worth saying, the largest saving first.

    A saving below one per cent of the run or below a hundredth of a second is left out unless
    `everything`; advice without a saving in seconds stays.
    """
    smallest = max(SMALLEST_SHARE * total, SMALLEST_SECONDS)
    kept = [item for item in advice
            if everything or item.seconds is None or item.seconds >= smallest]
    return sorted(kept, key=lambda item: -(item.seconds or 0.0))


def as_text(run, advice: list[Advice], notes: list[str], hidden: int) -> str:
    """The report for a reader."""
    lines = [run_line(run)]
    for number, item in enumerate(advice, start=1):
        lines += ["", f"{number}. {item.what}",
                  f"   saving    {saving_text(item.seconds, run.total)} ({item.basis})",
                  f"   evidence  {item.evidence}",
                  f"   change    {item.change}"]
    if not advice:
        lines += ["", "Nothing found that this run could have done without."]
    elif len(advice) > 1:
        lines += ["", "Each saving is that of one change alone; together they save less than "
                  "their sum."]
    if hidden:
        lines += ["", f"{hidden} more would save less than {SMALLEST_SHARE:.0%} of the run, or "
                  f"less than {SMALLEST_SECONDS} s, each (--all shows them)."]
    lines += ["", "For contact type and mesh: slideline-tools answer DECK --of QUANTITY --within X% --choose"]
    if notes:
        lines += ["", "Not judged:"] + [f"- {note}" for note in notes]
    return "\n".join(lines)


def run_line(run) -> str:
    """Name, seconds and where they went."""
    shares = ", ".join(f"{name} {run.seconds_of(name) / run.total:.0%}"
                       for name in ("elements", "contact", "nodes", "output", "solver")
                       if run.seconds_of(name) >= 0.005 * run.total)
    return f"{run.job}: {run.total:.3g} s ({shares})"


def saving_text(seconds: float | None, total: float) -> str:
    """Seconds and per cent of the total."""
    if seconds is None:
        return "not in wall clock"
    return f"about {seconds:.2g} s, {100.0 * seconds / total:.2g} % of the run"


def as_json(run, advice: list[Advice], notes: list[str]) -> str:
    """The report for a program."""
    return json.dumps({
        "job": run.job, "folder": str(run.folder), "total_seconds": run.total,
        "advice": [dataclasses.asdict(item)
                   | {"share": None if item.seconds is None else item.seconds / run.total}
                   for item in advice],
        "not_judged": notes}, indent=2)
