#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Bring the figures of doc/verification.md up to date from the results of the runs.

`make_table.py --results DIR`, where DIR holds the <case>.json files left by run_case.py
(`ctest -L verification`; SLIDELINE_FULL=1 runs every combination). What a case is and against what it is
judged is written by hand in the row of the case; this script fills in the last three cells.
All checks of a case stand below its README on the site (tools/docs/site_source.py).
"""
import argparse
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROW = re.compile(r"^(\| \[(\w+)\]\([^)]*\) \| .* \| .* \|) [^|]* \| [^|]* \| [^|]* \|$", re.M)
COUNT = re.compile(r"^\d+ cases with \d+ checks.*$", re.M)
LEGEND = """
## All checks

`error` is relative for kind `rel` (arrays: largest difference over largest expected value, the worst entry shown) and
absolute for kind `abs`; `min` and `max` are bounds on what was found.

| quantity | expected | found | error | tolerance | kind | verdict |
|---|---|---|---|---|---|---|
"""


def read_reports(folder):
    """{case: report} of the <case>.json files in a folder."""
    reports = (json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.json")))
    return {report["case"]: report for report in reports}


def number(value):
    return "" if value is None else f"{value:.6g}"


def all_checks(report):
    """Section with all checks of a case, and what it reports without judging it."""
    def cell(text):
        return text.replace("|", "\\|").replace("\n", " ")

    lines = [f"| {cell(check['quantity'])} | {number(check['expected'])} | {number(check['found'])} | {check['error']:.2g} | "
             f"{check['tolerance']:.2g} | {check['kind']} | {'pass' if check['passed'] else 'FAIL'} |"
             for check in report["checks"]]
    if report["reported"]:
        lines += ["\nReported, not judged:\n", "| quantity | found | note |", "|---|---|---|"]
        lines += [f"| {cell(entry['quantity'])} | {number(entry['found'])} | {cell(entry['note'])} |"
                  for entry in report["reported"]]
    if report["problem"]:
        lines.append("\nThe case stopped before its end.")
    return LEGEND + "\n".join(lines) + "\n"


def figures(report):
    """Cells of a case: number of checks, the error that comes nearest to its tolerance, this tolerance. Where nothing but
    bounds is judged: what was found and the bound."""
    checks = report["checks"]
    pairs = [(check["error"], check["tolerance"]) for check in checks if check["tolerance"] > 0.0]
    pairs = pairs or [(check["found"], check["expected"]) for check in checks if check["kind"] == "max"]
    error, tolerance = max(pairs, key=lambda pair: pair[0] / pair[1])
    return f"{len(checks)} | {error:.2g} | {tolerance:.2g}"


def with_figures(page, reports):
    """The page with the figures of these reports in the rows of their cases."""
    checks = [check["passed"] for report in reports.values() for check in report["checks"]]
    how = "in full" if all(report["full"] for report in reports.values()) else "with covering designs, as in CI"
    page = COUNT.sub(f"{len(reports)} cases with {len(checks)} checks, {sum(checks)} passed, run {how}.", page)
    return ROW.sub(lambda row: f"{row[1]} {figures(reports[row[2]])} |" if row[2] in reports else row[0], page)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", required=True, type=pathlib.Path)
    parser.add_argument("--page", type=pathlib.Path, default=ROOT / "doc" / "verification.md")
    options = parser.parse_args()
    reports = read_reports(options.results)
    page = options.page.read_text(encoding="utf-8")
    missing = set(reports) - {row[2] for row in ROW.finditer(page)}
    if missing or not reports:
        print(f"{options.page}: no row for {', '.join(sorted(missing))}" if reports else f"no results in {options.results}",
              file=sys.stderr)
        return 1
    options.page.write_text(with_figures(page, reports), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
