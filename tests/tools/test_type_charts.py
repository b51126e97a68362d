# SPDX-License-Identifier: MIT
"""What the program chooses contact types by is what the published pages say."""
import pathlib
import re

import pytest

from slideline_tools.commands.answers import CHEAPEST_FIRST

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCE = (ROOT / "src/model/type_charts.f90").read_text(encoding="utf-8")


def charted(name):
    """Figures of a table of the source."""
    text = re.search(rf"parameter :: {name}\(n_type\) = \[(.*?)\]", SOURCE, re.S)[1]
    return [float(figure) for figure in re.findall(r"([\d.]+)_wp", text)]


def column(page, heading, place, start=""):
    """{type: text of one cell} below a heading, from the table with `start` in its head."""
    section = (ROOT / f"doc/studies/{page}.md").read_text(encoding="utf-8").split(f"\n{heading}\n")[1].split("\n## ")[0]
    lines = section[section.index(start):].split("\n\n")[0].splitlines()
    return {int(line[2]): line.split("|")[place].strip() for line in lines if re.match(r"\| [1-7] ", line)}


def test_estimates():
    """The largest of each kind of scene; other processors and later mends may move the study by 2 %."""
    largest = [[max(float(figure) for figure in cell.split(",")) / 100.0 for cell in
                column("choosing", "## What it chooses by", place, "| type | cylinder, N_r 1, 2, 3 |").values()] for place in (2, 3, 4, 5)]
    assert charted("hertz") == pytest.approx([max(both) for both in zip(*largest[:2], strict=True)], rel=0.02)
    assert charted("sliding") == pytest.approx(largest[2], rel=0.02)
    assert charted("ironing") == pytest.approx(largest[3], rel=0.02)


def test_patch():
    """Largest deviation on any mesh; round-off counts as none."""
    section = (ROOT / "doc/studies/speed_accuracy.md").read_text(encoding="utf-8").split("\n## Patch test\n")[1].split("\n## ")[0]
    worst = []
    for number in range(1, 8):
        line = next(line for line in section.splitlines() if line.startswith(f"| {number} "))
        errors = re.findall(r"; (< )?([\d.e-]+) %", line)
        assert len(errors) == 3
        worst.append(max(0.0 if small else float(error) / 100.0 for small, error in errors))
    assert charted("patch") == pytest.approx(worst, rel=1e-9)


def test_times():
    """Contact times over that of type 1, which differ with the processor, in the order of the study and of `answer`."""
    times = {number: float(cell.split()[0]) for number, cell in column("speed_accuracy", "## What to choose", 3, "| type | exact pressure").items()}
    assert charted("published_time") == pytest.approx([times[number] for number in range(1, 8)], rel=0.15)
    for figures in (times, dict(enumerate(charted("published_time"), 1))):
        assert tuple(sorted(figures, key=figures.get)) == CHEAPEST_FIRST
