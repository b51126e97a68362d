# SPDX-License-Identifier: MIT
"""Quiescent tiles: a wave in a long bar, and a bar that flies into another one."""
import re

import numpy as np

from meshes import Deck, grid

RHO, YOUNG, SIZE, SPEED = 1000.0, 1.0e6, 0.1, 0.01
SOUND = np.sqrt(YOUNG / RHO)
WIDTH = 16
#: least number of elements in a tile of a long bar
LEAST_TILE = 400


def keep_active(deck):
    """A body load of no size moves nothing; with a body load no tile rests."""
    return deck.curve(77, [(0.0, 0.0), (1.0, 0.0)]).add("*LOAD_BODY_Y", (77,))


def stepped(result):
    """Steps of tiles that the log tells of, and those of all tiles in all cycles."""
    found = re.search(r"steps of tiles: (\d+) of (\d+)", (result.folder / f"{result.job}.log").read_text())
    return None if found is None else (int(found[1]), int(found[2]))


def struck_bar(length, cycles):
    """Plane-strain bar with nu = 0, the left end of which gets a velocity."""
    dt = 0.8 * SIZE / SOUND
    deck = Deck("bar struck at its end")
    deck.control(cycles * dt, dt=dt).part().elastic(RHO, YOUNG, 0.0)
    nodes = deck.mesh(*grid(length, WIDTH, length * SIZE, WIDTH * SIZE)).reshape(WIDTH + 1, -1)
    deck.curve(1, [(0.0, SPEED), (1.0, SPEED)])
    for node in nodes[:, 0]:
        deck.prescribe(node, 1, 0, 1)
    return deck.output(plot=cycles * dt / 5.0, glstat=cycles * dt / 20.0)


def two_bars(cycles, is_axisymmetric):
    """One flies and hits the end of another, a little aside (in a body of revolution along the axis)."""
    n, gap = (100, WIDTH), 0.25 * SIZE
    dt = 0.5 * SIZE / SOUND
    deck = Deck("a bar flies into another one")
    deck.control(cycles * dt, dt=dt).part().elastic(RHO, YOUNG, 0.2)
    bars = []
    for k in range(2):
        origin = (k * (n[0] * SIZE + gap), 0.3 * k * SIZE)
        coordinates, quads = grid(*n, n[0] * SIZE, WIDTH * SIZE, origin)
        if is_axisymmetric:
            coordinates, quads = coordinates[:, ::-1], [quad[::-1] for quad in quads]
        bars.append(deck.mesh(coordinates, quads).reshape(WIDTH + 1, -1))
    if is_axisymmetric:
        deck.lines[deck.lines.index("*SECTION_SHELL") + 1] = "1,15"
        deck.fix(np.concatenate([bars[0][0]]), x=1)
    deck.node_set(1, bars[0][::-1, -1] if is_axisymmetric else bars[0][:, -1])
    deck.node_set(2, bars[1][:, 0] if is_axisymmetric else bars[1][::-1, 0])
    deck.node_set(3, bars[0].ravel())
    speed = gap / (0.2 * cycles * dt)
    deck.add("*INITIAL_VELOCITY", (3,), (0.0, speed) if is_axisymmetric else (speed, 0.3 * speed))
    deck.contact(1, 2, 7, 1.0, unit=1)
    return deck.output(plot=cycles * dt / 5.0, glstat=cycles * dt / 20.0, matsum=cycles * dt / 20.0,
                       rcforc=cycles * dt / 20.0, nodout=cycles * dt / 20.0, nodes=bars[0][0, :3])


def same_files(run, name, deck, *args):
    """All that is written has the bits of the run in which every tile is stepped."""
    result = run.program(deck, *args, name=name)
    other = run.program(keep_active(deck), name=f"{name}_active")
    run.true(f"{name}: no tile rests under a body load", stepped(other) is None)
    for field in ("displacement", "velocity"):
        run.true(f"{name}: bits of {field}",
                 result.points(field).tobytes() == other.points(field).tobytes())
    run.true(f"{name}: bits of stress", result.cells("stress").tobytes()
             == other.cells("stress").tobytes())
    for path in sorted(result.folder.glob("*.csv")):
        table = path.name.split(".")[1]
        if table != "timing":
            run.true(f"{name}: bytes of {table}",
                     path.read_bytes() == other.csv_path(table).read_bytes())
    return result


def count_steps(run, name, result, cycles, length, start):
    """Steps taken, tiles, and steps of what motion reaches that enters a bar of `length` layers in cycle
    `start`: n layers n cycles later, in tiles of a bar."""
    taken, all_steps = stepped(result)
    n_tile = all_steps // (cycles + 1)
    n_bar = 2 if start else 1
    tiles_of_layer = n_tile / (n_bar * length)
    reached = n_bar * sum(min(n, length) for n in range(cycles + 1 - start)) * tiles_of_layer
    run.check(f"{name}: steps of tiles beyond", taken,
              reached + n_bar * (cycles + 1 - start) + 4 * n_tile)
    return taken, n_tile, reached


def check_bar(run):
    length, cycles = 640, 200
    result = same_files(run, "struck_bar", struck_bar(length, cycles))
    time = result.times[-1]
    stress = result.cells("stress")[-1, :length, 0]
    behind = np.abs(stress) > 0.5 * RHO * SOUND * SPEED
    run.check("struck_bar: place of the front", SIZE * np.count_nonzero(behind), SOUND * time)
    moved = np.any(result.points("displacement")[-1, :length + 1] != 0.0, axis=-1)
    run.check("struck_bar: columns of nodes that have moved", np.count_nonzero(moved), cycles + 1)
    taken, n_tile, reached = count_steps(run, "struck_bar", result, cycles, length, 0)
    run.check("struck_bar: tiles", n_tile * LEAST_TILE, length * WIDTH)
    run.check("struck_bar: steps of tiles", taken, reached)


def check_flight(run):
    for name, is_axisymmetric in (("flight", False), ("axisym_flight", True)):
        cycles = 160
        result = same_files(run, name, two_bars(cycles, is_axisymmetric), "ncpu=2")
        # The gap closes in a fifth of the cycles.
        count_steps(run, name, result, cycles, 100, cycles // 5 - 1)
        force = result.table("rcforc")
        run.true(f"{name}: the bars meet", np.any(np.hypot(force["fx"], force["fy"]) > 0.0))


def check(run):
    check_bar(run)
    check_flight(run)
