#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""How much faster contact is with more threads. See contact_threads.sh.

usage: contact_threads.py --build FOLDER --out FOLDER [--threads N ...] [--nodes N] [--rounds N] [--cycles N] [--types N ...]
"""
import argparse
import csv
import os
import pathlib
import statistics
import subprocess

from ranks import FIRST_TOUCH, LEVEL
from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.scenes import collision
from slideline_tools.studies.scale import study

#: threads that wait asleep take 10 us to begin with a part of a step, those that spin 1 us
ENVIRONMENT = {**os.environ, **study.ENVIRONMENT, "OMP_WAIT_POLICY": "active"}


def interface_seconds(build, nodes, kind, threads):
    """Seconds of a step of a long interface alone: two chains, the slave sliding."""
    text = subprocess.run([build / "tests/lab/bench/bench_contact", str(nodes), str(kind), "0", "flat", str(threads)],
                          check=True, capture_output=True, text=True, env=ENVIRONMENT).stdout
    row, = csv.DictReader(text.splitlines())
    return 1.0e-9 * float(row["ns_step"])


def collision_seconds(build, folder, cycles, kind, threads):
    """Seconds of contact, and of all cycles, of a collision of 96,000 elements from before it touches."""
    (folder / "collision.k").write_text(collision(LEVEL, 5), encoding="ascii")
    end = (FIRST_TOUCH + cycles) * study.STEP / LEVEL
    subprocess.run([build / "slideline", "i=collision.k", f"p:endtim={end}", f"p:ctype={kind}", f"ncpu={threads}", "d=out",
                    "jobid=job"], cwd=folder, env=ENVIRONMENT, check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    with open(folder / "out" / "job.timing.csv", newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    phases = {row["phase"]: float(row["seconds"]) for row in rows}
    return (sum(seconds for name, seconds in phases.items() if name.startswith("contact")),
            sum(seconds for name, seconds in phases.items() if name not in ("input", "output", "total")))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--types", type=int, nargs="+", default=list(ALL_TYPES))
    parser.add_argument("--nodes", type=int, default=20000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--cycles", type=int, default=0, help="of the collision in contact; 0: none of it")
    given = parser.parse_args()
    build = given.build.resolve()
    given.out.mkdir(parents=True, exist_ok=True)
    print(f"{'case':<12} {'type':>4} {'threads':>7} {'contact, s':>12} {'faster':>7} {'all cycles, s':>14} {'faster':>7}")
    for kind in given.types:
        for case, measure in (("interface", lambda kind, n: (interface_seconds(build, given.nodes, kind, n),) * 2),
                              ("collision", lambda kind, n: collision_seconds(build, given.out, given.cycles, kind, n))):
            if case == "collision" and given.cycles == 0:
                continue
            found = {n: [] for n in given.threads}
            for _ in range(given.rounds):
                for n in given.threads:
                    found[n].append(measure(kind, n))
            middle = {n: [statistics.median(column) for column in zip(*rows, strict=True)] for n, rows in found.items()}
            first = middle[given.threads[0]]
            for n, (contact, cycles) in middle.items():
                print(f"{case:<12} {kind:>4} {n:>7} {contact:>12.6f} {first[0] / contact:>7.2f} {cycles:>14.6f} "
                      f"{first[1] / cycles:>7.2f}", flush=True)


if __name__ == "__main__":
    main()
