# SPDX-License-Identifier: MIT
"""Decks and runs of the explicit step alone.

Square blocks of one-point quads, fixed on their left side, stretched by a linear velocity field, elastic or
yielding everywhere; no plot output. A step's time is that of the phases `elements` and `nodes`.
"""
import concurrent.futures
from pathlib import Path

import numpy as np

from measuring import Variant, is_fresh, phase_calls, run_program, without_others
from slideline_tools.decks import Deck
from slideline_tools.scenes.common import perfectly_plastic, elastic, plane_strain

SIDE, RHO, YOUNG, POISSON = 1.0, 7850.0, 210.0e9, 0.3
STRAIN_RATE = 20.0  # 1/s, less where the run is so long that it would stretch the block by more than
LONGEST = 0.1
SOFT = 1.0e3        # yield stress of the yielding blocks, Pa: passed in the first steps
LARGEST_AT_ONCE = 110000  # elements of several runs at once
WORK = 4.0e7        # elements times steps of a run; more where these are fewer than 20 steps


def columns_of(elements):
    """Columns and rows of a block of about this many elements."""
    columns = max(1, round(elements ** 0.5))
    return columns, max(1, round(elements / columns))


def write_mesh(path, columns, rows):
    """Nodes, elements and the unit velocity field of a block, as a file to be included."""
    y = np.linspace(0.0, SIDE * rows / columns, rows + 1).tolist()
    with path.open("w", encoding="ascii") as stream:
        stream.write("*KEYWORD\n*NODE\n")
        for i in range(columns + 1):
            first, x = i * (rows + 1) + 1, SIDE * i / columns
            stream.write("".join([f"{first + j:8d}{x:16.9g}{y[j]:16.9g}\n"
                                  for j in range(rows + 1)]))
        stream.write("*ELEMENT_SHELL\n")
        for i in range(columns):
            element, node = i * rows + 1, i * (rows + 1) + 1
            other = node + rows + 1
            stream.write("".join([
                f"{element + j:8d}       1{node + j:8d}{other + j:8d}{other + j + 1:8d}"
                f"{node + j + 1:8d}\n" for j in range(rows)]))
        stream.write("*END\n")


def write_velocities(path, columns, rows, rate):
    """v_x = rate x, v_y = -0.3 rate y, as a file to be included."""
    v_y = [f"{-0.3 * rate * SIDE * j / columns:10.2e}\n" for j in range(rows + 1)]
    with path.open("w", encoding="ascii") as stream:
        stream.write("*KEYWORD\n*INITIAL_VELOCITY_NODE\n")
        for i in range(columns + 1):
            first, v_x = i * (rows + 1) + 1, f"{rate * SIDE * i / columns:10.3e}"
            stream.write("".join([f"{first + j:10d}{v_x}{v_y[j]}" for j in range(rows + 1)]))
        stream.write("*END\n")


def write_deck(path, elements, yields, steps=None, law=None):
    """A block as described above; returns the number of elements.

    `law`: another material in its place, `law(deck)` writes material 1 and returns the number of its equation of state. Mesh and velocities are files beside it, shared by the materials.
    """
    columns, rows = columns_of(elements)
    steps = steps or max(20, int(WORK / (columns * rows)))
    step = 0.5 * SIDE / columns / 6000.0
    rate = min(STRAIN_RATE, LONGEST / (steps * step))
    mesh = path.with_name(f"mesh_{columns}x{rows}.inc")
    velocities = path.with_name(f"velocity_{columns}x{rows}_{steps}.inc")
    if not is_fresh(mesh, __file__):
        write_mesh(mesh, columns, rows)
    if not is_fresh(velocities, __file__):
        write_velocities(velocities, columns, rows, rate)
    deck = Deck("benchmark of the explicit step")
    deck.keyword("CONTROL_TERMINATION").card("endtim", steps * step)
    deck.constant_step(1, step, 1.0e3)
    deck.database(glstat=steps * step)
    deck.keyword("CONTROL_ENERGY").card("hgen rwen slnten rylen", 2, 2, 2, 2)
    plane_strain(deck, 1)
    eos = law(deck) if law else 0
    deck.keyword("PART", "block").card("pid secid mid eosid hgid", 1, 1, 1, eos, 0)
    if law:
        pass
    elif yields:
        perfectly_plastic(deck, 1, RHO, YOUNG, POISSON, SOFT)
    else:
        elastic(deck, 1, RHO, YOUNG, POISSON)
    deck.node_set(1, "left side", range(1, rows + 2))
    deck.spc_set(1, True, True)
    for name in (mesh.name, velocities.name):
        deck.keyword("INCLUDE")
        deck.lines.append(name)
    path.write_text(deck.text(), encoding="ascii")
    return columns * rows


def write_decks(folder, sizes):
    """{(size, material): (deck, elements)}."""
    decks = {}
    for size in sizes:
        for material in ("elastic", "yielding"):
            deck = Path(folder) / f"block_{size}_{material}.k"
            decks[size, material] = deck, write_deck(deck, size, material == "yielding")
    return decks


def step_time(folder, seconds, elements):
    """ns per element and step. Steps are counted as taken: where elements get shorter, there are more than planned."""
    stepping = seconds["elements"] + seconds["nodes"]
    return 1.0e9 * stepping / elements / phase_calls(folder / "bench.timing.csv", "elements")


def time_steps(options, deck, elements, material, threads):
    """The variant, ns per element and step of one run, and its share of the processors."""
    seconds, share = run_program(options.program, deck, options.out, threads)
    step = step_time(options.out, seconds, elements)
    return (Variant("step", material, elements, threads, "ns/element"),
            without_others(step, share, threads, seconds["elements"] + seconds["nodes"]), share)


def time_at_once(options, deck, elements, material, runs):
    """The same of so many runs of one thread at once: the mean, of the least share of a processor.

    It tells what the machine grants to several busy cores, whatever its host and its clock do.
    """
    def one(number):
        folder = options.out / f"at_once_{number}"
        seconds, share = run_program(options.program, deck, folder)
        return step_time(folder, seconds, elements), share

    with concurrent.futures.ThreadPoolExecutor(runs) as team:
        steps, shares = zip(*team.map(one, range(runs)))
    return (Variant("step", f"{material}, {runs} runs at once", elements, 1, "ns/element"),
            sum(steps) / runs, min(shares))
