# SPDX-License-Identifier: MIT
"""A block on a belt, held by a soft bar, explicit and implicit, against a rigid block."""
import numpy as np
import pytest
from conftest import is_full, numbers
from stick_slip import SPEED, block_on_belt, closed_form

from slideline_tools.contact_types import ALL_TYPES


def implicit_block_on_belt(kind):
    """The same with fully integrated quads and generalised-alpha steps of 1 ms."""
    deck = block_on_belt(kind)
    at = deck.lines.index("*SECTION_SHELL")
    deck.lines[at + 1] = "1,13,,4"
    without(deck, ("*CONTROL_TIMESTEP", 2), ("*CONTROL_HOURGLASS", 2))
    deck.add("*CONTROL_IMPLICIT_GENERAL", (1, 0.001)).add("*CONTROL_IMPLICIT_DYNAMICS", (1,))
    return deck.add("*CONTROL_IMPLICIT_AUTO", (1, None, None, 1.0e-6, 0.001))


def without(deck, *keywords):
    """Take keywords out of a deck, each with its number of lines."""
    for keyword, n in keywords:
        at = deck.lines.index(keyword)
        del deck.lines[at:at + n]


def pressed_block_on_belt(kind):
    """Without gravity and damping: the block is pressed down by a given way, so that it does not tip, and the belt starts at
    0.2 s."""
    deck = implicit_block_on_belt(kind)
    without(deck, ("*DAMPING_PART_MASS", 3), ("*LOAD_BODY_Y", 2))
    at = deck.lines.index("*INITIAL_VELOCITY_NODE")
    end = next(k for k in range(at + 1, len(deck.lines)) if deck.lines[k].startswith("*"))
    nodes = [int(line.split(",")[0]) for line in deck.lines[at + 1:end]]
    del deck.lines[at:end]
    at = deck.lines.index("*DEFINE_CURVE")
    deck.lines[at + 2:at + 4] = ["0.0,0.0", "0.2,0.0", f"0.21,{SPEED}", f"10.0,{SPEED}"]
    deck.curve(4, [(0.0, 0.0), (0.1, -3.0e-4), (10.0, -3.0e-4)])
    for node in nodes[48:]:
        deck.prescribe(node, 2, 2, 4)
    return deck.output(rcforc=0.1)


@pytest.mark.parametrize("kind, make", [*[(kind, block_on_belt) for kind in ALL_TYPES],
                                        *[(kind, implicit_block_on_belt) for kind in ((1, 2, 5, 7) if is_full() else (1, 7))]])
def test_block_on_a_belt_sticks_and_slips(slideline, tmp_path, kind, make):
    """The mean period to 6 %, the ends to 8 % of the way: what sticks still rings a little, and the block tips, so that its rear
    slips first: with type 1 and steps of 1 ms the period is 7 % less. A coefficient by the speed of stuck springs too comes
    to 14 % and 20 % less."""
    off = 0.08 if (kind, make) == (1, implicit_block_on_belt) else 0.06
    done = slideline("d=x", deck=make(kind))
    assert done.returncode == 0, done.stderr
    table = tmp_path / "x" / "job.nodout.csv"
    time, way = numbers(table, "time"), numbers(table, "ux")
    time, way = time[time > 0.5], way[time > 0.5]
    period, least, most = closed_form()
    middle = 0.5 * (least + most)
    rising = np.flatnonzero((way[:-1] < middle) & (way[1:] >= middle))
    assert np.diff(time[rising]).mean() == pytest.approx(period, rel=off)
    assert (way.min(), way.max()) == pytest.approx((least, most), abs=0.08 * (most - least))
    assert np.abs(numbers(tmp_path / "x" / "job.glstat.csv", "energy_ratio") - 1.0).max() < 1.0e-3


@pytest.mark.parametrize("kind", (1, 7))
def test_block_pressed_on_a_belt(slideline, tmp_path, kind):
    """The mean period to 3 %, the ends to 3 % of the way, under the pressure of each type."""
    done = slideline("d=x", deck=pressed_block_on_belt(kind))
    assert done.returncode == 0, done.stderr
    weight = abs(numbers(tmp_path / "x/job.rcforc.csv", "fy")[-1])
    period, least, most = closed_form(weight)
    time, way = (numbers(tmp_path / "x/job.nodout.csv", name) for name in ("time", "ux"))
    time, way = time[time > 0.7], way[time > 0.7]
    ups = time[1:][(way[:-1] < 0.005) & (way[1:] >= 0.005)]
    assert len(ups) > 2 and np.diff(ups).mean() == pytest.approx(period, rel=0.03)
    assert [way.min(), way.max()] == pytest.approx([least, most], abs=0.03 * (most - least))
