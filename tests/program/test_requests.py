# SPDX-License-Identifier: MIT
"""What a run does for those who come by: status.out, words in d3kil, signals, and the log in d3hsp's spirit."""
import re
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
from conftest import drop, numbers
from meshes import Deck, grid
from test_implicit import pulled

LONG = 1.0e5


def long_drop():
    """Minutes of cycles; rows of energies wait up to a second in memory."""
    text = drop(end_time=LONG, dt=1.0e-4).text()
    for keyword, interval in (("GLSTAT", 0.05), ("BINARY_D3PLOT", 1.0e4)):
        text = re.sub(rf"(\*DATABASE_{keyword})\n[0-9.e-]+,", rf"\1\n{interval},", text)
    return re.sub(r"(\*DATABASE_(?:MATSUM|RCFORC|NODOUT))\n[0-9.e-]+,", rf"\1\n{LONG},", text)


def long_press():
    """Very many implicit steps, of which none writes a plot state."""
    return pulled(1.0, dt=1.0e-6).text().replace("1000000000.0", "0.5")


def wait_for(found, seconds=20.0):
    end = time.monotonic() + seconds
    while not found():
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.01)


@pytest.fixture
def started(exe, tmp_path):
    """started(deck, *words): a run of job.k in the background, ended at the latest with the test."""
    running = []

    def start(deck, *words):
        (tmp_path / "job.k").write_text(deck)
        with open(tmp_path / "said", "w") as out:
            running.append(subprocess.Popen([exe, "i=job.k", "d=out", *words], cwd=tmp_path, stdout=out,
                                            stderr=out))
        wait_for((tmp_path / "out" / "status.out").exists)
        wait_for(lambda: int(status(tmp_path / "out" / "status.out")["cycle no."]) > 0)
        return running[0], tmp_path / "out"
    yield start
    for process in running:
        process.kill()
        process.wait()


def status(path):
    """Lines of status.out by name."""
    return {line[1:34].strip(): line[34:] for line in path.read_text().splitlines()}


def ask(folder, word):
    (folder / "d3kil").write_text(word + "\n")
    wait_for(lambda: not (folder / "d3kil").exists())


def plot_times(folder):
    with h5py.File(folder / "job.vtkhdf") as stream:
        return stream["VTKHDF/Steps/Values"][()]


def seconds(text):
    hours, minutes, rest = map(int, text.split(":"))
    return 3600 * hours + 60 * minutes + rest


def test_status_of_a_finished_run(slideline, tmp_path):
    assert slideline("d=plain", deck=drop()).returncode == 0
    assert slideline("d=named", "jobid=mine", deck=drop()).returncode == 0
    assert not (tmp_path / "named" / "status.out").exists()
    for path, job in ((tmp_path / "plain" / "status.out", "job"),
                      (tmp_path / "named" / "mine.status.out", "mine")):
        said = status(path)
        assert said["job"] == job
        assert said["state"].startswith("normal termination: termination time reached")
        assert int(said["cycle no."]) == 200
        assert float(said["time"]) == pytest.approx(0.02, rel=1e-6)
        assert said["estimated clock time to complete"] == "0:00:00"
    assert not list(tmp_path.rglob("*.part"))


def test_status_estimates_the_end(started, tmp_path):
    process, folder = started(long_drop(), "endtim=1000.0")
    ask(folder, "sw2")
    time.sleep(2.0)
    ask(folder, "sw2")
    said = status(folder / "status.out")
    assert said["state"] == "running"
    share = float(said["time"]) / float(said["termination time"])
    done = seconds(said["elapsed clock time"])
    assert done >= 1
    left = seconds(said["estimated clock time to complete"])
    assert (done - 0.5) * (1.0 - share) / share - 1.5 <= left <= (done + 1.0) * (1.0 - share) / share + 1.5
    ask(folder, "stop")
    assert process.wait(timeout=20) == 4
    assert "stopped on request" in status(folder / "status.out")["state"]


@pytest.mark.parametrize("deck", [long_drop(), long_press()], ids=["explicit", "implicit"])
def test_status_without_timing(started, deck):
    """With timing=off the clock takes no laps; `started` waits for a cycle above 0 in status.out."""
    process, folder = started(deck, "timing=off")
    first = int(status(folder / "status.out")["cycle no."])
    wait_for(lambda: int(status(folder / "status.out")["cycle no."]) > first, 6.0)
    said = status(folder / "status.out")
    assert said["state"] == "running" and seconds(said["elapsed clock time"]) >= 1
    ask(folder, "stop")
    assert process.wait(timeout=20) == 4


