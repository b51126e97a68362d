# SPDX-License-Identifier: MIT
"""Nodes that a wall does not see, and nodes that are no supports."""
import re

import pytest
from conftest import columns, numbers
from meshes import Deck, grid


def block(wall_normal=(0.0, 1.0), motions=(), fixed=(), loose=False, spcforc=False):
    """A block of 4 x 4 that stands a hundredth above the origin, and a wall through the origin."""
    deck = Deck("block and wall")
    deck.control(0.001).part().elastic(8000.0, 2.0e11, 0.3)
    nodes = deck.mesh(*grid(4, 4, 1.0, 1.0, (0.01, 0.01)))
    if loose:
        deck.add("*NODE", (999, 5.0, 5.0))
    deck.curve(8, [(0.0, 1.0), (1.0, 1.0)])
    for row, direction in motions:
        for node in nodes[5 * row:5 * row + 5]:
            deck.prescribe(node, direction, 0, 8, -50.0)
    for node, x, y in fixed:
        deck.fix([node], x=x, y=y)
    if wall_normal:
        deck.add("*RIGIDWALL_PLANAR", (0, 0, 0, 0.0),
                 (0.0, 0.0, 0.0, float(wall_normal[0]), float(wall_normal[1]), 0.0))
        deck.add("*DATABASE_RWFORC", (1.0e-5,))
    if spcforc:
        deck.add("*DATABASE_SPCFORC", (1.0e-4,))
    return deck.output(glstat=1.0e-4)


@pytest.mark.parametrize("normal, motions, fixed, number, first", [
    ((0.0, 1.0), [(0, 2)], [], 5, 1),                  # moved along the normal
    ((0.0, 1.0), [(1, 1)], [], 0, 0),                  # moved along the wall: it holds them
    ((1.0, 1.0), [(1, 1)], [], 0, 0),                  # oblique: it holds them in y
    ((1.0, 1.0), [(1, 1), (1, 2)], [], 5, 6),          # oblique, moved in both
    ((1.0, 1.0), [(1, 1)], [(8, 0, 1)], 1, 8),         # oblique, one moved in x and fixed in y
    ((0.0, 1.0), [], [(8, 1, 1)], 0, 0),               # fixed nodes do not come nearer
])
def test_moved_nodes_that_pass_a_wall_are_named(slideline, tmp_path, normal, motions, fixed, number, first):
    done = slideline("d=o", deck=block(normal, motions, fixed))
    assert done.returncode in (0, 2), done.stderr
    reported = re.findall(r"nodes that pass the wall while their motion is prescribed "
                      r"\(\*BOUNDARY_PRESCRIBED_MOTION\): (\d+), the first at node (\d+)",
                      (tmp_path / "o" / "job.log").read_text())
    assert reported == ([(str(number), str(first))] if number else [])


@pytest.mark.parametrize("order, ids", [
    ([2, None], ["2", "3"]), ([None, None], ["1", "2"]), ([None, 1], ["2", "1"]), ([7, None], ["7", "2"])])
def test_walls_without_a_number_get_a_free_one(slideline, tmp_path, order, ids):
    deck = block(wall_normal=None)
    for number in order:
        deck.add("*RIGIDWALL_PLANAR" + ("_ID" if number else ""), *([f"{number:10d}a wall"] if number else []),
                 (0,), (0.0, 0.0, 0.0, 0.0, 1.0, 0.0))
    deck.add("*DATABASE_RWFORC", (1.0e-4,))
    done = slideline("d=o", deck=deck)
    assert done.returncode == 0, done.stderr
    assert columns(tmp_path / "o" / "job.rwforc.csv")["wall"][:2] == ids


def test_binary_of_rwforc_chooses_its_files(slideline, tmp_path):
    """As that of other tables: 2 leaves the text file out, and what is none of its values is refused."""
    deck = block(wall_normal=None)
    deck.add("*RIGIDWALL_PLANAR", (0,), (0.0, 0.0, 0.0, 0.0, 1.0, 0.0)).add("*DATABASE_RWFORC", (1.0e-4, 2))
    done = slideline("d=o", deck=deck)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "o" / "job.rwforc.csv").exists() and not (tmp_path / "o" / "job.rwforc").exists()
    refused = slideline("d=p", deck=deck.add("*DATABASE_RWFORC", (1.0e-4, 7)))
    assert refused.returncode == 1 and "BINARY" in refused.stderr


def test_two_walls_of_one_number_are_refused(slideline):
    deck = block(wall_normal=None)
    for _ in range(2):
        deck.add("*RIGIDWALL_PLANAR_ID", "         4", (0,), (0.0, 0.0, 0.0, 0.0, 1.0, 0.0))
    done = slideline("d=o", deck=deck)
    assert done.returncode == 1 and "the wall number 4 belongs to an earlier wall" in done.stderr


def test_a_node_without_elements_sees_no_wall(slideline, tmp_path):
    assert slideline("d=o", deck=block(loose=True)).returncode == 0
    assert ", 25 nodes, plastic impact" in (tmp_path / "o" / "job.log").read_text()


def test_a_node_without_elements_is_no_support(slideline, tmp_path):
    deck = block(fixed=[(25, 1, 1)], loose=True, spcforc=True)
    assert slideline("d=one", deck=deck).returncode == 0
    assert set(columns(tmp_path / "one" / "job.spcforc.csv")["node"]) == {"25"}
    assert len(numbers(tmp_path / "one" / "job.spcforc.csv", "time")) >= 10
    text = (tmp_path / "one" / "job.spcforc").read_text()
    assert "25" in text and "999" not in text
    assert slideline("d=none", deck=block(loose=True, spcforc=True)).returncode == 0
    assert not list((tmp_path / "none").glob("*spcforc*"))
