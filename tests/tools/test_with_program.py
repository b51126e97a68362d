# SPDX-License-Identifier: MIT
"""The tools on results of the program itself (environment SLIDELINE names it)."""
import os
import subprocess

import conftest
import numpy as np
import pytest

from slideline_tools import scenes
from slideline_tools.histories import read_csv
from slideline_tools.results import read

HISTORIES = ("glstat", "rcforc", "nodout", "matsum", "contact")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Forty microseconds of the collision: first contact, 400 steps, three states."""
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    folder = tmp_path_factory.mktemp("collision")
    deck = conftest.ROOT / "input" / "collision" / "collision.k"
    finished = subprocess.run([os.environ["SLIDELINE"], f"i={deck}", f"d={folder}",
                               "p:endtim=4e-5"], capture_output=True, text=True, check=False)
    assert finished.returncode == 0, finished.stdout + finished.stderr
    return folder


def test_mesh_and_states(run):
    results = read(run / "collision.vtkhdf")
    plate, projectile = scenes.collision_grids(1)
    np.testing.assert_allclose(results.times, [0.0, 1.0e-5, 2.0e-5, 3.0e-5, 4.0e-5], rtol=1e-12)
    start = np.vstack([plate.points.reshape(-1, 2), projectile.points.reshape(-1, 2)])
    np.testing.assert_allclose(results.points[0][:, :2], start, atol=1e-14)
    ids = np.concatenate([plate.node.ravel(), projectile.node.ravel()])
    np.testing.assert_array_equal(results.point_field("node_id")[-1], ids)
    quads = np.vstack([plate.quads.reshape(-1, 4), projectile.quads.reshape(-1, 4)])
    np.testing.assert_array_equal(ids[results.cells], quads)
    moved = results.points - results.point_field("displacement")
    np.testing.assert_allclose(moved, np.broadcast_to(moved[0], moved.shape), atol=1e-14)
    assert results.run["deck"].endswith("collision.k")
    assert "*CONTACT_2D_SLIDELINE" in results.run["effective_deck"]


@pytest.mark.parametrize("name", HISTORIES)
def test_histories_are_the_csv_files(run, name):
    table, stored = (read_csv(run / f"collision.{name}.csv"),
                     read(run / "collision.vtkhdf").history(name))
    assert set(table.columns) == set(stored.columns)
    for column in table.columns:
        np.testing.assert_array_equal(table[column], stored[column], err_msg=column)


def test_projectile_before_contact(run):
    rows = read_csv(run / "collision.matsum.csv").where(part=2)
    assert rows["mass"][0] == pytest.approx(7850.0 * 0.020 * 0.005, rel=1e-10)
    assert rows["momentum_y"][0] == pytest.approx(-80.0 * rows["mass"][0], rel=1e-10)
    force = read_csv(run / "collision.rcforc.csv").where(side="slave")
    first = force["time"][np.argmax(force["n_active"] > 0)]
    assert 0.5e-3 / 80.0 <= first <= 0.5e-3 / 80.0 + 1.1e-6


@pytest.mark.parametrize("arguments", [
    ["info"], ["plot", "--output", "x.png"], ["plot", "--contact", "--output", "x.png"],
    ["plot", "--field", "contact_force:y", "--output", "x.png"],
    ["animate", "--field", "velocity:y", "--output", "x.gif"]])
def test_tools_take_the_results(run, tool, tmp_path, arguments):
    arguments = [tmp_path / word if word.startswith("x.") else word for word in arguments]
    finished = tool(arguments[0], run / "collision.vtkhdf", *arguments[1:])
    assert finished.returncode == 0, finished.stderr


@pytest.mark.parametrize("scene, end", [("sliding", "4e-6"), ("block", "0.02")])
def test_other_scenes_are_accepted(tool, slideline, tmp_path, scene, end):
    deck = tmp_path / f"{scene}.k"
    assert tool("make-deck", scene, "--output", deck).returncode == 0
    finished = subprocess.run([slideline, f"i={deck}", f"d={tmp_path}", f"p:endtim={end}"],
                              capture_output=True, text=True, check=False)
    assert finished.returncode == 0, finished.stdout + finished.stderr
    rows = read_csv(tmp_path / f"{scene}.glstat.csv")
    assert abs(rows["energy_ratio"][-1] - 1.0) < 0.01
