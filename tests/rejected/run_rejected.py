#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run every refused deck of this folder and check that it is refused for the reason it gives.

A deck NAME.k holds one or more comment lines `$ expect: TEXT`.  The program must end with status 1,
say each TEXT on standard error, and leave no results file.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

EXPECT = re.compile(r"^\$ expect: *(.*?)\s*$", re.MULTILINE)
#: what a checked build says of itself; some sanitisers end with status 1 too
CRASH = re.compile(r"Sanitizer|runtime error|received signal|Backtrace for this error", re.IGNORECASE)
TIME_LIMIT = 60


def check(program, deck):
    """What is wrong with the way `deck` is refused; empty when nothing is."""
    expected = EXPECT.findall(deck.read_text(encoding="latin-1"))
    if not expected or not all(expected):
        return ["the deck has no line '$ expect: TEXT'"]
    with tempfile.TemporaryDirectory() as folder:
        command = [program, f"i={deck.resolve()}", f"d={folder}"]
        try:
            run = subprocess.run(command, cwd=folder, capture_output=True, timeout=TIME_LIMIT,
                                 stdin=subprocess.DEVNULL, check=False)
        except subprocess.TimeoutExpired:
            return [f"still running after {TIME_LIMIT} s"]
        said = run.stderr.decode("utf-8", errors="replace")
        trouble = []
        if run.returncode != 1:
            trouble.append(f"exit status {run.returncode}, expected 1")
        trouble += [f"not said: {text}" for text in expected if text not in said]
        if CRASH.search(said):
            trouble.append("the program crashed")
        left = [path.name for path in Path(folder).rglob("*.vtkhdf")]
        if left:
            trouble.append("left behind: " + ", ".join(left))
    if trouble:
        trouble.append("standard error was:\n" + (said.rstrip() or "(empty)"))
    return trouble


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True, help="the program")
    parser.add_argument("decks", nargs="*", type=Path, help="decks; all of this folder if none")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    decks = options.decks or sorted(Path(__file__).resolve().parent.glob("*.k"))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda deck: check(program, deck), decks))
    failed = 0
    for deck, trouble in zip(decks, results):
        if trouble:
            failed += 1
            print(f"FAILED {deck.name}")
            for line in "\n".join(trouble).splitlines():
                print(f"  {line}")
    print(f"{len(decks) - failed} passed, {failed} failed")
    return 1 if failed or not decks else 0


if __name__ == "__main__":
    sys.exit(main())
