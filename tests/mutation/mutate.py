#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Break the sources of some layers on purpose and see whether the tests notice.

    mutate.py try --build DIR --out FILE.csv [--number N] [--seed S] [--jobs J] [LAYER...]
    mutate.py summary FILE.csv

`try` draws N mutants of the layers (default: contact and material), tries each, and appends one line to
the CSV file; those that are there already are not tried again, so that a stopped run goes on. Mutants
that are known to change nothing stand in equivalent.csv with the reason. See doc/reliability.md.
"""
from __future__ import annotations

import argparse
import csv
import json
import random
import threading
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from mutants import Mutant, make_mutants
from trial import ROOT, Build, Check, Trial, list_checks, measure, try_mutant

COLUMNS = ("file", "line", "rule", "before", "after", "verdict", "test", "key")
NOTICED = ("failed", "crash", "hang")
EQUIVALENT = Path(__file__).resolve().parent / "equivalent.csv"


def draw(layers: list[str], number: int, seed: int, every: list[str] | None = None) -> list[Mutant]:
    """`number` mutants of the layers, drawn evenly, after all of the layers `every`; 0: all."""
    mutants = [mutant for layer in layers for path in sorted((ROOT / "src" / layer).rglob("*.f90"))
               for mutant in make_mutants(path.relative_to(ROOT / "src").as_posix(), path.read_text(encoding="utf-8"))]
    random.Random(seed).shuffle(mutants)
    whole = [mutant for mutant in mutants if mutant.file.split("/")[0] in (every or [])]
    others = [mutant for mutant in mutants if mutant.file.split("/")[0] not in (every or [])]
    return whole + (others[:number] if number else others)


def read_rows(path: Path) -> list[dict[str, str]]:
    """The lines of a CSV file, the last one for each mutant; none if it is not there."""
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    return list({row.get("key", str(k)): row for k, row in enumerate(rows)}.values())


def baseline(trial: Trial, layer: str, units_only: bool) -> list[Check]:
    """The checks of a layer with their costs, which are measured once for a build."""
    path = trial.units.folder / "mutation_costs.json"
    costs = json.loads(path.read_text()) if path.exists() else {}
    checks = [check for check in list_checks(layer) if check.is_unit or not units_only]
    for check in measure(trial, [check for check in checks if check.name not in costs], layer):
        costs = (json.loads(path.read_text()) if path.exists() else {}) | {check.name: check.seconds}
        path.write_text(json.dumps(costs, indent=1))
    for check in checks:
        check.seconds = costs[check.name]
    return [check for check in checks if check.seconds >= 0.0]


def run(options: argparse.Namespace) -> None:
    """Draw and try."""
    units, program = Build(options.build), Build(options.program_build or options.build)
    scratch = units.folder / "mutation" / options.out.stem
    layers = options.layers or ["contact", "material"]
    checks = {layer: [check for check in baseline(Trial(units, program, scratch / "costs"), layer,
                                                  options.units_only)
                      if check.seconds <= options.longest] for layer in layers}
    done = {row["key"]: row for row in read_rows(options.out)}
    for row in [*done.values(), *(row for path in options.learn for row in read_rows(path))]:
        for check in checks.get(row["file"].split("/")[0], []):
            check.n_run += 1
            check.n_noticed += check.name == row["test"]
    drawn = draw(layers, options.number, options.seed, options.every)
    reasons = read_reasons()
    todo = [mutant for mutant in drawn if mutant.key not in done
            or (options.again and done[mutant.key]["verdict"] == "survived"
                and (mutant.file, mutant.before, mutant.after) not in reasons)]
    print(f"{len(drawn)} mutants, {len(todo)} to try", flush=True)
    lock, trials = threading.Lock(), [Trial(units, program, scratch / str(k))
                                      for k in range(options.jobs)]
    fresh = not options.out.exists()
    with open(options.out, "a", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        if fresh:
            writer.writerow(COLUMNS)

        def attempt(mutant: Mutant) -> None:
            own = [check for check in checks[mutant.file.split("/")[0]]
                   if check.is_unit or (mutant.file, mutant.before, mutant.after) not in reasons]
            with lock:
                trial = trials.pop()
            how, test = try_mutant(trial, own, mutant)
            with lock:
                trials.append(trial)
                writer.writerow([mutant.file, mutant.line, mutant.rule, mutant.before, mutant.after,
                                 how, test, mutant.key])
                stream.flush()
                print(f"{mutant.file}:{mutant.line} {how} {test}" + ("" if how != "survived" else
                      f"\n    {mutant.before}\n    {mutant.after}"), flush=True)

        with ThreadPoolExecutor(options.jobs) as pool:
            for future in [pool.submit(attempt, mutant) for mutant in todo]:
                future.result()
    summarise(read_rows(options.out))


def read_reasons() -> dict[tuple[str, str, str], str]:
    """Mutants, as (file, before, after), that change nothing a test could notice, and why."""
    return {(row["file"], row["before"], row["after"]): row["reason"] for row in read_rows(EQUIVALENT)}


def summarise(rows: list[dict[str, str]]) -> None:
    """Print the figures by layer and the survivors."""
    reasons = read_reasons()

    def known(row: dict[str, str]) -> str:
        return reasons.get((row["file"], row["before"], row["after"]), "")

    print("| layer | tried | compiled | noticed | by unit tests | survived | of these without effect | noticed of the rest |")
    print("|---|---|---|---|---|---|---|---|")
    for layer in (*sorted({row["file"].split("/")[0] for row in rows}), "all"):
        own = [row for row in rows if layer in ("all", row["file"].split("/")[0])]
        compiled = [row for row in own if row["verdict"] != "not compiled"]
        noticed = [row for row in compiled if row["verdict"] in NOTICED]
        left = [row for row in compiled if row["verdict"] == "survived"]
        n_known = sum(bool(known(row)) for row in left)
        rest = len(compiled) - n_known
        print(f"| {layer} | {len(own)} | {len(compiled)} | {len(noticed)} | "
              f"{sum(row['test'].startswith('unit.') for row in noticed)} | {len(left)} | {n_known} | "
              f"{100.0*len(noticed)/max(1, rest):.1f} % |")
    print("by kind of break:", dict(Counter(row["rule"] for row in rows if row["verdict"] == "survived")))
    print("by kind of test:", dict(Counter(row["test"].split(".")[0] for row in rows
                                           if row["verdict"] in NOTICED)))
    for row in rows:
        if row["verdict"] == "survived":
            print(f"{row['file']}:{row['line']} ({known(row) or 'NOT EXPLAINED'})\n    "
                  f"{row['before']}\n    {row['after']}")


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    trying = commands.add_parser("try")
    trying.add_argument("layers", nargs="*", metavar="LAYER")
    trying.add_argument("--build", type=Path, required=True, help="a finished Ninja build with tests")
    trying.add_argument("--program-build", type=Path, help="another one of the program (Release)")
    trying.add_argument("--out", type=Path, required=True, help="CSV file, appended to")
    trying.add_argument("--number", type=int, default=100, help="of mutants drawn; 0: all")
    trying.add_argument("--every", action="append", help="a layer of which all mutants are tried")
    trying.add_argument("--seed", type=int, default=1)
    trying.add_argument("--jobs", type=int, default=1)
    trying.add_argument("--again", action="store_true", help="try unexplained survivors once more")
    trying.add_argument("--learn", type=Path, action="append", default=[],
                        help="another table, to learn from which tests to begin with")
    trying.add_argument("--units-only", action="store_true", help="run no more than the unit tests")
    trying.add_argument("--longest", type=float, default=1e9, help="leave out tests above these seconds")
    summary = commands.add_parser("summary")
    summary.add_argument("table", type=Path)
    options = parser.parse_args()
    if options.command == "try":
        run(options)
    else:
        summarise(read_rows(options.table))


if __name__ == "__main__":
    main()
