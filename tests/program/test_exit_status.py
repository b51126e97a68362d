# SPDX-License-Identifier: MIT
"""Exit codes 0 to 4, what is said, and what is left on disk."""
import re
import resource
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
from conftest import drop, numbers
from meshes import Deck, grid

from slideline_tools.contact_types import ALL_TYPES

NORMAL = "N o r m a l    t e r m i n a t i o n"
ERROR = "E r r o r    t e r m i n a t i o n"


def test_normal_is_0(finished):
    folder, done = finished
    assert done.returncode == 0
    assert NORMAL in done.stdout
    assert ERROR not in done.stdout + done.stderr
    assert NORMAL in (folder / "drop.log").read_text()


def test_refused_deck_is_1(slideline, tmp_path):
    done = slideline("d=r", deck=drop(kind=9))
    assert done.returncode == 1
    assert NORMAL not in done.stdout
    assert "CONTACT_2D_SLIDELINE" in done.stderr
    for name in ("NTS", "NTS-AR", "two-pass"):
        assert name in done.stderr
    assert not list((tmp_path / "r").glob("*.vtkhdf"))


def test_refused_deck_says_how_it_ended(slideline, tmp_path):
    """A run does, refused or without a folder to write to; a check, a wrong word and --help are no runs."""
    (tmp_path / "taken").write_text("a file\n")
    (tmp_path / "wrong.k").write_text(drop(kind=9).text())
    for words, status in ((["i=wrong.k", "d=r"], 1), (["i=absent.k"], 1), (["r=absent.h5"], 1)):
        done = slideline(*words)
        assert (done.returncode, done.stdout) == (status, f" {ERROR}\n"), words
        assert done.stderr
    assert slideline("i=absent.k").stderr == "cannot read the deck absent.k: No such file or directory\n"
    done = slideline("d=taken", deck=drop())
    assert (done.returncode, done.stdout) == (3, f" {ERROR}\n")
    for words in (["check", "wrong.k"], ["check", "wrong.k", "--json"], ["wrong.k", "what=1"], ["--help"], []):
        assert ERROR not in slideline(*words).stdout, words
    assert not (tmp_path / "r").exists()


def check_reported_end(folder, done, status, reason):
    """An error after the log was opened: the reason on the screen and in the log, the ending, the timing table."""
    assert done.returncode == status, done.stderr
    assert reason in done.stderr
    log = (folder / "job.log").read_text()
    for said in (done.stdout, log):
        assert said.count(ERROR) == 1 and NORMAL not in said
        assert reason in said[:said.index(ERROR)]
    assert "total" in (folder / "job.timing.csv").read_text()


def test_no_room_for_an_automatic_penalty_is_reported(slideline, tmp_path):
    done = slideline("d=a", "punit=3", "pen=0.5", "tssfac=1.0", "dt=1.0", deck=drop())
    check_reported_end(tmp_path / "a", done, 1, "no automatic penalty (PUNIT 3) is stable")
    assert not list((tmp_path / "a").glob("*.vtkhdf*"))


def test_a_run_that_could_not_begin_leaves_nothing_of_the_run_before(slideline, tmp_path):
    assert slideline("d=a", deck=drop()).returncode == 0
    assert "normal termination" in (tmp_path / "a" / "status.out").read_text()
    assert slideline("d=a", "punit=3", "pen=0.5", "tssfac=1.0", "dt=1.0", deck=drop()).returncode == 1
    assert "error termination" in (tmp_path / "a" / "status.out").read_text()


@pytest.mark.parametrize("name", ["job.effective.k", "job.vtkhdf.part", "job.glstat.csv", "job.dump01.h5"])
def test_files_that_cannot_be_made_are_reported(slideline, tmp_path, name):
    """Names that are taken are looked at first: nothing is written, not even a log."""
    (tmp_path / "a" / name).mkdir(parents=True)
    done = slideline("d=a", deck=drop())
    assert done.returncode == 3 and f"a/{name}: it is a directory" in done.stderr, done.stderr
    assert ERROR in done.stdout and NORMAL not in done.stdout
    assert [path.name for path in (tmp_path / "a").iterdir()] == [name]


