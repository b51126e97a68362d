# SPDX-License-Identifier: MIT
"""Each case of tests/verification has a README of at most a page and a case.toml, of which make_table.py writes its row of
doc/verification.md; decks that case.toml names are there."""
import ast
import re
import sys

import pytest

from fortran_source import ROOT

sys.path.insert(0, str(ROOT / "tests" / "verification"))

from make_table import all_checks, figures, read_cases, with_rows  # noqa: E402

PAGE = (ROOT / "doc" / "verification.md").read_text(encoding="utf-8")
CASES, FOLDER = read_cases(), ROOT / "tests" / "verification"
MOST_LINES = 60
KEYS = {"tolerance", "kind", "source", "full"}


def check(error, tolerance, kind="rel", passed=True):
    return {"quantity": "x | y", "expected": 1.0, "found": 1.0 + error, "error": error, "tolerance": tolerance, "kind": kind,
            "passed": passed}


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
    assert all(set(entry) <= KEYS and entry.get("kind") in (None, "abs", "min", "max") for entry in CASES[case]["quantity"].values())
    sources = (ast.parse(path.read_text(encoding="utf-8"))
               for path in [*(FOLDER / case).glob("*.py"), *FOLDER.glob("*.py"), *(ROOT / "tools/slideline_tools").rglob("*.py")])
    makers = {node.name for tree in sources for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    files = {path.name for path in [*(FOLDER / case).rglob("*.k"), *(ROOT / "input").rglob("*.k")]}
    assert CASES[case]["decks"] and {deck.partition(":")[0] for deck in CASES[case]["decks"]} <= makers | files


def test_the_error_is_that_nearest_to_its_tolerance():
    assert figures(report(check(0.01, 1.0), check(1e-10, 2e-10), check(0.0, 0.0, "abs"))) == "3 | 1e-10 | 2e-10"
    assert figures(report(check(-0.5, 0.0, "max"))) == "1 | 0.5 | 1"


def test_figures_are_filled_in():
    found = report(check(0.25, 0.5), check(2.0, 1.0, passed=False))
    page = with_rows(PAGE, CASES, {"hertz": found})
    assert "| 2 | 2 | 1 |" in page and "1 cases with 2 checks, 1 passed" in page
    assert [line for line in page.splitlines() if "two_bars" in line] == [line for line in PAGE.splitlines() if "two_bars" in line]
    assert "](../tests/verification/new/README.md) | a | b |  |  |  |\n" in with_rows(
        PAGE, {"new": {"title": "a", "against": "b", "topic": "Contact"}}, {})


def test_all_checks_of_a_case():
    text = all_checks(report(check(2.0, 1.0, passed=False)))
    assert "| x \\| y | 1 | 3 | 2 | 1 | rel | FAIL |" in text
