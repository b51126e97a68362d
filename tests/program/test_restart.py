# SPDX-License-Identifier: MIT
"""A run that goes on from a restart file ends with the bits of one that was not interrupted."""
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import zlib

import h5py
import numpy as np
import pytest
from conftest import by_turns, drop, numbers
from erosion_decks import penetration
from impact_decks import plates
from meshes import Deck, grid
from axisymmetric_decks import rings
from seal_decks import seal, settled
from test_repeatability import large_drop

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from slideline_tools import scenes  # noqa: E402
from slideline_tools.contact_types import ALL_TYPES  # noqa: E402

HEAD = 512
VERSION = re.compile(rb"restart \d+")
#: scene -> (deck of a contact type, cycles, cycle of the restart, words of the first run)
SCENES = {
    "collision": (lambda kind: scenes.collision(1, ctype=kind), 200, 90),
    "sliding": (lambda kind: scenes.sliding(1, ctype=kind), 6000, 4500),
    "rigid die": (lambda kind: scenes.sliding(1, ctype=kind, rigid_die=True), 6000, 4500),
    "block": (lambda kind: scenes.block(ctype=kind), 90, 47),
    "hertz": (lambda kind: scenes.hertz(1, ctype=kind), 1500, 1100),
    "oblique": (lambda kind: scenes.oblique(ctype=kind), 280, 155),
    "collision with friction": (lambda kind: scenes.collision(1, ctype=kind), 200, 90, "fs=0.4", "fd=0.2", "dc=0.01"),
    "oblique with friction": (lambda kind: scenes.oblique(ctype=kind), 280, 155, "fs=0.3", "tfac=0.5"),
    "implicit penalty": (lambda kind: scenes.collision(1, ctype=kind), 100, 68, "punit=4", "pen=10"),
    "patch": (lambda kind: scenes.patch(ctype=kind), 300, 170),
    "rings": (lambda kind: rings(kind, 16, end=0.03), 60, 20),
    "plate": (lambda kind: scenes.symmetric_plate(16, 8, True), 300, 170),
    "impact": (plates, 90, 60),
    "impact, 2x2 points": (lambda kind: plates(kind, points=4), 90, 60),
    "erosion": (penetration, 330, 180),
    "erosion, round, 2x2 points": (lambda kind: penetration(kind, True, 4), 330, 180),
    "erosion, one surface": (lambda kind: penetration(kind, is_self=True), 330, 180),
    "round rubber": (seal, 340, 200),
    "behind a relaxation": (settled, 90, 50),
}
#: Scenes that are not for every type.
FEW_TYPES = {"plate": (1,), "rigid die": (2, 7), "impact": (3,), "impact, 2x2 points": (1,), "implicit penalty": (7,), "erosion": (4, 5), "erosion, round, 2x2 points": (6,),
             "erosion, one surface": (5,), "round rubber": (7,), "behind a relaxation": (1,)}
#: Those by turns, and so many more that each type goes on with friction.
CASES = list(dict.fromkeys([
    *by_turns([(scene, kind) for scene in SCENES for kind in ALL_TYPES if kind in FEW_TYPES.get(scene, ALL_TYPES)], release=2),
    *(("oblique with friction", kind) for kind in (3, 4, 5))]))


def text_of(deck):
    return deck if isinstance(deck, str) else deck.text()


def with_files(deck, dump=None, running=None):
    """A deck that asks for restart files."""
    text = text_of(deck).rsplit("*END", 1)[0]
    text += f"*DATABASE_BINARY_D3DUMP\n{dump},\n" if dump is not None else ""
    return text + (f"*DATABASE_BINARY_RUNRSF\n{running},\n" if running else "") + "*END\n"


def histories(folder, job="job"):
    """All CSV files but the timing."""
    return {path.name: path.read_bytes() for path in sorted(folder.glob(f"{job}.*.csv"))
            if "timing" not in path.name}


def arrays(path, *groups):
    """All arrays below some groups of an HDF5 file, as bytes with their shapes."""
    found = {}
    with h5py.File(path) as stream:
        for group in groups:
            stream[group].visititems(lambda name, item, group=group: found.update(
                {f"{group}/{name}": (item.shape, item[()].tobytes() if item.shape else b"")})
                if isinstance(item, h5py.Dataset) else None)
    return found


