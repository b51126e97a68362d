# SPDX-License-Identifier: MIT
"""Ties through the program: the same bits after a restart and at any number of threads, keywords and messages."""
import os
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from conftest import by_turns, numbers, some_types, threads_of
from meshes import Deck, grid
from test_implicit import implicit
from test_restart import assert_same, histories, part_of, with_files

from slideline_tools.contact_types import ALL_TYPES

sys.path.append(str(Path(__file__).resolve().parents[1] / "lab/fuzz"))
import fuzz_restarts  # noqa: E402


def tied(kind, columns=(40, 28), keyword=None, whole=False, is_axisymmetric=False, gap=0.0, static=None, overhang=0.0,
         strength=None):
    """Two blocks of 16 rows, unlike columns, `gap` apart, the upper one drawn up and aside by its top;
    with a strength (NFLS, SFLS) the tie breaks, with friction behind it."""
    deck = implicit(1.0, 0.1, dynamic=not static) if static is not None else Deck("tied blocks").control(0.03)
    deck.hourglass(4, 0.05)
    rows = 16 if static is None else 3
    for part in (1, 2):
        if is_axisymmetric:
            deck.add("*PART", f"part {part}", (part, 1, part))
            deck.add("*SECTION_SHELL", (1, 15), (1.0,)) if part == 1 else None
        else:
            deck.part(part, points=4 if static is not None else None)
        deck.elastic(1000.0, 1.0e6, 0.3, part)
    upper = deck.mesh(*grid(columns[0], rows, 1.0 + overhang, 0.5, (0.0, gap)), part=1)
    lower = deck.mesh(*grid(columns[1], rows, 1.0, 0.5, (0.0, -0.5)), part=2)
    deck.node_set(1, upper[:columns[0] + 1]).node_set(2, lower[-columns[1] - 1:][::-1])
    deck.add("*SET_PART_LIST", (1,), (1,)).add("*SET_PART_LIST", (2,), (2,))
    sides = (1, 2) if whole or keyword == "*CONTACT_2D_TIED_SLIDING" else (-1, -2)
    if keyword == "*CONTACT_2D_TIED_SLIDING":
        deck.add(keyword, sides)
    elif keyword:
        deck.add(keyword, sides, (0.0,), (0.0, 10.0, 0, 0, 0, -20.0))
    else:
        deck.add("*CONTACT_2D_SLIDELINE", (*sides, kind, 3, 0.0, 0.3 if strength else 0.0),
                 (0.0, 1.0e20, 0, 0, 0, 0, 0, -20.0), (0.0, 1.0, 2 if strength else 1, *(strength or ())))
    deck.fix(lower[:columns[1] + 1], 1, 1)
    deck.curve(1, [(0.0, 0.0), (0.02, 1.0), (1.0, 1.5)])
    # by radius in rings, whose nodes on the axis stand for no area
    deck.add("*LOAD_NODE_POINT", *[(int(n), dof, 1, 2.0e4 / columns[0] * (k / columns[0] if is_axisymmetric else 1.0))
                                   for k, n in enumerate(upper[-columns[0] - 1:]) if k > 0
                                   for dof in ((2,) if is_axisymmetric else (1, 2))])
    deck.output(plot=0.01 if static is None else 0.2, glstat=1.0e-3, rcforc=1.0e-3)
    return deck.add("*DATABASE_SLEOUT", (1.0e-3,)).text()


SCENES = {
    "blocks": {}, "with a gap": {"gap": 0.003}, "whole outlines": {"whole": True, "gap": 0.002},
    "rings": {"is_axisymmetric": True, "gap": 0.002},
}


CASES = by_turns([(scene, kind) for scene in SCENES for kind in ALL_TYPES if scene == "blocks" or kind in (4, 5, 7)], release=2)
CASES = sorted({*CASES, *((("blocks", kind) for kind in ALL_TYPES) if os.environ.get("SLIDELINE_BUILD") != "Debug" else ())})


