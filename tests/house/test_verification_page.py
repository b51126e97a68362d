# SPDX-License-Identifier: MIT
"""doc/verification.md has a row for each case, and make_table.py fills in its figures."""
import sys

from fortran_source import ROOT

sys.path.insert(0, str(ROOT / "tests" / "verification"))

from make_table import ROW, all_checks, figures, with_figures  # noqa: E402

PAGE = (ROOT / "doc" / "verification.md").read_text(encoding="utf-8")


def check(error, tolerance, kind="rel", passed=True):
    return {"quantity": "x | y", "expected": 1.0, "found": 1.0 + error, "error": error, "tolerance": tolerance, "kind": kind,
            "passed": passed}


def report(*checks):
    return {"case": "hertz", "full": False, "checks": list(checks), "reported": [], "problem": None}


def test_every_case_has_one_row():
    cases = sorted(path.parent.name for path in (ROOT / "tests" / "verification").glob("*/check.py"))
    assert sorted(row[2] for row in ROW.finditer(PAGE)) == cases


def test_the_error_is_that_nearest_to_its_tolerance():
    assert figures(report(check(0.01, 1.0), check(1e-10, 2e-10), check(0.0, 0.0, "abs"))) == "3 | 1e-10 | 2e-10"
    assert figures(report(check(-0.5, 0.0, "max"))) == "1 | 0.5 | 1"


def test_figures_are_filled_in():
    page = with_figures(PAGE, {"hertz": report(check(0.25, 0.5), check(2.0, 1.0, passed=False))})
    assert "| 2 | 2 | 1 |" in page and "1 cases with 2 checks, 1 passed" in page
    assert [line for line in page.splitlines() if "two_bars" in line] == [line for line in PAGE.splitlines() if "two_bars" in line]


def test_all_checks_of_a_case():
    text = all_checks(report(check(2.0, 1.0, passed=False)))
    assert "| x \\| y | 1 | 3 | 2 | 1 | rel | FAIL |" in text
