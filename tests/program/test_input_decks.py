# SPDX-License-Identifier: MIT
"""The decks of `input/`: all are accepted without a word; the short ones run, some to their end."""
import csv
import pathlib
import subprocess

import pytest

from conftest import numbers

INPUT = pathlib.Path(__file__).resolve().parents[2] / "input"
DECKS = sorted(path.relative_to(INPUT).as_posix() for path in INPUT.rglob("*.k"))
#: deck -> end time, where the run to the end is long
BEGINNINGS = {"block/block_implicit_2.k": "0.003", "sliding/sliding.k": "8e-6",
              "sliding/sliding_2.k": "4e-6", "sliding/sliding_3.k": "2e-6"}
SHORT = ["block/block.k", "block/block_2.k", "block/block_implicit.k", "hertz/hertz.k", *BEGINNINGS]
PATCHES = [deck for deck in DECKS if deck.startswith("patch/")]


def run(exe, folder, deck, *words):
    """One run that ends well, in a folder of its own."""
    done = subprocess.run([exe, f"i={INPUT / deck}", f"d={folder}", "jobid=job", *words],
                          capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "N o r m a l" in done.stdout


@pytest.mark.parametrize("deck", DECKS)
def test_accepted_without_a_warning(exe, deck):
    done = subprocess.run([exe, "check", str(INPUT / deck)], capture_output=True, text=True,
                          check=False, timeout=60)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    assert "accepted" in done.stdout


@pytest.mark.parametrize("deck", SHORT)
def test_runs(exe, tmp_path, deck):
    end = BEGINNINGS.get(deck)
    run(exe, tmp_path, deck, *([f"endtim={end}"] if end else []))
    assert numbers(tmp_path / "job.glstat.csv", "energy_ratio") == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("deck", PATCHES)
def test_patch_at_rest(exe, tmp_path, deck):
    """The pressure of 1 Pa arrives at every slave node with a type that passes the test."""
    run(exe, tmp_path, deck, "ctype=5")
    with open(tmp_path / "job.contact.csv", newline="", encoding="ascii") as stream:
        rows = list(csv.DictReader(stream))
    pressures = [float(row["pressure"]) for row in rows if row["time"] == rows[-1]["time"]]
    columns = int(deck.split("_")[1])
    assert pressures == pytest.approx([1.0] * (columns + 1), rel=1e-9)
