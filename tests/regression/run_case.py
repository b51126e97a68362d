#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run one regression case: `run_case.py CASE --program EXE --work DIR`.

CASE is a folder beside this file (see slideline_tools.regression for its case.toml); the run
goes to DIR/CASE, so that cases may share DIR and run at the same time. The exit status is 0 only
if the run ended normally and every column agrees with its reference.
"""
import argparse
import pathlib
import sys

from slideline_tools.regression import Case, CaseError, run_case

HERE = pathlib.Path(__file__).resolve().parent


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case")
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True)
    options = parser.parse_args()
    try:
        case = Case(HERE / options.case, HERE.parents[1])
    except CaseError as problem:
        print(problem)
        return 2
    work = pathlib.Path(options.work) / options.case
    return run_case(case, options.program, work, sys.stdout)


if __name__ == "__main__":
    sys.exit(main())
