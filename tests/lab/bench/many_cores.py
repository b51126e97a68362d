#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Threads, processes and jobs on many cores. See many_cores.sh.

usage: many_cores.py --build FOLDER --out FOLDER [--cores N ...] [--elements N] [--cycles N] [--jobs N]
"""
import argparse
import os
import pathlib
import subprocess
import time

import elements
import ranks
from slideline_tools.scenes import collision
from slideline_tools.studies.scale import study

TYPES = (1, 5, 7)


def scenes(folder, n_element, cycles):
    """{scene: words of the command line}."""
    elements.write_deck(folder / "block.k", n_element, True, cycles)
    (folder / "collision.k").write_text(collision(ranks.LEVEL, 5), encoding="ascii")
    end = (ranks.FIRST_TOUCH + cycles) * study.STEP / ranks.LEVEL
    return {f"{n_element} yielding quads": ["i=block.k"],
            **{f"collision, type {ctype}": ["i=collision.k", f"ctype={ctype}", f"p:endtim={end}"] for ctype in TYPES}}


def seconds(build, folder, way, n, words):
    """Of the cycles of a run on n threads or processes."""
    start = [build / "release/slideline"] if way == "threads" else ["mpirun", "-n", str(n), build / "mpi/slideline"]
    subprocess.run([*start, *words, f"ncpu={n if way == 'threads' else 1}", "d=out", "jobid=job"], cwd=folder, check=True,
                   env=ranks.ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return ranks.stepping(folder / "out")


def jobs_a_second(build, folder, n, jobs):
    """Small decks that end in a second, n at once."""
    elements.write_deck(folder / "tiny.k", 300, True, 1000)
    numbers = "\n".join(map(str, range(jobs)))
    start = time.perf_counter()
    subprocess.run(["xargs", f"-P{n}", "-I@", build / "release/slideline", "i=tiny.k", "d=jobs/@"], cwd=folder, input=numbers,
                   text=True, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return jobs / (time.perf_counter() - start)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=lambda path: pathlib.Path(path).resolve(), required=True)
    parser.add_argument("--out", type=lambda path: pathlib.Path(path).resolve(), required=True)
    parser.add_argument("--cores", type=int, nargs="+", default=[1, 2, 4, 8, 16])
    parser.add_argument("--elements", type=int, default=100000)
    parser.add_argument("--cycles", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=1000)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    print(f"{os.cpu_count()} logical cores; times faster than one, and small decks a second")
    print(f"{'':<40}" + "".join(f"{n:>8}" for n in given.cores))
    for scene, words in scenes(given.out, given.elements, given.cycles).items():
        for way in ranks.WAYS:
            spent = [seconds(given.build, given.out, way, n, words) for n in given.cores]
            print(f"{f'{scene}, {way}':<40}" + "".join(f"{spent[0] / one:>8.2f}" for one in spent), flush=True)
    rates = [jobs_a_second(given.build, given.out, n, given.jobs) for n in given.cores]
    print(f"{'small decks a second':<40}" + "".join(f"{rate:>8.0f}" for rate in rates))


if __name__ == "__main__":
    main()
