# SPDX-License-Identifier: MIT
"""Advice on runs: each check on a small run of its own, built so that one thing is needless."""
import dataclasses
import json
import os
import re
import shutil
import subprocess

import numpy as np
import pytest
import wasteful_decks

from slideline_tools import scenes
from slideline_tools.advise import advise, bodies, finished, geometry, outputs, report, stepping, surfaces, touching
from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.run_log import read_log

LOG = """slideline 0.1.0
part 1 "plate": 576 elements, section 1, material 1
part 7 "": 384 elements, section 1, material 2
material 1: density 2.700000E+03, E 6.9E+10, nu 3.3E-01, K 6.8E+10, G 2.6E+10, c 6.15E+03, yield 2.76E+08, plastic modulus 0.0E+00, beta 1.0E+00
material 2: density 7.850000E+03, E 2.1E+11, nu 3.0E-01, K 1.75E+11, G 8.1E+10, c 6.0E+03
end: time 1.000000E-03, step scale 9.000000E-01
part 1: one-point quads, viscous hourglass control 1.0E-01, bulk viscosity Q1 1.5E+00 Q2 6.0E-02
part 7: fully integrated quads (2x2 points), mean dilatation, bulk viscosity Q1 0.0E+00 Q2 0.0E+00
interface 4 "a title": two-pass NTS-AR (type 3)
  slave: 49 nodes, 48 segments of mean length 4.2E-04
  master: 41 nodes, 40 segments of mean length 6.2E-04
  penalty: 5.0E+08 per slave node = 1.2E+12 per unit length; master pass 5.0E+08 per master node = 8.0E+11 per unit length
first time step 5.000000E-08, smallest L/c of the elements 6.943311E-08
"""


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
    assert run.log.element_limit == pytest.approx(20.0e-3 / 24 / 6000.98, rel=1e-3)
    assert wasteful_decks.SHORT_STEP == pytest.approx(
        float(found["short steps"].evidence.split("mean step ")[1].split(";")[0]))
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


def test_longer_step_is_stable(runs, tmp_path):
    step = topics(runs["all"])["short steps"].change.split("dt=")[1].rstrip(")")
    waste = [name for name in wasteful_decks.WASTE if name != "short steps"]
    ratio = advise(run_variant(tmp_path / "long", waste, f"dt={step}"))[0].tables[
        "glstat"]["energy_ratio"]
    assert np.abs(ratio - 1.0).max() < 0.01


def test_threads(runs):
    found = topics(runs["threads"])["threads"]
    assert found.seconds is None and "4 threads" in found.what
    assert "threads" not in topics(runs["none"])


