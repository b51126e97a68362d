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
              "sliding/sliding_2.k": "4e-6", "sliding/sliding_3.k": "2e-6", "hopkinson/hopkinson.k": "1.8e-4",
              "penetration/penetration.k": "2e-5", "seal/seal.k": "6e-3", "tube/tube.k": "2e-4", "v_bend/v_bend.k": "4e-4"}
SHORT = ["block/block.k", "block/block_2.k", "block/block_implicit.k", "hertz/hertz.k", "taylor/taylor_johnson_cook.k",
         *BEGINNINGS]
#: deck, words, history, which rows, column, mean of it, relative tolerance: closed forms
#: and published figures of the decks' heads
KNOWN = [
    ("hopkinson/hopkinson.k", ["endtim=1.65e-4"], "elout", lambda row: 110e-6 < float(row["time"]) < 160e-6 and row["element"] == "10626",
     "syy", -0.5 * 7850.0 * (210.0e9 / 7850.0) ** 0.5 * 10.0, 0.01),
    ("v_bend/v_bend.k", ["endtim=3.5e-4"], "rcforc", lambda row: float(row["time"]) > 2.0e-4 and row["interface"] == "1"
     and row["side"] == "master", "fy", 37.0e3, 0.1),
    ("taylor/taylor_johnson_cook.k", [], "nodout", lambda row: float(row["time"]) > 7.98e-5 and row["node"] == "301",
     "y", 26.54e-3, 0.005),
    # Lame: p = E delta/(R C), of which a quarter of the circle pushes R p to the right.
    ("press_fit/press_fit.k", [], "rcforc", lambda row: float(row["time"]) > 0.99 and row["side"] == "master",
     "fx", 0.05 * 2.1e11 * 1.0e-3 * 0.3296703, 0.003),
    # Peterson: 3.15 at the edge, which falls by 7/3 of it in a radius.
    ("plate_hole/plate_hole.k", [], "elout", lambda row: float(row["time"]) > 0.99, "sxx",
     3.15e8 * (1.0 - 7.0 / 3.0 * 0.588 / 20.0), 0.02),
]
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


@pytest.mark.parametrize("deck, words, table, is_meant, column, wanted, tolerance", KNOWN, ids=[case[0] for case in KNOWN])
def test_mean_of_a_history_is_what_the_head_says(exe, tmp_path, deck, words, table, is_meant, column, wanted, tolerance):
    run(exe, tmp_path, deck, "p:dtplot=1.0", *words)
    with open(tmp_path / f"job.{table}.csv", newline="", encoding="ascii") as stream:
        values = [float(row[column]) for row in csv.DictReader(stream) if is_meant(row)]
    assert sum(values) / len(values) == pytest.approx(wanted, rel=tolerance)


def test_little_energy_withheld_is_listed_without_a_warning(exe, tmp_path):
    """Forces are limited in every third cycle, and 0.12 % of the energy is withheld."""
    run(exe, tmp_path, "hopkinson/hopkinson.k", "p:dtplot=1.0")
    log = (tmp_path / "job.log").read_text(encoding="ascii")
    assert log.count("contact forces limited") == 2
    assert "warning: interface" not in log


@pytest.mark.parametrize("deck", PATCHES)
def test_patch_at_rest(exe, tmp_path, deck):
    """The pressure of 1 Pa arrives at every slave node with a type that passes the test."""
    run(exe, tmp_path, deck, "ctype=5")
    with open(tmp_path / "job.contact.csv", newline="", encoding="ascii") as stream:
        rows = list(csv.DictReader(stream))
    pressures = [float(row["pressure"]) for row in rows if row["time"] == rows[-1]["time"]]
    columns = int(deck.split("_")[1])
    assert pressures == pytest.approx([1.0] * (columns + 1), rel=1e-9)
