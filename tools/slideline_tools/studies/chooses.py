# SPDX-License-Identifier: MIT
"""CTYPE 0 beside the contact types by name: what it costs in retired instructions, and how large its error is.

    python -m slideline_tools.studies.chooses FOLDER DOC PROGRAM [COUNTED]

Runs each scene of speed-accuracy on its coarsest mesh with every type and with CTYPE 0 (without and with targets) into
FOLDER: whole, by PROGRAM, and cut short and counted, by COUNTED (default: the program that `counting` names). The page
goes to DOC/studies/chooses.md. Errors are those published for the type that CTYPE 0 took, whose files it has to make
byte for byte; where it changed its type on the way, the page says so.
"""
from __future__ import annotations

import concurrent.futures
import dataclasses
import pathlib
import re
import subprocess
import sys

from slideline_tools import UserError, counting
from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.studies.speed_accuracy.scenes import SCENES, node_penalty
from slideline_tools.studies.common import label, markdown_table, write_page

ROOT = pathlib.Path(__file__).resolve().parents[3]
CUT = {"patch": "endtim=0.4", "block": "endtim=0.05", "hertz": "endtim=5.0e-6", "sliding": "endtim=2.0e-4", "collision": "endtim=1.0e-4"}
TARGETS = ("", "0.6", "0.01")
WORKERS = 4  # counts do not mind what runs beside them
SAME_ERROR, NEAR = 1.05, 1.10  # errors that count as equal; how near the front is near
FILES = ("rcforc", "matsum", "contact")


@dataclasses.dataclass
class Run:
    """One variant of a scene: a type by name, or what CTYPE 0 made of it."""

    scene: str
    ctype: int
    target: str = ""
    chosen: int = 0
    same: bool = True          # the files are those of the type by name
    instructions: int = 0
    judged: str = ""           # what the run says of its target

    @property
    def words(self):
        return label(self.ctype) if self.ctype else "CTYPE 0" + f", target {self.target}" * bool(self.target)


def options(scene, ctype, target):
    """Words of the command line: the penalty is that of the study, for CTYPE 0 that of the types with one pass."""
    one = SCENES[scene]
    return [f"ctype={ctype}", f"p:pen={node_penalty(one, 1, ctype):.17g}", *one.options(1), *[f"target={target}"] * bool(target)]


