# SPDX-License-Identifier: MIT
"""Contact of a surface with itself through the program: the same bits after a restart and at any number of threads, and
keywords."""
import numpy as np
import pytest
from conftest import numbers, some_types, threads_of
from meshes import Deck, grid, grid_quads
from test_implicit import implicit
from test_restart import assert_same, histories, part_of, with_files


def fork(deck, part, turned=False, away=0.0):
    """A U of 9 x 12 squares of 0.1 whose slot is one square wide, written so far away from the y axis; returns coordinates
    and ids of nodes."""
    x, quads = grid(9, 12, 0.9, 1.2)
    quads = np.array(quads)
    middle = x[quads].mean(axis=1)
    quads = quads[~((middle[:, 0] > 0.4) & (middle[:, 0] < 0.5) & (middle[:, 1] > 0.3))]
    used, numbers_of = np.unique(quads, return_inverse=True)
    x = x[used]
    if turned:
        x = np.array([0.9, 2.5]) - x
    return x, deck.mesh(x + [away, 0.0], numbers_of.reshape(quads.shape), part=part)


def forks(kind, friction=0.0, keyword=None, is_axisymmetric=False):
    """Two forks, one upside down on the other, whose arms are driven together, or rings of that section; all in one part
    set."""
    deck = Deck("two forks").control(0.25, scale=0.6).hourglass(4, 0.1)
    deck.add("*SECTION_SHELL", (1, 15 if is_axisymmetric else 13), (1.0,))
    moving = []
    for part in (1, 2):
        deck.part(part).elastic(1000.0, 1.0e6, 0.3, part)
        x, ids = fork(deck, part, part == 2, 4.0 if is_axisymmetric else 0.0)
        speed = np.where(x[:, 0] < 0.45, 2.0, -2.0) * np.abs(x[:, 1] - (0.0, 2.5)[part - 1])
        moving += [(int(n), a, (1.0, -1.0)[part - 1]) for n, a in zip(ids, speed)]
    deck.add("*INITIAL_VELOCITY_NODE", *moving).add("*SET_PART_LIST", (9,), (1, 2))
    if keyword:
        deck.add(keyword, (9, None, 1.0, 0, friction), (0.0,), (0.0, 5.0))
    else:
        deck.add("*CONTACT_2D_SLIDELINE", (9, 0, kind, 3, 1.0, friction), (0.0, 1.0e20, 2, 0.0, 5.0))
    deck.output(plot=0.025, glstat=2.0e-3, rcforc=2.0e-3)
    return deck.add("*DATABASE_SLEOUT", (2.0e-3,)).text()


def folded(kind):
    """A ring of elements round a slit, pressed together step by step: static."""
    deck = implicit(1.0, 0.1, automatic=(1.0e-4, 0.1)).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    x, quads = grid(8, 5, 1.6, 0.42)
    x[:, 1] = np.array([0.0, 0.1, 0.2, 0.22, 0.32, 0.42])[np.arange(len(x)) // 9]
    quads = np.array(grid_quads(8, 5))
    middle = x[quads].mean(axis=1)
    quads = quads[~((np.abs(middle[:, 1] - 0.21) < 0.01) & (np.abs(middle[:, 0] - 0.8) < 0.6))]
    ids = deck.mesh(x, quads)
    deck.fix(ids[:9], y=1).fix(ids[4:5], x=1).curve(1, [(0.0, 0.0), (1.0, 1.0)])
    deck.add("*LOAD_NODE_POINT", *[(int(n), 2, 1, -3.0e3) for n in ids[-7:-2]])
    deck.add("*SET_PART_LIST", (9,), (1,))
    deck.add("*CONTACT_2D_SLIDELINE", (9, 0, kind, 3, 1.0e7, 0.2), (0.0, 1.0e20, 1))
    return deck.output(plot=0.2, glstat=0.1, rcforc=0.1).text()


@pytest.mark.parametrize("kind, is_axisymmetric", [*((kind, False) for kind in some_types(0)), (5, True)])
def test_same_bits_after_a_restart_and_with_threads(slideline, tmp_path, kind, is_axisymmetric):
    text = with_files(forks(kind, friction=0.2, is_axisymmetric=is_axisymmetric), dump=60)
    for threads in threads_of(kind):
        done = slideline(f"d=on{threads}", f"ncpu={threads}", "perthread=1", deck=text)
        assert done.returncode == 0, done.stderr
    one = tmp_path / "on1"
    assert max(numbers(one / "job.sleout.csv", "energy")) > 1.0
    for threads in threads_of(kind)[1:]:
        assert histories(one) == histories(tmp_path / f"on{threads}")
    rest = part_of(one, tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    done = slideline("r=rest/job.dump01.h5")
    assert done.returncode == 0, done.stderr
    assert_same(one, rest)
    assert max(abs(value - 1.0) for value in numbers(one / "job.glstat.csv", "energy_ratio")) < 0.01


def test_the_far_side_of_a_sheet_is_no_first_contact(slideline):
    """A sheet of one element shears to and fro, and its faces pass nodes of each other: nothing is excluded."""
    deck = Deck("sheet").control(0.05).hourglass(4, 0.1).part(1).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(12, 1, 2.4, 0.1)).reshape(2, 13)
    deck.add("*SET_PART_LIST", (1,), (1,)).add("*CONTACT_2D_AUTOMATIC_SINGLE_SURFACE", (1,))
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), 0.0, 0.5 if k > 6 else -0.5) for row in nodes for k, node in enumerate(row)])
    done = slideline("d=out", deck=deck.output(glstat=0.01))
    assert done.returncode == 0 and "excluded" not in done.stderr, done.stderr


@pytest.mark.parametrize("kind", some_types(2, release=4))
def test_implicit_restart(slideline, tmp_path, kind):
    done = slideline("d=whole", deck=with_files(folded(kind), dump=4))
    assert done.returncode == 0, done.stderr
    assert max(numbers(tmp_path / "whole/job.contact.csv", "pressure")) > 0.0
    rest = part_of(tmp_path / "whole", tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    done = slideline("r=rest/job.dump01.h5")
    assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "whole", rest)


@pytest.mark.parametrize("keyword, kind", (("*CONTACT_2D_AUTOMATIC_SINGLE_SURFACE", 5),
                                           ("*CONTACT_2D_AUTOMATIC_SINGLE_SURFACE_MORTAR", 7)))
def test_stock_keywords(slideline, tmp_path, keyword, kind):
    for folder, words in (("own", {}), ("stock", {"keyword": keyword})):
        done = slideline(f"d={folder}", deck=forks(kind, friction=0.2, **words))
        assert done.returncode == 0, done.stderr
    # FD 0 is 0 there: without friction that decays nothing slides, so only the deck's own words differ
    assert "self contact" in (tmp_path / "stock/job.log").read_text()
    done = slideline("d=other", "ctype=4", deck=forks(kind, keyword=keyword))
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "other/job.effective.k").read_text()
    assert "*CONTACT_2D_SLIDELINE" in text
    done = slideline("d=again", deck=text)
    assert done.returncode == 0, done.stderr
    assert histories(tmp_path / "other") == histories(tmp_path / "again")
