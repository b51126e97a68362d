#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Reading a large deck and writing states, beside the disk's own rate.

usage: input_output.py --program SLIDELINE --out FOLDER [--elements 1000000] [--states 20] [--repeats 3]

Reading: the deck of elements.py, with an initial velocity for each node, and some steps, in which the memory is what
the run needs. Goals: at most 3 s, and a peak of at most 1.5 times that memory. Writing: states of a quarter as
many elements, the phase `output` with all that it fills in, beside a plain file of as many bytes written in the same
minute (neither is forced to the disk). Goal: half that rate. input_output.csv holds the medians.
"""
import argparse
import csv
import os
import statistics
import subprocess
import time
from pathlib import Path

from elements import phase_seconds, write_deck

READING_STEPS, WRITING_STEPS = 40, 40
PIECE = 1 << 24  # bytes of one write of the plain file


def look_at(pid):
    """Processor seconds, present and largest resident memory in MB of a process; zeros when it has gone."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text(encoding="ascii").splitlines()
        times = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()[11:13]
    except OSError:
        return 0.0, 0.0, 0.0
    values = dict(line.split(":", 1) for line in lines)
    present, largest = (int(values.get(name, "0 kB").split()[0]) for name in ("VmRSS", "VmHWM"))
    return sum(map(int, times)) / os.sysconf("SC_CLK_TCK"), present / 1.0e3, largest / 1.0e3


def read_once(program, deck, folder):
    """Seconds and processor seconds of reading, peak memory and that of the steps in MB."""
    start = time.monotonic()
    samples = []
    command = [program, f"i={deck}", f"d={folder}", "jobid=reading"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        while process.poll() is None:
            samples.append((time.monotonic() - start, *look_at(process.pid)))
            time.sleep(0.02)
    if process.returncode:
        raise SystemExit(f"{deck}: the program ended with status {process.returncode}")
    seconds = phase_seconds(folder / "reading.timing.csv")["input"]
    reading = max(used for at, used, _, _ in samples if at <= seconds)
    stepping = max(present for at, _, present, _ in samples if at > seconds)
    return seconds, reading, max(peak for _, _, _, peak in samples), stepping


def write_plain(path, size):
    """Seconds to write a file of so many bytes; it is removed."""
    piece = os.urandom(PIECE)
    start = time.monotonic()
    with path.open("wb", buffering=0) as stream:
        for at in range(0, size, PIECE):
            stream.write(piece[:min(PIECE, size - at)])
    seconds = time.monotonic() - start
    path.unlink()
    return seconds


def write_once(program, deck, folder):
    """MB of states, and MB/s of the program and of a plain file."""
    results = folder / "writing.vtkhdf"
    subprocess.run([program, f"i={deck}", f"d={folder}", "jobid=writing"], check=True,
                   stdout=subprocess.DEVNULL)
    seconds = phase_seconds(folder / "writing.timing.csv")["output"]
    size = results.stat().st_size - (folder / "writing.effective.k").stat().st_size
    results.unlink()
    return size / 1.0e6, size / 1.0e6 / seconds, size / 1.0e6 / write_plain(folder / "plain", size)


def states_deck(path, elements, states):
    """The yielding block with so many states besides the first."""
    write_deck(path, elements, True, steps=WRITING_STEPS)
    text = path.read_text(encoding="ascii")
    end = float(text.split("*CONTROL_TERMINATION")[1].splitlines()[2])
    plot = f"*DATABASE_BINARY_D3PLOT\n{end / states:.9g},\n*END"
    path.write_text(text.replace("*END", plot), encoding="ascii")


def measure(options):
    """Rows (quantity, unit, median, goal)."""
    options.out.mkdir(parents=True, exist_ok=True)
    large, states = options.out / "reading.k", options.out / "states.k"
    write_deck(large, options.elements, False, steps=READING_STEPS)
    states_deck(states, options.elements // 4, options.states)
    reads, writes = [], []
    for repeat in range(options.repeats):
        print(f"round {repeat + 1} of {options.repeats}", flush=True)
        reads.append(read_once(options.program, large, options.out))
        writes.append(write_once(options.program, states, options.out))
    middle = statistics.median
    return [
        ("deck", "MB", large.stat().st_size / 1.0e6, None),
        ("reading", "s", middle(read[0] for read in reads), 3.0),
        ("reading, processor time", "s", middle(read[1] for read in reads), 3.0),
        ("peak memory", "MB", middle(read[2] for read in reads), None),
        ("memory of the steps", "MB", middle(read[3] for read in reads), None),
        ("peak over steps", "", middle(read[2] / read[3] for read in reads), 1.5),
        ("states written", "MB", writes[0][0], None),
        ("states", "MB/s", middle(write[1] for write in writes), None),
        ("plain file", "MB/s", middle(write[2] for write in writes), None),
        ("states over plain file", "", middle(write[1] / write[2] for write in writes), 0.5)]


def main():
    """Measure, write the table and print it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--elements", type=int, default=1000000)
    parser.add_argument("--states", type=int, default=20)
    parser.add_argument("--repeats", type=int, default=3)
    rows = measure(options := parser.parse_args())
    with (options.out / "input_output.csv").open("w", newline="", encoding="ascii") as table:
        writer = csv.writer(table)
        writer.writerow(("quantity", "unit", "median", "goal"))
        writer.writerows((name, unit, f"{value:.4g}", goal) for name, unit, value, goal in rows)
    for name, unit, value, goal in rows:
        print(f"{name:32s}{value:10.2f} {unit:5s}" + (f" goal {goal}" if goal else ""))


if __name__ == "__main__":
    main()
