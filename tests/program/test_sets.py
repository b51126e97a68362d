# SPDX-License-Identifier: MIT
"""Surfaces by sets of every kind, stock sliding contact, and force transducers."""
import numpy as np
import pytest
from conftest import columns, numbers
from meshes import Deck, grid
from test_restart import assert_same, histories, part_of, with_files

KEYWORDS = ("SLIDELINE", "PENALTY", "SLIDING_VOIDS", "AUTOMATIC_NODE_TO_SURFACE", "AUTOMATIC_SURFACE_TO_SURFACE",
            "AUTOMATIC_SURFACE_TO_SURFACE_MORTAR", "AUTOMATIC_ONE_WAY_SURFACE_TO_SURFACE", "AUTOMATIC_TIED", "TIED_SLIDING",
            "PENALTY_FRICTION")
WITH_POSITIVE_NODE_SETS = {"PENALTY", "SLIDING_VOIDS", "TIED_SLIDING", "PENALTY_FRICTION"}


def deck_of(keyword, sets, sides, load=None):
    """A block that falls on a plate; `sets` gets the upper and the lower nodes of the two faces."""
    deck = Deck("sets").control(0.012).hourglass(4, 0.1)
    for part in (1, 2):
        deck.part(part).elastic(1000.0, 1.0e6, 0.3, part)
    upper = deck.mesh(*grid(5, 3, 0.6, 0.4, (0.2, 0.0)), part=1)
    lower = deck.mesh(*grid(7, 3, 1.0, 0.4, (0.0, -0.4)), part=2)
    deck.fix(lower[:8], 1, 1)
    deck.node_set(9, upper).add("*INITIAL_VELOCITY", (9,), (0.3, -1.0))
    sets(deck, upper[:6], lower[-8:][::-1], upper, lower)
    rest = [(0.0, 0.0), (0.1,)] if keyword == "PENALTY_FRICTION" else []
    deck.add(f"*CONTACT_2D_{keyword}", (*sides, *((5, 2, 1.0e6) if keyword == "SLIDELINE" else ())), *rest)
    if load:
        deck.curve(5, [(0.0, 1.0e3)]).add("*LOAD_SEGMENT_SET", (load, 5))
    return deck.output(plot=4.0e-3, glstat=1.0e-3, rcforc=1.0e-3).text()


def lists(deck, face, seat, *_):
    deck.node_set(1, face).node_set(2, seat)


def general(deck, face, seat, upper, lower):
    """In walking order, after what goes out again; and all of a part but the rest."""
    deck.add("*SET_NODE_GENERAL", (1,), ("DNODE", int(face[0])), ("NODE", *face[:3].tolist()), ("PART", 2), ("DPART", 2),
             ("NODE", *face.tolist()))
    others = sorted(set(lower.tolist()) - set(seat.tolist()))
    deck.add("*SET_NODE_GENERAL", (2,), ("ALL",), ("DPART", 1), *[("DNODE", *others[k:k + 7]) for k in range(0, len(others), 7)])


def segments(deck, face, seat, *_):
    """Neither in order nor in one direction; N3 and N4 repeat N2."""
    for number, nodes in ((1, face), (2, seat)):
        pairs = [(a, b, b, b) if k % 2 else (b, a) for k, (a, b) in enumerate(zip(nodes[:-1].tolist(), nodes[1:].tolist()))]
        deck.add("*SET_SEGMENT", (number,), *pairs[::-1])


def general_segments(deck, face, seat, upper, lower):
    """What is left of outlines, with one edge twice and one that goes out and comes back."""
    deck.add("*DEFINE_BOX", (1, -1.0, 2.0, -1.0, -0.05)).add("*DEFINE_BOX", (2, -1.0, 2.0, -0.05, 0.05))
    first, second = face[:2].tolist()
    deck.add("*SET_SEGMENT_GENERAL", (1,), ("PART", 1), ("DSEG", second, first), ("SEG", first, second), ("SEG", second, first),
             *[("DSEG", int(a), int(b)) for a, b in outline(upper, 5) if {a, b} - set(face.tolist())])
    deck.add("*SET_SEGMENT_GENERAL", (2,), ("BOX", 2), ("DPART", 1), ("PART", 2), ("DBOX", 1),
             *[("DSEG", int(a), int(b)) for a, b in outline(lower, 7) if {a, b} - set(seat.tolist())])