@pytest.mark.parametrize("scene, kind", CASES)
def test_same_bits_after_a_restart_and_with_threads(slideline, tmp_path, scene, kind):
    text = with_files(tied(kind, **SCENES[scene]), dump=60)
    for threads in threads_of(kind):
        done = slideline(f"d=on{threads}", f"ncpu={threads}", "perthread=1", deck=text)
        assert done.returncode == 0, done.stderr
    one = tmp_path / "on1"
    assert numbers(one / "job.sleout.csv", "energy")[-1] > 0.0
    assert set(numbers(one / "job.contact.csv", "state")) <= {0.0, 3.0}
    assert max(map(abs, numbers(one / "job.contact.csv", "slip"))) > 0.0
    for threads in threads_of(kind)[1:]:
        assert histories(one) == histories(tmp_path / f"on{threads}")
    rest = part_of(one, tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    done = slideline("r=rest/job.dump01.h5")
    assert done.returncode == 0, done.stderr
    assert_same(one, rest)
    ratio = numbers(one / "job.glstat.csv", "energy_ratio")
    assert max(abs(value - 1.0) for value in ratio) < 1.0e-3


BREAKING = by_turns([("blocks", kind) for kind in ALL_TYPES] + [("whole outlines", 5), ("rings", 4), ("rings", 5), ("rings", 7)])


@pytest.mark.parametrize("scene, kind", BREAKING)
def test_what_breaks_stays_broken(slideline, tmp_path, scene, kind):
    """The tie breaks from one side on; goes on from the middle of that, and at any number of threads, to the same bits."""
    text = with_files(tied(kind, **SCENES[scene], strength=(8.0e3, 8.0e3)), dump=48)
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
    time, node, state = (numbers(one / "job.contact.csv", name) for name in ("time", "node", "state"))
    broken = [{n for n, t, s in zip(node, time, state) if t == at and s == 4.0} for at in sorted(set(time))]
    assert not broken[0] and broken[-1]
    assert all(before <= after for before, after in zip(broken, broken[1:]))
    assert "tie points failed, from time" in (one / "job.log").read_text()
    ratio = numbers(one / "job.glstat.csv", "energy_ratio")
    assert max(abs(value - 1.0) for value in ratio) < 2.0e-3
    # contact behind the ties is reported as part of the interface
    assert set(numbers(one / "job.rcforc.csv", "interface")) == {1.0}


@pytest.mark.parametrize("kind", some_types(0, release=4))
def test_implicit_break_and_restart(slideline, tmp_path, kind):
    """In dynamics, that what has come loose is held."""
    text = with_files(tied(kind, columns=(7, 5), static=False, gap=0.002, strength=(2.0e4, 2.0e4)), dump=4)
    done = slideline("d=whole", deck=text)
    assert done.returncode == 0, done.stderr
    assert set(numbers(tmp_path / "whole/job.contact.csv", "state")) >= {3.0, 4.0}
    rest = part_of(tmp_path / "whole", tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    done = slideline("r=rest/job.dump01.h5")
    assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "whole", rest)


#: dataset of a tie -> (new content, word of the message)
LIES = {
    "side": (lambda old: old[:-1].copy(), "expected here"),
    "first": (lambda old: old[:-1].copy(), "expected here"),
    "lag": (lambda old: old[:, :-1].copy(), "expected here"),
    "offset": (lambda old: old[:-1].copy(), "expected here"),
    "state": (lambda old: old * 0 + 2, "do not exist"),
    "site": (lambda old: old * 0 + 10**6, "no site"),
    "to_stress": (lambda old: np.append(old, 1.0), "expected here"),
    "owner": (lambda old: old * 0 - 1, "no node"),
}


def test_lies_of_a_tie_are_named(slideline, tmp_path):
    text = with_files(tied(5, columns=(12, 9), strength=(8.0e3, 8.0e3)), dump=20)
    assert slideline("d=out", deck=text).returncode == 0
    for name, (change, word) in LIES.items():
        path = tmp_path / "lie.h5"
        path.write_bytes((tmp_path / "out/job.dump01.h5").read_bytes())
        with h5py.File(path, "r+") as stream:
            where = f"state/contacts/1/ties/{name}"
            fuzz_restarts.replace(stream, where, change(stream[where][()]))
        fuzz_restarts.mend(path)
        done = slideline("r=lie.h5", "d=again")
        assert done.returncode == 1, (name, done.returncode, done.stderr)
        assert "state/contacts/1/ties" in done.stderr and word in done.stderr, (name, done.stderr)


def test_a_deck_written_back_breaks_alike(slideline, tmp_path):
    done = slideline("d=first", "fs=0.2", deck=tied(5, columns=(10, 7), strength=(8.0e3, 9.0e3)))
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "first/job.effective.k").read_text()
    done = slideline("d=again", deck=text)
    assert done.returncode == 0, done.stderr
    assert histories(tmp_path / "first") == histories(tmp_path / "again")


