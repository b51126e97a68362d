# SPDX-License-Identifier: MIT
"""What all benchmarks share: runs and their share of the processor, the two units, the tables.

A sample is one measured value beside the units of the same minute. All samples are kept in
samples.csv, with the digest of the program they belong to; the summary has a row per variant.
"""
import csv
import dataclasses
import hashlib
import os
import signal
import statistics
import subprocess
import threading
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
BYTES = 216.0  # moved per element and step: state read and written, nodes, connectivity, by hand count
GOAL_BYTES, GOAL_YARDSTICKS = 220.0, 3.3  # of the goal for large models
UNDISTURBED = 0.97  # share of the processors that a run had
TURNS = 0.1  # s; some turns of the scheduler
LONGEST = 120.0  # s; a run that takes longer waits for processors that others have: no sample


class Disturbed(Exception):
    """A run that could not be measured, since others had the processors."""


@dataclasses.dataclass(frozen=True)
class Units:
    """The yardstick K in ns, the memory's bandwidth in GB/s by number of threads and the time of the program's own
    element routine in ns, at one time."""

    yardstick: float
    bandwidth: dict
    routine: float = float("nan")


@dataclasses.dataclass(frozen=True)
class Variant:
    """What is measured; `size` counts elements or slave nodes."""

    part: str
    case: str
    size: int
    threads: int
    unit: str


FIELDS = ("part", "case", "size", "threads", "unit", "value", "yardstick_ns", "bandwidth_gb_s",
          "share", "program")


class Samples:
    """The file of all samples; those of another program are kept and left alone."""

    def __init__(self, path, program):
        self.path = path
        self.program = hashlib.sha256(Path(program).read_bytes()).hexdigest()[:12]
        if not path.exists():
            with path.open("w", newline="", encoding="ascii") as stream:
                csv.writer(stream).writerow(FIELDS)
        elif path.read_text(encoding="ascii").splitlines()[0] != ",".join(FIELDS):
            raise SystemExit(f"{path} has other columns, perhaps times over an older unit: move it away")

    def add(self, variant, value, units, share=1.0):
        """Append one value; `share` of the processors that its run had."""
        bandwidth = units.bandwidth[min(variant.threads, max(units.bandwidth))]
        with self.path.open("a", newline="", encoding="ascii") as stream:
            csv.writer(stream).writerow((*dataclasses.astuple(variant), f"{value:.6g}",
                                         f"{units.yardstick:.4g}", f"{bandwidth:.4g}",
                                         f"{share:.3f}", self.program))

    def of_program(self):
        """{variant: list of (value, K, bandwidth, share)} of this program."""
        found = {}
        with self.path.open(newline="", encoding="ascii") as stream:
            for row in csv.DictReader(stream):
                if row["program"] == self.program:
                    variant = Variant(row["part"], row["case"], int(row["size"]),
                                      int(row["threads"]), row["unit"])
                    found.setdefault(variant, []).append(tuple(
                        float(row[name]) for name in FIELDS[5:9]))
        return found


