#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""slideline beside other programs: the same problems, in the same run.

usage: run.py --program SLIDELINE --peers PYTHON --out FOLDER [--counted SLIDELINE] [--rounds 5] [--quick]

PYTHON is that of an environment with akantu and KratosMultiphysics, its structural and its contact application; ccx is
CalculiX; OpenRadioss takes part where openradioss.py finds its programs. All programs run in turn, one thread each, in each round, with the yardstick K of the benchmarks before and
behind each run: elements.csv, collision.csv and contact.csv hold every run. With a program to be counted, retired
instructions of all programs are counted once, into counts.csv.
"""
import argparse
import csv
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import calculix
import collision
import counted
import openradioss
import openradioss_collision
import openradioss_wave
import slideline_collision
from slideline_tools.decks import Deck
from slideline_tools.results import read
from slideline_tools.scenes.block import block, block_grids
from slideline_tools.scenes.patch import even_lines, patch, patch_grids

HERE = Path(__file__).resolve().parent
POINTS = ("1", "4")                         # of the elements of slideline and of OpenRadioss
WAVES = ((32, 200), (100, 100), (316, 15))  # columns, steps
PATCHES = (5, 40)                           # columns of the upper block
QUICK_WAVE = (8, 20)
COLLISIONS = (40, 80)                       # columns of the upper block
QUICK_COLLISION = 10
TYPES = (2, 5, 7)
KRATOS_CONTACT = "mortar, augmented Lagrangian"
PUSH = 1.0e-4                               # of the upper face of the block, m
ONE = {**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}


def wave_commands(options, columns, steps):
    """The commands of one size."""
    size = [str(columns), str(steps)]
    ours = [sys.executable, str(HERE / "slideline_wave.py"), str(options.program), str(options.runs)]
    radioss = [sys.executable, str(HERE / "openradioss_wave.py"), str(options.runs)]
    return [*([*ours, points, *size] for points in POINTS),
            *([*radioss, points, *size] for points in POINTS if openradioss.programs()),
            *python_waves(options, size)]


def python_waves(options, size):
    """Those of the programs that are driven from Python."""
    return [[options.peers, str(HERE / "akantu_wave.py"), *size],
            [options.peers, str(HERE / "akantu_wave.py"), *size, "large"],
            [options.peers, str(HERE / "kratos_wave.py"), *size]]


def collision_commands(options, columns):
    """The commands of one size."""
    ours = [sys.executable, str(HERE / "slideline_collision.py"), str(options.program), str(options.runs)]
    radioss = [sys.executable, str(HERE / "openradioss_collision.py"), str(options.runs)]
    return [*([*ours, str(ctype), str(columns)] for ctype in TYPES),
            *([*radioss, str(columns)] for _ in range(bool(openradioss.programs()))),
            [options.peers, str(HERE / "akantu_collision.py"), str(columns)]]


def measure_yardstick():
    """K now, ns."""
    done = subprocess.run([HERE.parent / "yardstick" / "run.sh", "native", "500"], capture_output=True, text=True, check=True)
    return float(done.stdout.split(",")[1])


def beside_yardstick(action, *arguments):
    """What an action returns, and the mean of K before and behind it, ns."""
    before = measure_yardstick()
    result = action(*arguments)
    return result, 0.5 * (before + measure_yardstick())


def run_command(command):
    """The row that a program prints."""
    done = subprocess.run(command, capture_output=True, text=True, env=ONE, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode or not lines:
        raise SystemExit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    return json.loads(lines[-1])


def run_commands(commands):
    """One row for each command, with the yardstick beside it."""
    rows = []
    for command in commands:
        row, yardstick = beside_yardstick(run_command, command)
        rows.append({**row, "yardstick_ns": yardstick})
    return rows


def run_waves(options):
    """One row for each program and size."""
    return run_commands(command for columns, steps in ((QUICK_WAVE,) if options.quick else WAVES)
                        for command in wave_commands(options, columns, steps))


def run_collisions(options):
    """One row for each program, contact and size."""
    return run_commands(command for columns in ((QUICK_COLLISION,) if options.quick else COLLISIONS)
                        for command in collision_commands(options, columns))


def processor_seconds(action, *arguments):
    """What an action returns, with the processor and the clock time of the programs that it ran."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    result = action(*arguments)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return result, used, time.monotonic() - start