def test_signals_ask_for_files(started, tmp_path):
    process, folder = started(long_drop())
    process.send_signal(signal.SIGUSR1)
    wait_for((folder / "job.dump01.h5").exists)
    process.send_signal(signal.SIGUSR2)
    process.send_signal(signal.SIGUSR1)
    wait_for((folder / "job.dump02.h5").exists)
    time.sleep(0.1)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=20) == 4
    times = plot_times(folder)
    assert len(times) == 3 and 0.0 < times[1] < times[2]
    assert not (folder / "job.dump03.h5").exists()


def test_swa_brings_histories_up_to_date(started):
    """Rows go to the file once a second by themselves; asked for, they are there within that second."""
    process, folder = started(long_drop())
    path = folder / "job.glstat.csv"
    for _ in range(5):
        size = path.stat().st_size
        wait_for(lambda: path.stat().st_size > size)
        written, size = time.monotonic(), path.stat().st_size
        ask(folder, "swa")
        time.sleep(0.02)
        grown = path.stat().st_size > size
        if time.monotonic() - written < 0.95:
            assert grown
            break
    else:
        pytest.skip("the machine is too busy to tell")
    assert "smallest stable steps" in (folder / "job.log").read_text()
    assert process.poll() is None


def test_switches_of_an_implicit_run(started, tmp_path):
    process, folder = started(long_press())
    ask(folder, "sw2")
    ask(folder, "sw4")
    ask(folder, "sw3")
    ask(folder, "what")
    assert process.poll() is None
    ask(folder, "sw1")
    assert process.wait(timeout=20) == 4
    said = (tmp_path / "said").read_text()
    assert "status (sw2)" in said
    assert said.count("\nrestart file ") == 2
    assert "d3kil holds an unknown word" in said
    assert len(list(folder.glob("*.dump0[12].h5"))) == len(list(folder.glob("*.h5"))) == 2
    times = plot_times(folder)
    assert len(times) == 3 and 0.0 < times[1] < times[2] < 0.5


def test_stop_of_an_implicit_run(started):
    process, folder = started(long_press())
    ask(folder, "stop")
    assert process.wait(timeout=20) == 4
    assert "stopped on request" in status(folder / "status.out")["state"]


@pytest.mark.parametrize("points", [1, 4])
def test_log_names_masses_and_the_elements_that_rule_the_step(slideline, tmp_path, points):
    """Squares of rising size, one material: the smallest come first; masses and centres in closed form."""
    rho, young, poisson = 2000.0, 1.0e6, 0.25
    deck = Deck("squares")
    deck.control(1.0e-4).part(3, points=points).part(8, 3, points=points).elastic(rho, young, poisson, 3)
    sizes = 0.1 + 0.05 * np.random.default_rng(4).permutation(14)
    for k, size in enumerate(sizes):
        deck.mesh(*grid(1, 1, size, size, (2.0 * k, 0.0)), part=3 if k < 9 else 8)
    assert slideline("d=out", deck=deck).returncode == 0
    log = (tmp_path / "out" / "job.log").read_text()
    for part, chosen in ((3, range(9)), (8, range(9, 14))):
        found = re.search(rf"part {part}: (\d+) elements, mass (\S+), centre of mass (\S+), (\S+)", log).groups()
        areas = sizes[chosen.start:chosen.stop] ** 2
        centres = 2.0 * np.array(chosen) + 0.5 * sizes[chosen.start:chosen.stop]
        expected = [len(chosen), rho * areas.sum(), areas @ centres / areas.sum(),
                    0.5 * areas @ np.sqrt(areas) / areas.sum()]
        assert [float(text) for text in found] == pytest.approx(expected, rel=1e-5)
    assert f"all parts: 14 elements, mass {rho * (sizes ** 2).sum():.6E}" in log
    rows = re.search(r"smallest stable steps.*\n.*\n((?:\s+\d+\s+\d+\s+\S+\n)+)", log).group(1).split()
    elements, steps = [int(text) for text in rows[::3]], [float(text) for text in rows[2::3]]
    assert elements == [int(k) + 1 for k in np.argsort(sizes)[:10]]
    speed = np.sqrt(young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) / rho)
    if points == 1:
        assert steps == pytest.approx(np.sqrt(1.0 - poisson) * np.sort(sizes)[:10] / speed, rel=1e-6)
    else:
        assert np.array(steps) / steps[0] == pytest.approx(np.sort(sizes)[:10] / 0.1, rel=1e-6)
    first = float(re.search(r"smallest L/c of the elements (\S+)", log).group(1))
    assert steps[0] == pytest.approx(first, rel=1e-6)