def test_the_command_line_passes_ties_by(slideline, tmp_path):
    for folder, words in (("plain", ()), ("led", ("vdc=20", "punit=3", "pen=0.5", "fs=0.1"))):
        done = slideline(f"d={folder}", *words, deck=tied(5, columns=(10, 7)))
        assert done.returncode == 0, done.stderr
    for text in ("interface 1 is tied: its penalty cannot be a share of the largest stable penalty; ", "interface 1 is tied: ties have no contact damping",
                 'interface 1 is tied: "fs=0.1" on the command line has no effect'):
        assert text in done.stderr
    assert histories(tmp_path / "plain") == histories(tmp_path / "led")


def test_fields_without_effect_are_named(slideline):
    text = tied(5, columns=(10, 7)).replace("0.0,1.0,1\n", "3.0,0.5,1,5.0\n").replace(",0,0,0,0,0,-20.0", ",0,0,0,0,30,-20.0")
    done = slideline("d=out", deck=text)
    assert done.returncode == 0, done.stderr
    assert "interface 1 is tied: VC, TFAC, FREQ without effect" in done.stderr
    assert '(NFLS): "5.0" has no effect: only tiebreak (TIE 2) has strengths' in done.stderr


def test_master_penalty_beside_a_blank_one(slideline, tmp_path):
    """PENT with PUNIT 2 is kept beside the default of PEN."""
    for folder, card in (("default", "0,0"), ("given", "2,20.0")):
        text = tied(3, columns=(10, 7)).replace("0.0,1e+20,0,0", f"0.0,1e+20,{card}")
        assert slideline(f"d={folder}", deck=text).returncode == 0
    last = [line for folder in ("default", "given") for line in (tmp_path / folder / "job.log").read_text().splitlines()
            if "times the built-in estimate" in line]
    assert "1.000000E+01 and 1.000000E+01 times" in last[0] and "1.000000E+01 and 2.000000E+01 times" in last[1]


@pytest.mark.parametrize("static", (True, False))
@pytest.mark.parametrize("kind", some_types(1, release=4))
def test_implicit_restart(slideline, tmp_path, kind, static):
    text = with_files(tied(kind, columns=(7, 5), static=static, gap=0.002), dump=4)
    done = slideline("d=whole", deck=text)
    assert done.returncode == 0, done.stderr
    rest = part_of(tmp_path / "whole", tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    done = slideline("r=rest/job.dump01.h5")
    assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "whole", rest)


@pytest.mark.parametrize("keyword", ("*CONTACT_2D_AUTOMATIC_TIED", "*CONTACT_2D_AUTOMATIC_TIED_ONE_WAY",
                                     "*CONTACT_2D_TIED_SLIDING"))
