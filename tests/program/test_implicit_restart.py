# SPDX-License-Identifier: MIT
"""Restart of implicit runs: to the same bits, whatever the step control, the contact type and the solver do."""
import re
import signal
import time

import h5py
import pytest
from conftest import by_turns, numbers
from meshes import grid
from test_implicit import implicit, pulled
from test_restart import arrays, assert_same, histories, part_of, start, wait_for, with_files

from slideline_tools.contact_types import ALL_TYPES

GROUPS = ("state", "outputs", "driver")
VERSION = re.compile(rb"restart \d+")
TABLES = ("glstat", "rcforc", "nodout", "matsum", "sleout", "spcforc")


def blocks(deck, kind):
    """A block of 4 x 2 quads 0.002 above one of 6 x 2 that is held at its bottom; the lower one yields."""
    deck.part(1, points=4).elastic(1000.0, 1.0e6, 0.3, 1).part(2).plastic(1000.0, 1.0e6, 0.3, 2.0e4, 1.0e5, 0.5, 2)
    upper = deck.mesh(*grid(4, 2, 0.6, 0.4, (0.2, 0.002)), part=1)
    lower = deck.mesh(*grid(6, 2, 1.0, 0.4, (0.0, -0.4)), part=2)
    deck.fix(lower[:7], x=1, y=1).node_set(1, upper).node_set(2, upper[:5]).node_set(3, lower[-7:][::-1])
    deck.contact(2, 3, kind, 2.0e6)
    return upper, lower


def tables(deck, interval, nodes):
    """All outputs there are."""
    deck.output(plot=4 * interval, glstat=interval, matsum=interval, rcforc=interval, nodout=interval, nodes=nodes)
    return deck.add("*DATABASE_SLEOUT", (interval,)).add("*DATABASE_SPCFORC", (interval,))


def pressed(kind, most_iterations=5):
    """Static: pressed down by a curve with corners, then moved aside; steps grow, are cut and end at corners and plots."""
    deck = implicit(1.0, 0.04, automatic=(1.0e-4, 0.3), most_iterations=most_iterations)
    upper, lower = blocks(deck, kind)
    deck.curve(1, [(0.0, 0.0), (0.31, -0.03), (1.0, -0.05)]).curve(2, [(0.0, 0.0), (0.45, 0.0), (1.0, 0.2)])
    for node in upper[-5:]:
        deck.prescribe(int(node), 2, 2, 1).prescribe(int(node), 1, 2, 2)
    return tables(deck, 0.05, [1, int(upper[-1])])


def struck(kind):
    """Dynamic: falls on under gravity, damping, a load and a motion that comes and goes; constant steps."""
    deck = implicit(0.03, 5.0e-4, dynamic=True)
    upper, lower = blocks(deck, kind)
    deck.add("*INITIAL_VELOCITY", (1,), (0.3, -2.0)).curve(1, [(0.0, 9.81), (10.0, 9.81)]).add("*LOAD_BODY_Y", (1, 1.0))
    deck.curve(2, [(0.0, 0.0), (0.01, 1.0), (0.02, 0.0)]).add("*LOAD_NODE_POINT", (int(upper[-1]), 2, 2, -200.0))
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", (int(lower[-1]), 1, 0, 2, 0.05, 0, 0.0223, 0.0042),
             (int(upper[-5]), 2, 2, 2, -0.01, 0, 0.018, 0.0))
    deck.add("*DAMPING_PART_MASS", (1, 2, 5.0)).add("*DAMPING_GLOBAL", (0, 0.1))
    return tables(deck, 1.0e-3, [1, int(upper[-1])])


def grown(kind):
    """Dynamic, with steps that grow and are cut, of Newmark's method with damping."""
    deck = implicit(0.03, 5.0e-4, dynamic=True, automatic=(1.0e-6, 4.0e-3), most_iterations=3)
    deck.lines[deck.lines.index("*CONTROL_IMPLICIT_DYNAMICS") + 1] = "1,0.6,0.3025"
    upper, lower = blocks(deck, kind)
    deck.add("*INITIAL_VELOCITY", (1,), (0.3, -2.0))
    return tables(deck, 1.5e-3, [1, int(upper[-1])])


