# SPDX-License-Identifier: MIT
"""Helpers of the program tests: SLIDELINE names the program to test."""
import csv
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[n] / folder) for n, folder in ((1, "verification"), (2, "tools"))]
from meshes import Deck, grid  # noqa: E402
from slideline_tools.contact_types import ALL_TYPES  # noqa: E402


def program_path():
    path = os.environ.get("SLIDELINE")
    if not path:
        pytest.exit("set SLIDELINE to the program to test", returncode=2)
    return str(pathlib.Path(path).resolve())


def drop(end_time=0.02, dt=1.0e-4, kind=2, penalty=2.0e5, parametric=False):
    """A 3 x 2 block that hits a fixed 5 x 2 block: contact, loads, all outputs."""
    deck = Deck("drop")
    if parametric:
        deck.add("*PARAMETER", f"R  tend,{end_time!r}", "R    v0,-2.0")
        deck.add("*CONTROL_TERMINATION", "&tend,")
        deck.add("*CONTROL_TIMESTEP", (0.0, 0.9, 0, 0.0, 0.0, 9001))
        deck.curve(9001, [(0.0, dt), (1.0e6, dt)])
    else:
        deck.control(end_time, dt=dt)
    deck.part(1).elastic(1000.0, 1.0e6, 0.3, 1)
    deck.part(2).plastic(1000.0, 1.0e6, 0.3, 2.0e4, 1.0e5, 0.5, 2)
    upper = deck.mesh(*grid(3, 2, 0.6, 0.4, (0.2, 0.002)), part=1)
    lower = deck.mesh(*grid(5, 2, 1.0, 0.4, (0.0, -0.4)), part=2)
    deck.node_set(1, upper).node_set(2, upper[:4]).node_set(3, lower[-6:][::-1])
    deck.fix(lower[:6], x=1, y=1)
    deck.add("*INITIAL_VELOCITY", (1,), "0.3,&v0" if parametric else (0.3, -2.0))
    deck.curve(1, [(0.0, 9.81), (10.0, 9.81)]).add("*LOAD_BODY_Y", (1, 1.0))
    deck.contact(2, 3, kind, penalty)
    interval = 10 * dt
    return deck.output(plot=2 * interval, glstat=interval, matsum=interval, rcforc=interval,
                       nodout=interval, nodes=[1, 13, 20])


def is_full():
    """Whether every combination is asked for, not a covering design, as in tests/verification/run_case.py."""
    return os.environ.get("SLIDELINE_FULL") == "1"


def threads_of(kind):
    """Numbers of threads to compare: one, and others; where not in full one other, in turn by the type."""
    return (1, 2, 4) if is_full() else (1, 2 + 2 * (kind % 2))


def some_types(turn=0, each=3, release=len(ALL_TYPES)):
    """Some types, from another one on for every turn: `each` with the checked Debug build, `release` with another one; there all
    where SLIDELINE_FULL is 1."""
    if os.environ.get("SLIDELINE_BUILD") != "Debug":
        each = len(ALL_TYPES) if is_full() else release
    return tuple(ALL_TYPES[(each * turn + i) % len(ALL_TYPES)] for i in range(each))


def by_turns(cases, each=1, release=4):
    """Of (scene, type) some types of each scene, in turn: `each` with the checked Debug build, which is slow, `release` with
    another one; all where SLIDELINE_FULL is 1."""
    if os.environ.get("SLIDELINE_BUILD") != "Debug":
        if is_full():
            return cases
        each = release
    scenes = {scene: [case for case in cases if case[0] == scene] for scene, _ in cases}
    return [own[(each * k + i) % len(own)] for k, own in enumerate(scenes.values())
            for i in range(min(each, len(own)))]


def columns(path):
    """A CSV file as {column: list of text}."""
    with open(path, newline="") as stream:
        rows = list(csv.reader(stream))
    return {head: [row[k] for row in rows[1:]] for k, head in enumerate(rows[0])}


def numbers(path, name):
    return np.array([float(text) for text in columns(path)[name]])


@pytest.fixture(scope="session")
def exe():
    return program_path()


@pytest.fixture
def slideline(exe, tmp_path):
    """slideline(*args, deck=..., name=...): writes the deck and runs the program in tmp_path."""
    def call(*args, deck=None, name="job", stdin=None, timeout=120):
        words = list(args)
        if deck is not None:
            path = tmp_path / f"{name}.k"
            path.write_text(deck if isinstance(deck, str) else deck.text())
            words.insert(0, f"i={path}")
        return subprocess.run([exe, *words], capture_output=True, text=True, cwd=tmp_path,
                              timeout=timeout)
    return call


@pytest.fixture(scope="session")
def finished(exe, tmp_path_factory):
    """One finished run of the drop deck, shared by the tests that only look at it."""
    folder = tmp_path_factory.mktemp("finished")
    (folder / "drop.k").write_text(drop().text())
    done = subprocess.run([exe, "i=drop.k", "d=out"], capture_output=True, text=True, cwd=folder,
                          timeout=120)
    assert done.returncode == 0, done.stderr + done.stdout
    return folder / "out", done