def test_stock_keywords_stand_for_type_5(slideline, tmp_path, keyword):
    for folder, words in (("own", {}), ("stock", {"keyword": keyword})):
        done = slideline(f"d={folder}", deck=tied(5, columns=(10, 7), **words))
        assert done.returncode == 0, done.stderr
    assert histories(tmp_path / "own") == histories(tmp_path / "stock")
    # the deck with another type is our own card, and runs again to the same bits
    done = slideline("d=other", "ctype=4", deck=tied(5, columns=(10, 7), keyword=keyword))
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "other/job.effective.k").read_text()
    assert "*CONTACT_2D_SLIDELINE" in text
    done = slideline("d=again", deck=text)
    assert done.returncode == 0, done.stderr
    assert histories(tmp_path / "other") == histories(tmp_path / "again")


def test_what_is_out_of_reach_is_named(slideline, tmp_path):
    done = slideline("d=out", deck=tied(5, columns=(12, 10), overhang=0.3))
    assert done.returncode == 0, done.stderr
    # node 11 is beyond the master too, but its segment is tied in part
    assert "interface 1: 2 of 13 slave nodes have no master segment within the search radius (SRCH) and are not tied: 12 13" in done.stderr
    assert "with its ties the stable step is" in (tmp_path / "out/job.log").read_text()


def test_a_tie_of_nothing_is_an_error(slideline):
    done = slideline("d=out", deck=tied(5, columns=(12, 10), gap=0.03))
    assert done.returncode == 1
    assert "interface 1 ties nothing: none of its 13 slave nodes lies within the search radius of the master" in done.stderr


def test_step_obeys_ties(slideline, tmp_path):
    """With matching meshes the step of the elements alone would be unstable; ECDT 1 takes it."""
    text = tied(5, columns=(32, 32)).replace("*END", "*CONTROL_TERMINATION\n1.0,\n*END")
    assert slideline("d=on", deck=text).returncode == 0
    ratio = numbers(tmp_path / "on/job.glstat.csv", "energy_ratio")
    assert max(abs(value - 1.0) for value in ratio) < 1.0e-3
    free = slideline("d=free", deck=text.replace("*END", "*CONTROL_CONTACT\n0.1,\n0,0,0,0,0.0,0,1\n*END"))
    assert numbers(tmp_path / "free/job.glstat.csv", "dt")[1] > 1.1 * numbers(tmp_path / "on/job.glstat.csv", "dt")[1]
    assert free.returncode == 0, free.stderr
    assert "exceeds the stability limit of its ties" in free.stderr and "(ECDT 1 of *CONTROL_CONTACT" in free.stderr
    assert max(abs(value - 1.0) for value in numbers(tmp_path / "free/job.glstat.csv", "energy_ratio")) > 0.1


@pytest.mark.parametrize("penalty, unit, reported", [(None, 0, ""), (1.0, 2, ""), (1.0e4, 2, "the ties cost 9"), (5.0, 0, "as soft as")])
def test_ties_of_unlikely_penalties_are_reported(slideline, penalty, unit, reported):
    """Springs that cost most of the step, and springs that hold next to nothing. PUNIT 2 is a factor on a tenth of K L/A."""
    text = tied(5)
    if penalty:
        assert text.count("\n-1,-2,5,3,0.0,") == text.count("\n0.0,1e+20,0,0,0,") == 1
        text = text.replace("\n-1,-2,5,3,0.0,", f"\n-1,-2,5,3,{penalty},").replace("\n0.0,1e+20,0,0,0,", f"\n0.0,1e+20,{unit},0,0,")
    done = slideline("d=out", "endtim=1.0e-5", deck=text)
    assert done.returncode == 0, done.stderr
    for words in ("the ties cost 9", "as soft as"):
        assert (words in done.stderr) == (words == reported), done.stderr


def test_contact_behind_ties_counts_in_the_step(slideline, tmp_path):
    """It has the stiff penalty of the ties: once something has broken the step may not rise to that of the elements."""
    text = tied(5, strength=(1.0e3, 1.0e3))
    assert slideline("d=broken", deck=text).returncode == 0
    dt, state = numbers(tmp_path / "broken/job.glstat.csv", "dt"), numbers(tmp_path / "broken/job.contact.csv", "state")
    assert 3.0 in state and set(state[-8:]) == {4.0}
    assert max(dt[1:]) < 1.02 * dt[1]
