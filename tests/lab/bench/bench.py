#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""All benchmarks: interleaved rounds, one table with ratios to the yardstick and the bandwidth.

usage: bench.py --build FOLDER --out FOLDER [--quick] [--rounds N] [--threads N] [--sizes ...] [--parts ...]

Each round measures everything in turn, K and the bandwidth before each size. After each round the table bench.csv
(medians and quartiles of the least disturbed half) is written anew from samples.csv, which holds every sample: stopped and
started again, with the same program, it goes on collecting.
"""
import argparse
import contextlib
import json
import os
import subprocess
from pathlib import Path

from contact import time_contact
import counts
import elements
import input_output
from measuring import Disturbed, Samples, Units, Variant, measure_units, write_summary
import search

SIZES = (100, 300, 1000, 4000, 20000, 100000, 400000, 1000000, 4000000)
CHAINS = (10, 20, 100, 1000, 10000, 100000)
SEARCHES = (1000, 4000, 16000, 64000)
LARGE = 1000000
COUNTED = (300, 4000)


def build_parser():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, required=True, help="a Release build with -DSLIDELINE_BENCH=ON")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--quick", action="store_true", help="smallest sizes, one round: does it run?")
    parser.add_argument("--rounds", type=int, default=5, help="0: the table of what is there")
    parser.add_argument("--threads", type=int, default=min(2, os.cpu_count()))
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="elements")
    parser.add_argument("--counted", type=Path, help="the counted build with bench_kernel: instructions too")
    parser.add_argument("--parts", nargs="+", default=["step", "contact", "search", "files"],
                        choices=["step", "contact", "search", "files"])
    return parser


def plan(options):
    """What is to be measured: decks by part."""
    sizes, chains, searches, large = options.sizes, CHAINS, SEARCHES, LARGE
    cases = search.CASES
    if options.quick:
        sizes, chains, searches, large = (100, 300), (10, 20), (500,), 4000
        elements.WORK = 1.0e5
    decks = options.out / "decks"
    decks.mkdir(parents=True, exist_ok=True)
    elements.write_deck(decks / "unit.k", 64, True)
    return {"step": elements.write_decks(decks, sizes), "contact": chains,
            "search": search.write_decks(decks, searches, cases),
            "files": input_output.write_decks(decks, large)}


def describe_machine(program):
    """What the page says of the machine and the program."""
    lines = Path("/proc/cpuinfo").read_text(encoding="ascii").splitlines()
    processor = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    caches = []
    for index in sorted(Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        level, kind, size = ((index / name).read_text(encoding="ascii").strip()
                             for name in ("level", "type", "size"))
        caches.append(f"L{level} {kind.lower()} {size}")
    memory = int(Path("/proc/meminfo").read_text(encoding="ascii").split()[1]) / 1.0e6
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True)
    return {"processor": processor[0] if processor else "unknown",
            "logical cores": os.cpu_count(), "caches seen by a core": ", ".join(caches),
            "memory": f"{memory:.0f} GB",
            "processes that wanted to run (mean of a minute, at the end)":
                f"{os.getloadavg()[0]:.1f}",
            "program": " ".join(version.stdout.split())}


def run_axisymmetric(options, work, samples):
    """One measurement of everything."""
    unit_deck = options.out / "decks" / "unit.k"

    def units():
        now = measure_units(options.kernel, unit_deck, options.threads,
                            *((200000, 1000, 500) if options.quick else (20000000,)))
        samples.add(Variant("unit", "yardstick", 96, 1, "ns/element"), now.yardstick, now)
        samples.add(Variant("unit", "routine", 64, 1, "ns/element"), now.routine, now)
        for count, bandwidth in now.bandwidth.items():
            samples.add(Variant("unit", "bandwidth", 0, count, "GB/s"), bandwidth, now)
        return now

    if "step" in options.parts:
        now = None  # the elastic decks come first
        for (_, material), (deck, count) in work["step"].items():
            now = units() if material == "elastic" else now
            for threads in sorted({1, options.threads}):
                with contextlib.suppress(Disturbed):
                    variant, value, share = elements.time_steps(options, deck, count, material,
                                                                threads)
                    samples.add(variant, value, now, share)
            if options.threads > 1 and count <= elements.LARGEST_AT_ONCE:
                with contextlib.suppress(Disturbed):
                    variant, value, share = elements.time_at_once(options, deck, count, material,
                                                                  options.threads)
                    samples.add(variant, value, now, share)
    if "contact" in options.parts:
        for nodes in work["contact"]:
            now = units()
            for variant, value in time_contact(options.contact, nodes, 200 if options.quick else 0):
                samples.add(variant, value, now)
    if "search" in options.parts:
        for (case, _), (deck, nodes) in work["search"].items():
            now = units() if case == search.CASES[0] else now
            for ctype in search.TYPES:
                with contextlib.suppress(Disturbed):
                    for variant, value, share in search.time_search(options, case, deck, nodes,
                                                                    ctype):
                        samples.add(variant, value, now, share)
    if "files" in options.parts:
        now = units()
        for variant, value in input_output.time_files(options, work["files"]):
            samples.add(variant, value, now)


def main():
    """Measure in rounds; the table is there after each."""
    options = build_parser().parse_args()
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    options.program = options.build.resolve() / "slideline"
    options.kernel = options.build.resolve() / "tests" / "lab" / "bench" / "bench_kernel"
    options.contact = options.build.resolve() / "tests" / "lab" / "bench" / "bench_contact"
    work = plan(options) if options.rounds else {}
    samples = Samples(options.out / "samples.csv", options.program)
    if options.counted and options.rounds and not any(v.part == "count" for v in samples.of_program()):
        for variant, value in counts.count_all(options.counted.resolve(), options.out / "decks" / "unit.k",
                                               options.out / "counts", COUNTED[:1] if options.quick else COUNTED):
            samples.add(variant, value, Units(1.0, {1: 1.0}))
    for number in range(1 if options.quick else options.rounds):
        print(f"round {number + 1}", flush=True)
        run_axisymmetric(options, work, samples)
        write_summary(samples, options.out / "bench.csv")
    rows = write_summary(samples, options.out / "bench.csv")
    (options.out / "machine.json").write_text(
        json.dumps(describe_machine(options.program), indent=1), encoding="utf-8")
    for row in rows:
        ratio = f" = {row['over_yardstick']:6.2f} K" if row["over_yardstick"] is not None else ""
        print("{part:8s}{case:28s}{size:>9d} {threads}  {median:10.4g} {unit}".format(**row) + ratio)


if __name__ == "__main__":
    main()
