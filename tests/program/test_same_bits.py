# SPDX-License-Identifier: MIT
"""The same bits at any number of threads and on every repeat: every scene with every type.

End times are short and meshes fine enough for several tiles of 512 elements, which is what threads share;
the scenes come into contact within the run. Every table and every dataset is compared byte for byte.
A long interface is shared by threads as well. The checked Debug build, many times slower, runs one type with one and two threads; where SLIDELINE_FULL is not 1
each scene has some of the types and three of the numbers of threads, in turn.
"""
import importlib
import os
import subprocess

import h5py
import numpy as np
import pytest
from conftest import by_turns, is_full
from erosion_decks import penetration
from impact_decks import plates
from meshes import Deck, divide, grid, rotate
from axisymmetric_decks import rings

from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.scenes import block, collision, hertz, oblique, patch, patch_grids
from slideline_tools.scenes import symmetric_plate
from slideline_tools.scenes.patch import even_lines

TYPES = ALL_TYPES
THREADS = (1, 2, 3, 4, 3)  # the last one is a repeat
FEW_THREADS = ((1, 3, 2), (1, 4, 3), (1, 3, 3))
DEBUG_TYPE, DEBUG_THREADS = 7, (1, 2)
# Threads beyond the cores wait asleep, or the test would take minutes.
ENVIRONMENT = {**os.environ, "OMP_WAIT_POLICY": "passive"}


def fast_sliding(kind):
    """The sliding scene with its strokes in microseconds, so that some hundred steps hold both."""
    scene = importlib.import_module("slideline_tools.scenes.sliding")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(scene, "PRESS", (0.0, 3.0e-6, -0.02e-3))
        patched.setattr(scene, "DRAW", (2.0e-6, 5.0e-6, 0.5e-3))
        return scene.sliding(2, kind)


def long_interface(kind):
    """Blocks with so many segments that threads share the contact of them."""
    return block(kind, n_slave=1201, n_master=1200)


def fine_patch(kind):
    return patch(kind, grids=patch_grids(even_lines(24), even_lines(22)))


def everything(kind):
    """Two bodies on many tiles under all that acts from outside: gravity, damping, pressure, nodal
    forces, prescribed motion; the pressed upper body yields."""
    deck = Deck("everything that acts")
    deck.control(0.004, scale=0.6).hourglass(4, 0.1)
    deck.part(1).plastic(1000.0, 1.0e6, 0.3, 2.0e3, 1.0e5, 0.5, 1)
    deck.part(2).elastic(1000.0, 1.0e6, 0.3, 2)
    upper = deck.mesh(*grid(61, 21, 0.6, 0.2, (0.2, 0.0)), part=1)
    lower = deck.mesh(*grid(80, 24, 1.0, 0.3, (0.0, -0.3)), part=2)
    deck.node_set(2, upper[:62]).node_set(3, lower[-81:][::-1])
    deck.contact(2, 3, kind, 2.0e4, gauss=3)
    deck.fix(lower[:81], y=1)
    deck.curve(1, [(0.0, 9.81), (0.002, 20.0), (1.0, 20.0)]).curve(2, [(0.0, 10.0), (1.0, 20.0)])
    deck.curve(3, [(0.0, 0.0), (0.002, 0.2), (1.0, 0.2)]).curve(4, [(0.0, 5.0e3), (1.0, 5.0e3)])
    deck.add("*LOAD_BODY_Y", (1, 1.0)).add("*LOAD_BODY_X", (1, 0.1))
    deck.add("*DAMPING_GLOBAL", (2, 0.0))
    top = upper[-62:].tolist()
    deck.add("*LOAD_SEGMENT", *[(4, 1.0, 0.0, b, a, a, a) for a, b in zip(top[:-1], top[1:])])
    deck.add("*LOAD_NODE_POINT", (top[0], 1, 4, 0.001), (top[-1], 1, 4, -0.0005))
    for node in lower[:81:10]:
        deck.prescribe(node, 1, 0, 3)
    return deck.output(plot=0.002, glstat=1.0e-4, matsum=1.0e-4, rcforc=1.0e-4, nodout=1.0e-4,
                       nodes=[1, 30, int(lower[-1])]).text()


