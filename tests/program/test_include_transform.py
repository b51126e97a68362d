# SPDX-License-Identifier: MIT
"""A file with *INCLUDE_TRANSFORM gives the run of the deck with all numbers and positions written out."""
import pytest

from meshes import Deck, grid
from test_restart import histories

MOVES = {"TRANSL": ("TRANSL", 3.0, -2.0), "turned": ("ROTATE", 0.0, 0.0, -2.0, 1.0, 1.0, 0.0, -90.0)}


def body(n, i, steps, at=lambda x, y: (x, y)):
    """A block with all that has a number: n is added to nodes and elements, i to all others."""
    deck = Deck("body")
    deck.add("*SECTION_SHELL", (1 + i, 13, 1.0, 1)).add("*HOURGLASS", (1 + i, 4, 0.1))
    deck.add("*PART", "block", (1 + i, 1 + i, 1 + i, 0, 1 + i)).add("*MAT_ELASTIC", (1 + i, 1000.0, 1.0e6, 0.3))
    x, quads = grid(4, 3, 0.4, 0.3)
    deck.add("*NODE", *[f"{k + 1 + n},{at(*p)[0]!r},{at(*p)[1]!r}" for k, p in enumerate(x.tolist())])
    deck.add("*ELEMENT_SHELL", *[",".join(str(v) for v in (k + 1 + n, 1 + i, *(q + 1 + n for q in quad)))
                                 for k, quad in enumerate(quads)])
    deck.add("*SET_NODE_LIST", (1 + i,), tuple(v + n for v in (1, 2, 3, 4, 5)))
    deck.add("*SET_NODE_LIST_GENERATE", (2 + i,), (16 + n, 20 + n)).add("*SET_PART_LIST", (3 + i,), (1 + i,))
    deck.add("*SET_NODE_GENERAL", (4 + i,), ("PART", 1 + i), ("DNODE", 1 + n))
    deck.add("*SET_SEGMENT", (5 + i,), *[(k + n, k + 1 + n) for k in range(16, 20)])
    deck.add("*SET_SEGMENT_GENERAL", (6 + i,), ("SEG", 1 + n, 2 + n))
    deck.curve(1 + i, steps)
    deck.add("*LOAD_SEGMENT_SET", (5 + i, 1 + i, 1.0e3)).add("*LOAD_SEGMENT", (1 + i, 2.0e3, 0.0, 1 + n, 2 + n))
    deck.add("*LOAD_SEGMENT_SET", (6 + i, 1 + i, 1.0e3)).add("*DAMPING_PART_MASS_SET", (3 + i, 1 + i, 5.0))
    deck.add("*ELEMENT_MASS", f"{1 + n:8d}{7 + n:8d}{0.5:16}")
    return deck


def run(slideline, folder, tmp_path, includes, files, n_number):
    deck = Deck("whole").control(5.0e-3)
    for include in includes:
        deck.add(*include)
    deck.add("*DATABASE_HISTORY_NODE", (1, 1 + n_number)).output(glstat=1.0e-3, nodout=1.0e-3)
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    done = slideline(f"d={folder}", deck=deck.text())
    assert done.returncode == 0, done.stderr
    return tmp_path / folder


@pytest.mark.parametrize("move", MOVES)
def test_numbers_and_positions_are_those_written_out(slideline, tmp_path, move):
    steps = [(0.0, 0.0), (1.0e-3, 1.0), (1.0, 1.0)]

    def at(x, y):
        return (x + 3.0, y - 2.0) if move == "TRANSL" else (1.0 - (y - 1.0), 1.0 + (x - 1.0))

    files = {"body.k": body(0, 0, steps).text(), "moved.k": body(100, 10, steps, at).text(),
             "outer.k": "*INCLUDE_TRANSFORM\nbody.k\n60,40,4,4,4,4,4\n4\n\n1\n*DEFINE_TRANSFORMATION\n1\n"
                        + ",".join(map(str, MOVES[move])) + "\n"}
    ways = {"written": [("*INCLUDE", "body.k"), ("*INCLUDE", "moved.k")],
            "moved": [("*INCLUDE", "body.k"), ("*INCLUDE_TRANSFORM", "body.k", (100, 100, 10, 10, 10, 10, 10), (10,), (), (1,)),
                      ("*DEFINE_TRANSFORMATION", (1,), MOVES[move])]}
    if move == "TRANSL":  # offsets of files inside each other add up
        ways["nested"] = [("*INCLUDE", "body.k"), ("*INCLUDE_TRANSFORM", "outer.k", (40, 60, 6, 6, 6, 6, 6), (6,))]
    found = {name: histories(run(slideline, name, tmp_path, ways[name], files, 100)) for name in ways}
    done = slideline("i=moved/job.effective.k", "d=again", "jobid=job")
    assert done.returncode == 0, done.stderr
    assert histories(tmp_path / "again") == found["moved"]
    if move == "TRANSL":
        assert found["moved"] == found["written"] == found["nested"]
    else:  # cos 90 degrees is not 0
        assert found["moved"].keys() == found["written"].keys()