def outline(ids, n):
    """Edges around a mesh with n elements in a row."""
    rows = ids.reshape(-1, n + 1)
    ring = [*rows[0], *rows[1:, -1], *rows[-1, -2::-1], *rows[-2::-1, 0]]
    return list(zip(ring[:-1], ring[1:]))


@pytest.mark.parametrize("keyword", KEYWORDS)
def test_a_chain_is_the_same_by_any_set(slideline, tmp_path, keyword):
    sign = 1 if keyword in WITH_POSITIVE_NODE_SETS else -1
    for folder, sets, sides in (("lists", lists, (sign, 2 * sign)), ("general", general, (sign, 2 * sign)),
                                ("segments", segments, (1, 2)), ("general_segments", general_segments, (1, 2))):
        done = slideline(f"d={folder}", deck=deck_of(keyword, sets, sides))
        assert done.returncode == 0, done.stderr
        assert histories(tmp_path / folder) == histories(tmp_path / "lists")
    assert np.abs(numbers(tmp_path / "lists/job.rcforc.csv", "fy")).max() > 1.0


@pytest.mark.parametrize("keyword", sorted(set(KEYWORDS) - WITH_POSITIVE_NODE_SETS))
def test_boundaries_of_parts_are_those_of_part_sets(slideline, tmp_path, keyword):
    def parts(deck, *_):
        deck.add("*SET_PART_LIST", (1,), (1,)).add("*SET_PART_LIST", (2,), (2,))

    def boundaries(deck, *_):
        deck.add("*SET_2D_SEGMENT", (11,), (1,)).add("*SET_PART_LIST", (5,), (2,)).add("*SET_2D_SEGMENT_SET", (12,), (5,))

    def edges(deck, face, seat, upper, lower):
        for number, ids, n in ((11, upper, 5), (12, lower, 7)):
            deck.add("*SET_SEGMENT", (number,), *[(int(a), int(b)) for a, b in outline(ids, n)])

    def added(deck, *_):
        deck.add("*SET_PART_LIST", (5,), (1,)).add("*SET_PART_LIST", (6,), (2,))
        deck.add("*SET_PART_ADD", (1,), (5, 5)).add("*SET_PART_ADD", (2,), (6,))

    for folder, sets, sides in (("parts", parts, (1, 2)), ("boundaries", boundaries, (11, 12)), ("edges", edges, (11, 12)),
                                ("added", added, (1, 2))):
        done = slideline(f"d={folder}", deck=deck_of(keyword, sets, sides))
        assert done.returncode == 0, done.stderr
        assert histories(tmp_path / folder) == histories(tmp_path / "parts")


def test_a_surface_with_itself(slideline, tmp_path):
    """Both bodies in one set: by part set and by the boundary of that; an open chain is no outline."""
    def parts(deck, *_):
        deck.add("*SET_PART_LIST", (1,), (1, 2))

    def boundary(deck, *_):
        deck.add("*SET_PART_LIST", (5,), (1, 2)).add("*SET_2D_SEGMENT_SET", (11,), (5,))

    for folder, sets, number in (("parts", parts, 1), ("boundary", boundary, 11)):
        done = slideline(f"d={folder}", deck=deck_of("AUTOMATIC_SINGLE_SURFACE", sets, (number, 0)))
        assert done.returncode == 0, done.stderr
    assert histories(tmp_path / "parts") == histories(tmp_path / "boundary")
    assert numbers(tmp_path / "parts/job.glstat.csv", "contact").max() > 0.0
    done = slideline("d=open", deck=deck_of("AUTOMATIC_SINGLE_SURFACE", segments, (1, 0)))
    assert done.returncode == 1
    assert "is a segment set with an open chain; self contact needs closed boundaries" in done.stderr


def test_pressure_on_the_boundary_of_a_part(slideline, tmp_path):
    """It presses from all sides: no resultant, and the block keeps its momentum."""
    def sets(deck, face, seat, *_):
        lists(deck, face, seat)
        deck.add("*SET_2D_SEGMENT", (3,), (1,))

    done = slideline("d=out", deck=deck_of("PENALTY", sets, (1, 2), load=3))
    assert done.returncode == 0, done.stderr
    plain = slideline("d=plain", deck=deck_of("PENALTY", lists, (1, 2)))
    assert plain.returncode == 0, plain.stderr
    energy = [numbers(tmp_path / folder / "job.glstat.csv", "internal")[1] for folder in ("out", "plain")]
    assert energy[0] != energy[1]