def test_inverted_element_is_2(slideline, tmp_path):
    deck = Deck("driven through itself")
    deck.control(1.0, dt=0.001).part().elastic(1.0e4, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(1, 1))
    deck.curve(1, [(0.0, 0.0), (1.0, -2.0)])
    deck.fix(nodes, y=1).fix(nodes[[0, 2]], x=1)
    for node in nodes[[1, 3]]:
        deck.prescribe(node, 1, 2, 1)
    deck.output(plot=0.1, glstat=0.1)
    done = slideline("d=x", deck=deck, timeout=20)
    assert done.returncode == 2
    assert ERROR in done.stdout + done.stderr
    assert NORMAL not in done.stdout
    assert "element" in done.stderr or "step" in done.stderr
    last = numbers(tmp_path / "x" / "job.glstat.csv", "time")[-1]
    assert 0.3 <= last <= 0.55
    with h5py.File(tmp_path / "x" / "job.vtkhdf") as stream:
        assert stream["VTKHDF/Steps"].attrs["NSteps"] >= 4


def test_energy_out_of_bounds_is_2(slideline):
    """ENDENG far below what an impact on a coarse mesh can keep; and a sane one."""
    for percent, status in (("1.0e-9", 2), ("5.0", 0)):
        text = drop().text().replace("*CONTROL_TERMINATION\n0.02,",
                                     f"*CONTROL_TERMINATION\n0.02,0,0.0,{percent}")
        done = slideline("d=e", deck=text)
        assert done.returncode == status, percent
        assert ("ENDENG" in done.stderr) == (status == 2)
        assert (ERROR in done.stdout + done.stderr) == (status == 2)


def test_contact_too_stiff_for_the_step_is_warned_of(slideline, tmp_path):
    done = slideline("d=p", "pen=1.0e10", deck=drop())
    said = (done.stderr + (tmp_path / "p" / "job.log").read_text()).lower()
    assert "warning" in said and "contact" in said and "step" in said
    done = slideline("d=q", deck=drop())
    assert "warning" not in done.stderr.lower()


def test_energy_that_contact_created_is_warned_of(slideline, tmp_path):
    """An interface that is born deep holds energy that nothing put in: the warning names the sum of the table."""
    deck = drop(penalty=3.0e6).add("*DATABASE_SLEOUT", (1.0e-3,))
    deck.lines = [line.replace("0.0,1e+20,0", "0.004,1e+20,0") for line in deck.lines]
    done = slideline("d=p", deck=deck)
    created = numbers(tmp_path / "p" / "job.sleout.csv", "energy")[-1] - numbers(tmp_path / "p" / "job.sleout.csv", "stored")[-1]
    in_all = numbers(tmp_path / "p" / "job.glstat.csv", "contact")[-1]
    assert in_all == pytest.approx(numbers(tmp_path / "p" / "job.sleout.csv", "energy")[-1], rel=1e-12)
    said = re.search(r"warning: interface 1: in the whole run the contact springs created energy: (\S+),", done.stderr)
    assert created < 0.0 and said and float(said[1]) == pytest.approx(-created, rel=1e-6), done.stderr
    assert "springs created" not in slideline("d=q", deck=drop()).stderr


def bent_beam(points):
    """A clamped beam, one element thick, that swings: elements of one point bend by hourglasses alone."""
    deck = Deck("beam").control(0.2, scale=0.8).hourglass(4, 0.1)
    deck.part(points=points).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(8, 1, 2.0, 0.25)).reshape(2, 9)
    deck.fix(nodes[:, 0], x=1, y=1).node_set(1, nodes[:, -1])
    deck.add("*INITIAL_VELOCITY", (1,), (0.0, 0.5))
    return deck.output(plot=0.1, glstat=0.01)


