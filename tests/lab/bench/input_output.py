# SPDX-License-Identifier: MIT
"""Reading a large deck and writing states, beside the disk's own rate; memory of a run.

Reading: the deck of elements.py, with an initial velocity for each node, and some steps, in which the memory is what
the run needs. Goals: at most 3 s for a million elements, a peak of at most 1.5 times that memory, and 250 bytes an
element. Writing: states of a quarter as many elements, the phase `output` with all that it fills in, beside a plain
file of as many bytes written in the same minute (neither is forced to the disk). Both stand on the disk until both are
written: a file that takes the memory which another has just given up is written up to ten times as fast. Goal: half
that rate.
"""
import os
import subprocess
import time
from pathlib import Path

from elements import write_deck
from measuring import Variant, phase_seconds

READING_STEPS, WRITING_STEPS, STATES = 40, 40, 20
PIECE = 1 << 24  # bytes of one write of the plain file
LATER = 0.1  # s that the program's clock may start later than ours


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
    largest = max(peak for _, _, _, peak in samples)
    reading = max((used for at, used, _, _ in samples if at <= seconds), default=seconds)
    stepping = max((present for at, _, present, _ in samples if at > seconds + LATER),
                   default=largest)
    return seconds, reading, largest, stepping


def write_plain(path, size):
    """Seconds to write a file of so many bytes."""
    piece = os.urandom(PIECE)
    start = time.monotonic()
    with path.open("wb", buffering=0) as stream:
        for at in range(0, size, PIECE):
            stream.write(piece[:min(PIECE, size - at)])
    return time.monotonic() - start


def write_once(program, deck, folder):
    """MB of states, and MB/s of the program and of a plain file."""
    results = folder / "writing.vtkhdf"
    subprocess.run([program, f"i={deck}", f"d={folder}", "jobid=writing"], check=True,
                   stdout=subprocess.DEVNULL)
    seconds = phase_seconds(folder / "writing.timing.csv")["output"]
    size = results.stat().st_size - (folder / "writing.effective.k").stat().st_size
    plain = folder / "plain"
    states_rate, plain_rate = size / 1.0e6 / seconds, size / 1.0e6 / write_plain(plain, size)
    results.unlink()
    plain.unlink()
    return size / 1.0e6, states_rate, plain_rate


def states_deck(path, elements, states):
    """The yielding block with so many states besides the first."""
    write_deck(path, elements, True, steps=WRITING_STEPS)
    text = path.read_text(encoding="ascii")
    end = float(text.split("*CONTROL_TERMINATION")[1].splitlines()[2])
    plot = f"*DATABASE_BINARY_D3PLOT\n{end / states:.9g},\n*END"
    path.write_text(text.replace("*END", plot), encoding="ascii")


def write_decks(folder, elements):
    """Decks of reading, of writing and of a run that is nothing but the program, with their elements."""
    decks = {}
    for name, count in (("reading", elements), ("nothing", 64)):
        decks[name] = folder / f"{name}.k", write_deck(folder / f"{name}.k", count, False,
                                                       steps=READING_STEPS)
    states_deck(folder / "states.k", elements // 4, STATES)
    decks["states"] = folder / "states.k", elements // 4
    return decks


def deck_bytes(path):
    """Bytes of a deck with what it includes."""
    lines = path.read_text(encoding="ascii").splitlines()
    included = [path.with_name(name) for line, name in zip(lines, lines[1:]) if line == "*INCLUDE"]
    return sum(file.stat().st_size for file in [path, *included])


def time_files(options, decks):
    """[(variant, value)] of one run of each deck."""
    (large, elements), (small, _) = decks["reading"], decks["nothing"]
    clock, used, peak, stepping = read_once(options.program, large, options.out)
    empty = read_once(options.program, small, options.out)[3]
    size, states, plain = write_once(options.program, decks["states"][0], options.out)
    megabytes = deck_bytes(large) / 1.0e6

    def row(part, case, unit, value, count=elements):
        return Variant(part, case, count, 1, unit), value

    return [
        row("input", "deck", "MB", megabytes), row("input", "reading", "s", clock),
        row("input", "reading, processor time", "s", used),
        row("input", "rate of reading", "MB/s", megabytes / max(used, 1.0e-3)),
        row("memory", "steps", "bytes/element", 1.0e6 * (stepping - empty) / elements),
        row("memory", "peak", "bytes/element", 1.0e6 * (peak - empty) / elements),
        row("memory", "peak over steps", "", peak / max(stepping, 1.0)),
        row("output", "states written", "MB", size, decks["states"][1]),
        row("output", "states", "MB/s", states, decks["states"][1]),
        row("output", "plain file", "MB/s", plain, decks["states"][1]),
        row("output", "states over plain file", "", states / plain, decks["states"][1])]
