#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Small jobs: start to exit, and jobs a second. See small_jobs.sh.

usage: small_jobs.py --build FOLDER --out FOLDER [--jobs N] [--repeats N]
"""
import argparse
import os
import resource
import shutil
import statistics
import subprocess
import time
from pathlib import Path

import elements

ROOT = Path(__file__).resolve().parents[3]
CYCLES = 1000


def used():
    """Processor seconds of all processes that have ended."""
    times = resource.getrusage(resource.RUSAGE_CHILDREN)
    return times.ru_utime + times.ru_stime


def timed(command, **more):
    """Seconds, and seconds of a processor."""
    before, start = used(), time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **more)
    return time.perf_counter() - start, used() - before


def write_decks(folder):
    """Decks by name, and words of the command line."""
    folder.mkdir(parents=True, exist_ok=True)
    elements.write_deck(folder / "one.k", 1, False, 1)
    elements.write_deck(folder / "tiny.k", 300, True, CYCLES)
    text = (folder / "tiny.k").read_text(encoding="ascii")
    end = float(text.split("*CONTROL_TERMINATION\n", 1)[1].splitlines()[1])
    (folder / "states.k").write_text(text.replace("*END", f"*DATABASE_BINARY_D3PLOT\n{end / 10:10.3E}\n*END"), encoding="ascii")
    collision = ROOT / "input" / "collision" / "collision.k"
    return {"one element, one cycle": (folder / "one.k", []),
            "306 elements, 1,000 cycles": (folder / "tiny.k", []),
            "the same with 11 plot states": (folder / "states.k", []),
            "collision, 1,000 cycles": (collision, ["endtim=1.0e-4"])}


def time_each(program, decks, out, repeats):
    """A line for the program alone and for each deck: median from start to exit, and of the processor."""
    rows = {"--version": [str(program), "--version"]}
    rows |= {name: [str(program), f"i={deck}", f"d={out / 'each'}", *words] for name, (deck, words) in decks.items()}
    for name, command in rows.items():
        samples = [timed(command) for _ in range(repeats)]
        wall, busy = (1.0e3 * statistics.median(column) for column in zip(*samples))
        print(f"{name:32s} {wall:8.2f} ms   {busy:8.2f} ms of a processor", flush=True)


def time_folder(program, deck, out, jobs):
    """Jobs a second of a folder of copies, both ways."""
    shutil.rmtree(out / "folder", ignore_errors=True)
    (out / "folder").mkdir(parents=True)
    for include in deck.parent.glob("*.inc"):
        shutil.copy(include, out / "folder")
    for number in range(jobs):
        shutil.copy(deck, out / "folder" / f"job{number}.k")
    ways = {"run_folder.sh -j 2": ["sh", ROOT / "tools" / "batch" / "run_folder.sh", "-j", "2", "."],
            "xargs -P 2": ["sh", "-c", 'ls *.k | sed "s/[.]k$//" | xargs -P 2 -I@ "$SLIDELINE" i=@.k d=plain/@']}
    variables = {**os.environ, "SLIDELINE": str(program)}
    for name, command in ways.items():
        wall, busy = timed(command, cwd=out / "folder", env=variables)
        print(f"{name:32s} {jobs / wall:8.1f} jobs/s {1.0e3 * busy / jobs:8.2f} ms of a processor each, "
              f"share of two processors {busy / wall / 2.0:.2f}", flush=True)
    missing = sum(not (out / "folder" / "results" / f"job{i}" / f"job{i}.glstat.csv").exists() for i in range(jobs))
    if missing:
        raise SystemExit(f"{missing} jobs of the folder have no results")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, required=True, help="a Release build")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=1000)
    parser.add_argument("--repeats", type=int, default=50)
    options = parser.parse_args()
    out, program = options.out.resolve(), options.build.resolve() / "slideline"
    decks = write_decks(out / "decks")
    time_each(program, decks, out, options.repeats)
    time_folder(program, decks["306 elements, 1,000 cycles"][0], out, options.jobs)


if __name__ == "__main__":
    main()