@pytest.mark.parametrize("points", [1, 4])
def test_hourglass_energy_above_a_tenth_is_warned_of(slideline, tmp_path, points):
    done = slideline("d=h", deck=bent_beam(points))
    assert done.returncode == 0, done.stderr
    last = {name: numbers(tmp_path / "h" / "job.glstat.csv", name)[-1] for name in ("hourglass", "internal")}
    said = re.search(r"warning: the hourglass energy (\S+) is more than 10 % of the internal energy (\S+)", done.stderr)
    assert (last["hourglass"] > 0.1 * last["internal"]) == (points == 1), last
    assert bool(said) == (points == 1), done.stderr
    if said:
        assert [float(text) for text in said.groups()] == pytest.approx([last["hourglass"], last["internal"]], rel=1e-6)


def pushed_in(depth):
    """The drop with its blocks overlapping by `depth` at the start."""
    deck = Deck("overlap").control(0.002, dt=1.0e-4).part(1).elastic(1000.0, 1.0e6, 0.3)
    upper = deck.mesh(*grid(3, 2, 0.6, 0.4, (0.2, -depth)))
    lower = deck.mesh(*grid(5, 2, 1.0, 0.4, (0.0, -0.4)))
    deck.node_set(2, upper[:4]).node_set(3, lower[-6:][::-1]).fix(lower[:6], x=1, y=1)
    return deck.contact(2, 3, 1, 2.0e5).output(plot=0.001)


@pytest.mark.parametrize("depth", [0.0, 1.0e-9, 0.004])
def test_initial_penetration_is_one_warning(slideline, depth):
    """Four nodes, all as deep: warned of once, with a node and the depth; round-off is not."""
    done = slideline("d=i", deck=pushed_in(depth))
    assert done.returncode == 0, done.stderr
    found = re.findall(r"warning: interface 1: initial penetration at (\d+) points, deepest at "
                       r"node \d+: (\S+), contact force", done.stderr)
    assert [(int(n), float(d)) for n, d in found] == ([(4, depth)] if depth > 1.0e-3 else [])
    assert f"Warnings            = {len(found)}" in done.stdout


@pytest.mark.parametrize("kind", ALL_TYPES)
def test_initial_penetration_names_the_nearest_node(slideline, kind):
    """The block is tilted: its last node is the deepest, or the node next to the deepest point."""
    deck = pushed_in(0.004)
    for i in range(1, 13):
        place = next(k for k, line in enumerate(deck.lines) if line.startswith(f"{i},0."))
        number, x, y = deck.lines[place].split(",")
        deck.lines[place] = f"{number},{x},{float(y) - 0.02 * (float(x) - 0.2)!r}"
    done = slideline("d=i", f"ctype={kind}", deck=deck)
    assert re.search(r"initial penetration at \d+ points, deepest at node 4: ", done.stderr), done.stderr


def test_released_first_contacts_are_warned_of(slideline):
    """Born when the blocks overlap deeper than what is caught."""
    deck = pushed_in(0.12)
    place = deck.lines.index("*CONTACT_2D_SLIDELINE") + 2
    deck.lines[place] = "0.001" + deck.lines[place][deck.lines[place].index(","):]
    done = slideline("d=i", deck=deck)
    assert done.returncode == 0, done.stderr
    assert re.search(r"warning: interface 1: first contacts deeper than the limit were excluded: \d+; SRCH", done.stderr)
    assert "Warnings            = 1" in done.stdout


def driven_through(deck, start, drop):
    """A square of its own, far away, whose one side is driven by `drop` from the time `start` on."""
    nodes = deck.mesh(*grid(1, 1, 1.0, 1.0, (20.0, 0.0)))
    deck.curve(7, [(0.0, 0.0), (start, 0.0), (start + 2.0e-4, drop), (1.0, drop)])
    deck.fix(nodes, y=1).fix(nodes[[0, 2]], x=1)
    for node in nodes[[1, 3]]:
        deck.prescribe(node, 1, 2, 7)
    return deck