def relaxing(points, most_time):
    """A column that comes to rest very slowly under its weight; the phase ends by DRTERM. Velocities begin with the run."""
    deck = Deck("relaxing")
    deck.add("*CONTROL_TERMINATION", (0.05,)).add("*CONTROL_TIMESTEP", (0.0, 0.9)).hourglass(4, 0.1)
    deck.part(points=points).add("*MAT_PLASTIC_KINEMATIC", (1, 1000.0, 1.0e6, 0.25, 300.0, 1.0e5))
    nodes = deck.mesh(*grid(2, 8, 0.5, 2.0))
    deck.fix(nodes[:3], x=1, y=1).node_set(1, nodes).add("*INITIAL_VELOCITY", (1,), (0.01, 0.0))
    deck.add("*DEFINE_CURVE", (1, 2), (0.0, 0.05), (1.0e4, 1.0)).add("*LOAD_BODY_Y", (1, 1.0))
    deck.add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    deck.add("*CONTROL_DYNAMIC_RELAXATION", (1000, 1.0e-12, 0.99999, most_time))
    deck.output(plot=0.01, glstat=0.001, nodout=0.001, nodes=nodes)
    return deck.add("*DATABASE_BINARY_D3DUMP", (1000000,)).text()


@pytest.mark.parametrize("points", [None, 4])
def test_dynamic_relaxation_hears(exe, tmp_path, points):
    """A restart file of the phase goes on to the bits of the whole run, whether it was asked for or left by a stop; sense
    switches are heard too."""
    def start(name, most_time=600.0):
        (tmp_path / "job.k").write_text(relaxing(points, most_time))
        process = subprocess.Popen([exe, "i=job.k", f"d={name}"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        wait_for((tmp_path / name / "job.nodout.csv").exists)
        return process

    def on(file, name):
        with h5py.File(file) as stream:
            assert stream["state/relaxation/n"][()] > 0, "the phase was over"
        done = subprocess.run([exe, f"r={file}", f"d={name}"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    whole = start("whole")
    whole.send_signal(signal.SIGUSR1)
    said, complaint = whole.communicate(timeout=60)
    assert whole.returncode == 0 and "job.dump01.h5 in dynamic relaxation, after" in said, complaint
    assert numbers(tmp_path / "whole" / "job.glstat.csv", "viscous")[0] == 0.0    # of the run alone
    on(tmp_path / "whole" / "job.dump01.h5", "asked")
    for name, act in (("term", signal.SIGTERM), ("int", signal.SIGINT), ("stop", None)):
        process = start(name, 600.0 if act else 1.0e6)
        if act:
            process.send_signal(act)
        else:
            ask(tmp_path / name, "stop")
        said, complaint = process.communicate(timeout=60)
        assert process.returncode == 4, complaint
        assert "stopped on request in dynamic relaxation" in said and "N o r m a l" in said and "E r r o r" not in said
        assert status(tmp_path / name / "status.out")["state"].startswith("normal termination: stopped on request")
        assert not list((tmp_path / name).glob("job.vtkhdf*"))
        if act:
            on(tmp_path / name / "job.dump01.h5", name)
    for name in ("asked", "term", "int"):
        for table in ("glstat", "nodout"):
            assert (tmp_path / name / f"job.{table}.csv").read_bytes() == (tmp_path / "whole" / f"job.{table}.csv").read_bytes()
        with h5py.File(tmp_path / name / "job.vtkhdf") as one, h5py.File(tmp_path / "whole" / "job.vtkhdf") as two:
            for field in ("Steps/Values", "Points", "PointData/velocity", "CellData/stress"):
                assert np.array_equal(one[f"VTKHDF/{field}"][()], two[f"VTKHDF/{field}"][()]), field