def test_plate_that_yields_and_bodies_that_touch(slideline, tmp_path):
    """The collision of the paper: neither law nor contact is needless, and it is a half model."""
    deck = finished.pathlib.Path(__file__).parents[2] / "input/collision/collision.k"
    done = subprocess.run([slideline, f"i={deck}", f"d={tmp_path}", "p:endtim=3e-4"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert not set(topics(tmp_path)) & {"never yielded", "never touched", "symmetry",
                                        "long flight", "rigid", "long surface", "dear type"}


def test_short_touch_between_rows_is_not_overlooked(tmp_path):
    """No row of rcforc sees a contact, but the contact energy does: no advice."""
    folder = run_variant(tmp_path, ())
    run = finished.read_run(folder)
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


def test_contact_time_by_interface(runs):
    """Shared out by slave nodes, as many on both, or as timed, which names the id."""
    run = advise(runs["all"])[0]
    first, second = run.log.interfaces.values()
    assert first.n_slave == second.n_slave
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


def test_log():
    log = read_log(LOG)
    assert log.parts[7].points == 4 and log.parts[1].viscosity == (1.5, 0.06)
    assert log.materials[1]["yield"] == 2.76e8 and "yield" not in log.materials[2]
    assert log.materials[2]["density"] == 7850.0 and log.materials[1]["c"] == 6150.0
    interface = log.interfaces[4]
    assert (interface.ctype, interface.n_slave, interface.n_master) == (3, 49, 41)
    assert (interface.slave_penalty, interface.master_penalty) == (1.2e12, 8.0e11)
    assert not log.normal and log.element_limit == 6.943311e-08


@pytest.mark.parametrize("force, length", [("N", "m"), ("(g cm/us^2)", "cm")])
def test_log_of_a_deck_that_tells_its_units(force, length):
    text = LOG.replace(" per unit length", f" {force}/{length}^2")
    for side in ("slave", "master"):
        text = text.replace(f"5.0E+08 per {side}", f"5.0E+08 {force}/{length} per {side}")
    text = text.replace("E-04\n", f"E-04 {length}\n")
    assert text.count(f"{force}/{length}") == 4 and text.count(f"E-04 {length}\n") == 2
    assert read_log(text) == read_log(LOG)


def test_log_of_a_material_with_points_of_hardening():
    log = read_log("material 3: density 8.0E+03, E 2.0E+11, c 5.8E+03, yield 3.0E+08, hardening by 2 point(s) to plastic "
                   "strain 1.0E-01, then modulus 1.0E+09, 2 strain rates from 0.0E+00 to 1.0E+02, Cowper-Symonds C "
                   "4.0E+01, P 5.0E+00, rate factor by curve 7\n")
    assert log.materials[3] == {
        "density": 8.0e3, "E": 2.0e11, "c": 5.8e3, "yield": 3.0e8, "points of hardening": 2.0, "last plastic strain": 0.1,
        "last plastic modulus": 1.0e9, "strain rates": 2.0, "lowest strain rate": 0.0, "highest strain rate": 100.0,
        "Cowper-Symonds C": 40.0, "Cowper-Symonds P": 5.0, "rate factor by curve": 7.0}


def test_log_of_an_automatic_penalty():
    """The penalties come in a line of their own; a restart has none."""
    share = "  penalty: 1.000000E+00 of the largest stable one\n"
    head, foot = LOG.split("  penalty: ")
    fixed, rest = foot.split("\n", 1)
    log = read_log(f"{head}{share}interface 4: penalty {fixed}, 1.0E+00 of the largest for a time "
                   f"step of 1.0E-07\n{rest}")
    interface = log.interfaces[4]
    assert interface.stable_share == 1.0 and len(log.interfaces) == 1
    assert (interface.node_penalty, interface.slave_penalty) == (5.0e8, 1.2e12)
    assert interface.master_penalty == 8.0e11
    assert read_log(head + share).interfaces[4].slave_penalty == 0.0
    assert not read_log(LOG).interfaces[4].stable_share


def test_restart_in_a_folder_of_its_own_says_what_it_lacks(runs, slideline, tmp_path):
    first, second = tmp_path / "first", tmp_path / "second"
    first.mkdir()
    deck = wasteful_decks.deck((), level=1).replace(
        "*END", "*DATABASE_BINARY_RUNRSF\n200,\n*END")
    run_scene(first, deck, "jobid=run", "endtim=5e-5")
    done = subprocess.run([slideline, f"r={first / 'run.runrsf.h5'}", f"d={second}"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    notes = advise(second)[2]
    assert any(note.startswith("interfaces, bulk viscosity and steps: the log of a restart")
               for note in notes)
    assert not any(note.startswith("steps") for note in notes)
    assert not any("restart" in note for note in advise(runs["none"])[2])


def test_a_log_that_is_continued_is_no_restart_alone():
    """The log of the run before stands above, of either method."""
    on = "goes on from the restart file a/job.runrsf.h5\n"
    assert read_log(on).is_restart
    assert not read_log(LOG + on).is_restart
    assert not read_log("implicit method: static, first step 1.0E-01\n" + on).is_restart


@pytest.mark.parametrize("rigid_die", [False, True])
def test_automatic_penalty_leaves_the_step_alone(slideline, tmp_path, rigid_die):
    """The penalty would follow a longer step: nothing is said of either."""
    deck = scenes.sliding(rigid_die=rigid_die)
    given, share = (tmp_path / name for name in ("given", "share"))
    for folder, arguments in ((given, ()), (share, ("punit=3", "pen=0.5"))):
        folder.mkdir()
        run_scene(folder, deck, "p:endtim=2e-5", "ctype=5", *arguments)
    _, found, notes = advise(share)
    assert not {item.topic for item in found} & {"short steps", "penalty rules the step"}
    assert "steps: the penalty follows the step (PUNIT 3, interface 1)" in notes
    assert finished.read_run(share).log.interfaces[1].slave_penalty > 0.0
    assert not any("steps" in note for note in advise(given)[2])


def test_equation_of_state_leaves_the_step_alone(runs, tmp_path):
    """Under pressure waves run faster than at the start: no limit follows from the mesh."""
    shutil.copytree(runs["all"], tmp_path / "run")
    log = tmp_path / "run" / "run.log"
    words, count = re.subn("(?m)^(material 1: .*)$", r"\1, equation of state 5 (K and c of the start)", log.read_text())
    assert count == 1
    log.write_text(words)
    _, found, notes = advise(tmp_path / "run")
    assert "short steps" in topics(runs["all"]) and "short steps" not in {item.topic for item in found}
    assert "steps: the wave speed follows the equation of state (material 1)" in notes


def test_unknown_limits_have_a_reason(runs):
    run = finished.read_run(runs["none"])
    assert stepping.unknown_limits(run) == "" and stepping.limits(run) is not None
    run.log.interfaces[1].slave_penalty = 0.0
    assert stepping.unknown_limits(run) == "the log has no penalty of interface 1"
    assert stepping.limits(run) is None
    run.log.element_limit = 0.0
    assert "smallest L/c" in stepping.unknown_limits(run)


@pytest.mark.parametrize("n_slave, expected", [(51, False), (50, True)])
def test_symmetry_needs_nodes_on_the_cut(slideline, tmp_path, n_slave, expected):
    """The middle element of 51 lies across x = 5."""
    folder = run_scene(tmp_path, scenes.block(5, implicit=True, n_slave=n_slave), "endtim=0.05")
    assert ("symmetry" in topics(folder)) is expected


def test_mirror_images():
    points = np.array([[0, 0], [1, 0], [3, 0], [4, 0], [0, 1], [1, 1], [3, 1], [4, 1.0]])
    cells = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6]])
    pairs = geometry.mirror_pairs(points, 0)
    assert pairs.tolist() == [3, 2, 1, 0, 7, 6, 5, 4]
    assert geometry.mirrored_cells(cells, pairs).tolist() == [2, 1, 0]
    assert geometry.mirrored_cells(cells[:2], pairs) is None
    points[[1, 5], 0] = 1.1
    assert geometry.mirror_pairs(points, 0) is None
    assert geometry.mirror_pairs(points, 1).tolist() == [4, 5, 6, 7, 0, 1, 2, 3]


def test_areas_and_limits():
    points = np.array([[0, 0], [2, 0], [2, 1], [0, 1.0]])
    area, length = geometry.corner_difference(points, np.array([[0, 1, 2, 3], [0, 1, 2, 2]]))
    np.testing.assert_allclose(area, [2.0, 1.0])
    np.testing.assert_allclose(length, [1.0, 1.0 / np.sqrt(5.0)])


def test_coarser_rows():
    times = np.linspace(0.0, 1.0, 101)
    straight, bent = np.stack([times], axis=1), np.stack([np.sin(40.0 * times)], axis=1)
    assert outputs.coarse_error(times, straight, 10) < 1e-12
    # Chord of a sine over the interval d: d^2/8 times the second derivative, over the range 2.
    assert outputs.coarse_error(times, bent, 2) == pytest.approx(0.8 ** 2 / 8.0 / 2.0, rel=0.06)


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
    rows = finished.read_run(oblique).tables["contact"]
    pressed = np.unique(rows["node"][rows["pressure"] > 0.0])
    assert f"{len(pressed)} of 18 slave nodes" in found["long surface"].evidence
    force = finished.read_run(oblique).tables["rcforc"].where(side="slave")
    first, last = force["time"][force["n_active"] > 0][[0, -1]]
    assert f"from {first:.4g} to {last:.4g}" in found["touched for a while"].what
    assert "symmetry" not in found and "never touched" not in found


def test_symmetric_mesh_that_moves_otherwise(runs):
    run = finished.read_run(runs["all"])
    assert [item.topic for item in bodies.symmetric(run)] == ["symmetry"]
    moved = run.results.point_field("displacement")
    moved[-1, 0, 0] += 2.0 * bodies.SYMMETRIC * np.abs(moved).max()
    assert bodies.symmetric(run) == []


def test_rigid_part_strains_little_and_keeps_little_energy(runs):
    run = finished.read_run(runs["none"])
    assert bodies.nearly_rigid(run) == []
    energy = run.tables["matsum"]["internal"]
    energy[run.tables["matsum"]["part"] == 2] *= 1.0e-4
    assert bodies.nearly_rigid(run) == []
    run.log.materials[2]["E"] *= 1.0e6
    found = bodies.nearly_rigid(run)
    assert len(found) == 1 and found[0].what.startswith('part 2 "block"')
    # Block and plate have equal elements, 24 and 40 columns of 4.
    assert found[0].seconds == pytest.approx(run.seconds_of("elements") * 24.0 / 64.0)


def test_dear_type(runs):
    run = finished.read_run(runs["none"])
    run.seconds["contact_force"] = 0.3 * run.total
    assert touching.dear_type(run) == []
    run.log.interfaces[1].ctype = 6
    found = touching.dear_type(run)
    assert found[0].seconds == pytest.approx(0.20 * run.seconds_of("contact"))
    run.seconds["contact_force"] = 0.0
    assert touching.dear_type(run) == []


def test_output_written_too_often(runs):
    run = finished.read_run(runs["all"])
    run.seconds["output"] = 0.05 * run.total
    assert outputs.too_often(run) == []
    run.seconds["output"] = 0.5 * run.total
    found = {item.what.split()[0]: item for item in outputs.too_often(run)}
    assert "*DATABASE_GLSTAT from 1e-07 to" in found["glstat"].change
    assert 0.0 < found["glstat"].seconds < run.seconds["output"]
    # Energies of alternating rows do not lie on straight lines.
    run.tables["glstat"]["kinetic"][::2] *= 1.1
    assert "glstat" not in {item.what.split()[0] for item in outputs.too_often(run)}


@pytest.mark.parametrize("ctype", ALL_TYPES)
@pytest.mark.parametrize("scene", [scenes.patch, scenes.oblique])
def test_limit_of_springs_is_that_of_the_program(slideline, tmp_path, scene, ctype):
    """The program warns of a penalty far too stiff and names the limits; they are ours."""
    (tmp_path / "scene.k").write_text(scene(), encoding="ascii")
    subprocess.run([slideline, f"i={tmp_path / 'scene.k'}", f"d={tmp_path}", f"ctype={ctype}",
                    "pen=1e9", "endtim=0.02"], capture_output=True, check=False)
    log = (tmp_path / "scene.log").read_text(encoding="utf-8")
    warned = float(log.split("springs of all contacts at its nodes alone ")[1].split()[0])
    run = finished.read_run(tmp_path)
    interface = run.log.interfaces[1]
    limit = surfaces.spring_limit(run, interface, surfaces.read_surfaces(run)[1],
                                  geometry.lumped_mass(run))
    assert limit == pytest.approx(warned, rel=1e-5)


def test_softer_penalty_and_its_step_are_stable(tmp_path):
    folder = run_scene(tmp_path, scenes.patch())
    found = topics(folder)["penalty rules the step"]
    factor = float(found.change.split("PEN times ")[1].split()[0])
    step = float(found.change.split("dt=")[1].rstrip(")"))
    again = tmp_path / "again"
    again.mkdir()
    run_scene(again, scenes.patch(), f"p:pen={1.0e6 * factor}", f"dt={step}")
    soft, hard = finished.read_run(again), finished.read_run(folder)
    assert len(soft.tables["glstat"]) and soft.log.normal
    assert np.abs(soft.tables["glstat"]["kinetic"]).max() < 2.0 * np.abs(
        hard.tables["glstat"]["kinetic"]).max()


def test_saving_of_an_interface(runs):
    run = finished.read_run(runs["all"])
    saved, = touching.never_touched(run)
    assert saved.seconds == pytest.approx(
        run.seconds_of("contact") / 2.0 + run.seconds_of("nodes") / 4.0)
