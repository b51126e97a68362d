#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run one regression case: `run_case.py CASE --program EXE --work DIR`.

CASE is a folder beside this file (see regression.py for its case.toml); the run goes to
DIR/CASE, so that cases may share DIR and run at the same time. The exit status is 0 only if
the run ended normally and every column agrees with its reference. `--bless REASON` makes the
histories of the run the reference instead (20 rows a table) and keeps the reason.
"""
import argparse
import pathlib
import sys

from regression import Case, CaseError, renew, run_case

HERE = pathlib.Path(__file__).resolve().parent


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case")
    parser.add_argument("--program", default=HERE.parents[1] / "build/release/slideline")
    parser.add_argument("--work", default=HERE.parents[1] / "build/regression")
    parser.add_argument("--bless", metavar="REASON", help="why the reference changes")
    options = parser.parse_args()
    work = pathlib.Path(options.work) / options.case
    try:
        case = Case(HERE / options.case, HERE.parents[1])
        if options.bless is None:
            return run_case(case, options.program, work, sys.stdout)
        renew(case, options.program, work, options.bless)
    except CaseError as problem:
        print(problem)
        return 2
    print(f"renewed the reference of {options.case}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
