#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Two processes against two threads, and what a process keeps in memory. See ranks.sh.

usage: ranks.py --program SLIDELINE --out FOLDER [--rounds N] [--cycles N] [--memory N]
"""
import argparse
import csv
import os
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import time

import elements
from slideline_tools.scenes import collision, collision_grids
from slideline_tools.studies.scale import study
from slideline_tools.studies.scale.tiles import grid_mesh

LEVEL, BLOCK = 20, 100000  # of the collision, 96,000 elements, and elements of the block
FIRST_TOUCH = 1250         # cycles until the bodies touch
LARGE = 1000               # side of the square for memory
WAYS = ("threads", "processes")
ENVIRONMENT = {**os.environ, **study.ENVIRONMENT}


def write_decks(folder, cycles):
    """{scene: (words of the command line, elements)}."""
    (folder / "collision.k").write_text(collision(LEVEL, 5), encoding="ascii")
    end = (FIRST_TOUCH + cycles) * study.STEP / LEVEL
    return {"collision": (["i=collision.k", f"p:endtim={end}"], sum(grid.element.size for grid in collision_grids(LEVEL))),
            "block": (["i=block.k"], elements.write_deck(folder / "block.k", BLOCK, False, cycles))}


def command(program, way, words):
    """The run on two threads, or on two processes of one."""
    if way == "threads":
        return [program, *words, "ncpu=2"]
    return ["mpirun", "-n", "2", program, *words, "ncpu=1"]


def stepping(folder):
    """Seconds on the wall in cycles: all phases but those of input and output."""
    with open(folder / "job.timing.csv", newline="", encoding="utf-8") as stream:
        rows = [row for row in csv.reader(line for line in stream if not line.startswith("#"))]
    names = rows[0]
    return sum(float(row[names.index("seconds")]) for row in rows[1:] if row[0] not in ("input", "output", "total"))


def timed(folder, words):
    """Seconds in cycles, of a processor, and the share of two processors over the whole run."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([*words, "d=out", "jobid=job"], cwd=folder, env=ENVIRONMENT, check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return stepping(folder / "out"), used, used / wall / 2.0


def compare(program, folder, rounds, cycles):
    """Print a row for each scene and way, and the ratio of the two."""
    print(f"{'scene':<10} {'elements':>8} {'way':<10} {'cycles, s':>10} {'processor, s':>12} {'share of two':>12}")
    for scene, (words, n_element) in write_decks(folder, cycles).items():
        found = {way: [] for way in WAYS}
        for _ in range(rounds):
            for way in WAYS:
                found[way].append(timed(folder, command(program, way, words)))
        middle = {way: [statistics.median(column) for column in zip(*rows, strict=True)] for way, rows in found.items()}
        for way, (wall, used, share) in middle.items():
            print(f"{scene:<10} {n_element:>8} {way:<10} {wall:>10.3f} {used:>12.3f} {share:>12.2f}")
        ratios = [middle["processes"][k] / middle["threads"][k] for k in range(2)]
        print(f"{scene:<10} processes over threads: cycles {ratios[0]:.3f} (goal 1.10), processor {ratios[1]:.3f}", flush=True)


def follow(launcher):
    """{number of a process: [(largest, present) resident kB, ...]} of those of a launcher, looked at while they run."""
    found = {}
    while launcher.poll() is None:
        reported = subprocess.run(["pgrep", "-P", str(launcher.pid)], capture_output=True, text=True, check=False).stdout
        for child in reported.split():
            try:
                rank = re.search(rb"OMPI_COMM_WORLD_RANK=(\d+)", pathlib.Path(f"/proc/{child}/environ").read_bytes())
                status = pathlib.Path(f"/proc/{child}/status").read_text(encoding="ascii")
            except OSError:
                continue
            sizes = [int(size) for name in ("HWM", "RSS") for size in re.findall(rf"Vm{name}:\s+(\d+)", status)]
            if rank and len(sizes) == 2:
                found.setdefault(int(rank[1]), []).append(sizes)
        time.sleep(0.05)
    return found


def turning(side):
    """A square that turns, so that no tile rests."""
    text = study.body(*grid_mesh(side, side, 1.0, 1.0), "square")
    return text.rsplit("*END", 1)[0] + "*INITIAL_VELOCITY_GENERATION\n1,2,1.0\n0.0,0.0\n*END\n"


def memory(program, folder, side, cycles):
    """Print the memory of four processes for a square, per element, less that of a square of four elements."""
    sizes = {}
    for name, n in (("small", 2), ("square", side)):
        (folder / f"{name}.k").write_text(turning(n), encoding="ascii")
        words = ["mpirun", "--oversubscribe", "-n", "4", program, f"i={name}.k", f"p:cycles={cycles}", "d=out", "jobid=job"]
        with subprocess.Popen(words, cwd=folder, env=ENVIRONMENT, stdout=subprocess.DEVNULL) as launcher:
            found = follow(launcher)
        # The last quarter of the time is cycles, most of it.
        sizes[name] = {rank: (seen[-1][0], statistics.median(present for _, present in seen[-len(seen) // 4:]))
                       for rank, seen in found.items()}
    for rank, seen in sorted(sizes["square"].items()):
        most, late = ((large - small) * 1024 / side**2 for large, small in zip(seen, sizes["small"][rank], strict=True))
        print(f"process {rank + 1} of 4, {side**2} elements: {most:.0f} bytes an element at the peak, {late:.0f} in the cycles")


def main():
    """Returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=lambda path: str(pathlib.Path(path).resolve()), required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--cycles", type=int, default=1000)
    parser.add_argument("--memory", type=int, default=LARGE, metavar="SIDE", help="elements along the square's side, 0: none")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    if given.rounds:
        compare(given.program, given.out, given.rounds, given.cycles)
    if given.memory:
        memory(given.program, given.out, given.memory, given.cycles)
    return 0


if __name__ == "__main__":
    sys.exit(main())
