# SPDX-License-Identifier: MIT
"""The runs of the study of scale: decks of some cycles on 1 to 64 processes, and what they count and take.

    python -m slideline_tools.studies.scale.runs FOLDER --program SLIDELINE [--most N]

The program is one with MPI (tools/build.sh mpi). Leaves the decks, their runs and runs.csv in FOLDER.
"""
import argparse
import csv
import os
import pathlib
import re
import subprocess
import sys
import time

import numpy as np

from slideline_tools import UserError
from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes import collision, collision_grids
from slideline_tools.scenes.common import elastic, part, plane_strain

RANKS = (1, 2, 4, 8, 16, 32, 64)
CYCLES = 10
COST_CYCLES = (20, 220)  # the difference is what cycles take
REPEATS = 3
LEVEL = 8                # of the collision
STEP = 1.0e-7            # of the collision at level 1, s
EXCHANGE = re.compile(r"messages (\S+) \((\S+)\), bytes (\S+) \((\S+)\), calls of all (\S+) \(\S+\), "
                      r"bytes by them (\S+) \(\S+\)")
NAMES = ("scene", "elements", "ranks", "cycles", "messages", "most_messages", "bytes", "most_bytes", "calls",
         "bytes_to_all", "processor_seconds", "kilobytes")
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_mpi_yield_when_idle": "1", "OMP_WAIT_POLICY": "passive"}


def ring_mesh(around, across):
    """Nodes and quads of a ring of radii 0.8 to 1."""
    angle = 2.0 * np.pi * np.arange(around) / around
    radius = np.linspace(0.8, 1.0, across + 1)
    points = np.stack([np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius)], axis=-1).reshape(-1, 2)
    node = np.arange(around * (across + 1)).reshape(around, across + 1)
    following = np.roll(node, -1, axis=0)
    quads = np.stack([node[:, :-1], node[:, 1:], following[:, 1:], following[:, :-1]], axis=-1).reshape(-1, 4)
    return points, quads


def grid_mesh(columns, rows, width, height):
    """Nodes and quads of a rectangle."""
    grid = Grid(spaced((0.0, width, columns)), spaced((0.0, height, rows)), first_node=0)
    return grid.points.reshape(-1, 2), grid.quads.reshape(-1, 4)


MESHES = {  # one body without contact each
    "square": lambda: grid_mesh(200, 200, 1.0, 1.0),
    "bar": lambda: grid_mesh(1600, 25, 64.0, 1.0),
    "ring": lambda: ring_mesh(1000, 40),
}
COSTS = {"square, 40 000": 200, "square, 160 000": 400}  # columns and rows


def body(points, quads, title):
    """The deck of an elastic body that two nodes hold and that turns."""
    deck = Deck(title)
    deck.parameters(("cycles", CYCLES, "cycles of the run"))
    deck.keyword("CONTROL_TERMINATION").card("endtim endcyc", 1.0, "&cycles")
    plane_strain(deck, 1)
    elastic(deck, 1, 1000.0, 1.0e6, 0.3)
    part(deck, 1, "body", 1, 1)
    deck.nodes(np.arange(1, len(points) + 1), points)
    deck.quads(np.arange(1, len(quads) + 1), 1, quads + 1)
    deck.node_set(1, "held", [1]).spc_set(1, True, True)
    deck.database(glstat=1.0)
    return deck.text()


def write_decks(folder):
    """{scene: (deck, elements)}."""
    found = {}
    for name, mesh in MESHES.items():
        points, quads = mesh()
        found[name] = (body(points, quads, name), len(quads))
    for name, n in COSTS.items():
        points, quads = grid_mesh(n, n, 1.0, 1.0)
        found[name] = (body(points, quads, name), len(quads))
    text = collision(LEVEL, 5)
    found["collision"] = (text, sum(grid.element.size for grid in collision_grids(LEVEL)))
    for name, (text, _) in found.items():
        (folder / f"{in_file(name)}.k").write_text(text, encoding="ascii")
    return found


def in_file(name):
    """A name without blanks and commas."""
    return name.replace(",", "").replace(" ", "_")


def run(program, folder, scene, ranks, cycles):
    """One run; its figures by name."""
    out = folder / f"{in_file(scene)}_{ranks}_{cycles}"
    length = f"p:endtim={cycles * STEP / LEVEL}" if scene == "collision" else f"p:cycles={cycles}"
    words = [program, f"i={folder / in_file(scene)}.k", f"d={out}", "jobid=job", length]
    if ranks > 1:
        words = ["mpirun", "--oversubscribe", "-n", str(ranks), *words]
    with open(folder / "said.txt", "w", encoding="utf-8") as said:
        process = subprocess.Popen(words, stdout=said, stderr=said, env={**os.environ, **ENVIRONMENT})
        peak = follow_memory(process.pid)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise UserError(f"{scene} on {ranks} processes failed:\n{(folder / 'said.txt').read_text()}")
    counted = EXCHANGE.search((out / "job.log").read_text(encoding="utf-8"))
    alone = ranks == 1  # what the launcher uses says nothing
    return [ranks, cycles, *(counted.groups() if counted else [0] * 6), used.ru_utime if alone else "",
            peak if alone else ""]


def follow_memory(pid):
    """Largest resident memory of a process in kB, looked at while it runs (the system's own figure remembers its parent)."""
    peak = 0
    while True:
        try:
            told = pathlib.Path(f"/proc/{pid}/status").read_text(encoding="ascii")
        except OSError:
            return peak
        if "zombie" in told:
            return peak
        peak = max([peak, *map(int, re.findall(r"VmHWM:\s+(\d+)", told))])
        time.sleep(0.005)


def measure(program, folder, most):
    """All runs, those of costs some times; runs.csv."""
    decks = write_decks(folder)
    rows = []
    for scene, (_, elements) in decks.items():
        plan = [(1, cycles) for cycles in REPEATS * COST_CYCLES] if scene in COSTS else [
            (ranks, CYCLES) for ranks in RANKS if ranks <= most]
        for ranks, cycles in plan:
            print(f"== {scene}, {ranks} processes, {cycles} cycles", flush=True)
            rows.append([scene, elements, *run(program, folder, scene, ranks, cycles)])
    with open(folder / "runs.csv", "w", newline="", encoding="utf-8") as stream:
        csv.writer(stream).writerows([NAMES, *rows])


def main(arguments=None):
    """Returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--program", required=True)
    parser.add_argument("--most", type=int, default=RANKS[-1], help="processes (64)")
    options = parser.parse_args(arguments)
    options.folder.mkdir(parents=True, exist_ok=True)
    try:
        measure(options.program, options.folder, options.most)
    except UserError as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