def test_released_first_contacts_are_reported_at_an_error(slideline, tmp_path):
    """The run ends by an element that turns over in a cycle that writes nothing. Its hourglass form takes no root of the area."""
    deck = pushed_in(0.12).add("*CONTROL_HOURGLASS", (4, 0.05))
    place = deck.lines.index("*CONTACT_2D_SLIDELINE") + 2
    deck.lines[place] = "0.001" + deck.lines[place][deck.lines[place].index(","):]
    done = slideline("d=i", deck=driven_through(deck, 1.55e-3, -3.0))
    assert done.returncode == 2 and "element" in done.stderr, done.stderr
    cycle = int(re.search(r"Problem cycle += (\d+)", done.stdout)[1])
    assert cycle not in numbers(tmp_path / "i" / "job.glstat.csv", "cycle")
    assert len(re.findall(r"warning: interface 1: first contacts deeper than the limit", done.stderr)) == 1
    assert "Warnings            = 2" in done.stdout and "the constant time step" in done.stderr


def test_step_below_its_floor_is_2(slideline):
    """A squeezed element wants a smaller step than DTMIN allows."""
    deck = Deck("squeezed")
    deck.add("*CONTROL_TERMINATION", (1.0, 0, 0.5)).add("*CONTROL_TIMESTEP", (0.0, 0.9))
    deck.part().elastic(1.0e4, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(1, 1))
    deck.curve(1, [(0.0, 0.0), (1.0, -0.9)])
    deck.fix(nodes, y=1).fix(nodes[[0, 2]], x=1)
    for node in nodes[[1, 3]]:
        deck.prescribe(node, 1, 2, 1)
    done = slideline("d=x", deck=deck)
    assert done.returncode == 2
    assert "DTMIN" in done.stderr
    assert ERROR in done.stdout


def test_step_above_the_stable_one_is_not_used(slideline, tmp_path):
    done = slideline("d=u", "dt=0.02", deck=drop())
    assert done.returncode == 0
    assert "stable step" in done.stderr + (tmp_path / "u" / "job.log").read_text()
    assert np.all(numbers(tmp_path / "u" / "job.glstat.csv", "dt") < 0.01)


def test_folder_that_is_a_file_is_3(slideline, tmp_path):
    (tmp_path / "taken").write_text("a file\n")
    done = slideline("d=taken", deck=drop())
    assert done.returncode == 3
    assert "taken" in done.stderr
    assert (tmp_path / "taken").read_text() == "a file\n"


def start_long_run(exe, tmp_path, before=()):
    (tmp_path / "long.k").write_text(drop(end_time=1.0e4).text())
    process = subprocess.Popen([*before, exe, "i=long.k", "d=out", "dt=1.0e-4"], cwd=tmp_path, text=True,
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    path = tmp_path / "out" / "long.glstat.csv"
    for _ in range(100):
        time.sleep(0.1)
        if path.exists() and path.stat().st_size > 1000:
            return process
    process.kill()
    pytest.fail("the run wrote nothing in ten seconds")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_terminated_is_4(exe, tmp_path, number):
    process = start_long_run(exe, tmp_path)
    process.send_signal(number)
    stdout, stderr = process.communicate(timeout=20)
    assert process.returncode == 4, stderr
    assert re.search(r"\*\*\* stopped on request \(exit status 4\) before the termination time "
                     r"1\.000000E\+04 \*\*\*\n N o r m a l    t e r m i n a t i o n", stdout)
    assert "stopped on request at time" in stderr
    with h5py.File(tmp_path / "out" / "long.vtkhdf") as stream:
        steps = stream["VTKHDF/Steps"]
        last = numbers(tmp_path / "out" / "long.glstat.csv", "time")[-1]
        assert steps["Values"][-1] == last, "the last state is written on the way out"


@pytest.mark.parametrize("asked, before", [
    (signal.SIGHUP, ["nohup"]), (signal.SIGINT, ["sh", "-c", "trap '' INT; exec \"$@\"", "sh"])])
def test_signal_that_was_ignored_is_nothing(exe, tmp_path, asked, before):
    """Hang-up under nohup; an interrupt of a job that a script has put behind itself."""
    process = start_long_run(exe, tmp_path, before)
    process.send_signal(asked)
    time.sleep(1.0)
    assert process.poll() is None
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=20)
    assert process.returncode == 4


