# SPDX-License-Identifier: MIT
"""Each case of tests/verification has a README of at most a page and a case.toml, of which make_table.py writes its row of
doc/verification.md; decks that case.toml names are there."""
import re
import sys

import pytest

from fortran_source import ROOT

sys.path.insert(0, str(ROOT / "tests" / "verification"))

import run_case  # noqa: E402
from make_table import all_checks, figures, read_cases, with_rows  # noqa: E402

PAGE = (ROOT / "doc" / "verification.md").read_text(encoding="utf-8")
CASES, FOLDER = read_cases(), ROOT / "tests" / "verification"
MOST_LINES = 60
KEYS = {"tolerance", "scale", "kind", "source", "full"}


def named(folder):
    """Functions and classes of the Python files of a folder, and its decks."""
    text = "\n".join(path.read_text(encoding="utf-8") for path in folder.rglob("*.py"))
    return {*re.findall(r"^ *(?:def|class) (\w+)", text, re.M), *(path.name for path in folder.rglob("*.k"))}


NAMED = named(FOLDER) | named(ROOT / "tools" / "slideline_tools") | named(ROOT / "input")


def check(error, tolerance, kind="rel", passed=True):
    return {"quantity": "x | y", "expected": 1.0, "found": 1.0 + error, "error": error, "tolerance": tolerance, "kind": kind,
            "source": "Lame", "passed": passed}


def report(*checks):
    return {"case": "hertz", "full": False, "checks": list(checks), "reported": [], "problem": None}


def test_every_case_has_one_row():
    assert sorted(CASES) == sorted(path.parent.name for path in FOLDER.glob("*/check.py"))
    assert with_rows(PAGE, CASES, {}) == PAGE
    assert sorted(re.findall(r"^\| \[(\w+)\]", PAGE, re.M)) == sorted(CASES)


@pytest.mark.parametrize("case", CASES)
def test_case_is_described(case):
    """What README.md says is not said twice: its title stands in case.toml."""
    text = (FOLDER / case / "README.md").read_text(encoding="utf-8")
    assert not text.startswith("#") and text.count("\n") <= MOST_LINES
    assert set(CASES[case]) == {"title", "against", "topic", "decks", "quantity"}
    for name, entry in CASES[case]["quantity"].items():
        assert name.strip("*: ") and set(entry) <= KEYS and entry.get("kind") in (None, "abs", "min", "max")
    makers = {deck.partition(":")[0] for deck in CASES[case]["decks"]}
    assert makers and makers <= NAMED


def test_the_error_is_that_nearest_to_its_tolerance():
    assert figures(report(check(0.01, 1.0), check(1e-10, 2e-10), check(0.0, 0.0, "abs"))) == "3 | 1e-10 | 2e-10"
    assert figures(report(check(-0.5, 0.0, "max"))) == "1 | 0.5 | 1"


def test_figures_are_filled_in():
    found = report(check(0.25, 0.5), check(2.0, 1.0, passed=False))
    page = with_rows(PAGE, CASES, {"hertz": found})
    assert "| 2 | 2 | 1 |" in page and "1 cases with 2 checks, 1 passed" in page
    assert [line for line in page.splitlines() if "two_bars" in line] == [line for line in PAGE.splitlines() if "two_bars" in line]
    assert "](../tests/verification/new/README.md) | a | b | - | - | - |\n" in with_rows(
        PAGE, {"new": {"title": "a", "against": "b", "topic": "Contact"}}, {})


def test_all_checks_of_a_case():
    text = all_checks(report(check(2.0, 1.0, passed=False)))
    assert "| x \\| y | Lame | 1 | 3 | 2 | 1 | rel | FAIL |" in text


def test_checks_find_their_entries(tmp_path):
    run = run_case.Run("hertz", None, tmp_path)
    run.quantities = {"round*: force": {"tolerance": 0.5, "kind": "abs"}, "force": {"tolerance": 0.1, "source": "F"},
                      "width of *": {"tolerance": "two cells"}, "arc": {"tolerance": 0.1, "scale": "s"},
                      "[a] meets": {}, "order": {"full": True}}
    assert run.check("round, type 2: force", 1.4, 1.0) and not run.check("plane, round: force", 1.4, 1.0)
    assert run.check("arc", 1.4, 1.0, scale=5.0) and run.true("a: [a] meets", True) and not run.true("[a] meets", False)
    assert run.check("plane: width of a", 2.0, 1.0, tol=1.0) and run.records[1]["source"] == "F"
    for quantity, words in (("moment", {}), ("width of a", {}), ("force", {"tol": 0.1}), ("force", {"scale": 2.0}), ("arc", {})):
        with pytest.raises((LookupError, ValueError), match=quantity):
            run.check(quantity, 1.0, 1.0, **words)
    assert run.unused() == []
    run.is_full = True
    assert run.unused() == ["order"]