def transduced(tie=0):
    """A block between two plates, with an interface to each, one of which may be tied (1) or tied until it breaks (2);
    transducers on the block, on a plate, and on nothing."""
    deck = Deck("transducers").control(0.012).hourglass(4, 0.1)
    for part in (1, 2, 3):
        deck.part(part).elastic(1000.0, 1.0e6, 0.3, part)
    block = deck.mesh(*grid(5, 3, 0.6, 0.4, (0.2, 0.0)), part=1)
    lower = deck.mesh(*grid(7, 3, 1.0, 0.4, (0.0, -0.4)), part=2)
    upper = deck.mesh(*grid(6, 3, 1.0, 0.4, (0.0, 0.398)), part=3)
    deck.fix([*lower[:8], *upper[-7:]], 1, 1)
    deck.node_set(1, block[:6]).node_set(2, lower[-8:][::-1]).node_set(3, block[-6:][::-1]).node_set(4, upper[:7])
    deck.node_set(5, lower[:8])
    deck.add("*SET_PART_LIST", (1,), (1,)).add("*SET_2D_SEGMENT", (6,), (2,))
    deck.add("*INITIAL_VELOCITY", (1,), (0.3, -1.0))
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, 5, 2, 1.0e6, 0.2), (0.0, 0.0),
             (0.0, 1.0, tie, *((3.0e3, 3.0e3) if tie == 2 else ())))
    deck.add("*CONTACT_2D_FORCE_TRANSDUCER", (1, 0), (0.0, 0.0))
    deck.add("*CONTACT_2D_SLIDELINE", (-3, -4, 4, 2, 1.0e6))
    deck.add("*CONTACT_2D_FORCE_TRANSDUCER_TITLE", "        10the lower plate", (6, 0))
    deck.add("*CONTACT_2D_FORCE_TRANSDUCER", (-5, 0))
    deck.output(plot=4.0e-3, glstat=1.0e-3)
    return deck.add("*DATABASE_RCFORC", (1.0e-3, 1)).text()


@pytest.mark.parametrize("tie", (0, 1, 2))
def test_a_transducer_adds_up_all_interfaces(slideline, tmp_path, tie):
    done = slideline("d=out", deck=transduced(tie))
    assert done.returncode == 0, done.stderr
    assert "transducer 5 has no nodes of an interface: its forces are 0" in done.stdout + done.stderr
    table = columns(tmp_path / "out/job.rcforc.csv")

    def force(number, side):
        rows = [k for k in range(len(table["time"])) if (table["interface"][k], table["side"][k]) == (str(number), side)]
        return np.array([[float(table[name][k]) for name in ("fx", "fy", "n_active")] for k in rows])

    both = force(1, "slave") + force(3, "slave")
    largest = np.abs(both[:, :2]).max()
    assert largest > 1.0 and (tie or np.abs(force(3, "slave")[:, 1]).max() > 1.0)
    np.testing.assert_allclose(force(2, "slave")[:, :2], both[:, :2], rtol=0, atol=1e-12 * largest)
    np.testing.assert_allclose(force(10, "slave")[:, :2], force(1, "master")[:, :2], rtol=0, atol=1e-12 * largest)
    assert force(2, "slave")[:, 2].max() == 12 and not np.any(force(5, "slave"))
    assert not len(force(2, "master"))
    assert "the lower plate" in (tmp_path / "out/job.rcforc").read_text()


def test_a_transducer_changes_nothing(slideline, tmp_path):
    text = transduced()
    done = slideline("d=with", deck=text)
    assert done.returncode == 0, done.stderr
    kept, is_kept = [], True
    for line in text.splitlines():
        if line.startswith("*"):
            is_kept = "FORCE_TRANSDUCER" not in line
        kept += [line] if is_kept else []
    done = slideline("d=without", deck="\n".join(kept) + "\n")
    assert done.returncode == 0, done.stderr
    for name in ("glstat", "contact"):
        a, b = (columns(tmp_path / folder / f"job.{name}.csv") for folder in ("with", "without"))
        a.pop("interface", None), b.pop("interface", None)  # by position in the deck
        assert a == b


def test_transducers_after_a_restart_and_with_threads(slideline, tmp_path):
    text = with_files(transduced(), dump=60)
    for threads in (1, 2, 4):
        done = slideline(f"d=on{threads}", f"ncpu={threads}", "perthread=1", deck=text)
        assert done.returncode == 0, done.stderr
        assert histories(tmp_path / f"on{threads}") == histories(tmp_path / "on1")
    rest = part_of(tmp_path / "on1", tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    done = slideline("r=rest/job.dump01.h5")
    assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "on1", rest)
