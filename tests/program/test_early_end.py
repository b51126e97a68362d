# SPDX-License-Identifier: MIT
"""*TERMINATION_NODE, _BODY and _CONTACT: when runs end, what they say, threads and restarts."""
import re
import shutil

import numpy as np
import pytest
from conftest import drop, numbers
from history_decks import busy_block
from meshes import Deck, grid


def with_end(deck, keyword, *cards, dump=None):
    deck.add(f"*TERMINATION_{keyword}", *cards)
    if dump:
        deck.add("*DATABASE_BINARY_D3DUMP", (dump,))
    return deck.text()


def check_end(slideline, tmp_path, deck, reported, name="out"):
    """Normal termination that tells why, on the screen, in the log and in status.out; the last time."""
    done = slideline(f"d={name}", deck=deck)
    assert done.returncode == 0, done.stderr
    assert "N o r m a l    t e r m i n a t i o n" in done.stdout and re.search(reported, done.stdout)
    for file in ("job.log", "status.out"):
        assert re.search(reported, (tmp_path / name / file).read_text()), file
    return numbers(tmp_path / name / "job.glstat.csv", "time")[-1]


def test_node_reaches_a_coordinate(slideline, tmp_path):
    """The first cycle at or below the bound: the one before is above it."""
    time = check_end(slideline, tmp_path, with_end(drop(), "NODE", (1, 2, None, 0.0005)), r"node 1 has come to y = ")
    end = numbers(tmp_path / "out" / "job.nodout.csv", "y")[numbers(tmp_path / "out" / "job.nodout.csv", "node") == 1]
    assert end[-1] <= 0.0005 < end[-2]
    assert time == pytest.approx(0.0015 / 2.0, rel=0.2)


def test_node_in_contact(slideline, tmp_path):
    time = check_end(slideline, tmp_path, with_end(drop(), "NODE", (1, 4)), r"node 1 is in contact")
    assert 0.002 / 2.1 < time < 0.002 / 2.0 + 5.0e-4
    force = numbers(tmp_path / "out" / "job.rcforc.csv", "fy")
    assert np.abs(force[-2:]).max() > 0.0


def test_body_moves(slideline, tmp_path):
    for cards, reported, component, bound in (((2, 2, 0.0, -0.004), r"body 2 has moved to displacement y = -", "uy", 0.004),
                                          ((2, 4, 0.006), r"body 2 has moved by \d", None, 0.006)):
        name = f"body{cards[1]}"
        check_end(slideline, tmp_path, with_end(busy_block(interval=1.0e-4), "BODY", cards), reported, name)
        table = {c: numbers(tmp_path / name / "job.rbdout.csv", c) for c in ("part", "ux", "uy")}
        own = table["part"] == 2
        gone = np.abs(table["uy"][own]) if component else np.hypot(table["ux"][own], table["uy"][own])
        assert gone[-1] >= bound > gone[-2]


def test_contact_lets_go(slideline, tmp_path):
    """Bounce: the run ends DUR after the force has gone; not before ACTIM."""
    deck = Deck("bounce")
    deck.control(0.5, dt=1.0e-4).part(1).elastic(1000.0, 1.0e6, 0.3, 1)
    lower, upper = deck.mesh(*grid(2, 2)), deck.mesh(*grid(2, 2, 0.6, 0.6, (0.2, 1.002)))
    deck.node_set(1, upper[:3]).node_set(2, lower[-3:][::-1]).node_set(3, upper)
    deck.fix(lower[:3], x=1, y=1).add("*INITIAL_VELOCITY", (3,), (0.0, -1.0)).contact(1, 2, 1, 1.0e6)
    deck.output(glstat=1.0e-4, rcforc=1.0e-4)
    text = deck.text()
    time = check_end(slideline, tmp_path, text.replace("*END", "*TERMINATION_CONTACT\n1,0.003,0.002\n*END"),
                     r"interface 1 has no contact force \(\*TERMINATION_CONTACT\)")
    force = np.abs(numbers(tmp_path / "out" / "job.rcforc.csv", "fy")[::2])
    times = numbers(tmp_path / "out" / "job.rcforc.csv", "time")[::2]
    last = times[force > 0.0].max()
    assert last > 0.005 and time == pytest.approx(last + 0.002, abs=3.1e-4)
    # The rest before the first contact does not count to that after it.
    rested = check_end(slideline, tmp_path, text.replace("*END", "*TERMINATION_CONTACT\n1,0.0,0.003\n*END"), "has no contact force", "rested")
    assert rested == pytest.approx(last + 0.003, abs=3.1e-4)
    at_once = check_end(slideline, tmp_path, text.replace("*END", "*TERMINATION_CONTACT\n1,0.0\n*END"), "has no contact force", "once")
    assert at_once <= 2.1e-4
    never = slideline("d=never", "endtim=0.01", deck=text.replace("*END", "*TERMINATION_CONTACT\n1,0.3\n*END"))
    assert "termination time reached" in never.stdout


def test_threads_and_restarts(slideline, tmp_path):
    """A run that goes on ends where the whole one does, from a file halfway and from the last one."""
    deck = with_end(busy_block(), "BODY", (2, 2, 0.0, -0.0062), dump=20)
    time = check_end(slideline, tmp_path, deck, r"body 2 has moved to displacement y", "whole")
    assert 0.005 < time < 0.012 and len(list((tmp_path / "whole").glob("job.dump*.h5"))) > 3
    whole = (tmp_path / "whole" / "job.bndout.csv").read_bytes()
    done = slideline("d=three", "ncpu=3", "perthread=1", deck=deck)
    assert done.returncode == 0 and (tmp_path / "three" / "job.bndout.csv").read_bytes() == whole
    for file in sorted((tmp_path / "whole").glob("job.dump*.h5")):
        rest = tmp_path / f"rest_{file.stem}"
        rest.mkdir()
        for name in (file.name, "job.vtkhdf"):
            shutil.copy(tmp_path / "whole" / name, rest / name)
        done = slideline(f"r={rest.name}/{file.name}")
        assert done.returncode == 0, done.stderr
        assert (rest / "job.bndout.csv").read_bytes() == whole, file.name


def test_implicit(slideline, tmp_path):
    deck = Deck("pulled")
    deck.control(1.0).part(points=4).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(2, 1))
    deck.fix(nodes[[0, 3]], x=1, y=1).curve(1, [(0.0, 0.0), (1.0, 0.1)])
    for node in nodes[[2, 5]]:
        deck.prescribe(node, 1, 2, 1)
    deck.add("*CONTROL_IMPLICIT_GENERAL", (1, 0.1)).output(glstat=0.1)
    time = check_end(slideline, tmp_path, with_end(deck, "NODE", (int(nodes[2]), 1, 1.045)), r"node 3 has come to x = ")
    assert time == pytest.approx(0.5)