def test_killed_run_leaves_files_that_open(exe, tmp_path):
    process = start_long_run(exe, tmp_path)
    process.kill()
    process.communicate(timeout=20)
    lines = (tmp_path / "out" / "long.glstat.csv").read_text().splitlines()
    assert len(lines) > 1
    with h5py.File(tmp_path / "out" / "long.vtkhdf") as stream:
        steps = stream["VTKHDF/Steps"]
        count = int(steps.attrs["NSteps"])
        assert count >= 1
        assert len(steps["Values"]) == count
        assert len(stream["VTKHDF/Points"]) >= count * int(stream["VTKHDF/NumberOfPoints"][0])
        assert np.all(np.isfinite(stream["VTKHDF/CellData/stress"][:]))


@pytest.mark.parametrize("plots, portion", [(False, 1 << 18), (True, 1 << 17)])
def test_memory_that_is_refused_is_no_refused_input(exe, tmp_path, plots, portion):
    """Address space in growing portions, from where the program can be loaded until the run fits: some eighty of them.
    Wherever memory is refused the end is the same; in HDF5 too, which a small deck with plot states comes to."""
    if "-fsanitize" in subprocess.run([exe, "--version"], capture_output=True, text=True, check=True).stdout:
        pytest.skip("sanitisers take their address space first")
    deck = Deck("large").control(1.0e-5).part().elastic(1000.0, 1.0e6, 0.3)
    deck.mesh(*grid(250, 250))
    (tmp_path / "job.k").write_text(drop(end_time=0.002).text() if plots else deck.text())

    def limited(size, *words):
        return subprocess.run([exe, *words], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=60,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)))

    first = next(size for size in range(16 << 20, 2000 << 20, 1 << 18) if limited(size, "--version").returncode == 0)
    found = []
    for size in range(first + (1 << 18), 2000 << 20, portion):
        done = limited(size, "i=job.k")
        found.append(done.returncode)
        if done.returncode == 0:
            break
        assert done.returncode == 2, (size, done.returncode, done.stderr)
        assert "out of memory" in done.stderr or "llocat" in done.stderr, done.stderr
        assert "error termination" in done.stderr and "E r r o r    t e r m i n a t i o n" in done.stdout, done.stderr
    assert found.count(2) > 20 and found[-1] == 0, found


def test_many_errors_in_one_pass(slideline, tmp_path):
    wrong = ["*FROBNICATE",                                   # unknown keyword
             "      99     abc             0.0",              # no number
             "      91       1       1       2     777       4",  # dangling node
             "         5        77         1         1",      # dangling section of a part: part 5
             "        -2        -3         9",                # unknown contact type
             "     12345         0         1         1",      # SPC on an absent node
             "         1         1         0      4711",      # absent curve
             "        88         2         1       1.0"]      # load on an absent set
    base = drop().text().splitlines()
    lines = base[:-1] + ["*FROBNICATE", "*NODE", wrong[1], "*ELEMENT_SHELL", wrong[2],
                         "*PART", "stray", wrong[3], "*CONTACT_2D_SLIDELINE", wrong[4],
                         "*BOUNDARY_SPC_NODE", wrong[5], "*BOUNDARY_PRESCRIBED_MOTION_NODE", wrong[6],
                         "*LOAD_NODE_SET", wrong[7], "*END"]
    done = slideline("d=x", deck="\n".join(lines) + "\n", name="bad")
    assert done.returncode == 1
    missing = [text for text in wrong if f"bad.k:{lines.index(text) + 1}:" not in done.stderr]
    assert not missing, f"no message for {missing}\n{done.stderr}"
    for found in ("FROBNICATE", "abc", "777", "4711", "12345", "88"):
        assert found in done.stderr, found