def assert_same(one, other, job="job"):
    """Two folders of results hold the same bits."""
    assert histories(one, job) == histories(other, job)
    first = arrays(one / f"{job}.vtkhdf", "VTKHDF", "history")
    assert len(first) > 20 and first == arrays(other / f"{job}.vtkhdf", "VTKHDF", "history")
    with h5py.File(one / f"{job}.vtkhdf") as a, h5py.File(other / f"{job}.vtkhdf") as b:
        steps = a["VTKHDF/Steps"].attrs["NSteps"]
        assert steps == b["VTKHDF/Steps"].attrs["NSteps"] == len(a["VTKHDF/Steps/Values"])


def part_of(folder, target, *names):
    """A folder with some of the files of another."""
    target.mkdir()
    for name in names:
        shutil.copy(folder / name, target)
    return target


@pytest.mark.parametrize("scene, kind", CASES)
def test_scene_goes_on_to_the_same_bits(slideline, tmp_path, scene, kind):
    make, cycles, middle, *words = SCENES[scene]
    text = re.sub(r"(\*CONTROL_TERMINATION\n(?:\$.*\n)*) *([^\s,]+).*\n", rf"\g<1>\g<2>,{cycles}\n",
                  make(kind), count=1)
    done = slideline("d=whole", *words, deck=with_files(text, dump=middle))
    assert done.returncode == 0, done.stderr
    whole = tmp_path / "whole"
    assert "friction" not in scene or numbers(whole / "job.glstat.csv", "friction")[-1] > 0.0
    if scene not in ("plate", "behind a relaxation", "oblique", "oblique with friction"):  # type 1 of the oblique impact may have let go by then
        active, at = numbers(whole / "job.rcforc.csv", "n_active"), middle / cycles
        assert active[int(at * len(active)):].max() > 0
    rest = part_of(whole, tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    done = slideline("r=rest/job.dump01.h5", f"ncpu={2 if (scene, kind) == ('block', 3) else 1}", "perthread=1")
    assert done.returncode == 0, done.stderr
    assert numbers(rest / "job.glstat.csv", "cycle")[-1] == cycles
    assert_same(whole, rest)
    last = f"job.dump0{len(list(whole.glob('*.dump*')))}.h5"
    groups = ("state", "outputs", "driver")
    assert arrays(whole / last, *groups) == arrays(rest / last, *groups)


def everything(form=4):
    """Loads, damping, motion that starts and ends, points, hourglass memory, bulk viscosity, a varying interval."""
    deck = Deck("everything")
    deck.control(0.03).hourglass(form, 0.05).add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    deck.part(1, points=4).elastic(1000.0, 1.0e6, 0.3, 1)
    deck.part(2, section=2).plastic(1000.0, 1.0e6, 0.3, 1.0e3, 1.0e5, 0.5, 2)
    deck.add("*CONTROL_CONTACT", (0.1,), (0, 0, 0, 0, 0.0, 0, 2))  # springs limit the step
    deck.add("*SECTION_SHELL", (2, 13, None, 1), (1.0,))
    deck.add("*DAMPING_GLOBAL", (0, 5.0)).curve(1, [(0.0, 9.81), (10.0, 9.81)])
    deck.add("*LOAD_BODY_Y", (1, 1.0)).curve(2, [(0.0, 0.0), (0.01, 1.0), (0.02, 0.0)])
    upper = deck.mesh(*grid(30, 10, 0.6, 0.4, (0.2, 0.001)), part=1)
    lower = deck.mesh(*grid(50, 10, 1.0, 0.4, (0.0, -0.4)), part=2)
    deck.node_set(1, upper).node_set(2, upper[:31]).node_set(3, lower[-51:][::-1])
    deck.add("*INITIAL_VELOCITY", (1,), (0.3, -2.0)).fix(lower[:51], y=1)
    deck.add("*LOAD_NODE_POINT", (int(upper[-1]), 2, 2, -200.0))
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE",
             (int(lower[0]), 1, 0, 2, 0.05, 0, 0.025, 0.004),
             (int(upper[-31]), 2, 0, 2, -3.0, 0, 0.018, 0.0))
    deck.curve(3, [(0.0, 0.001), (0.03, 0.004)]).contact(2, 3, 3, 2.0e5)
    deck.add("*DATABASE_BINARY_D3PLOT", (0.0, 3))
    return deck.output(glstat=5.0e-4, matsum=1.0e-3, rcforc=2.0e-4, nodout=3.0e-4, nodes=[1, 13, 20])


