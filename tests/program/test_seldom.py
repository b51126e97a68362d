# SPDX-License-Identifier: MIT
"""What runs seldom do: a look without a solution, penalties that share nodes, many interfaces, walls that see a few
nodes, a run on a terminal."""
import os
import re
import signal
import subprocess

import numpy as np
import pytest
from conftest import columns, drop, numbers
from meshes import Deck, grid


def test_no_solution_asked_for(slideline, tmp_path):
    """NOSOL 1: the model is judged and the run ends normally where it began."""
    text = drop().text().replace("*CONTROL_TERMINATION\n0.02,", "*CONTROL_TERMINATION\n0.02,0,0.0,0.0,0.0,1", 1)
    done = slideline("d=out", deck=text)
    assert done.returncode == 0 and "model checked, no solution asked for (NOSOL)" in done.stdout
    assert not (tmp_path / "out/job.glstat.csv").exists() or \
        max(numbers(tmp_path / "out/job.glstat.csv", "time"), default=0.0) == 0.0


def penalty_of(log):
    """The automatic penalties that a log tells, by interface."""
    return {int(number): float(value) for number, value in
            re.findall(r"interface (\d+): penalty .*?([0-9.]+E[+-][0-9]+)", log)}


def shared(tmp_path, slideline, name, *penalties):
    """Log of the drop with an interface of each of these (penalty, unit) over the same surfaces; its standard error."""
    deck = drop(end_time=0.001, dt=5.0e-4)
    text = deck.text()
    card = text[text.index("*CONTACT_2D_SLIDELINE"):]
    card = card[:card.index("\n*", 1) + 1]
    cards = "".join(f"*CONTACT_2D_SLIDELINE\n-2,-3,2,2,{penalty!r}\n0.0,1.0e20,{unit}\n" for penalty, unit in penalties)
    done = slideline(f"d={name}", deck=text.replace(card, cards), name=name)
    path = tmp_path / name / f"{name}.log"
    return done, path.read_text() if path.exists() else ""


def test_automatic_penalties_that_share_nodes(slideline, tmp_path):
    """Springs in parallel add up: two equal interfaces may have half of what one may have alone."""
    done, log = shared(tmp_path, slideline, "alone", (1.0, 3))
    assert done.returncode == 0, done.stderr
    alone = penalty_of(log)[1]
    done, log = shared(tmp_path, slideline, "both", (1.0, 3), (1.0, 3))
    assert done.returncode == 0, done.stderr
    both = penalty_of(log)
    assert both == pytest.approx({1: 0.5 * alone, 2: 0.5 * alone}, rel=1.0e-4)


def test_automatic_penalties_without_room(slideline, tmp_path):
    """Beside a penalty that takes all there is, and with a step that the elements alone use up."""
    done, log = shared(tmp_path, slideline, "alone", (1.0, 3))
    done, _ = shared(tmp_path, slideline, "stiff", (1.0, 3), (1.0e9, 0))
    assert done.returncode == 1 and "no automatic penalty (PUNIT 3) is stable beside the penalties of other interfaces" in done.stderr, done.stderr
    text = drop().text().replace("0.0,1e+20,0", "0.0,1e+20,3").replace("200000.0", "1.0")
    text = text.replace("*CONTROL_TIMESTEP\n0.0,0.9,0,0.0,0.0,9001", "*CONTROL_TIMESTEP\n0.0,1.0")
    assert "0.0,1.0\n" in text
    done = slideline("d=long", deck=text)
    assert done.returncode == 1 and "no automatic penalty (PUNIT 3) is stable: the time step" in done.stderr, done.stderr