def with_friction(deck, rule):
    """The same deck with friction: FS, FD, DC."""
    deck.lines[deck.lines.index("*CONTACT_2D_SLIDELINE") + 1] += "," + rule
    return deck


def as_rings(deck):
    """The same deck with x as the radius: the left side of the lower block is the axis."""
    section = deck.lines.index("*SECTION_SHELL") + 1
    assert deck.lines[section] == "1,13,,4"
    deck.lines[section] = "1,15,,4"
    return deck


#: scene -> (deck of a contact type, steps between two restart files, what its log must show)
SCENES = {"pressed": (pressed, 5, "no equilibrium"), "struck": (struck, 23, ""),
          "grown": (grown, 6, "no equilibrium"),
          "pressed with friction": (lambda kind: with_friction(pressed(kind, 15), "0.3"), 5, ""),
          "struck with friction": (lambda kind: with_friction(struck(kind), "0.3,0.2,0.5"), 23, ""),
          "rings struck with friction": (lambda kind: with_friction(as_rings(struck(kind)), "0.3,0.2,0.5"), 23, "")}
#: Those by turns, and one more so that each type goes on with friction.
CASES = list(dict.fromkeys([*by_turns([(scene, kind) for scene in SCENES for kind in ALL_TYPES], release=2),
                            ("pressed with friction", 6)]))


def run_whole(slideline, deck, folder="whole", **files):
    """An uninterrupted run that writes restart files."""
    done = slideline(f"d={folder}", deck=with_files(deck, **files))
    assert done.returncode == 0, done.stderr


def go_on(slideline, file, *words):
    """Go on from a file."""
    done = slideline(f"r={file}", *words)
    assert done.returncode == 0, done.stderr
    return done


def texts(folder):
    """DYNA's text files."""
    return [(folder / f"job.{name}").read_bytes() for name in TABLES]


def iterations(folder):
    """What the log says of steps and iterations, figures included."""
    return [line for line in (folder / "job.log").read_text().splitlines() if line.startswith("step to ")]


@pytest.mark.parametrize("scene, kind", CASES)
def test_scene_goes_on_to_the_same_bits(slideline, tmp_path, scene, kind):
    make, interval, shown = SCENES[scene]
    run_whole(slideline, make(kind), dump=interval)
    whole = tmp_path / "whole"
    # With type 5 each step of the pressed block finds its equilibrium in some builds: a matter of rounding.
    assert shown in (whole / "job.log").read_text() or kind == 5
    assert numbers(whole / "job.rcforc.csv", "n_active").max() > 0
    assert (numbers(whole / "job.glstat.csv", "friction")[-1] > 0.0) == ("friction" in scene)
    dumps = sorted(path.name for path in whole.glob("job.dump*"))
    assert len(dumps) >= 3
    for thread, name in enumerate(dumps[:2], 1):
        rest = part_of(whole, tmp_path / name, name, "job.vtkhdf")
        go_on(slideline, rest / name, f"ncpu={thread}", "perthread=1")
        assert_same(whole, rest)
        assert texts(whole) == texts(rest)
        after = iterations(rest)
        assert len(after) > 1 and after == iterations(whole)[-len(after):]
        assert arrays(whole / dumps[-1], *GROUPS) == arrays(rest / dumps[-1], *GROUPS)
        assert sorted(path.name for path in rest.glob("job.dump*")) == dumps[thread - 1:]