def least_disturbed(samples):
    """The samples whose runs had the processors to themselves, at least the better half."""
    ordered = sorted(samples, key=lambda sample: -sample[3])
    count = max((len(ordered) + 1) // 2, sum(s[3] >= UNDISTURBED for s in ordered))
    return ordered[:count]


def summarise(variant, samples):
    """One row of the summary: medians and quartiles of the least disturbed samples."""
    kept = least_disturbed(samples)
    values = [sample[0] for sample in kept]
    low, middle, high = quartiles(values)
    row = {**dataclasses.asdict(variant), "repeats": len(samples), "kept": len(kept),
           "median": middle, "low": low, "high": high,
           "yardstick_ns": statistics.median(s[1] for s in kept),
           "bandwidth_gb_s": statistics.median(s[2] for s in kept),
           "over_yardstick": None, "over_bandwidth": None, "over_goal": None,
           "share": statistics.median(s[3] for s in kept)}
    if variant.unit.startswith("ns"):
        row["over_yardstick"] = statistics.median(s[0] / s[1] for s in kept)
    if variant.part == "step":
        row["over_bandwidth"] = statistics.median(s[0] * s[2] / BYTES for s in kept)
        row["over_goal"] = statistics.median(s[0] / (GOAL_YARDSTICKS * s[1] + GOAL_BYTES / s[2]) for s in kept)
    elif variant.unit == "MB/s":
        row["over_bandwidth"] = statistics.median(s[0] / 1.0e3 / s[2] for s in kept)
    return row


def quartiles(values):
    """Lower quartile, median, upper quartile."""
    if len(values) == 1:
        return values * 3
    return tuple(statistics.quantiles(values, n=4, method="inclusive"))


def write_summary(samples, path):
    """The table of all variants, smallest size first; returns its rows."""
    order = {name: k for k, name in enumerate(("unit", "count", "step", "contact", "search", "memory",
                                               "input", "output"))}
    found = sorted(samples.of_program().items(), key=lambda item: (
        order.get(item[0].part, len(order)), item[0].case, item[0].threads, item[0].size))
    rows = [summarise(variant, values) for variant, values in found]
    with path.open("w", newline="", encoding="ascii") as stream:
        writer = csv.DictWriter(stream, rows[0].keys())
        writer.writeheader()
        for row in rows:
            writer.writerow({name: f"{value:.5g}" if isinstance(value, float) else value
                             for name, value in row.items()})
    return rows


def is_fresh(path, script):
    """Whether a deck is there and was written after the script that writes it."""
    return path.exists() and path.stat().st_mtime > Path(script).stat().st_mtime


def measure_yardstick(rounds=5000):
    """K, ns: the fixed arithmetic of yardstick/, never a routine of the program."""
    output = subprocess.run([HERE / "yardstick" / "run.sh", "native", str(rounds)], check=True, capture_output=True, text=True).stdout
    return float(output.split(",")[1])


def measure_units(kernel, deck, threads, entries, calls=20000, rounds=5000):
    """K, now, of so many rounds; the element routine, so many calls a round, and the bandwidth of 1 thread and of `threads` on
    arrays of so many entries."""
    found = {}
    for count in sorted({1, threads}):
        output = subprocess.run([kernel, deck, str(count), str(entries), str(calls)], check=True, capture_output=True,
                                text=True).stdout
        found[count] = dict(line.split(",") for line in output.split())
    return Units(measure_yardstick(rounds),
                 {count: float(values["bandwidth_gb_s"]) for count, values in found.items()},
                 float(found[1]["routine_ns"]))


def without_others(value, share, threads, seconds):
    """A time without that in which others had the processor, as far as it can be known.

    With one thread it is in proportion to the processor time; threads that wait for each other use it up. What took
    fewer `seconds` than some turns of the scheduler may have had the processor to itself: it stays.
    """
    if threads == 1 and share < UNDISTURBED and seconds > TURNS:
        return value * share
    return value


def phase_seconds(path):
    """Seconds of the phases of a timing table."""
    with path.open(newline="", encoding="ascii") as table:
        return {row["phase"]: float(row["seconds"]) for row in csv.DictReader(table)}


def phase_calls(path, phase):
    """How often a phase was entered."""
    with path.open(newline="", encoding="ascii") as table:
        return next(int(row["calls"]) for row in csv.DictReader(table) if row["phase"] == phase)


def run_program(program, deck, folder, threads=1, words=()):
    """Run a deck; seconds by phase, and the share of the processors the run had.

    Raises `Disturbed` where it is not done within LONGEST seconds.
    """
    command = [str(program), f"i={deck}", f"d={folder}", "jobid=bench", f"ncpu={threads}", *words]
    start = time.monotonic()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        alarm = threading.Timer(LONGEST, process.kill)
        alarm.start()
        trouble = process.stderr.read().decode()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        alarm.cancel()
    clock = time.monotonic() - start
    if process.returncode == -signal.SIGKILL and clock >= LONGEST:
        raise Disturbed(deck)
    if process.returncode:
        raise SystemExit(f"{deck}: the program ended with status {process.returncode}\n{trouble}")
    seconds = phase_seconds(folder / "bench.timing.csv")
    alone = min(clock, clock - seconds["total"] + seconds["input"] + seconds["output"])
    wanted = alone + threads * (clock - alone)
    return seconds, min(1.0, (usage.ru_utime + usage.ru_stime) / wanted)
