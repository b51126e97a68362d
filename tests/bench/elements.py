#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Cost of the explicit step against the element kernel and the memory's bandwidth.

usage: elements.py --program SLIDELINE --kernel BENCH_KERNEL --out FOLDER [--sizes 300 4000 ...]
       [--threads 1 2] [--repeats 3]

Square blocks of one-point quads, fixed on their left side, stretched by a linear velocity field, elastic or
yielding everywhere; no plot output. A step's time is that of the phases `elements` and `nodes`.
Every repeat runs all variants in turn and measures K (ns per element of the kernel on L1 data) and the
bandwidth beside each; elements.csv holds medians and ratios of the same minute.
"""
import argparse
import csv
import statistics
import subprocess
from pathlib import Path

import numpy as np

from slideline_tools.decks import Deck, WIDTH, field, spaced, Grid
from slideline_tools.scenes.common import part, perfectly_plastic, elastic, plane_strain

SIDE, RHO, YOUNG, POISSON = 1.0, 7850.0, 210.0e9, 0.3
STRAIN_RATE = 20.0  # 1/s, less where the run is so long that it would stretch the block by more than
LONGEST = 0.1
SOFT = 1.0e3        # yield stress of the yielding blocks, Pa: passed in the first steps
WORK = 4.0e8        # elements times steps of a run; fewer where 20 steps are more
BYTES = 320.0       # moved per element and step: state read and written, nodes, connectivity


def columns_of(elements):
    """Columns and rows of a block of about this many elements."""
    columns = max(1, round(elements ** 0.5))
    return columns, max(1, round(elements / columns))


def write_deck(path, elements, yields, steps=None):
    """A block as described above; returns the number of elements and of steps."""
    columns, rows = columns_of(elements)
    steps = steps or max(20, int(WORK / (columns * rows) / 10.0))
    height = SIDE * rows / columns
    grid = Grid(spaced((0.0, SIDE, columns)), spaced((0.0, height, rows)))
    step = 0.5 * SIDE / columns / 6000.0
    rate = min(STRAIN_RATE, LONGEST / (steps * step))
    deck = Deck("benchmark of the explicit step")
    deck.keyword("CONTROL_TERMINATION").card("endtim", steps * step)
    deck.constant_step(1, step, 1.0e3)
    deck.database(glstat=steps * step)
    deck.keyword("CONTROL_ENERGY").card("hgen rwen slnten rylen", 2, 2, 2, 2)
    part(deck, 1, "block", 1, 1)
    plane_strain(deck, 1)
    if yields:
        perfectly_plastic(deck, 1, RHO, YOUNG, POISSON, SOFT)
    else:
        elastic(deck, 1, RHO, YOUNG, POISSON)
    deck.node_set(1, "left side", grid.left)
    deck.spc_set(1, True, True)
    grid.write(deck, 1)
    deck.keyword("INITIAL_VELOCITY_NODE")
    points = grid.points.reshape(-1, 2)
    deck.lines.extend(f"{number:{WIDTH}d}{field(rate * x)}{field(-0.3 * rate * y)}"
                      for number, (x, y) in zip(grid.node.ravel(), points))
    path.write_text(deck.text(), encoding="ascii")
    return columns * rows, steps


def phase_seconds(path):
    """Seconds of the phases of a timing table."""
    with path.open(newline="", encoding="ascii") as table:
        return {row["phase"]: float(row["seconds"]) for row in csv.DictReader(table)}


def units(kernel, deck):
    """K in ns and the bandwidth in GB/s, now."""
    output = subprocess.run([kernel, deck], check=True, capture_output=True, text=True).stdout
    values = dict(line.split(",") for line in output.split())
    return float(values["kernel_ns"]), float(values["bandwidth_gb_s"])


def run_once(program, deck, folder, threads):
    """ns of one step and the timing table of one run."""
    subprocess.run([program, f"i={deck}", f"d={folder}", "jobid=bench", f"ncpu={threads}"],
                   check=True, capture_output=True)
    return phase_seconds(folder / "bench.timing.csv")


def measure(options):
    """Rows of the result: one per variant, medians over the repeats."""
    options.out.mkdir(parents=True, exist_ok=True)
    unit_deck = options.out / "unit.k"
    write_deck(unit_deck, 64, True)
    variants = []
    for size in options.sizes:
        for yields in (False, True):
            deck = options.out / f"block_{size}_{'yielding' if yields else 'elastic'}.k"
            elements, steps = write_deck(deck, size, yields)
            variants += [(elements, steps, yields, threads, deck) for threads in options.threads]
    found = {variant: [] for variant in variants}
    for repeat in range(options.repeats):
        print(f"round {repeat + 1} of {options.repeats}", flush=True)
        for variant in variants:
            elements, steps, _, threads, deck = variant
            kernel, bandwidth = units(options.kernel, unit_deck)
            seconds = run_once(options.program, deck, options.out, threads)
            step = 1.0e9 * (seconds["elements"] + seconds["nodes"]) / elements / (steps + 1)
            found[variant].append((step, kernel, bandwidth, seconds["input"]))
    return [summarise(variant, values) for variant, values in found.items()]


def summarise(variant, values):
    """One row: medians of times and of ratios of the same minute."""
    elements, steps, yields, threads, _ = variant
    return {
        "elements": elements, "steps": steps, "material": "yielding" if yields else "elastic",
        "threads": threads,
        "step_ns": statistics.median(v[0] for v in values),
        "kernel_ns": statistics.median(v[1] for v in values),
        "bandwidth_gb_s": statistics.median(v[2] for v in values),
        "step_over_kernel": statistics.median(v[0] / v[1] for v in values),
        "step_over_roofline": statistics.median(
            v[0] / (2.7 * v[1] + BYTES / v[2]) for v in values),
        "input_s": statistics.median(v[3] for v in values),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--kernel", required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--sizes", type=int, nargs="+", default=[300, 4000, 100000, 1000000])
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    rows = measure(options)
    with (options.out / "elements.csv").open("w", newline="", encoding="ascii") as table:
        writer = csv.DictWriter(table, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    for row in rows:
        print("{elements:>8} {material:>9} {threads} thread(s): {step_ns:7.2f} ns = "
              "{step_over_kernel:5.2f} K".format(**row))


if __name__ == "__main__":
    np.seterr(all="raise")
    main()
