#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write the rows of doc/verification.md from case.toml of each case and from the results of the runs.

`make_table.py --results DIR`, where DIR holds the <case>.json files left by run_case.py
(`ctest -L verification`; SLIDELINE_FULL=1 runs every combination). A case without results keeps its figures, the last
three cells. All checks of a case stand below its README on the site (tools/docs/site_source.py).
"""
import argparse
import json
import pathlib
import re
import sys

try:
    import tomllib
except ModuleNotFoundError:  # Python before 3.11
    import tomli as tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
ROW = re.compile(r"^\| \[(\w+)\]\(.*\| ([^|]* \| [^|]* \| [^|]*) \|$", re.M)
SECTION = re.compile(r"^## (.+)\n\n(\| case .*\n\|---.*\n)((?:\| \[.*\n)*)", re.M)
COUNT = re.compile(r"^\d+ cases with \d+ checks.*$", re.M)
LEGEND = """
## All checks

`error` is relative for kind `rel` (arrays: largest difference over largest expected value, the worst entry shown) and
absolute for kind `abs`; `min` and `max` are bounds on what was found.

| quantity | source | expected | found | error | tolerance | kind | verdict |
|---|---|---|---|---|---|---|---|
"""


def read_reports(folder):
    """{case: report} of the <case>.json files in a folder."""
    reports = (json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.json")))
    return {report["case"]: report for report in reports}


def read_cases():
    """{case: content of its case.toml}."""
    return {path.parent.name: tomllib.loads(path.read_text(encoding="utf-8")) for path in sorted(HERE.glob("*/case.toml"))}


def number(value):
    return "" if value is None else f"{value:.6g}"


def all_checks(report):
    """Section with all checks of a case, and what it reports without judging it."""
    def cell(text):
        return text.replace("|", "\\|").replace("\n", " ")

    lines = [f"| {cell(check['quantity'])} | {cell(check['source'])} | {number(check['expected'])} | {number(check['found'])} | "
             f"{check['error']:.2g} | {check['tolerance']:.2g} | {check['kind']} | {'pass' if check['passed'] else 'FAIL'} |"
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


def with_rows(page, cases, reports):
    """The page with a row for each case in the section of its topic, figures from `reports` or as they were."""
    stand = {row[1]: row[2] for row in ROW.finditer(page)}
    stand |= {case: figures(report) for case, report in reports.items()}

    def section(found):
        rows = "".join(f"| [{name}](../tests/verification/{name}/README.md) | {case['title']} | {case['against']} | "
                       f"{stand.get(name, '- | - | -')} |\n" for name, case in cases.items() if case["topic"] == found[1])
        return f"## {found[1]}\n\n{found[2]}{rows}"

    if reports:
        checks = [check["passed"] for report in reports.values() for check in report["checks"]]
        how = "in full" if all(report["full"] for report in reports.values()) else "with covering designs, as in CI"
        page = COUNT.sub(f"{len(reports)} cases with {len(checks)} checks, {sum(checks)} passed, run {how}.", page)
    return SECTION.sub(section, page)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", type=pathlib.Path, help="without them the figures stay")
    parser.add_argument("--page", type=pathlib.Path, default=ROOT / "doc" / "verification.md")
    options = parser.parse_args()
    reports, cases = read_reports(options.results) if options.results else {}, read_cases()
    page = with_rows(options.page.read_text(encoding="utf-8"), cases, reports)
    missing = (set(cases) | set(reports)) - {row[1] for row in ROW.finditer(page)}
    if missing or options.results and not reports:
        print(f"{options.page}: no row for {', '.join(sorted(missing))}: topic of its case.toml" if missing
              else f"no results in {options.results}", file=sys.stderr)
        return 1
    options.page.write_text(page, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