def anvil(kind):
    """A rigid body falls turned upon a soft one, which falls upon a rigid wall: nodes of walls and rigid bodies on many tiles."""
    deck = Deck("rigid body, soft body and wall")
    deck.control(0.06, scale=0.6)
    deck.part(1).elastic(1000.0, 1.0e6, 0.3)
    deck.part(2).add("*MAT_RIGID", (2, 3000.0, 1.0e6, 0.3), (0.0,))
    turned = rotate(grid(61, 21, 0.6, 0.2)[0], 0.01) + np.array([0.2, 0.302])
    upper = deck.mesh(turned, grid(61, 21, 0.6, 0.2)[1], part=2)
    lower = deck.mesh(*grid(80, 24, 1.0, 0.3), part=1)
    deck.node_set(2, upper[:62]).node_set(3, lower[-81:][::-1])
    deck.contact(2, 3, kind, 2.0e4, gauss=3)
    deck.add("*INITIAL_VELOCITY", (0,), (0.1, -2.0))
    deck.add("*RIGIDWALL_PLANAR", (0,), (0.0, -0.001, 0.0, 0.02, 0.999, 0.0))
    deck.add("*DATABASE_RWFORC", (1.0e-3,))
    return deck.output(plot=0.02, glstat=1.0e-3, matsum=1.0e-3, rcforc=1.0e-3).text()


def hanging(kind):
    """Two bodies with small elements at the contact, by chance elsewhere too, on a wall and a support, with gravity, pressure,
    damping of a part and a motion: hanging nodes on many tiles, between them and within."""
    deck = Deck("hanging nodes").control(0.02, scale=0.8)
    bodies, rng = [], np.random.default_rng(5)
    for part, mesh in enumerate((grid(30, 20, 0.6, 0.3, (0.2, 0.0)), grid(40, 20, 1.0, 0.3, (0.0, -0.3))), 1):
        coordinates, quads = mesh
        marked = {k for k, quad in enumerate(quads) if np.any(coordinates[list(quad), 1] == 0.0)}
        marked |= {k for k in rng.permutation(len(quads))[:150].tolist() if np.abs(coordinates[quads[k][0], 1] + 0.16) < 0.1 or part == 1}
        coordinates, quads, pairs = divide(coordinates, quads, marked)
        deck.part(part).elastic(1000.0, 1.0e6, 0.3, part)
        bodies.append((deck.mesh(coordinates, quads, part=part), coordinates))
        deck.hang(bodies[-1][0], pairs)
    (upper, above), (lower, below) = bodies
    faces = [ids[np.flatnonzero(x[:, 1] == 0.0)[np.argsort(x[x[:, 1] == 0.0, 0])]] for ids, x in bodies]
    deck.node_set(1, upper).node_set(2, faces[0]).node_set(3, faces[1][::-1]).node_set(4, lower)
    deck.contact(2, 3, kind, 2.0e4).add("*INITIAL_VELOCITY", (1,), (0.1, -1.0))
    deck.add("*RIGIDWALL_PLANAR", (4,), (0.0, -0.3, 0.0, 0.0, 0.7, 0.0)).add("*DATABASE_RWFORC", (1.0e-3,))
    deck.curve(1, [(0.0, 10.0), (1.0, 10.0)]).add("*LOAD_BODY_Y", (1,)).add("*DAMPING_PART_MASS", (2, 1))
    top = upper[np.flatnonzero(above[:, 1] == 0.3)[np.argsort(above[above[:, 1] == 0.3, 0])]].tolist()
    deck.add("*LOAD_SEGMENT", *[(1, 10.0, 0.0, b, a, a, a) for a, b in zip(top[:-1], top[1:])])
    deck.fix(upper[above[:, 0] == 0.2], x=1)
    for node in lower[below[:, 0] == 1.0]:
        deck.prescribe(node, 1, 0, 1, 1.0e-2)
    deck.add("*DATABASE_ERROR_INDICATOR")
    return deck.output(plot=5.0e-3, glstat=5.0e-4, matsum=5.0e-4, rcforc=5.0e-4).text()