def quasi_static():
    """Scaled masses that grow, damping of parts by mass and by stiffness, masses on nodes, nodes that move alike,
    skew supports, a loaded rigid body; several tiles."""
    deck = Deck("quasi-static help")
    deck.add("*CONTROL_TERMINATION", (0.02,)).add("*CONTROL_TIMESTEP", (0.0, 0.9, 0, 0.0, -9.5e-4)).hourglass(4, 0.05)
    deck.part(1).elastic(1000.0, 1.0e6, 0.3, 1).part(2, section=2).elastic(1000.0, 1.0e6, 0.3, 2)
    deck.add("*SECTION_SHELL", (2, 13, None, 4), (1.0,))
    deck.part(3).add("*MAT_RIGID", (3, 1000.0, 1.0e6, 0.3), "0,0,0", "0.0")
    first = deck.mesh(*grid(30, 20, 1.2, 0.8), part=1)
    second = deck.mesh(*grid(30, 20, 1.2, 0.8, (2.0, 0.0)), part=2)
    body = deck.mesh(*grid(4, 4, origin=(5.0, 0.0)), part=3)
    deck.curve(1, [(0.0, 0.0), (0.01, 40.0), (1.0, 40.0)]).curve(2, [(0.0, 1.0), (1.0, 1.0)])
    deck.add("*DAMPING_PART_MASS", (1, 1, 1.0, 1), (1.0, 0.5), (3, 2, 5.0)).add("*DAMPING_GLOBAL", (0, 1.0))
    deck.add("*DAMPING_PART_STIFFNESS", (2, 0.1))
    deck.add("*ELEMENT_MASS", f"{1:8d}{int(first[40]):8d}{3.0:16.1f}")
    deck.add("*DEFINE_COORDINATE_SYSTEM", (7, 0.0, 0.0, 0.0, 0.8, 0.6, 0.0), (-0.6, 0.8, 0.0))
    deck.add("*BOUNDARY_SPC_NODE", *[(int(node), 7, 0, 1) for node in first[:31]])
    deck.node_set(1, [*first[-31:], *second[-31:]]).add("*CONSTRAINED_NODE_SET", (1, 2))
    deck.add("*LOAD_RIGID_BODY", (3, 1, 1, 50.0, 7), (3, 7, 2, 5.0)).fix(second[:31], x=1, y=1)
    deck.curve(3, [(0.0, -3.0), (1.0, -3.0)]).prescribe(int(first[-1]), 1, 0, 3)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), 0.5, -2.0) for node in first[200:300]])
    return deck.output(plot=5.0e-3, glstat=5.0e-4, matsum=1.0e-3, nodout=1.0e-3,
                       nodes=[int(first[0]), int(first[-1]), int(second[-1]), int(body[0])])


def longer_drop():
    """Several tiles and some hundred cycles."""
    return large_drop().text().replace("\n0.004,", "\n0.04,")


def test_any_thread_counts(slideline, tmp_path):
    for deck, name, cycles in ((everything(), "e", 40), (everything(6), "h", 40), (longer_drop(), "l", 60), (quasi_static(), "q", 12)):
        deck = with_files(deck, dump=cycles)
        assert slideline(f"d={name}1", "ncpu=1", deck=deck).returncode == 0
        assert slideline(f"d={name}3", "ncpu=3", "perthread=1", deck=deck).returncode == 0
        count = numbers(tmp_path / f"{name}1" / "job.glstat.csv", "cycle")[-1]
        assert count > 1.2 * cycles
        for before, after in ((1, 3), (3, 1)):
            rest = part_of(tmp_path / f"{name}{before}", tmp_path / f"{name}{before}{after}",
                           "job.dump01.h5", "job.vtkhdf")
            done = slideline(f"r={rest}/job.dump01.h5", f"ncpu={after}", "perthread=1")
            assert done.returncode == 0, done.stderr
            assert_same(tmp_path / f"{name}1", rest)


def test_restarts_follow_each_other(slideline, tmp_path):
    """Files of a run that went on serve as well; numbers count on; a finished run repeats its end."""
    assert slideline("d=whole", deck=with_files(drop(), dump=60, running=33)).returncode == 0
    whole = tmp_path / "whole"
    assert [path.name for path in sorted(whole.glob("*.h5"))] == [
        "job.dump01.h5", "job.dump02.h5", "job.dump03.h5", "job.dump04.h5", "job.runrsf.h5"]
    rest = part_of(whole, tmp_path / "rest", "job.dump01.h5", "job.vtkhdf", "job.log")
    for name in ("dump01", "dump02", "runrsf", "dump04"):
        done = slideline(f"r=rest/job.{name}.h5")
        assert done.returncode == 0, done.stderr
        assert_same(whole, rest)
    assert len(list(rest.glob("*.h5"))) == 5 and not list(rest.glob("*.part"))
    log = (rest / "job.log").read_text()
    assert log.count("restart from the restart file") == 4


