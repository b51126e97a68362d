# SPDX-License-Identifier: MIT
"""Advice on runs: each check on a small run of its own, built so that one thing is needless."""
import dataclasses
import json
import os
import pathlib
import subprocess

import numpy as np
import pytest
import wasteful_decks

from slideline_tools import scenes
from slideline_tools.advise import advise, bodies, finished, report, running, touching

def run_variant(folder, waste, *arguments):
    folder.mkdir(parents=True, exist_ok=True)
    return run_scene(folder, wasteful_decks.deck(waste, level=1), "jobid=run", *arguments)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Folders: a run with all needless things, one with none, by name."""
    root = tmp_path_factory.mktemp("advise")
    return {"all": run_variant(root / "all", wasteful_decks.WASTE), "none": run_variant(root / "none", ()),
            "threads": run_variant(root / "threads", (), "ncpu=4", "endtim=1e-5")}


def topics(folder):
    return {item.topic: item for item in advise(folder)[1]}


@pytest.mark.parametrize("topic", [name for name in wasteful_decks.WASTE
                                   if name != "written too often"])
def test_finds_what_is_needless_and_not_more(runs, topic):
    assert topic in topics(runs["all"])
    assert topic not in topics(runs["none"])


def test_figures_are_those_of_the_deck(runs):
    found = topics(runs["all"])
    run = advise(runs["all"])[0]
    # The columns of the block are 20/24 mm wide: the shortest length of all elements.
    assert run.element_limit == pytest.approx(20.0e-3 / 24 / 6000.98, rel=1e-3)
    # Flight of 1e-4 s of 3e-4 s; a third of what is paid per cycle.
    expected = run.seconds_of("loop") + run.seconds_of("output")
    assert found["long flight"].seconds == pytest.approx(expected / 3.0, rel=0.05)
    assert "part 2 by (0, -0.0009" in found["long flight"].change
    assert found["symmetry"].seconds == pytest.approx(0.5 * expected)
    assert "x = 0:" in found["symmetry"].what
    assert "interface 2" in found["never touched"].what
    assert "*MAT_PLASTIC_KINEMATIC" in found["never yielded"].change
    run.tables["glstat"]["external_work"][-1] = 1.0e-9
    assert touching.long_flight(run) == []  # what is driven may not begin later


def test_threads(runs):
    found = topics(runs["threads"])["threads"]
    assert found.seconds is None and "4 threads" in found.what
    assert "threads" not in topics(runs["none"])


def test_plate_that_yields_and_bodies_that_touch(slideline, tmp_path):
    """The collision of the paper: neither law nor contact is needless, and it is a half model."""
    deck = pathlib.Path(__file__).parents[2] / "input/collision/collision.k"
    done = subprocess.run([slideline, f"i={deck}", f"d={tmp_path}", "p:endtim=3e-4"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert not set(topics(tmp_path)) & {"never yielded", "never touched", "symmetry",
                                        "long flight", "rigid", "long surface"}


def test_short_touch_between_rows_is_not_overlooked(tmp_path):
    """No row of rcforc sees a contact, but the contact energy does: no advice."""
    folder = run_variant(tmp_path, ())
    run = finished.Finished(folder)
    for name in ("n_active", "fx", "fy"):
        run.tables["rcforc"].columns[name][:] = 0
    assert np.any(run.tables["glstat"]["contact"])
    assert touching.never_touched(run) == []


def test_any_file_of_the_run_will_do(runs, tool):
    for name in ("", "run.vtkhdf", "run.log", "run.timing.csv", "run.effective.k",
                 "run.glstat.csv"):
        finished_tool = tool("advise", runs["none"] / name)
        assert finished_tool.returncode == 0, finished_tool.stderr
        assert finished_tool.stdout.startswith("run: ")


def test_json(runs, tool):
    report_ = json.loads(tool("advise", runs["all"], "--json", "--all").stdout)
    by_topic = {item["topic"]: item for item in report_["advice"]}
    assert by_topic["symmetry"]["share"] == pytest.approx(
        by_topic["symmetry"]["seconds"] / report_["total_seconds"])
    assert all(item["what"] and item["evidence"] and item["change"] for item in by_topic.values())


def test_what_is_no_run(tool, tmp_path):
    assert tool("advise", tmp_path).returncode == 2
    assert tool("advise", tmp_path / "x.txt").returncode == 2
    (tmp_path / "a.log").write_text("", encoding="ascii")
    missing = tool("advise", tmp_path)
    assert missing.returncode == 2 and "timing.csv" in missing.stderr
    (tmp_path / "b.log").write_text("", encoding="ascii")
    assert "several runs: a.log, b.log" in tool("advise", tmp_path).stderr


def test_run_that_failed_gets_no_advice(runs, tmp_path):
    for file in runs["all"].iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    log = tmp_path / "run.log"
    log.write_text(log.read_text(encoding="utf-8").replace("N o r m a l", "E r r o r"),
                   encoding="utf-8")
    _, found, notes = advise(tmp_path)
    assert not found and "did not end normally" in notes[0]


def test_run_that_goes_on_from_a_restart_file_has_not_ended(runs, tmp_path):
    """Its log tells of the normal end of the part before."""
    for file in runs["all"].iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    with open(tmp_path / "run.log", "a", encoding="utf-8") as log:
        log.write("restart from the restart file run.dump01.h5\n")
    _, found, notes = advise(tmp_path)
    assert not found and "did not end normally" in notes[0]


def test_contact_time_by_interface(runs):
    """Shared out by slave nodes, as many on both, or as timed, which names the id."""
    run = advise(runs["all"])[0]
    first, second = run.interfaces
    assert len(first.slave.nodes) == len(second.slave.nodes)
    shared = touching.contact_seconds(run, second)
    assert 0.0 < shared == pytest.approx(run.seconds_of("contact") / 2.0)
    run.seconds.update({f"contact_{step}.2": 1.0 for step in ("search", "pairing", "force")})
    assert touching.contact_seconds(run, second) == 3.0
    assert touching.contact_seconds(run, second, ("search",)) == 1.0
    assert touching.contact_seconds(run, first) == pytest.approx(shared)
    run.seconds.update({f"contact_{step}.12": 2.0 for step in ("search", "pairing", "force")})
    assert touching.contact_seconds(run, dataclasses.replace(first, id=12)) == 6.0


def test_run_without_clock_gets_no_advice(runs, tmp_path):
    for file in runs["all"].iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    (tmp_path / "run.timing.csv").write_text("phase,seconds,calls,share\ntotal,1.0,1,1.0\n",
                                             encoding="ascii")
    _, found, notes = advise(tmp_path)
    assert not found and "timing=off" in notes[0]


def test_without_a_program_states_alone_are_judged(runs, monkeypatch):
    monkeypatch.setenv("SLIDELINE", "/nowhere/slideline")
    _, found, notes = advise(runs["all"])
    assert {item.topic for item in found} - {"written too often"} == {"symmetry"}
    assert any("no program reads the deck as run" in note for note in notes)
    monkeypatch.undo()
    assert not any("no program" in note for note in advise(runs["all"])[2])


@pytest.mark.parametrize("n_slave, expected", [(51, False), (50, True)])
def test_symmetry_needs_nodes_on_the_cut(slideline, tmp_path, n_slave, expected):
    """The middle element of 51 lies across x = 5."""
    folder = run_scene(tmp_path, scenes.block(5, implicit=True, n_slave=n_slave), "endtim=0.05")
    assert ("symmetry" in topics(folder)) is expected


def test_mirror_images():
    points = np.array([[0, 0], [1, 0], [3, 0], [4, 0], [0, 1], [1, 1], [3, 1], [4, 1.0]])
    cells = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6]])
    pairs = bodies.mirror_pairs(points, 0)
    assert pairs.tolist() == [3, 2, 1, 0, 7, 6, 5, 4]
    assert bodies.mirrored_cells(cells, pairs).tolist() == [2, 1, 0]
    assert bodies.mirrored_cells(cells[:2], pairs) is None
    points[[1, 5], 0] = 1.1
    assert bodies.mirror_pairs(points, 0) is None
    assert bodies.mirror_pairs(points, 1).tolist() == [4, 5, 6, 7, 0, 1, 2, 3]


def test_coarser_rows():
    times = np.linspace(0.0, 1.0, 101)
    straight, bent = np.stack([times], axis=1), np.stack([np.sin(40.0 * times)], axis=1)
    assert running.coarse_error(times, straight, 10) < 1e-12
    # Chord of a sine over the interval d: d^2/8 times the second derivative, over the range 2.
    assert running.coarse_error(times, bent, 2) == pytest.approx(0.8 ** 2 / 8.0 / 2.0, rel=0.06)


def test_small_savings_are_left_out():
    items = [report.Advice("a", "", "", "", seconds, "") for seconds in (0.005, 0.5, 2.0, None)]
    assert [item.seconds for item in report.select(items, 100.0)] == [2.0, None]
    assert [item.seconds for item in report.select(items, 0.1)] == [2.0, 0.5, None]
    assert len(report.select(items, 100.0, everything=True)) == 4


@pytest.fixture(scope="module")
def oblique(tmp_path_factory):
    """The oblique impact: a corner of a turned block on a free one, quarter of a second."""
    return run_scene(tmp_path_factory.mktemp("oblique"), scenes.oblique())


def run_scene(folder, text, *arguments):
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    (folder / "scene.k").write_text(text, encoding="ascii")
    done = subprocess.run([os.environ["SLIDELINE"], f"i={folder / 'scene.k'}", f"d={folder}",
                           *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_corner_first(oblique):
    found = topics(oblique)
    rows = finished.Finished(oblique).tables["contact"]
    pressed = np.unique(rows["node"][rows["pressure"] > 0.0])
    assert f"{len(pressed)} of 18 slave nodes" in found["long surface"].evidence
    force = finished.Finished(oblique).tables["rcforc"].where(side="slave")
    first, last = force["time"][force["n_active"] > 0][[0, -1]]
    assert f"from {first:.4g} to {last:.4g}" in found["touched for a while"].what
    assert "symmetry" not in found and "never touched" not in found


def test_symmetric_mesh_that_moves_otherwise(runs):
    run = finished.Finished(runs["all"])
    assert [item.topic for item in bodies.symmetric(run)] == ["symmetry"]
    moved = run.results.point_field("displacement")
    moved[-1, 0, 0] += 2.0 * bodies.SYMMETRIC * np.abs(moved).max()
    assert bodies.symmetric(run) == []


def test_rigid_part_strains_little_and_keeps_little_energy(runs):
    run = finished.Finished(runs["none"])
    assert bodies.nearly_rigid(run) == []
    energy = run.tables["matsum"]["internal"]
    energy[run.tables["matsum"]["part"] == 2] *= 1.0e-4
    assert bodies.nearly_rigid(run) == []
    run.model.parts[2].young *= 1.0e6
    found = bodies.nearly_rigid(run)
    assert len(found) == 1 and found[0].what.startswith('part 2 "block"')
    # Block and plate have equal elements, 24 and 40 columns of 4.
    assert found[0].seconds == pytest.approx(run.seconds_of("elements") * 24.0 / 64.0)


def test_output_written_too_often(runs):
    run = finished.Finished(runs["all"])
    run.seconds["output"] = 0.05 * run.total
    assert running.too_often(run) == []
    run.seconds["output"] = 0.5 * run.total
    found = {item.what.split()[0]: item for item in running.too_often(run)}
    assert "*DATABASE_GLSTAT from 1.22e-07 to" in found["glstat"].change
    assert 0.0 < found["glstat"].seconds < run.seconds["output"]
    # Energies of alternating rows do not lie on straight lines.
    run.tables["glstat"]["kinetic"][::2] *= 1.1
    assert "glstat" not in {item.what.split()[0] for item in running.too_often(run)}
