#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write doc/verification.md from the results of the verification runs.

`make_table.py --results DIR [--output doc/verification.md]`, where DIR holds
the <case>.json files left by run_case.py (`SLIDELINE_FULL=1 ctest -L verification`
for the page: it says which cases were run with a covering design instead).
"""
import argparse
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEAD = """# Verification

Each case is a folder of `tests/verification`; its README.md says where the expected value comes
from and why the tolerance is what it is. No expected value comes from this program. This page is
written by `tests/verification/make_table.py` from the results of the runs: do not edit it.

`error` is relative for kind `rel` (arrays: largest difference over largest expected value, the
worst entry shown) and absolute for kind `abs`; `min` and `max` are bounds on what was found.
"""


def number(value):
    return "" if value is None else f"{value:.6g}"


def cell(text):
    return text.replace("|", "\\|").replace("\n", " ")


def case_section(report):
    lines = [f"\n## {report['case']}\n",
             "| quantity | expected | found | error | tolerance | kind | verdict |",
             "|---|---|---|---|---|---|---|"]
    for check in report["checks"]:
        lines.append(f"| {cell(check['quantity'])} | {number(check['expected'])} | "
                     f"{number(check['found'])} | {check['error']:.2g} | "
                     f"{check['tolerance']:.2g} | {check['kind']} | "
                     f"{'pass' if check['passed'] else 'FAIL'} |")
    if report["reported"]:
        lines += ["\nReported, not judged:\n", "| quantity | found | note |", "|---|---|---|"]
        lines += [f"| {cell(entry['quantity'])} | {number(entry['found'])} | "
                  f"{cell(entry['note'])} |" for entry in report["reported"]]
    if report["problem"]:
        lines.append("\nThe case stopped before its end.")
    return lines


def coverage(reports):
    """Whether the cases were run in full."""
    few = [report["case"] for report in reports if not report.get("full")]
    if not few:
        return "All were run in full (`run_case.py --full`); CI takes covering designs."
    which = "All" if len(few) == len(reports) else ", ".join(few)
    return f"Run with covering designs, as in CI, not in full: {which}."


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", required=True, type=pathlib.Path)
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "doc" / "verification.md")
    options = parser.parse_args()
    reports = [json.loads(path.read_text()) for path in sorted(options.results.glob("*.json"))]
    if not reports:
        print(f"no results in {options.results}", file=sys.stderr)
        return 1
    checks = [check for report in reports for check in report["checks"]]
    lines = [HEAD, f"{len(reports)} cases, {len(checks)} checks, "
             f"{sum(check['passed'] for check in checks)} passed. {coverage(reports)}",
             "\n| case | checks | passed |", "|---|---|---|"]
    lines += [f"| {report['case']} | {len(report['checks'])} | "
              f"{sum(check['passed'] for check in report['checks'])} |" for report in reports]
    for report in reports:
        lines += case_section(report)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text("\n".join(lines) + "\n")
    print(f"{options.output}: {len(checks)} checks of {len(reports)} cases")
    return 0


if __name__ == "__main__":
    sys.exit(main())