@pytest.mark.parametrize("is_axisymmetric", [False, True])
def test_assumed_strain_goes_on_to_the_same_bits(slideline, tmp_path, is_axisymmetric):
    deck = struck(4)
    deck.lines[deck.lines.index("*SECTION_SHELL") + 1] = "1,15" if is_axisymmetric else "1,13"
    run_whole(slideline, deck.hourglass(6, 1.0), dump=23)
    whole = tmp_path / "whole"
    assert (whole / "job.log").read_text().count("assumed strain hourglass control") == 2
    assert numbers(whole / "job.glstat.csv", "hourglass")[-1] > 0.0
    rest = part_of(whole, tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    go_on(slideline, rest / "job.dump01.h5", "ncpu=2", "perthread=1")
    assert_same(whole, rest)


def test_file_before_the_last_step(slideline, tmp_path):
    """CYCL 0 asks for it alone; a run of one step begins anew from it."""
    for name, dt, reached, cycle in (("a", 0.25, 0.75, 3), ("b", 1.0, 0.0, 0)):
        run_whole(slideline, pulled(1.0e3, dt=dt), name, dump=0)
        with h5py.File(tmp_path / name / "job.dump01.h5") as stream:
            assert stream["state/time"][0] == reached and stream["state/cycle"][0] == cycle
            assert stream["run/is_implicit"][0] == 1
        rest = part_of(tmp_path / name, tmp_path / f"{name}2", "job.dump01.h5", "job.vtkhdf")
        go_on(slideline, rest / "job.dump01.h5")
        assert_same(tmp_path / name, rest)
        assert [path.name for path in rest.glob("*.h5")] == ["job.dump01.h5"]


def test_running_file_and_later_restarts(slideline, tmp_path):
    """Every step replaces the running file; files of a run that went on serve as well; the end is repeated."""
    run_whole(slideline, pressed(4), dump=4, running=1)
    whole = tmp_path / "whole"
    last = int(numbers(whole / "job.glstat.csv", "cycle")[-1])
    with h5py.File(whole / "job.runrsf.h5") as stream:
        assert stream["state/cycle"][0] == last
    rest = part_of(whole, tmp_path / "rest", "job.dump01.h5", "job.vtkhdf", "job.log")
    for name in ("dump01", "dump02", "runrsf", f"dump0{len(list(whole.glob('*.dump*')))}"):
        go_on(slideline, rest / f"job.{name}.h5")
        assert_same(whole, rest)
    assert not list(rest.glob("*.part"))


def test_later_files_are_the_same(slideline, tmp_path):
    """Each file of the run that goes on, also where nothing has been written since the restart."""
    deck = pulled(4.0e4, dt=0.0625)
    deck.lines[deck.lines.index("*DATABASE_GLSTAT") + 1] = "0.5,"
    run_whole(slideline, deck, dump=1)
    rest = part_of(tmp_path / "whole", tmp_path / "rest", "job.dump10.h5", "job.vtkhdf")
    go_on(slideline, rest / "job.dump10.h5")
    later = sorted(path.name for path in rest.glob("job.dump*"))
    assert len(later) == 7
    for name in later:
        assert arrays(tmp_path / "whole" / name, *GROUPS) == arrays(rest / name, *GROUPS), name


def test_sparse_solver(slideline, tmp_path):
    """A mesh too wide for a band."""
    deck = implicit(1.0, 0.5).part(points=4).plastic(1000.0, 1.0e6, 0.3, 1.0e3, 1.0e5)
    nodes = deck.mesh(*grid(42, 42))
    deck.fix(nodes[:43], x=1, y=1).curve(1, [(0.0, 0.0), (1.0, -0.002)])
    for node in nodes[-43:]:
        deck.prescribe(int(node), 2, 2, 1)
    run_whole(slideline, deck.output(glstat=1.0e-9, plot=0.5), dump=0)
    log = (tmp_path / "whole" / "job.log").read_text()
    if "UMFPACK" not in log:
        pytest.skip("built without UMFPACK")
    assert "sparse LU (UMFPACK)" in log
    rest = part_of(tmp_path / "whole", tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    go_on(slideline, rest / "job.dump01.h5")
    assert_same(tmp_path / "whole", rest)


def test_later_end(slideline, tmp_path):
    """A finished run of constant steps goes on as if the later end had been meant from the start, a shortened last step
    is forgotten; another one of automatic steps goes on at least."""
    gentle = pulled(4.0e4, dt=0.15)
    for name, deck, short, late in (("s", struck(5), 0.015, 0.03), ("p", gentle, 0.5, 0.7)):
        assert slideline(f"d={name}long", f"endtim={late}", deck=deck).returncode == 0
        assert slideline(f"d={name}", f"endtim={short}", deck=with_files(deck, dump=0)).returncode == 0
        go_on(slideline, f"{name}/job.dump01.h5", f"endtim={late}")
        assert_same(tmp_path / f"{name}long", tmp_path / name)
    assert slideline("d=g", "endtim=0.02", deck=with_files(grown(7), dump=0)).returncode == 0
    go_on(slideline, "g/job.dump01.h5", "endtim=0.03")
    times = numbers(tmp_path / "g" / "job.glstat.csv", "time")
    assert times[-1] == 0.03 and (times[1:] > times[:-1]).all()


def test_earlier_end(slideline, tmp_path):
    """An end at the time of the file ends there; one before is refused."""
    run_whole(slideline, pulled(1.0e3, dt=0.25), dump=2)
    rest = part_of(tmp_path / "whole", tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    done = slideline("r=rest/job.dump01.h5", "endtim=0.4999")
    assert done.returncode == 1 and "after the end time" in done.stderr
    go_on(slideline, "rest/job.dump01.h5", "endtim=0.5")
    assert list(numbers(rest / "job.glstat.csv", "time")) == [0.0, 0.25, 0.5]
    with h5py.File(rest / "job.vtkhdf") as stream:
        assert list(stream["VTKHDF/Steps/Values"]) == [0.0, 0.5]


def test_an_end_within_a_divided_step(slideline, tmp_path):
    """A motion is born at 0.0042, within the whole step to 0.0045; the run that goes on from there ends before that."""
    run_whole(slideline, struck(2), dump=9)
    with h5py.File(tmp_path / "whole" / "job.dump01.h5") as stream:
        assert stream["state/time"][0] == 0.0042 and stream["driver/control/target"][0] == pytest.approx(0.0045)
    rest = part_of(tmp_path / "whole", tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    go_on(slideline, rest / "job.dump01.h5", "endtim=0.0043")
    assert numbers(rest / "job.glstat.csv", "time")[-1] == 0.0043


@pytest.mark.parametrize("automatic", [False, True])
def test_small_deck_changes_end_and_intervals(slideline, tmp_path, automatic):
    deck = pulled(1.0e3, dt=0.05, automatic=(0.05, 0.05) if automatic else None)
    deck.lines[deck.lines.index("*DATABASE_GLSTAT") + 1] = "0.1,"
    run_whole(slideline, deck, "a", dump=11)
    (tmp_path / "changes.k").write_text(
        "*CONTROL_TERMINATION\n1.5,\n*DATABASE_GLSTAT\n0.17,\n*DATABASE_BINARY_D3PLOT\n0.5,\n")
    go_on(slideline, "a/job.dump01.h5", "i=changes.k")
    times = numbers(tmp_path / "a" / "job.glstat.csv", "time")
    # From 0.55 on: the states next to multiples of 0.17; of automatic steps those at or after them.
    after = [0.55, 0.7, 0.85, 1.05, 1.2, 1.4, 1.5] if automatic else [0.7, 0.85, 1.0, 1.2, 1.35, 1.5]
    assert times == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, *after], abs=1.0e-9)
    (tmp_path / "changes.k").write_text("*CONTROL_IMPLICIT_GENERAL\n0,\n")
    done = slideline("r=a/job.dump01.h5", "i=changes.k")
    assert done.returncode == 1 and "changes.k:1: *CONTROL_IMPLICIT_GENERAL cannot change at a restart; *CONTROL_TERMINATION and the intervals of *DATABASE_ can" in done.stderr


def test_last_cycle_of_the_deck(slideline, tmp_path):
    """ENDCYC ends a run and may change."""
    deck = struck(2).text()
    cut = deck.replace("*CONTROL_TERMINATION\n0.03,\n", "*CONTROL_TERMINATION\n0.03,20\n")
    run_whole(slideline, cut, "cut", dump=0)
    with h5py.File(tmp_path / "cut" / "job.dump01.h5") as stream:
        assert stream["state/cycle"][0] == 19
    run_whole(slideline, deck)
    (tmp_path / "changes.k").write_text("*CONTROL_TERMINATION\n0.03,\n")
    go_on(slideline, "cut/job.dump01.h5", "i=changes.k")
    assert_same(tmp_path / "whole", tmp_path / "cut")


def test_failure_is_repeated(slideline, tmp_path):
    """Beyond the limit load: the same last state, cause and status."""
    deck = pulled(1.5 * 2.0 / 3.0 ** 0.5 * 1.0e3, dt=0.05, plastic=True, automatic=(1.0e-3, 0.05))
    first = slideline("d=whole", deck=with_files(deck, dump=5, running=1))
    assert first.returncode == 2 and "no equilibrium" in first.stderr
    for name in ("dump02", "runrsf"):
        rest = part_of(tmp_path / "whole", tmp_path / name, f"job.{name}.h5", "job.vtkhdf")
        again = slideline(f"r={name}/job.{name}.h5")
        assert again.returncode == 2 and again.stderr == first.stderr
        assert_same(tmp_path / "whole", rest)


def test_files_of_the_other_method_are_refused(slideline, tmp_path):
    decks = {"implicit": with_files(struck(2), dump=0)}
    decks["explicit"] = re.sub(r"\*CONTROL_IMPLICIT_\w+\n[^*]*", "", decks["implicit"])
    for method, deck in decks.items():
        assert slideline(f"d={method}", deck=deck, name=method).returncode == 0
    for method, other in (("implicit", "explicit"), ("explicit", "implicit")):
        before = histories(tmp_path / method, method)
        done = slideline(f"i={other}.k", f"r={method}/{method}.dump01.h5")
        assert done.returncode == 1
        assert f"{method}/{method}.dump01.h5 is refused: it is of an {method} run, and {other}.k asks for the " \
            f"{other} method" in done.stderr
        assert histories(tmp_path / method, method) == before


def test_bad_files_are_refused(slideline, tmp_path):
    run_whole(slideline, pulled(1.0e3, dt=0.25), dump=2)
    good = (tmp_path / "whole" / "job.dump01.h5").read_bytes()
    flipped = bytearray(good)
    flipped[len(good) // 2] ^= 4
    for data, reason in ((good[:-1], "truncated"), (bytes(flipped), "damaged"),
                         (VERSION.sub(b"restart 06", good, count=1), "an older version")):
        (tmp_path / "bad.h5").write_bytes(data)
        done = slideline("r=bad.h5", "d=b")
        assert done.returncode == 1 and reason in done.stderr and "bad.h5" in done.stderr
        assert not (tmp_path / "b").exists()


LONG = 1000.0
INTERVAL = 0.01


def long_fall():
    """A hundred thousand steps of a small dynamic run, few of which write."""
    deck = implicit(LONG, 1.0e-3, dynamic=True)
    upper, _ = blocks(deck, 5)
    deck.add("*INITIAL_VELOCITY", (1,), (0.0, -0.5)).curve(1, [(0.0, 9.81), (1.0e4, 9.81)]).add("*LOAD_BODY_Y", (1, 1.0))
    return tables(deck, INTERVAL, [int(upper[0])])


def check_cut(slideline, tmp_path, *files):
    """The run that was stopped goes on from each of the files as one that was not."""
    end = f"endtim={numbers(tmp_path / 'cut' / 'job.glstat.csv', 'time')[-1] + 2.5 * INTERVAL:.3f}"
    assert slideline("d=whole", end, deck=long_fall()).returncode == 0
    for name in files:
        go_on(slideline, f"cut/job.{name}.h5", end)
        assert_same(tmp_path / "whole", tmp_path / "cut")


def test_sense_switches(exe, slideline, tmp_path):
    process = start(exe, tmp_path, long_fall(), "cut")
    kill, dump = tmp_path / "cut" / "d3kil", tmp_path / "cut" / "job.dump01.h5"
    kill.write_text("sw3\n")
    wait_for(dump.exists)
    assert process.poll() is None
    process.send_signal(signal.SIGUSR1)
    wait_for((tmp_path / "cut" / "job.dump02.h5").exists)
    kill.write_text("sw1\n")
    assert process.wait(timeout=20) == 4
    said = (tmp_path / "cut.out").read_text()
    assert len(re.findall(r"^restart file cut/job.dump0[123].h5 at time \S+, cycle \d+$", said, re.M)) == 3, said
    check_cut(slideline, tmp_path, "dump01", "dump02", "dump03")


def test_stop_signal_writes_what_the_deck_asks_for(exe, slideline, tmp_path):
    process = start(exe, tmp_path, with_files(long_fall(), dump=0, running=1000000000), "cut")
    time.sleep(0.2)
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=20) == 4
    check_cut(slideline, tmp_path, "dump01", "runrsf")
