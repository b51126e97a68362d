#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the clock inside the program costs: a scene with readings on and off, interleaved. Run by hand.

`clock_overhead.py PROGRAM [DECK] [--repeats N] [--word WORD ...]`; without DECK the collision at level 1, 25 slave nodes,
one step of which is a few microseconds. Compares the processor time of timing=phase, timing=interface and timing=off (that of others on the
machine does not count), the medians and the least of all repeats, and says how much of each contact phase is the clock: its readings times the cost of one.
"""
import argparse
import pathlib
import re
import resource
import statistics
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
MODES = ("off", "phase", "interface")
# Few outputs, so that little but cycles is timed.
QUIET = ("p:dtplot=1.0", "p:dthist=1.0", "p:dtforc=1.0")


def run(program, deck, mode, words, folder):
    """Rows {phase: (seconds, calls)}, nanoseconds of a lap (None where off) and processor seconds of one run."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([program, f"i={deck}", f"d={folder}", "jobid=clock", f"timing={mode}", *words],
                   check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    lines = (folder / "clock.timing.csv").read_text().splitlines()[1:]
    rows = {name: (float(seconds), int(calls)) for name, seconds, calls, _ in
            (line.split(",") for line in lines)}
    found = re.search(r"readings of (\S+) nanoseconds", (folder / "clock.log").read_text())
    return rows, float(found.group(1)) if found else None, used


def report(runs):
    """Lines on the totals and on the share of the clock in each contact phase."""
    totals = {mode: [used for _, _, used in runs[mode]] for mode in MODES}
    lines = ["mode       median s   least s   median / off   least / off"]
    for mode in MODES:
        median, least = statistics.median(totals[mode]), min(totals[mode])
        ratios = median / statistics.median(totals["off"]), least / min(totals["off"])
        lines.append(f"{mode:10s} {median:8.4f}  {least:8.4f}   {ratios[0]:12.4f}  {ratios[1]:12.4f}")
    each = min(lap for _, lap, _ in runs["phase"])
    laps = sum(calls for name, (_, calls) in runs["phase"][0][0].items() if name != "total")
    extra = (statistics.median(totals["phase"]) - statistics.median(totals["off"])) / laps
    lines.append(f"{laps} readings of {each:.1f} ns in a row; {1.0e9 * extra:.1f} ns each more processor time")
    for name, (_, calls) in runs["phase"][0][0].items():
        if name.startswith("contact_") and calls:
            step = 1.0e9 * statistics.median(rows[name][0] for rows, _, _ in runs["phase"]) / calls
            lines.append(f"{name:16s} {step:8.1f} ns a step, of it the clock {100.0 * each / step:.1f} %")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program", help="the program, a Release build")
    parser.add_argument("deck", nargs="?", default=ROOT / "input/collision/collision.k")
    parser.add_argument("--repeats", type=int, default=40)
    parser.add_argument("--word", action="append", default=[], help="an override, such as ctype=7")
    options = parser.parse_args()
    words = [*QUIET, *options.word]
    runs = {mode: [] for mode in MODES}
    with tempfile.TemporaryDirectory() as folder:
        for repeat in range(options.repeats):
            for k in range(len(MODES)):
                mode = MODES[(repeat + k) % len(MODES)]
                runs[mode].append(run(options.program, options.deck, mode, words, pathlib.Path(folder)))
    print("\n".join(report(runs)))


if __name__ == "__main__":
    main()