def execute(program, folder, scene, words):
    folder.mkdir(parents=True, exist_ok=True)
    command = [program, f"i={folder.parent / scene}.k", f"d={folder}", "jobid=run", *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise UserError(f"{' '.join(map(str, command))}: {done.stderr[-500:]}")
    return (folder / "run.log").read_text(encoding="utf-8")


def name_of(run):
    return f"{run.scene}_{run.ctype}{run.target}"


def run_whole(run, folder, program):
    """The whole run; what CTYPE 0 says in its log."""
    log = execute(program, folder / name_of(run), run.scene, options(run.scene, run.ctype, run.target))
    if run.ctype == 0:
        run.chosen = int(re.search(r"\(type (\d)\), chosen by the program", log)[1])
        run.judged = re.search(r"interface \d+: the target \S+ % is (.*)", log)[1]


def compare(run, folder):
    """Whether the files of a run of CTYPE 0 are those of the type that it took."""
    files = [folder / name_of(run) / f"run.{kind}.csv" for kind in FILES]
    run.same = all(path.read_bytes() == (folder / f"{run.scene}_{run.chosen}" / path.name).read_bytes()
                   for path in files if path.exists())


def count(run, folder, counted):
    """The same, cut short and counted."""
    name = f"{name_of(run)}_counted"
    (folder / name).mkdir(exist_ok=True)
    words = [f"i={folder / run.scene}.k", f"d={folder / name}", "jobid=run", *options(run.scene, run.ctype, run.target), CUT[run.scene]]
    run.instructions = counting.count_instructions([counted, *words], folder / name).total


def published(scene, doc):
    """{type: errors in per cent on the coarsest mesh}, with their titles, from the page speed_accuracy beside this one.

    What stands in brackets there is below what the reference itself is known to, and counts as that.
    """
    page = (doc / "studies/speed_accuracy.md").read_text(encoding="utf-8")
    section = page.split(f"\n## {SCENES[scene].title}\n")[1].split("\n## ")[0]
    # A long list of errors goes over more than one line.
    titles = " ".join(re.search(r"errors in per cent \(([^|]*)\):", section)[1].split()).split("; ")
    errors = {}
    for line in section.splitlines():
        if found := re.match(r"\| ([1-7]) [^|]*\|[^;]*; (.*?) % \|", line):
            errors[int(found[1])] = [known_error(page, f"{SCENES[scene].title}: {title}", text.strip())
                                     for title, text in zip(titles, found[2].split(","), strict=True)]
    if sorted(errors) != list(ALL_TYPES):
        raise UserError(f"speed_accuracy.md: the table of {scene} is not as this study reads it")
    return titles, errors


def known_error(page, title, text):
    """The figure of a cell, or that of its reference: type 7 on a finer mesh."""
    if text.startswith("("):
        return float(re.search(rf"^\| {re.escape(title)} \| 7 \|[^|]*\|[^|]*\| ([\d.]+) % \|", page, re.MULTILINE)[1])
    return float(text.replace("< ", ""))


def behind_front(cost, error, costs, errors):
    """How many times what the cheapest type costs that has none of these errors larger; 1 or less: on the front."""
    return cost / min(costs[ctype] for ctype in costs
                      if all(other <= SAME_ERROR * own for other, own in zip(errors[ctype], error, strict=True)))


def table(runs, doc):
    """Rows of the variants of a scene, and how far each CTYPE 0 is behind the front."""
    scene = runs[0].scene
    titles, errors = published(scene, doc)
    costs = {run.ctype: run.instructions for run in runs if run.ctype}
    rows, worst = [], []
    for run in runs:
        ctype = run.ctype or run.chosen
        alone = [behind_front(run.instructions, [errors[ctype][k]], costs, {other: [errors[other][k]] for other in errors})
                 for k in range(len(titles))]
        whole = behind_front(run.instructions, errors[ctype], costs, errors)
        if run.ctype == 0:
            worst.append((run, whole, [(title, factor) for title, factor in zip(titles, alone) if factor > NEAR]))
        rows.append([run.words, "" if run.ctype else label(run.chosen), f"{1e-6 * run.instructions:.1f}",
                     ", ".join(f"{error:g}" for error in errors[ctype]), f"{whole:.3f}",
                     ", ".join(f"{factor:.3f}" for factor in alone),
                     "" if run.ctype else f"{run.instructions / costs[run.chosen] - 1.0:+.2%}"])
    names = ["variant", "took", "instructions, millions", "errors, %", "over the front", "for each error alone", "over its type"]
    return f"Errors: {'; '.join(titles)}.\n\n" + markdown_table(names, rows), worst


def page_text(scenes, doc):
    parts, worst = [], []
    for runs in scenes:
        text, found = table(runs, doc)
        parts.append(f"## {SCENES[runs[0].scene].title}\n\n{text}")
        told = [f"- {run.words}: took type {run.chosen}, "
                f"files {'those' if run.same else 'not those'} of the type by name; the target is {run.judged}."
                for run in runs if not run.ctype]
        parts.append("\n".join(told))
        worst += found
    plain = [(run, factor, alone) for run, factor, alone in worst if not run.target]
    near = [run for run, factor, _ in plain if factor <= NEAR]
    far = [f"{SCENES[run.scene].title} ({factor:.2f})" for run, factor, _ in plain if factor > NEAR]
    single = [f"{SCENES[run.scene].title}, {title}: {factor:.2f}" for run, _, alone in plain for title, factor in alone]
    most = max(run.instructions / next(other.instructions for other in runs if other.ctype == run.chosen)
               for runs in scenes for run in runs if not run.ctype) - 1.0
    head = [f"Without a target it is on the front of cost and errors, or within {NEAR - 1.0:.0%} of it, in {len(near)} of "
            f"{len(plain)} scenes" + (f"; not in {', '.join(far)}." if far else "."),
            "Who asks for one of the errors alone finds a cheaper type by more than that for: " + ("; ".join(single) or "none") + ".",
            f"To choose and to watch costs at most {most:.2%} of a run."]
    return PAGE.format(claims="\n".join(f"- {line}" for line in head), scenes="\n\n".join(parts),
                       cut=", ".join(f"{SCENES[scene].title} ({word})" for scene, word in CUT.items()), by=counting.method())


PAGE = """# What leaving the type to the program costs

This page is written by `tools/batch/chooses.sh`: do not edit it.

CTYPE 0 chooses the contact type ([keywords](../keywords.md#contact_2d_slideline-title)). Here it stands beside the types by
name, in the scenes of [speed against accuracy](speed_accuracy.md) on their coarsest meshes, with the penalty of that study.

{claims}

Cost: retired instructions of the whole run with its start and end, counted by {by}, of runs cut short: {cut}. Errors are
those published for the type ({same}). *Over the front*: instructions over those of the cheapest type by name that has
none of the errors larger (by 5 %); then the same for each error alone, where every dearer type is behind if it does not
lower that one.

{scenes}
""".replace("{same}", "CTYPE 0 has them where its files are those of the type, byte for byte")


def main(arguments):
    folder, doc, program, *rest = map(pathlib.Path, arguments)
    counted = rest[0] if rest else counting.counted_program(ROOT)
    folder.mkdir(parents=True, exist_ok=True)
    folder = folder.resolve()
    scenes = [[Run(scene, ctype) for ctype in ALL_TYPES] + [Run(scene, 0, target) for target in TARGETS] for scene in SCENES]
    for scene in SCENES:
        (folder / f"{scene}.k").write_text(SCENES[scene].deck(1), encoding="ascii")
    runs = [run for same in scenes for run in same]
    with concurrent.futures.ThreadPoolExecutor(WORKERS) as workers:
        list(workers.map(lambda run: run_whole(run, folder, program.resolve()), runs))
        list(workers.map(lambda run: count(run, folder, pathlib.Path(counted).resolve()), runs))
    for run in runs:
        if run.ctype == 0:
            compare(run, folder)
    write_page(doc, "chooses", page_text(scenes, doc))
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except UserError as problem:
        sys.exit(str(problem))