def run_slideline(options, name, text, words):
    """{element: s_yy at the end}."""
    deck = options.runs / f"{name}.k"
    deck.write_text(text, encoding="ascii")
    subprocess.run([options.program, f"i={deck}", f"d={options.runs}", f"jobid={name}",
                    "ncpu=1", *words], check=True, stdout=subprocess.DEVNULL, env=ONE)
    results = read(options.runs / f"{name}.vtkhdf")
    numbers = np.asarray(results.cell_field("element_id")[-1])
    return dict(zip(numbers.tolist(), np.asarray(results.cell_field("stress")[-1])[:, 1].tolist()))


def exact(scene):
    """-s_yy by the closed form, Pa: the load; or two blocks of 0.5 m and the springs, in a row."""
    if scene == "patch":
        return 1.0
    side = float(np.diff(block_grids()[1].points[:, 0, 0])[0])
    return PUSH / (1.0 / calculix.YOUNG + side / calculix.PENALTY)


def contact_row(scene, elements, program, contact, found, used, clock, trouble=""):
    """A row of contact.csv."""
    values = np.array(list(found.values())) if found else np.array([np.nan])
    return {"scene": scene, "elements": elements, "program": program, "contact": contact,
            "mean": -float(values.mean()), "exact": exact(scene),
            "deviation": float(np.abs(values / values.mean() - 1.0).max()),
            "processor_seconds": used, "seconds": clock, "message": trouble}