SCENES = {
    "hanging nodes": (hanging, ()),
    "collision": (lambda kind: collision(2, kind),
                  ("endtim=1e-5", "p:dtplot=5e-6", "p:dthist=1e-6")),
    "sliding": (fast_sliding, ("endtim=6e-6", "p:dtplot=3e-6", "p:dthist=1e-6", "p:dtforc=1e-7")),
    "block": (lambda kind: block(kind, n_slave=151, n_master=150), ("endtim=0.1", "dt=5e-4")),
    "long interface": (long_interface, ("endtim=0.02", "dt=2e-4")),
    "long interface with friction": (long_interface, ("endtim=0.02", "dt=2e-4", "fs=0.3", "vdc=10")),
    "patch": (fine_patch, ("endtim=0.3", "p:dtplot=0.05")),
    "hertz": (lambda kind: hertz(1, kind), ("endtim=6e-6", "p:dthist=1e-6", "p:dtplot=2e-6")),
    "oblique": (oblique, ("endtim=0.06",)),
    "collision with friction": (lambda kind: collision(2, kind), ("endtim=1e-5", "p:dtplot=5e-6", "p:dthist=1e-6",
                                                                  "fs=0.3", "fd=0.1", "dc=0.01")),
    "oblique with friction": (oblique, ("endtim=0.06", "fs=0.3")),
    "everything": (everything, ()),
    "anvil": (anvil, ()),
    "rings": (rings, ()),
    "static_patch": (lambda kind: patch(kind, static=True), ()),
}


