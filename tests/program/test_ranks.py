# SPDX-License-Identifier: MIT
"""Explicit runs on several processes (MPI) write the files of one process, byte for byte.

The program is the one of the tests of a Release build where MPI is installed (slideline_mpi, named by
SLIDELINE_MPI): the objects of the ordinary program linked with the other module of src/parallel. One process of it
is held against two to eight, more than the machine may have. Each scene has another type and its own features:
loads, damping, gravity, walls, rigid bodies, points that fail, friction, axisymmetric bodies, elements that leave, one
surface with itself, masses that grow, all histories; there are more tiles than processes, and fewer.
"""
import contextlib
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import h5py
import pytest
from conftest import drop, numbers
from erosion_decks import penetration
from history_decks import busy_block
from impact_decks import plates
from meshes import Deck, grid
from axisymmetric_decks import rings
from test_contact_fineness import blow
from test_plane_stress import strip
from test_requests import wait_for
from test_same_bits import anvil, everything, hanging

from slideline_tools.scenes import block, collision

PROGRAM = os.environ.get("SLIDELINE_MPI", "")
LAUNCH = ["mpirun", "--oversubscribe", "-n"]
ENVIRONMENT = {**os.environ, "OMP_WAIT_POLICY": "passive", "OMPI_ALLOW_RUN_AS_ROOT": "1",
               "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}
pytestmark = pytest.mark.skipif(not PROGRAM or not shutil.which("mpirun"), reason="MPI is not installed")


def growing(kind):
    """A part is damped and gets mass as its elements are crushed; on a node more mass, with the damping of all alone."""
    deck = Deck("mass that grows")
    deck.control(0.01, scale=0.9)
    deck.add("*CONTROL_TIMESTEP", (0.0, 0.9, 0, 0.0, -2.2e-4))
    deck.part(1).elastic(1000.0, 1.0e6, 0.3)
    deck.part(2).plastic(1000.0, 1.0e6, 0.3, 1.0e4, 1.0e4, 0.5, 2)
    upper = deck.mesh(*grid(40, 20, 0.4, 0.2, (0.3, 0.0)), part=1)
    lower = deck.mesh(*grid(60, 24, 1.0, 0.24, (0.0, -0.24)), part=2)
    deck.node_set(1, upper).node_set(2, upper[:41]).node_set(3, lower[-61:][::-1])
    deck.contact(2, 3, kind, 2.0e5)
    deck.fix(lower[:61], x=1, y=1)
    deck.curve(1, [(0.0, 20.0), (1.0, 20.0)]).add("*DAMPING_PART_MASS", (1, 1))
    deck.add("*DAMPING_GLOBAL", (0, 5.0)).add("*ELEMENT_MASS", (1, int(upper[400]), 0.5), (2, int(lower[800]), 0.5))
    deck.add("*INITIAL_VELOCITY", (1,), (0.0, -12.0))
    return deck.output(plot=2.0e-3, glstat=2.0e-4, matsum=1.0e-3, rcforc=2.0e-4).text()


def settling():
    """Gravity and damping, whose work is summed over blocks of nodes, between a dozen tiles that nothing else touches."""
    deck = Deck("gravity and damping").control(0.01)
    deck.part(1).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(100, 60, 1.0, 0.6))
    deck.fix(nodes[:101], x=1, y=1)
    deck.curve(1, [(0.0, 10.0), (1.0, 10.0)]).add("*LOAD_BODY_Y", (1,))
    deck.curve(2, [(0.0, 20.0), (1.0, 20.0)]).add("*DAMPING_GLOBAL", (2,))
    deck.add("*INITIAL_VELOCITY", (0,), (1.0, -2.0))
    return deck.output(plot=2.0e-3, glstat=2.0e-4, matsum=1.0e-3).text()


