# SPDX-License-Identifier: MIT
"""Interference (LCINT) through the program: restart, threads, overrides, messages."""
import pytest
from conftest import numbers, some_types, threads_of
from meshes import Deck, grid
from test_implicit import implicit
from test_restart import assert_same, histories, part_of, with_files

OVERLAP = 1.0e-3


def pressed(kind, static=None, is_axisymmetric=False, whole=False, friction=0.2, curve=((0.0, 0.0), (0.02, 1.0)),
            overlap=OVERLAP, card=None):
    """Two blocks of unlike columns that overlap; top and bottom held. In the middle of the curve a file is written."""
    deck = implicit(0.03, 0.003, dynamic=not static) if static is not None else Deck("overlapping blocks").control(0.03)
    deck.hourglass(4, 0.05)
    columns, rows = ((40, 28), 16) if static is None else ((7, 5), 3)
    for part in (1, 2):
        if is_axisymmetric:
            deck.add("*PART", f"part {part}", (part, 1, part))
            deck.add("*SECTION_SHELL", (1, 15), (1.0,)) if part == 1 else None
        else:
            deck.part(part, points=4 if static is not None else None)
        deck.elastic(1000.0, 1.0e6, 0.3, part)
    upper = deck.mesh(*grid(columns[0], rows, 0.9, 0.5, (0.02, -overlap)), part=1)
    lower = deck.mesh(*grid(columns[1], rows, 1.0, 0.5, (0.0, -0.5)), part=2)
    deck.node_set(1, upper[:columns[0] + 1]).node_set(2, lower[-columns[1] - 1:][::-1])
    deck.add("*SET_PART_LIST", (1,), (1,)).add("*SET_PART_LIST", (2,), (2,))
    deck.curve(7, curve)
    deck.add("*CONTACT_2D_SLIDELINE", (*((1, 2) if whole else (-1, -2)), kind, 3, 1.0, friction),
             (0.0, 1.0e20, 2, 0, 0), card or (0.0, 1.0, 0, None, None, 7))
    deck.fix(lower[:columns[1] + 1], 1, 1).fix(upper[-columns[0] - 1:], 1, 1)
    deck.output(plot=0.01, glstat=1.0e-3, rcforc=1.0e-3)
    return deck.add("*DATABASE_SLEOUT", (1.0e-3,)).text()


CASES = [(scene, kind) for turn, scene in enumerate(({}, {"whole": True}, {"is_axisymmetric": True})) for kind in some_types(turn)
         if not scene or kind in (4, 5, 7)]


@pytest.mark.parametrize("scene, kind", CASES)
def test_same_bits_after_a_restart_and_with_threads(slideline, tmp_path, scene, kind):
    text = with_files(pressed(kind, **scene), dump=60)
    for threads in threads_of(kind):
        done = slideline(f"d=on{threads}", f"ncpu={threads}", "perthread=1", deck=text)
        assert done.returncode == 0, done.stderr
    one = tmp_path / "on1"
    for threads in threads_of(kind)[1:]:
        assert histories(one) == histories(tmp_path / f"on{threads}")
    rest = part_of(one, tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    done = slideline("r=rest/job.dump01.h5")
    assert done.returncode == 0, done.stderr
    assert_same(one, rest)
    assert "interference at" in (one / "job.log").read_text()
    assert "warning" not in (one / "job.log").read_text()
    force = numbers(one / "job.rcforc.csv", "fy")
    assert force[0] == 0.0 and max(force) > 100.0
    ratio = numbers(one / "job.glstat.csv", "energy_ratio")
    assert max(abs(value - 1.0) for value in ratio) < 2.0e-3
    work = numbers(one / "job.glstat.csv", "external_work")
    assert work[0] == 0.0 and work[-1] > 0.0


@pytest.mark.parametrize("static", (True, False))
@pytest.mark.parametrize("kind", some_types(1, release=4))
def test_implicit_restart(slideline, tmp_path, kind, static):
    text = with_files(pressed(kind, static=static), dump=4)
    done = slideline("d=whole", deck=text)
    assert done.returncode == 0, done.stderr
    rest = part_of(tmp_path / "whole", tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    done = slideline("r=rest/job.dump01.h5")
    assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "whole", rest)


def test_an_overridden_deck_keeps_its_curve(slideline, tmp_path):
    done = slideline("d=other", "ctype=4", deck=pressed(5, static=True))
    assert done.returncode == 0, done.stderr
    done = slideline("d=again", deck=(tmp_path / "other/job.effective.k").read_text())
    assert done.returncode == 0, done.stderr
    done = slideline("d=own", deck=pressed(4, static=True))
    assert done.returncode == 0, done.stderr
    assert histories(tmp_path / "other") == histories(tmp_path / "again") == histories(tmp_path / "own")


@pytest.mark.parametrize("words, message", [
    ({"curve": ((0.0, 0.0), (0.02, 0.9))}, "is an interference curve that ends at 9.000000E-01, not at 1"),
    ({"curve": ((0.0, 0.5), (0.02, 1.0))}, "is an interference curve that begins at 5.000000E-01, not at 0"),
    ({"curve": ((0.0, 0.0), (0.01, 1.5), (0.02, 1.0))}, "leaves the range from 0 to 1"),
    ({"curve": ((-0.1, 0.0), (0.02, 1.0))}, "begins at the time -1.000000E-01, before the run"),
    ({"card": (0.0, 1.0, 0, None, None, 8)}, '"8" matches no curve of this deck'),
    ({"card": (0.0, 1.0, 0, None, None, -7)}, "(LCINT)"),
    ({"card": (0.0, 1.0, 1, None, None, 7)}, "asks for an interference curve, which ties do not have (a tie keeps its gaps)"),
    ({"whole": True, "overlap": 0.03}, "overlaps the slave surface at the start"),
])
def test_refused(slideline, words, message):
    done = slideline(deck=pressed(5, **words))
    assert done.returncode == 1
    assert message in done.stderr


def test_what_the_log_warns_of(slideline):
    done = slideline(deck=pressed(5, curve=((0.0, 0.0), (0.5, 1.0))))
    assert done.returncode == 0 and ", after the end time; the full overlap is not reached" in done.stdout + done.stderr
    done = slideline(deck=pressed(5, overlap=-1.0e-3))
    assert done.returncode == 0 and "(LCINT) has no effect: surfaces do not overlap" in done.stdout + done.stderr