def test_without_the_states_before(slideline, tmp_path):
    assert slideline("d=whole", deck=with_files(drop(), dump=90)).returncode == 0
    done = slideline("r=whole/job.dump01.h5", "d=other", "jobid=new")
    assert done.returncode == 0 and "warning" in done.stderr
    whole = histories(tmp_path / "whole")
    other = histories(tmp_path / "other", "new")
    assert list(whole.values()) == list(other.values())
    with h5py.File(tmp_path / "other" / "new.vtkhdf") as stream:
        assert 0.008 < stream["VTKHDF/Steps/Values"][0] < 0.02


def test_cost_is_that_of_the_cycles_run(slideline, tmp_path):
    """The time per zone cycle of a run that goes on, against its own timing table, to the rounding of the table."""
    assert slideline("d=run", deck=with_files(drop(), dump=90)).returncode == 0
    done = slideline("r=run/job.dump01.h5")
    assert done.returncode == 0, done.stderr
    said = (tmp_path / "run" / "job.log").read_text().split("restart from the restart file")[1]
    last = int(re.search(r"Problem cycle\s+= (\d+)", said)[1])
    cost = float(re.search(r"Time per zone cycle = (\S+)", said)[1])
    with h5py.File(tmp_path / "run" / "job.vtkhdf") as stream:
        elements = stream["VTKHDF/NumberOfCells"][0]
    rows = [line.split(",") for line in (tmp_path / "run" / "job.timing.csv").read_text().split()]
    seconds = {row[0]: float(row[1]) for row in rows if row[0] in ("total", "output", "input")}
    spent = seconds["total"] - seconds["output"] - seconds["input"]
    assert last > 90
    assert cost*elements*(last - 90) == pytest.approx(1.0e9*spent, rel=0.02, abs=0.02*elements*last)


def test_later_end(slideline, tmp_path):
    """A finished run goes on to a later end as if it had been meant from the start."""
    assert slideline("d=long", "endtim=0.03", deck=drop()).returncode == 0
    assert slideline("d=short", deck=with_files(drop(), dump=0)).returncode == 0
    done = slideline("r=short/job.dump01.h5", "endtim=0.03")
    assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "long", tmp_path / "short")
    done = slideline("r=short/job.dump01.h5", "endtim=0.01")
    assert done.returncode == 1 and "after the end time" in done.stderr
    done = slideline("r=short/job.dump01.h5", "ctype=3")
    assert done.returncode == 1 and "endtim" in done.stderr


def test_small_deck_changes_end_and_intervals(slideline, tmp_path):
    assert slideline("d=a", deck=with_files(drop(), dump=100)).returncode == 0
    (tmp_path / "changes.k").write_text(
        "*KEYWORD\n*CONTROL_TERMINATION\n0.03,\n*DATABASE_GLSTAT\n2.5e-3,\n*END\nrest\n")
    done = slideline("r=a/job.dump01.h5", "i=changes.k")
    assert done.returncode == 0, done.stderr
    times = numbers(tmp_path / "a" / "job.glstat.csv", "time")
    expected = [*np.arange(0.0, 0.00999, 1.0e-3), *np.arange(0.01, 0.0301, 2.5e-3)]
    assert times == pytest.approx(expected, rel=1.0e-9)
    assert numbers(tmp_path / "a" / "job.matsum.csv", "time")[-1] == pytest.approx(0.03)
    (tmp_path / "changes.k").write_text("*KEYWORD\n*DAMPING_GLOBAL\n0,1.0\n*DEFINE_CURVE\n1,\n*END\n")
    done = slideline("r=a/job.dump01.h5", "i=changes.k")
    assert done.returncode == 1
    assert "changes.k:2: *DAMPING_GLOBAL" in done.stderr
    assert "changes.k:4: *DEFINE_CURVE" in done.stderr