def struck(is_axisymmetric):
    """A bar of bands of three materials, struck at one end: its tiles wake one after the other, with all that damping, points,
    hourglass forms, bulk viscosity and an equation of state remember."""
    n_x, n_y = 900, 12
    deck = Deck("a bar that is struck").add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_TIMESTEP", (0.0, 0.6))
    deck.hourglass(4, 0.05).add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    deck.add("*SECTION_SHELL", (1, 15 if is_axisymmetric else 13), (1.0,))
    deck.add("*SECTION_SHELL", (2, 15 if is_axisymmetric else 13, None, 4), (1.0,))
    deck.add("*PART", "copper", (1, 1, 1, 7)).add("*PART", "steel", (2, 2, 2)).add("*PART", "lead", (3, 1, 3))
    deck.add("*MAT_JOHNSON_COOK", (1, 8930.0, 46.0e9), (9.0e7, 2.92e8, 0.31, 0.025, 1.09, 1356.0, 293.0, 1.0),
             (383.0,), (0.0,))
    deck.add("*EOS_GRUNEISEN", (7, 3940.0, 1.489, 0.0, 0.0, 1.99, 0.47), (1.0,))
    deck.plastic(7850.0, 2.1e11, 0.3, 2.0e8, 1.0e9, 0.5, 2).elastic(11340.0, 1.6e10, 0.42, 3)
    coordinates, quads = grid(n_x, n_y, 0.9, 0.012, (0.1, 0.0))
    coordinates[450::n_x + 1, 0] += 0.0004  # the step is that of elements in a tile that sleeps
    deck.add("*NODE", *[(k + 1, x, y) for k, (x, y) in enumerate(coordinates)])
    deck.add("*ELEMENT_SHELL", *[(k + 1, 1 + k % n_x // 15 % 3, *[node + 1 for node in quad]) for k, quad in enumerate(quads)])
    if not is_axisymmetric:
        deck.curve(2, [(0.0, 50.0), (1.0, 50.0)]).add("*DAMPING_GLOBAL", (2,)).add("*DAMPING_PART_STIFFNESS", (3, 0.1))
    deck.node_set(1, [1 + i + j * (n_x + 1) for j in range(n_y + 1) for i in range(6)]).add("*INITIAL_VELOCITY", (1,), (30.0, 9.0))
    return deck.output(plot=1.5e-5, glstat=3.0e-6, matsum=3.0e-6).text()


def two_blocks(kind, depth, speed):
    """A block that flies into another, or lies in it by several elements: then the first search finds nodes inside of bodies.
    Nothing makes processes start from all of the model, as masses that grow do."""
    deck = Deck("two blocks").control(0.01, scale=0.8)
    for part in (1, 2):
        deck.part(part).elastic(1000.0, 1.0e6, 0.3, part)
    upper = deck.mesh(*grid(40, 20, 0.4, 0.2, (0.3, -depth)), part=1)
    lower = deck.mesh(*grid(60, 24, 0.96, 0.24, (0.0, -0.24)), part=2)
    deck.node_set(1, upper).node_set(2, upper[:41]).node_set(3, lower[-61:][::-1]).contact(2, 3, kind, 2.0e4)
    deck.add("*INITIAL_VELOCITY", (1,), (0.3 * speed, -speed))
    return deck.output(plot=2.0e-3, glstat=2.0e-4, rcforc=2.0e-4).text()


def ended():
    """A row for every history, and a rigid body that ends the run."""
    return busy_block(fine=4).add("*TERMINATION_BODY", (2, 2, 1.0, -0.004)).text()


#: A program in between that leaves how much memory the process has taken at most, in kB. A launcher may lose what is said.
PEAK = """import os, resource, subprocess, sys
status = subprocess.call(sys.argv[1:])
with open(os.environ["OMPI_COMM_WORLD_RANK"] + ".peak", "w") as stream:
    stream.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
sys.exit(status)"""

#: scene -> (deck, cycles, processes, threads, words)
SCENES = {
    "rigid body and wall, type 2": (lambda: anvil(2), 60, (3,), 1),
    "points that fail, type 3": (lambda: plates(3), 90, (2,), 2),
    "friction, type 4": (lambda: collision(2, 4), 60, (3,), 2, "fs=0.3"),
    "one surface, type 5": (lambda: penetration(5, is_self=True, n=16), 330, (3,), 1),
    "elements that leave, type 5": (lambda: penetration(5, n=8), 330, (2,), 1),
    "plane stress, elements that leave": (lambda: strip(4, "plastic"), 330, (2,), 1),
    "hanging nodes, type 7": (lambda: hanging(7), 60, (3,), 2),
    "round, type 6": (lambda: rings(6), 60, (4,), 2),
    "mass that grows, type 7": (lambda: growing(7), 60, (2,), 1),
    "no contact, gravity": (settling, 60, (5,), 1),
    "tiles that wake, round": (lambda: struck(True), 260, (2,), 2),
    "histories and an end before its time, type 3": (ended, 60, (3,), 1),
    "penalty and step by default": (lambda: blow("*CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE", ("steel", 16, 20, 0.4),
                                                 ("brass", 160, 12, 0.2), end=2.0e-7), 60, (3,), 1),
    "bodies in each other, type 3": (lambda: two_blocks(3, 0.035, 0.0), 60, (2, 3), 1),
    "implicit springs, type 7": (lambda: two_blocks(7, 0.0, 6.0), 60, (2, 3), 1, "punit=4", "pen=10", "fs=0.3"),
}


def with_cycles(text, cycles, dump=None):
    """A deck of so many cycles, and with restart files."""
    text = text if isinstance(text, str) else text.text()
    text = re.sub(r"(\*CONTROL_TERMINATION\n(?:\$.*\n)*) *([^\s,]+).*\n", rf"\g<1>\g<2>,{cycles}\n", text, count=1)
    return text.rsplit("*END", 1)[0] + (f"*DATABASE_BINARY_D3DUMP\n{dump},\n" if dump else "") + "*END\n"


def run(folder, processes, *words, status=0, program=(PROGRAM,)):
    """The program on so many processes; what it says."""
    # Launchers that start at the same time get into each other's way in one folder.
    environment = {**ENVIRONMENT, "OMPI_MCA_orte_tmpdir_base": str(folder)}
    done = subprocess.run([*LAUNCH, str(processes), *program, *words, "perthread=1"], cwd=folder, env=environment,
                          capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == status, done.stderr + done.stdout
    return done


def contents(folder):
    """All files but what tells of the run itself: tables and deck as bytes, datasets of the others."""
    found = {path.name: path.read_bytes() for path in folder.iterdir()
             if path.suffix not in (".log", ".out", ".vtkhdf", ".h5") and "timing" not in path.name}
    for path in (*folder.glob("*.vtkhdf"), *folder.glob("*.h5")):
        with h5py.File(path) as stream:
            stream.visititems(lambda name, item, path=path: found.update(
                {f"{path.name}/{name}": (item.shape, item[()].tobytes() if item.shape else str(item[()]))})
                if isinstance(item, h5py.Dataset) else None)
    return found


def log_of(folder):
    """What the log says of the run: not the command, its times and its build."""
    lines = next(folder.glob("*.log")).read_text().splitlines()
    end = next(i for i, line in enumerate(lines) if line.startswith(" *** "))
    return [line for line in lines[:end + 1]
            if "command line" not in line and not line.startswith(("restart file", "exchange:"))]


def assert_same(one, other):
    first, second = contents(one), contents(other)
    assert len(first) > 20 and first.keys() == second.keys()
    assert not [name for name in first if first[name] != second[name]]
    assert log_of(one) == log_of(other)


@pytest.mark.parametrize("scene", SCENES)
def test_files_are_those_of_one_process(tmp_path, scene):
    make, cycles, processes, threads, *words = SCENES[scene]
    (tmp_path / "job.k").write_text(with_cycles(make(), cycles), encoding="ascii")
    run(tmp_path, 1, "i=job.k", "d=one", *words)
    for n in processes:
        done = run(tmp_path, n, "i=job.k", f"d=on{n}", f"ncpu={threads}", *words)
        assert done.stdout.count("N o r m a l") == 1, "more than one process speaks"
        assert_same(tmp_path / "one", tmp_path / f"on{n}")
    log = "\n".join(log_of(tmp_path / "one"))
    assert "wake" not in scene or "steps of tiles: " in log
    assert "leave" not in scene or "eroded elements: " in log
    assert "fail" not in scene or "failed point" in log
    assert ("end before" in scene) == ("*TERMINATION_BODY" in log)
    assert ("by default" in scene) == ("the time step follows its springs" in log)
    assert "in each other" not in scene or "deepest at node 1: 3.500000E-02" in log
    assert ("implicit springs" in scene) == ("penalty: implicit springs of" in log)
    if "grows" in scene:
        added = numbers(tmp_path / "one" / "job.glstat.csv", "added_mass")
        assert added[-1] > added[0]


def test_two_stages(tmp_path):
    """The file for the second stage, and what that makes of it, on any number of processes."""
    text = with_cycles(two_blocks(5, 0.0, 6.0), 60).replace("*END", "*INTERFACE_SPRINGBACK_LSDYNA\n0,\n*END")
    (tmp_path / "job.k").write_text(text, encoding="ascii")
    (tmp_path / "next.k").write_text(re.sub(r"\*(NODE|ELEMENT_SHELL)\n[^*]*", "", text).replace(
        "*END", "*INCLUDE\non3/job.dynain\n*END"), encoding="ascii")
    for deck, processes in (("job", 3), ("next", 2)):
        run(tmp_path, 1, f"i={deck}.k", f"d={deck}_one")
        run(tmp_path, processes, f"i={deck}.k", f"d=on{processes}")
        assert_same(tmp_path / f"{deck}_one", tmp_path / f"on{processes}")
    first, second = [(tmp_path / path).read_text().split("*INITIAL_STRESS_SHELL") for path in ("on3/job.dynain", "on2/next.dynain")]
    assert len(first) == len(second) == 2 and first[1] != second[1]


def test_restart_files_go_from_two_processes_to_three(tmp_path):
    (tmp_path / "job.k").write_text(with_cycles(everything(1), 40, 20), encoding="ascii")
    run(tmp_path, 1, "i=job.k", "d=one")
    run(tmp_path, 2, "i=job.k", "d=two")
    assert_same(tmp_path / "one", tmp_path / "two")
    (tmp_path / "rest").mkdir()
    for name in ("job.dump01.h5", "job.vtkhdf"):
        shutil.copy(tmp_path / "two" / name, tmp_path / "rest")
    run(tmp_path, 3, "r=rest/job.dump01.h5", "ncpu=2")
    one, rest = contents(tmp_path / "one"), contents(tmp_path / "rest")
    assert len(rest) > 20 and not [name for name in rest if rest[name] != one[name]]


def test_a_run_that_goes_on_reports_soft_springs_once(tmp_path):
    """Estimates come from the file on each process; the parts of all elements are known to the first alone."""
    examples = pathlib.Path(__file__).parents[2] / "doc/examples"
    shutil.copytree(examples / "parts", tmp_path / "parts")
    deck = (examples / "contact_2d_slideline_chosen.k").read_text(encoding="ascii")
    (tmp_path / "job.k").write_text(with_cycles(deck, 90, 42), encoding="ascii")
    run(tmp_path, 1, "i=job.k", "d=one")
    (tmp_path / "rest").mkdir()
    shutil.copy(tmp_path / "one" / "job.dump01.h5", tmp_path / "rest")
    run(tmp_path, 2, "r=rest/job.dump01.h5")
    last = [(tmp_path / name / "job.rcforc.csv").read_text().splitlines()[-1] for name in ("one", "rest")]
    assert last[0] == last[1]


def test_restart_files_go_from_three_processes_to_eight(tmp_path):
    """Nodes between the tiles of others are as old as the start where they have not been gathered."""
    (tmp_path / "job.k").write_text(with_cycles(settling(), 40, 20), encoding="ascii")
    run(tmp_path, 1, "i=job.k", "d=one")
    run(tmp_path, 3, "i=job.k", "d=rest")
    for name in ("job.dump02.h5", "job.dump03.h5"):
        (tmp_path / "rest" / name).unlink(missing_ok=True)
    run(tmp_path, 8, "r=rest/job.dump01.h5")
    one, rest = contents(tmp_path / "one"), contents(tmp_path / "rest")
    assert len(rest) > 20 and not [name for name in rest if rest[name] != one[name]]


def test_restart_files_of_tiles_that_wake(tmp_path):
    """Tiles of the bar wake in the first run and in the one that goes on, on other processes."""
    (tmp_path / "job.k").write_text(with_cycles(struck(False), 200, 140), encoding="ascii")
    run(tmp_path, 1, "i=job.k", "d=one")
    run(tmp_path, 3, "i=job.k", "d=rest")
    assert_same(tmp_path / "one", tmp_path / "rest")
    (tmp_path / "rest" / "job.dump02.h5").unlink()
    run(tmp_path, 2, "r=rest/job.dump01.h5")
    one, rest = contents(tmp_path / "one"), contents(tmp_path / "rest")
    assert one.keys() == rest.keys() and not [name for name in rest if rest[name] != one[name]]


def test_forces_go_to_neighbours_alone(tmp_path):
    """The bytes that are counted are those of the nodes between the parts: 16 a node and tile, from each to the others."""
    deck = Deck("a strip").control(0.01)
    deck.part(1).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(2048, 2, 204.8, 0.2))
    deck.fix(nodes[::2049], x=1, y=1)
    (tmp_path / "job.k").write_text(with_cycles(deck.output(plot=1.0, glstat=1.0).text(), 10), encoding="ascii")
    run(tmp_path, 8, "i=job.k", "d=out")
    reported = re.search(r"messages (\S+) \((\S+)\), bytes (\S+) \((\S+)\), calls of all 1.00 \(1.00\), bytes by them 80.00 \(80.00\)",
                     (tmp_path / "out" / "job.log").read_text())
    # Eight tiles side by side, each with a column of three nodes in common with the next.
    assert [float(word) for word in reported.groups()] == [14 / 8, 2.0, 14 * 48 / 8, 96.0]


def test_an_error_ends_all_processes_and_is_reported_once(tmp_path):
    """A run that goes wrong, a deck that is refused and a method that has one process."""
    deck = Deck("crushed").control(0.02)
    deck.part(1).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(60, 40, 0.6, 0.4))
    deck.curve(1, [(0.0, 0.0), (0.01, -30.0), (1.0, -30.0)])
    deck.fix(nodes[:61], x=1, y=1)
    for node in nodes[-61:]:
        deck.prescribe(int(node), 2, 0, 1)
    (tmp_path / "job.k").write_text(deck.output(glstat=1.0e-3).text(), encoding="ascii")
    said = [run(tmp_path, n, "i=job.k", f"d=crushed_{n}", status=2) for n in (1, 3)]
    reported = [[line for line in done.stderr.splitlines() if "element" in line] for done in said]
    assert len(reported[0]) == 1 and reported[0] == reported[1], said
    (tmp_path / "bad.k").write_text("*KEYWORD\n*PART\n", encoding="ascii")
    done = run(tmp_path, 3, "i=bad.k", status=1)
    assert done.stderr.count("bad.k") == run(tmp_path, 1, "i=bad.k", status=1).stderr.count("bad.k")
    text = block(2, implicit=True)
    (tmp_path / "implicit.k").write_text(text if isinstance(text, str) else text.text(), encoding="ascii")
    assert "implicit runs have one" in run(tmp_path, 2, "i=implicit.k", "d=none", status=1).stderr
    assert not (tmp_path / "none").exists()


def test_a_disk_that_takes_no_more_ends_all_processes(tmp_path):
    (tmp_path / "job.k").write_text(with_cycles(everything(3), 40), encoding="ascii")
    limited = ["sh", "-c", "ulimit -f 300; trap '' XFSZ; exec \"$@\"", "sh", PROGRAM]
    said = run(tmp_path, 2, "i=job.k", "d=full", program=limited, status=3).stderr
    assert said.count("full/job.") == 1, said


#: All but the first process run in a folder of their own, where there is nothing.
FIRST_ALONE = ["sh", "-c", 'test "$OMPI_COMM_WORLD_RANK" = 0 || { mkdir -p "aside$OMPI_COMM_WORLD_RANK" && '
               'cd "aside$OMPI_COMM_WORLD_RANK"; }; exec "$@"', "sh", PROGRAM]


def test_the_first_process_alone_reads_the_deck(tmp_path):
    """Its include files and its mistakes as well."""
    (tmp_path / "fast.inc").write_text("*INITIAL_VELOCITY\n1,\n0.3,-3.0\n")
    deck = re.sub(r"\*INITIAL_VELOCITY\n.*\n.*\n", "*INCLUDE\nfast.inc\n", drop(end_time=0.002).text())
    (tmp_path / "job.k").write_text(deck, encoding="ascii")
    run(tmp_path, 1, "i=job.k", "d=one")
    run(tmp_path, 3, "i=job.k", "d=several", program=FIRST_ALONE)
    assert_same(tmp_path / "one", tmp_path / "several")
    (tmp_path / "bad.k").write_text(deck.replace("fast.inc", "slow.inc"), encoding="ascii")
    said = run(tmp_path, 3, "i=bad.k", program=FIRST_ALONE, status=1).stderr
    assert said.count('*INCLUDE: the file "slow.inc" was not found') == 1, said
    assert len([*tmp_path.glob("aside?")]) == 2 and not [*tmp_path.glob("aside?/*")]


def test_a_process_that_is_not_the_first_never_has_the_mesh(tmp_path):
    """Its peak, an element of the model: a quarter of some 236 bytes and what all know of nodes between tiles. Nodes, elements
    and slots alone would be 80 more, at whatever number of processes."""
    peaks = []
    for n in (10, 300):
        deck = Deck("a square").control(1.0)
        deck.part(1).elastic(1000.0, 1.0e6, 0.3)
        deck.mesh(*grid(n, n, 1.0, 1.0))
        text = with_cycles(deck.output(plot=1.0, glstat=1.0).text(), 3)
        (tmp_path / "job.k").write_text(text, encoding="ascii")
        run(tmp_path, 4, "i=job.k", f"d=square{n}", program=[sys.executable, "-c", PEAK, PROGRAM])
        peaks.append([int((tmp_path / f"{rank}.peak").read_text()) for rank in range(4)])
        for rank in range(4):
            (tmp_path / f"{rank}.peak").unlink()
    for rank in (1, 2, 3):
        assert (peaks[1][rank] - peaks[0][rank]) * 1024 / 300**2 < 114, peaks
    assert (peaks[1][0] - peaks[0][0]) * 1024 / 300**2 > 200, peaks


@contextlib.contextmanager
def going_run(folder, processes):
    """A run of minutes that has begun to write, and its processes in the order of their numbers."""
    (folder / "job.k").write_text(everything(2).replace("0.004", "4.0", 1), encoding="ascii")
    command = [*LAUNCH, str(processes), PROGRAM, "i=job.k", "d=out", "endtim=4"]
    environment = {**ENVIRONMENT, "OMPI_MCA_orte_tmpdir_base": str(folder)}
    with subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
        table = folder / "out" / "job.glstat.csv"
        wait_for(lambda: table.exists() and table.stat().st_size > 2000, 60.0)
        children = subprocess.run(["pgrep", "-P", str(run.pid)], capture_output=True, text=True, check=True).stdout
        of_rank = {}
        for child in map(int, children.split()):
            reported = pathlib.Path(f"/proc/{child}/environ").read_bytes().split(b"\0")
            of_rank.update({int(word.partition(b"=")[2]): child for word in reported
                            if word.startswith(b"OMPI_COMM_WORLD_RANK=")})
        try:
            yield run, [of_rank[rank] for rank in range(processes)]
        finally:
            run.kill()


def test_signals_reach_the_run_through_any_process(tmp_path):
    """A restart file once though all hear of it, a plot state, and an end."""
    with going_run(tmp_path, 3) as (run, processes):
        out = tmp_path / "out"
        for process in processes:
            os.kill(process, signal.SIGUSR1)
        wait_for((out / "job.dump01.h5").exists)
        os.kill(processes[2], signal.SIGUSR2)
        time.sleep(1.2)
        assert not (out / "job.dump02.h5").exists()
        os.kill(processes[2], signal.SIGUSR1)
        wait_for((out / "job.dump02.h5").exists)
        os.kill(processes[1], signal.SIGTERM)
        assert run.wait(60) == 4
        assert "stopped on request" in run.stderr.read().decode()
    with h5py.File(out / "job.vtkhdf") as stream:
        times = stream["VTKHDF/Steps/Values"][()]
    # That which was asked for and the last one are not multiples of the interval.
    assert len(times) >= 3


def test_a_process_that_is_killed_ends_the_run_and_leaves_files_that_can_be_read(tmp_path):
    with going_run(tmp_path, 3) as (run, processes):
        os.kill(processes[2], signal.SIGKILL)
        assert run.wait(60) != 0
    out = tmp_path / "out"
    lines = (out / "job.glstat.csv").read_text().splitlines()
    assert len(lines) > 2 and all(line.count(",") == lines[0].count(",") for line in lines)
    with h5py.File(out / next(out.glob("*.vtkhdf*")).name) as stream:
        assert stream["VTKHDF/Steps"].attrs["NSteps"] >= 1