def run(program, folder, text, words, name):
    """Run a deck into folder/name; the contents of all its tables and datasets."""
    (folder / "job.k").write_text(text, encoding="ascii")
    done = subprocess.run([program, "i=job.k", f"d={name}", *words], cwd=folder, env=ENVIRONMENT,
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr + done.stdout
    found = {path.name: path.read_bytes() for path in (folder / name).glob("*.csv")
             if "timing" not in path.name}
    with h5py.File(folder / name / "job.vtkhdf") as results:
        results.visititems(lambda key, item: found.update({key: item[()].tobytes()})
                           if isinstance(item, h5py.Dataset) else None)
    return found


@pytest.fixture(scope="module")
def is_debug(exe):
    """Whether the program is a Debug build."""
    return "Debug" in subprocess.run([exe, "--version"], check=True, capture_output=True, text=True).stdout


def check_same(program, is_debug, folder, text, words, turn=0):
    """Run with every number of threads, or some of them; returns what the last run wrote."""
    numbers = DEBUG_THREADS if is_debug else THREADS if is_full() else FEW_THREADS[turn % len(FEW_THREADS)]
    runs = [run(program, folder, text, (*words, f"ncpu={threads}", "perthread=1"), f"run_{k}")
            for k, threads in enumerate(numbers)]
    for threads, found in zip(numbers[1:], runs[1:]):
        assert found.keys() == runs[0].keys()
        different = [name for name in found if found[name] != runs[0][name]]
        assert not different, f"{threads} threads"
    return runs[-1]


def last_force(found):
    """The largest force component of the last row of the table of contact forces."""
    _, _, _, f_x, f_y, _ = found["job.rcforc.csv"].split()[-1].split(b",")
    return max(abs(float(f_x)), abs(float(f_y)))


CASES = [(scene, DEBUG_TYPE) for scene in SCENES] if os.environ.get("SLIDELINE_BUILD") == "Debug" else by_turns(
    [(scene, kind) for scene in SCENES for kind in TYPES], release=2)


@pytest.mark.parametrize("scene, kind", CASES)
def test_scene_has_the_same_bits(exe, is_debug, tmp_path, scene, kind):
    write, words = SCENES[scene]
    found = check_same(exe, is_debug, tmp_path, write(kind), words, CASES.index((scene, kind)))
    assert last_force(found) > 0.0, "no contact in this run"
    if scene == "anvil":
        head, *_, last = (line.split(b",") for line in found["job.rwforc.csv"].splitlines())
        assert int(last[head.index(b"n_active")]) > 0, "no node on the wall"


@pytest.mark.parametrize("elastoplastic", [False, True])
def test_plate_has_the_same_bits(exe, is_debug, tmp_path, elastoplastic):
    text = symmetric_plate(64, 16, elastoplastic=elastoplastic)
    found = check_same(exe, is_debug, tmp_path, text, ("endtim=0.03", "p:dtplot=1e-2"))
    plate = np.frombuffer(found["VTKHDF/PointData/velocity"])
    assert np.abs(plate).max() > 0.0


@pytest.mark.parametrize("points", [None, 4])
def test_impact_has_the_same_bits(exe, is_debug, tmp_path, points):
    """Materials that remember energy, temperature and damage."""
    found = check_same(exe, is_debug, tmp_path, plates(3, points=points), ())
    damage = np.frombuffer(found["VTKHDF/CellData/damage"])
    assert damage.max() >= 1.0 and np.frombuffer(found["VTKHDF/CellData/temperature"]).max() > 310.0


def test_implicit_penalty_has_the_same_bits(exe, is_debug, tmp_path):
    """Contact forces that follow all others, on one thread between two pieces of work of all."""
    found = check_same(exe, is_debug, tmp_path, collision(2, 7), ("endtim=7.5e-6", "p:dtplot=5e-6", "p:dthist=1e-6", "punit=4", "pen=10"))
    assert last_force(found) > 0.0, "no contact in this run"


@pytest.mark.parametrize("is_self", [False, True])
def test_erosion_has_the_same_bits(exe, is_debug, tmp_path, is_self):
    """Elements leave the mesh, and surfaces of contact follow."""
    found = check_same(exe, is_debug, tmp_path, penetration(5, is_self=is_self, n=16), ())
    assert np.frombuffer(found["VTKHDF/CellData/eroded"]).sum() > 5.0
    # Of a surface with itself both sides feel all forces, and these add up to nothing.
    assert is_self or last_force(found) > 0.0, "no contact behind what has gone"


@pytest.mark.parametrize("kind", [1, 7])
def test_energies_do_not_depend_on_what_else_is_written(slideline, tmp_path, kind):
    """Motion of all nodes is kept for plot states and histories of nodes, velocities for sums of parts, and nothing
    where energies alone are asked for."""
    tables = []
    for name, others in (("alone", {}), ("parts", {"matsum": 1.0e-3}), ("states", {"plot": 1.0e-3}),
                         ("nodes", {"nodout": 1.0e-3, "nodes": [1, 30]})):
        deck = Deck("two blocks")
        deck.control(0.01, dt=1.0e-4)
        deck.part(1).elastic(1000.0, 1.0e6, 0.3, 1)
        deck.part(2).plastic(1000.0, 1.0e6, 0.3, 2.0e4, 1.0e5, 0.5, 2)
        upper = deck.mesh(*grid(30, 21, 0.6, 0.4, (0.2, 0.002)), part=1)
        lower = deck.mesh(*grid(50, 20, 1.0, 0.4, (0.0, -0.4)), part=2)
        deck.node_set(1, upper).node_set(2, upper[:31]).node_set(3, lower[-51:][::-1])
        deck.fix(lower[:51], x=1, y=1)
        deck.add("*INITIAL_VELOCITY", (1,), (0.3, -2.0))
        deck.curve(1, [(0.0, 9.81), (10.0, 9.81)]).add("*LOAD_BODY_Y", (1, 1.0))
        deck.contact(2, 3, kind, 2.0e5)
        done = slideline(f"d={name}", deck=deck.output(glstat=1.0e-3, **others))
        assert done.returncode == 0, done.stderr + done.stdout
        tables.append((tmp_path / name / "job.glstat.csv").read_bytes())
    assert len(tables[0].splitlines()) > 8
    assert all(table == tables[0] for table in tables)