def test_whole_deck_must_be_the_same(slideline, tmp_path):
    text = with_files(drop(), dump=100)
    assert slideline("d=a", "endtim=0.03", deck=text).returncode == 0
    assert slideline("d=b", deck=text).returncode == 0
    done = slideline("i=job.k", "r=b/job.dump01.h5", "endtim=0.03")
    assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "a", tmp_path / "b")
    (tmp_path / "other.k").write_text(with_files(drop(penalty=2.1e5), dump=100))
    done = slideline("i=other.k", "r=b/job.dump01.h5")
    assert done.returncode == 1
    assert "another deck" in done.stderr and "b/job.dump01.h5" in done.stderr


def test_head_is_that_of_an_independent_program(slideline, tmp_path):
    assert slideline("d=a", deck=with_files(drop(), dump=100)).returncode == 0
    data = (tmp_path / "a" / "job.dump01.h5").read_bytes()
    lines = data[:HEAD].decode().splitlines()
    assert lines[:3] == ["slideline restart 27", f"length {len(data) - HEAD}",
                         f"checksum {zlib.crc32(data[HEAD:]):08X}"]
    with h5py.File(tmp_path / "a" / "job.dump01.h5") as stream:
        assert stream["state/cycle"][0] == 100
        assert stream["run/effective_deck"][()].startswith(b"$ The deck as run")


def test_bad_files_are_refused_with_the_reason(slideline, tmp_path):
    assert slideline("d=a", deck=with_files(drop(), dump=100)).returncode == 0
    good = (tmp_path / "a" / "job.dump01.h5").read_bytes()
    random = np.random.default_rng(8)
    cases = [(good[:n], "truncated") for n in (600, 5000, len(good) - 1)]
    for at in [HEAD, len(good) - 1, *random.integers(HEAD, len(good), 10)]:
        flipped = bytearray(good)
        flipped[at] ^= 1 << int(random.integers(8))
        cases.append((bytes(flipped), "damaged"))
    cases += [(good + b" ", "damaged"), (good[:300], "truncated"), (b"", "empty"),
              (VERSION.sub(b"restart 06", good, count=1), "an older version"),
              (VERSION.sub(b"restart 99", good, count=1), "a newer version"),
              (good.replace(b"checksum ", b"checksun ", 1), "damaged"),
              (good[HEAD:], "another HDF5 file"), (b"*KEYWORD\n*END\n", "not a restart file"),
              ((tmp_path / "a" / "job.vtkhdf").read_bytes(), "another HDF5 file")]
    bad = tmp_path / "b" / "bad.h5"
    bad.parent.mkdir()
    for data, reason in cases:
        bad.write_bytes(data)
        done = slideline("r=b/bad.h5")
        assert done.returncode == 1, reason
        assert reason in done.stderr and "b/bad.h5" in done.stderr, (reason, done.stderr)
        assert [path.name for path in bad.parent.iterdir()] == ["bad.h5"]
    done = slideline("r=b/none.h5")
    assert done.returncode == 1 and "none.h5" in done.stderr
    assert "cannot be opened; restart files are called <job>.dump01.h5" in done.stderr


def test_results_of_another_run_are_not_lost(slideline, tmp_path):
    assert slideline("d=a", deck=with_files(drop(), dump=100)).returncode == 0
    assert slideline("d=b", "endtim=0.005", deck=drop(dt=2.0e-4)).returncode == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "b").iterdir()}
    done = slideline("r=a/job.dump01.h5", "d=b")
    assert done.returncode == 1 and "job.vtkhdf" in done.stderr
    assert before == {path.name: path.read_bytes() for path in (tmp_path / "b").iterdir()}


def test_bad_cards_are_refused(slideline):
    for value, reason in (("-1.0", "number of cycles"), ("2.5", "whole number")):
        done = slideline("d=a", deck=with_files(drop(), dump=value))
        assert done.returncode == 1 and reason in done.stderr


LONG = 1000.0
INTERVAL = 0.3


def long_drop():
    """Minutes of cycles, few of which write."""
    text = drop(end_time=LONG, dt=1.0e-4, kind=2).text()
    return re.sub(r"(\*DATABASE_(?:BINARY_)?[A-Z0-9]+)\n[0-9.e-]+,", rf"\1\n{INTERVAL},", text)


def wait_for(found, seconds=20.0):
    """Wait until `found()` says so."""
    end = time.monotonic() + seconds
    while not found():
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.01)