@pytest.mark.parametrize("scale, bound", [(0.5, "springs that open and close"), (0.95, "springs that stay closed")])
def test_penalty_that_demands_a_smaller_step(slideline, scale, bound):
    """The warning names a penalty that would fit. It does, and just above it the warning names the bound that rules;
    with PUNIT 3 there is none."""
    text = drop(end_time=0.001).text().replace("0.9,0,0.0,0.0,9001", f"{scale}")
    assert f"*CONTROL_TIMESTEP\n0.0,{scale}\n" in text

    def say(penalty, unit=0):
        deck = text.replace("200000.0", repr(penalty)).replace("0.0,1e+20,0", f"0.0,1e+20,{unit}")
        done = slideline("d=out", deck=deck)
        assert done.returncode == 0, done.stderr
        return done.stdout + done.stderr

    warned = say(2.0e9)
    assert "requires a time step of at most" in warned
    fitting = 2.0e9 * float(re.search(r"a penalty of (\S+) times the present one would be stable", warned).group(1))
    assert "requires a time step" not in say(0.999999 * fitting)
    assert f", the bound of {bound} (while they stay closed" in say(1.000001 * fitting)
    assert "requires a time step" not in say(1.0, 3)


def test_many_interfaces_changed_by_the_command_line(slideline, tmp_path):
    """Eighty interfaces, more changed lines than there is room for at first, against the deck that says so itself."""
    text = drop(end_time=0.002).text()
    card = text[text.index("*CONTACT_2D_SLIDELINE"):]
    card = card[:card.index("\n*", 1) + 1]
    many = text.replace(card, 80 * "*CONTACT_2D_SLIDELINE\n-2,-3,2,2,1000.0\n0.0,1.0e20,0\n")
    assert slideline("d=changed", "ctype=5", "pen=2500.0", deck=many).returncode == 0
    assert slideline("d=given", deck=many.replace("-2,-3,2,2,1000.0", "-2,-3,5,2,2500.0")).returncode == 0
    named = many.replace("-2,-3,2,2,1000.0\n0.0,1.0e20,0", "-2,-3,5,2,&pen\n0.0,1.0e20,0,&pen")
    named = named.replace("*CONTROL_TERMINATION", "*PARAMETER\nR    pen,2500.000000000000\n*CONTROL_TERMINATION", 1)
    assert slideline("d=named", deck=named).returncode == 0
    for folder in ("changed", "named"):
        for name in ("glstat", "rcforc"):
            assert (tmp_path / f"{folder}/job.{name}.csv").read_bytes() == (tmp_path / f"given/job.{name}.csv").read_bytes()
    effective = (tmp_path / "changed/job.effective.k").read_text()
    assert len(re.findall(r"^-2,-3,5,2,2500.0,$", effective, re.MULTILINE)) == 80


def flying(offset, rigid=False):
    """A block that flies down at 10 m/s onto a wall 0.1 below it, which sees what is within `offset` (0: all)."""
    deck = Deck("offset").control(0.03, dt=1.0e-4).part(1).elastic(1000.0, 1.0e6, 0.3)
    deck.mesh(*grid(2, 2, 0.2, 0.2, (0.0, 0.1)))
    if rigid:
        deck.part(2, section=1).add("*MAT_RIGID", (2, 1000.0, 1.0e6, 0.3), (0.0,))
        deck.mesh(*grid(1, 1, 0.1, 0.1, (5.0, 5.0)), part=2)
    deck.add("*INITIAL_VELOCITY", (0,), (0.0, -10.0))
    deck.add("*RIGIDWALL_PLANAR", (0, 0, 0, offset), (0.0, 0.0, 0.0, 0.0, 1.0, 0.0))
    return deck.add("*DATABASE_RWFORC", (1.0e-3,)).output(glstat=1.0e-3, nodout=1.0e-3, nodes=[1])


