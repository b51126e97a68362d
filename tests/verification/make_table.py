#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write doc/verification.md and a page for each case in doc/verification/ from the results of the runs.

`make_table.py --results DIR [--output doc/verification.md]`, where DIR holds
the <case>.json files left by run_case.py (`SLIDELINE_FULL=1 ctest -L verification`
for the pages: the front page says which cases were run with a covering design instead).
"""
import argparse
import json
import pathlib
import re
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from slideline_tools.prose import CELL  # noqa: E402

HEAD = """# Verification

No expected value comes from this program: closed forms, conservation laws, symmetry, differences, other programs and
published figures. Each case is a folder of `tests/verification`; its README.md says where the expected values come
from and why the tolerances are what they are. Behind each name below are all checks of the case, with their number.
These pages are written by `tests/verification/make_table.py` from the results of the runs: do not edit them.
"""
CASE_HEAD = """`error` is relative for kind `rel` (arrays: largest difference over largest expected value, the
worst entry shown) and absolute for kind `abs`; `min` and `max` are bounds on what was found.
"""
#: subject -> the cases that belong to it; a case goes to the first that fits
SUBJECTS = {
    "Friction": "friction|cattaneo|ironing|sliding_flutter|wall_friction",
    "Ties, self contact, interference": "tie|self_contact|interference|press_fit|closed_chains",
    "Bodies of revolution": "round|punch|hertz_spheres|taylor_bar|ring$",
    "Materials of impact, erosion": "impact_laws|rubber|erosion|penetration|expanding|plate_impact|taylor_johnson",
    "Quasi-static help": "dynamic_relaxation|mass_scaling|part_damping|constraints",
    "Implicit": "implicit|contact_patch_static",
    "Rigid bodies, walls, loads": "rigid|gravity|spin",
    "Elements and waves": "element|assumed|hourglass|integration|bar_wave|free_flight|symmetric_plate|stable_step|energy_balance"
                          "|histories|cross_sections|resting_tiles",
    "Contact": ".",
}


def number(value):
    return "" if value is None else f"{value:.6g}"


def cell(text):
    return text.replace("|", "\\|").replace("\n", " ")


def named(rows):
    """Lines of a table from rows of a name and what follows it. A name too long for a cell has what stands before its last
    colon in a row of its own, once where it is that of several rows."""
    lines, scene = [], ""
    for name, rest in rows:
        if len(name) > CELL and ": " in name:
            head, name = name.rsplit(": ", 1)
            if head != scene:
                lines.append(f"| {head}: |{' |' * (rest.count(' | ') + 1)}")
            name, scene = f"... {name}", head
        else:
            scene = ""
        lines.append(f"| {name} | {rest} |")
    return lines


def case_page(report):
    """All checks of a case."""
    lines = [f"# {report['case']}\n",
             f"[What the case is](../../tests/verification/{report['case']}/README.md).\n{CASE_HEAD}",
             "| quantity | expected | found | error | tolerance | kind | verdict |",
             "|---|---|---|---|---|---|---|"]
    lines += named((cell(check["quantity"]),
                    f"{number(check['expected'])} | {number(check['found'])} | {check['error']:.2g} | "
                    f"{check['tolerance']:.2g} | {check['kind']} | {'pass' if check['passed'] else 'FAIL'}")
                   for check in report["checks"])
    if report["reported"]:
        lines += ["\nReported, not judged:\n", "| quantity | found | note |", "|---|---|---|"]
        lines += named((cell(entry["quantity"]), f"{number(entry['found'])} | {cell(entry['note'])}")
                       for entry in report["reported"])
    if report["problem"]:
        lines.append("\nThe case stopped before its end.")
    return lines


def coverage(reports):
    """Whether the cases were run in full."""
    few = [report["case"] for report in reports if not report.get("full")]
    if not few:
        return "All were run in full (`run_case.py --full`); CI takes covering designs."
    which = "All" if len(few) == len(reports) else ", ".join(few)
    return f"{which} were run with covering designs, as in CI, not in full."


def by_subject(reports):
    """Subject -> reports, in the order of SUBJECTS."""
    groups = {subject: [] for subject in SUBJECTS}
    for report in reports:
        subject = next(name for name, pattern in SUBJECTS.items() if re.search(pattern, report["case"]))
        groups[subject].append(report)
    return {subject: members for subject, members in groups.items() if members}


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
             f"{sum(check['passed'] for check in checks)} passed. {coverage(reports)}"]
    for subject, members in by_subject(reports).items():
        found = [check["passed"] for report in members for check in report["checks"]]
        lines.append(f"\n**{subject}** ({sum(found)} of {len(found)} checks passed):")
        cases = ", ".join(f"[{report['case']}](verification/{report['case']}.md) {len(report['checks'])}"
                          for report in members)
        lines.append(textwrap.fill(cases + ".", 120, break_long_words=False, break_on_hyphens=False))
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text("\n".join(lines) + "\n")
    folder = options.output.with_suffix("")
    folder.mkdir(exist_ok=True)
    for path in folder.glob("*.md"):
        path.unlink()
    for report in reports:
        (folder / f"{report['case']}.md").write_text("\n".join(case_page(report)) + "\n")
    print(f"{options.output}: {len(checks)} checks of {len(reports)} cases")
    return 0


if __name__ == "__main__":
    sys.exit(main())