def start(exe, tmp_path, deck, folder):
    """Start a run in the background; back when it has begun its cycles."""
    (tmp_path / "job.k").write_text(text_of(deck))
    with open(tmp_path / f"{folder}.out", "w") as out:
        process = subprocess.Popen([exe, "i=job.k", f"d={folder}"], cwd=tmp_path, stdout=out)
    wait_for((tmp_path / folder / "job.vtkhdf").exists)
    return process


def test_sense_switches(exe, slideline, tmp_path):
    process = start(exe, tmp_path, long_drop(), "cut")
    kill, dump = tmp_path / "cut" / "d3kil", tmp_path / "cut" / "job.dump01.h5"
    kill.write_text("sw3\n")
    wait_for(dump.exists)
    assert process.poll() is None and not kill.exists()
    kill.write_text("sw2\n")
    wait_for(lambda: not kill.exists())
    kill.write_text("sw1\n")
    assert process.wait(timeout=20) == 4
    said = (tmp_path / "cut.out").read_text()
    assert "status (sw2)" in said
    for name in ("job.dump01.h5", "job.dump02.h5"):
        assert re.search(rf"^restart file cut/{name} at time \S+, cycle \d+$", said, re.M), said
    assert (tmp_path / "cut" / "job.dump02.h5").exists()
    cut = numbers(tmp_path / "cut" / "job.glstat.csv", "time")[-1]
    end = f"endtim={1.05 * cut:.3f}"
    assert slideline("d=whole", end, deck=long_drop()).returncode == 0
    done = slideline("r=cut/job.dump02.h5", end)
    assert done.returncode == 0, done.stderr
    place = re.search(r"job.dump02.h5( at time \S+, cycle \d+)$", said, re.M)[1]
    assert f"restart from cut/job.dump02.h5{place}\n" in done.stdout
    assert_same(tmp_path / "whole", tmp_path / "cut")


def test_stop_and_plot_switches(exe, tmp_path):
    process = start(exe, tmp_path, long_drop(), "stop")
    kill = tmp_path / "stop" / "d3kil"
    kill.write_text("sw4\n")
    wait_for(lambda: not kill.exists())
    kill.write_text("stop\n")
    assert process.wait(timeout=20) == 4
    assert not list((tmp_path / "stop").glob("*.h5"))
    with h5py.File(tmp_path / "stop" / "job.vtkhdf") as stream:
        times = stream["VTKHDF/Steps/Values"][()]
    extra = np.abs(times / INTERVAL - np.rint(times / INTERVAL)) > 1.0e-6
    assert extra.sum() == 2 and extra[-1]


def test_stop_signal_writes_what_the_deck_asks_for(exe, slideline, tmp_path):
    deck = with_files(long_drop(), dump=0, running=1000000000)
    process = start(exe, tmp_path, deck, "cut")
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=20) == 4
    end = f"endtim={1.05 * numbers(tmp_path / 'cut' / 'job.glstat.csv', 'time')[-1] + 0.01:.3f}"
    assert slideline("d=whole", end, deck=long_drop()).returncode == 0
    for name in ("dump01", "runrsf"):
        done = slideline(f"r=cut/job.{name}.h5", end)
        assert done.returncode == 0, done.stderr
        assert_same(tmp_path / "whole", tmp_path / "cut")


def test_killed_while_writing_leaves_the_last_whole_file(exe, slideline, tmp_path):
    """Every cycle writes a file, so that most kills hit one in the making."""
    assert slideline("d=whole", deck=longer_drop()).returncode == 0
    deck = with_files(longer_drop(), running=1)
    random = np.random.default_rng(9)
    hits = 0
    for _ in range(6):
        shutil.rmtree(tmp_path / "cut", ignore_errors=True)
        process = start(exe, tmp_path, deck, "cut")
        running = tmp_path / "cut" / "job.runrsf.h5"
        wait_for(running.exists)
        time.sleep(float(random.uniform(0.0, 0.3)))
        process.kill()
        process.wait()
        hits += (tmp_path / "cut" / "job.runrsf.h5.part").exists()
        data = running.read_bytes()
        assert f"checksum {zlib.crc32(data[HEAD:]):08X}" in data[:HEAD].decode()
    assert hits > 0
    # The run that goes on need not write a file in every cycle.
    (tmp_path / "changes.k").write_text("*DATABASE_BINARY_RUNRSF\n100,\n")
    done = slideline("r=cut/job.runrsf.h5", "i=changes.k")
    assert done.returncode == 0, done.stderr
    assert not list((tmp_path / "cut").glob("*.part"))
    assert_same(tmp_path / "whole", tmp_path / "cut")