def pinned(grids):
    """A node of each block that is held in x."""
    lower, upper = grids
    return [int(lower.lower[len(lower.lower) // 2]), int(upper.upper[len(upper.upper) // 2])]


def calculix_name(scene, elements, contact):
    """Stem of the files of a run of CalculiX."""
    return f"ccx_{scene}_{elements}_{contact.split()[0].lower()}"


def scene_rows(options, scene, grids, text, step, words=()):
    """All programs on one scene; `words`: further arguments of slideline."""
    lower, upper = grids
    elements = lower.element.size + upper.element.size
    rows = []
    for ctype in TYPES:
        (found, used, clock), yardstick = beside_yardstick(
            processor_seconds, run_slideline, options, f"{scene}_{elements}", text, (f"ctype={ctype}", *words))
        rows.append({**contact_row(scene, elements, "slideline", f"type {ctype}", found, used, clock),
                     "yardstick_ns": yardstick})
    for contact in calculix.CONTACTS:
        name = calculix_name(scene, elements, contact)
        ((found, trouble), used, clock), yardstick = beside_yardstick(
            processor_seconds, calculix.run, options.runs, name,
            calculix.deck(contact, lower, upper, pinned(grids), step))
        rows.append({**contact_row(scene, elements, "CalculiX", contact.lower(), found, used, clock, trouble),
                     "yardstick_ns": yardstick})
    if scene == "patch":
        rows.append(kratos_row(options, elements, upper.element.shape[0]))
    return rows


def kratos_row(options, elements, columns):
    """Kratos on the patch; its time is that of the analysis alone."""
    found, yardstick = beside_yardstick(run_command, [options.peers, str(HERE / "kratos_patch.py"), str(columns)])
    used = found["processor_seconds"]
    return {**contact_row("patch", elements, "Kratos", KRATOS_CONTACT, found["stress"], used, used), "yardstick_ns": yardstick}


def static_block(grids):
    """The block-to-block scene as one static step that pushes the upper face down by PUSH."""
    lines = block(implicit=True).splitlines()
    at = lines.index("*CONTROL_IMPLICIT_DYNAMICS")
    del lines[at:at + 3]
    more = Deck("pins")
    more.lines = []
    more.node_set(9, "held in x", pinned(grids))
    more.spc_set(9, True, False)
    return "\n".join(lines[:-1] + more.lines + lines[-1:]) + "\n"


def contact_scenes(options):
    """Arguments of `scene_rows`: contact patches of all sizes and the block."""
    for columns in PATCHES[:1] if options.quick else PATCHES:
        grids = patch_grids(even_lines(columns), even_lines(columns * 4 // 5))
        yield ("patch", grids, patch(grids=grids, static=True, penalty=calculix.PENALTY), calculix.STATIC, ())
    grids = block_grids()
    yield ("block", grids, static_block(grids), calculix.PUSH.format(push=PUSH),
           ("p:dt=1.0", "p:endtim=1.0", f"p:v0=-{PUSH}"))


def run_contact(options):
    """One row for each scene, program and contact."""
    return [row for scene in contact_scenes(options) for row in scene_rows(options, *scene)]


def counted_waves(options, columns, steps):
    """As `wave_commands`, but of the programs alone."""
    return [*(counted.slideline_step(options.counted, options.runs, int(points), columns, steps) for points in POINTS),
            *(openradioss_wave.command(options.runs, int(points), columns, steps) for points in POINTS
              if openradioss.programs()),
            *python_waves(options, [str(columns), str(steps)])]


def count_waves(options, rows):
    """Instructions per element and step of the smallest size; `rows`: what `run_waves` gave."""
    columns, steps = QUICK_WAVE if options.quick else WAVES[0]
    few, many = (counted_waves(options, columns, number) for number in (steps, counted.MORE * steps))
    return [row for labels, *commands in zip(rows, few, many)
            for row in counted.step_row(labels, commands, options.runs, env=ONE, cwd=options.runs)]


def counted_collisions(options, columns, steps):
    """As `collision_commands`, but of the programs alone and for so many steps."""
    return [*(slideline_collision.command(options.counted, options.runs, ctype, columns, steps)[0] for ctype in TYPES),
            *(openradioss_collision.command(options.runs, columns, steps) for _ in range(bool(openradioss.programs()))),
            [options.peers, str(HERE / "akantu_collision.py"), str(columns), str(steps)]]


def count_collisions(options, rows):
    """Instructions per element and step of the smallest size, the first step left out; `rows`: what `run_collisions` gave."""
    columns = QUICK_COLLISION if options.quick else COLLISIONS[0]
    steps = collision.steps(columns)
    few, many = (counted_collisions(options, columns, number) for number in (1, steps))
    return [row for labels, *commands in zip(rows, few, many)
            for row in counted.difference_row("collision", labels, labels["contact"], commands, steps - 1, options.runs,
                                              env=ONE, cwd=options.runs)]


def count_contact(options, rows):
    """Instructions of each process that gave an answer, but of Kratos, most of which is Python's start; `rows`: what
    `run_contact` gave, whose files are still there."""
    words = {(scene, lower.element.size + upper.element.size): words
             for scene, (lower, upper), _, _, words in contact_scenes(options)}
    found = []
    for row in (row for row in rows if not row["message"] and row["program"] != "Kratos"):
        scene, elements, contact = row["scene"], row["elements"], row["contact"]
        name = calculix_name(scene, elements, contact)
        command = ["ccx", name] if row["program"] == "CalculiX" else [
            options.counted, f"i={options.runs / f'{scene}_{elements}.k'}", f"d={options.runs}", "jobid=counted",
            "ncpu=1", f"ctype={contact.split()[-1]}", *words[scene, elements]]
        found += counted.row(scene, elements, row["program"], contact,
                             counted.count(command, options.runs, env=ONE, cwd=options.runs))
    return found


def append(path, rows, number):
    """Add the rows of a round."""
    new = number == 1
    with path.open("w" if new else "a", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, ["round", *rows[0]])
        if new:
            writer.writeheader()
        writer.writerows({"round": number, **row} for row in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--peers", required=True, help="Python with the other programs")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--counted", type=Path, help="the program whose instructions are counted")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--quick", action="store_true", help="smallest sizes, one round")
    options = parser.parse_args()
    options.program, options.out = options.program.resolve(), options.out.resolve()
    options.runs = options.out / "runs"
    options.runs.mkdir(parents=True, exist_ok=True)
    for number in range(1, 2 if options.quick else options.rounds + 1):
        print(f"round {number}", flush=True)
        waves, collisions, contact = run_waves(options), run_collisions(options), run_contact(options)
        append(options.out / "elements.csv", waves, number)
        append(options.out / "collision.csv", collisions, number)
        append(options.out / "contact.csv", contact, number)
    (options.out / "counts.csv").unlink(missing_ok=True)
    if options.counted:
        print("instructions", flush=True)
        options.counted = options.counted.resolve()
        rows = count_waves(options, waves) + count_collisions(options, collisions) + count_contact(options, contact)
        if rows:
            append(options.out / "counts.csv", rows, 1)


if __name__ == "__main__":
    main()