def test_a_wall_sees_nodes_within_its_offset(slideline, tmp_path):
    """A block that starts farther off than OFFSET goes through; its free flight is v t."""
    assert slideline("d=through", deck=flying(0.05)).returncode == 0
    table = columns(tmp_path / "through/job.nodout.csv")
    time, down = (np.array([float(text) for text in table[name]]) for name in ("time", "uy"))
    assert down == pytest.approx(-10.0 * time, rel=1.0e-9, abs=1.0e-12)
    assert "the wall has no nodes" in (tmp_path / "through/job.log").read_text()
    assert slideline("d=held", deck=flying(0.15)).returncode == 0
    assert min(float(text) for text in columns(tmp_path / "held/job.nodout.csv")["uy"]) >= -0.1 - 1.0e-12


def test_nodes_of_rigid_bodies_do_not_see_a_wall(slideline, tmp_path):
    assert slideline("d=out", deck=flying(0.0, rigid=True)).returncode == 0
    assert "nodes of rigid bodies, which pass the wall: 4, the first at node" in (tmp_path / "out/job.log").read_text()


def test_implicit_motion_by_acceleration(slideline, tmp_path):
    """All nodes accelerate by 3 m/s^2 from rest: u = 3 t^2/2, v = 3 t (Newmark is exact for a constant acceleration)."""
    deck = Deck("accelerated").part(1, points=4).elastic(1000.0, 1.0e6, 0.3)
    deck.add("*CONTROL_TERMINATION", (0.4,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.05))
    deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1, 0.5, 0.25)).curve(1, [(0.0, 3.0), (1.0, 3.0)])
    nodes = deck.mesh(*grid(1, 1))
    for node in nodes:
        deck.prescribe(node, 1, 1, 1)
    done = slideline("d=out", deck=deck.fix(nodes[:2], y=1).output(glstat=0.05, nodout=0.05, nodes=[1, 4]))
    assert done.returncode == 0, done.stderr
    table = columns(tmp_path / "out/job.nodout.csv")
    time, u, v = (np.array([float(text) for text in table[name]]) for name in ("time", "ux", "vx"))
    assert time.max() == pytest.approx(0.4)
    assert u == pytest.approx(1.5 * time**2, abs=1.0e-12)
    assert v == pytest.approx(3.0 * time, abs=1.0e-12)


def test_progress_on_a_terminal(exe, tmp_path):
    """One line that is written over, with the share of the time and what is to come, until the run is stopped."""
    (tmp_path / "job.k").write_text(drop(end_time=2000.0).text())
    ours, theirs = os.openpty()
    process = subprocess.Popen([exe, "i=job.k", "d=out"], cwd=tmp_path, stdout=theirs, stderr=subprocess.DEVNULL)
    os.close(theirs)
    said = b""
    while True:
        try:
            more = os.read(ours, 4096)
        except OSError:
            break
        if not more:
            break
        said += more
        if said.count(b"to go") >= 2 and process.poll() is None:
            process.send_signal(signal.SIGTERM)
    os.close(ours)
    assert process.wait(timeout=60) == 4
    assert b"stopped on request" in said
    shares = [float(value) for value in re.findall(rb"\r t[^%\r]*?([0-9.]+) %", said)]
    assert len(shares) >= 2 and all(0.0 <= value <= 100.0 for value in shares) and shares == sorted(shares)


def test_a_deck_beside_a_restart_file_that_is_not_there(slideline):
    text = drop().text().rsplit("*END", 1)[0] + "*DATABASE_BINARY_D3DUMP\n50,\n*END\n"
    assert slideline("d=out", deck=text).returncode == 0
    done = slideline("r=out/job.dump01.h5", "i=nowhere.k", "d=out")
    assert done.returncode == 1 and "cannot read the deck nowhere.k" in done.stderr, done.stderr


def test_a_deck_of_more_than_2_gb(slideline, tmp_path):
    """The length alone is looked at (the file has one byte and a hole)."""
    (tmp_path / "huge.k").write_bytes(b"*")
    os.truncate(tmp_path / "huge.k", 2**31)
    done = slideline("i=huge.k", "d=out")
    assert done.returncode == 1 and "the file is larger than 2 GB" in done.stderr
