# SPDX-License-Identifier: MIT
"""Retired instructions per element and step: of the yardstick, of the program's element routine and of its step.

By callgrind, of what is built for x86-64-v3. Each is the difference of two runs of which one does more of the same, so
that start and end drop out: the figures are the same on a busy machine.
"""
import subprocess

import elements
from measuring import HERE, Variant
from slideline_tools.counting import count_instructions

ARCH = "x86-64-v3"
YARDSTICK_ROUNDS, YARDSTICK_WORK = (20, 60), 200 * 96  # calls of a round times elements, as in yardstick.f90
ROUTINE_CALLS, ROUTINE_WORK = (20, 120), 7 * 64        # rounds times elements, as in kernel.f90
STEPS = (100, 200)


def difference(commands, work, folder):
    """Instructions per unit of the work that the second command does more."""
    few, many = (count_instructions(command, folder).total for command in commands)
    return (many - few) / work


def count_yardstick(folder):
    """Of the yardstick, per element."""
    subprocess.run([HERE / "yardstick" / "run.sh", ARCH], check=True, stdout=subprocess.DEVNULL)
    program = HERE.parents[2] / "build" / "yardstick" / ARCH / "yardstick"
    first, second = YARDSTICK_ROUNDS
    return difference([[program, str(rounds)] for rounds in (first, second)],
                      YARDSTICK_WORK * (second - first), folder)


def count_routine(kernel, deck, folder, words=()):
    """Of the element routine alone, per element; `words`: what else the program is reported."""
    first, second = ROUTINE_CALLS
    return difference([[kernel, deck, "1", "1000", str(calls), *words] for calls in (first, second)],
                      ROUTINE_WORK * (second - first), folder)


def count_step(program, size, material, folder):
    """Of the whole step, per element; and how many elements there are."""
    commands = []
    for steps in STEPS:
        deck = folder / f"counted_{size}_{material}_{steps}.k"
        count = elements.write_deck(deck, size, material == "yielding", steps)
        commands.append([program, f"i={deck}", f"d={folder}", "jobid=counted", "ncpu=1"])
    return difference(commands, count * (STEPS[1] - STEPS[0]), folder), count


def count_all(build, unit_deck, folder, sizes):
    """[(variant, instructions)] of all; `build`: the folder of the counted build, with bench_kernel."""
    folder.mkdir(parents=True, exist_ok=True)
    unit = "instructions/element"
    found = [(Variant("count", "yardstick", 96, 1, unit), count_yardstick(folder)),
             (Variant("count", "element routine", 64, 1, unit),
              count_routine(build / "tests" / "lab" / "bench" / "bench_kernel", unit_deck, folder))]
    for size in sizes:
        for material in ("elastic", "yielding"):
            value, count = count_step(build / "slideline", size, material, folder)
            found.append((Variant("count", f"step, {material}", count, 1, unit), value))
    return found
