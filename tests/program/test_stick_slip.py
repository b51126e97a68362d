# SPDX-License-Identifier: MIT
"""A block on a belt, held by a soft bar: it sticks until the bar pulls with FS p, and slips under FD p until the belt takes it
along again."""
import math

import numpy as np
import pytest
from conftest import numbers
from meshes import Deck, grid

from slideline_tools.contact_types import ALL_TYPES

AT_REST, SLIDING, SPEED, GRAVITY = 0.5, 0.2, 0.1, 10.0


def block_on_belt(kind):
    """A block of 40 kg/m on a bar of 1.6e4 N/m2, with friction that falls within 2 mm/s."""
    deck = Deck("stick and slip").control(2.0, scale=0.8).hourglass(4, 0.1)
    deck.part(1).elastic(1000.0, 1.0e7, 0.0, 1).part(2).elastic(5.0, 8.0e4, 0.0, 2).part(3).elastic(1000.0, 1.0e8, 0.0, 3)
    (block, block_quads), (bar, bar_quads) = grid(4, 2, 0.2, 0.2), grid(4, 2, 1.0, 0.2, (-1.0, 0.0))
    block = deck.mesh(block, block_quads, part=1)
    free = [k for k in range(len(bar)) if k % 5 != 4]
    number = {k: i for i, k in enumerate(free)}
    number |= {4: -15, 9: -10, 14: -5}
    first = deck.n_node
    ids = np.arange(len(free)) + first + 1
    deck.add("*NODE", *[(int(i), *bar[k]) for i, k in zip(ids, free)])
    name = [int(ids[number[k]]) if number[k] >= 0 else int(block[number[k]]) for k in range(len(bar))]
    deck.add("*ELEMENT_SHELL", *[(deck.n_element + 1 + j, 2, *(name[k] for k in quad)) for j, quad in enumerate(bar_quads)])
    deck.n_node += len(free)
    deck.n_element += len(bar_quads)
    belt = deck.mesh(*grid(23, 1, 2.0, 0.1, (-1.5, -0.1)), part=3)
    deck.fix([name[0], name[5], name[10]], x=1, y=1).fix(belt[:24], y=1)
    deck.curve(1, [(0.0, SPEED), (10.0, SPEED)]).curve(2, [(0.0, GRAVITY), (10.0, GRAVITY)]).curve(3, [(0.0, 60.0), (10.0, 60.0)])
    for node in belt[:24]:
        deck.prescribe(node, 1, 0, 1)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), SPEED, 0.0) for node in (*belt, *block)])
    deck.add("*LOAD_BODY_Y", (2, 1.0)).add("*DAMPING_PART_MASS", (1, 3, 1.0, 1), (0.0, 1.0))
    deck.node_set(1, block[:5]).node_set(2, belt[:23:-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, 2.0, AT_REST, SLIDING, 500.0), (0.0, 1.0e20, 2))
    return deck.output(glstat=0.001, nodout=0.001, nodes=[int(block[2])])


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


def closed_form(weight=GRAVITY * 40.0):
    """Period and ends of the way of a rigid block with a third of the bar: it slips by a cosine about FD p from where the bar
    pulls with FS p, at the speed of the belt, until it has that again, and sticks on the way back."""
    mass, stiffness = 40.0 + 1.0 / 3.0, 1.6e4
    omega, centre = math.sqrt(stiffness / mass), SLIDING * weight / stiffness
    half = (AT_REST - SLIDING) * weight / stiffness
    swing = math.hypot(half, SPEED / omega)
    slips = (math.pi + 2.0 * math.atan2(SPEED / omega, half)) / omega
    return slips + 2.0 * half / SPEED, centre - swing, centre + swing


@pytest.mark.parametrize("kind, make", [*[(kind, block_on_belt) for kind in ALL_TYPES],
                                        *[(kind, implicit_block_on_belt) for kind in (1, 2, 5, 7)]])
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
