# SPDX-License-Identifier: MIT
"""The binout branches of elements, rigid bodies, walls and boundaries as lasso-python reads them, against the tables."""
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest
from lasso.dyna import Binout

from slideline_tools.binout import write_binout
from slideline_tools.finished_run import Run

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[1] / folder) for folder in ("program", "verification")]
from history_decks import HISTORIES, busy_block  # noqa: E402


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    folder = tmp_path_factory.mktemp("branches")
    (folder / "busy.k").write_text(busy_block().text())
    subprocess.run([os.environ["SLIDELINE"], "i=busy.k", "d=out"], cwd=folder, check=True, capture_output=True)
    return Run(folder / "out")


@pytest.fixture(scope="module")
def binout(run, tmp_path_factory):
    path = tmp_path_factory.mktemp("binout") / "binout0000"
    assert set(write_binout(run, path)) == {"glstat", "matsum", *HISTORIES}
    return Binout(str(path))


@pytest.mark.parametrize("branch, entity, columns", [
    (("rwforc", "forces"), "wall", {"normal_force": "normal_force", "x_force": "fx"}),
    (("elout", "shell"), "element", {"sig_xx": "sxx", "sig_yy": "syy", "sig_zz": "szz", "sig_xy": "sxy",
                                     "plastic_strain": "plastic_strain"}),
    (("rbdout",), "part", {"global_x": "x", "global_y": "y", "global_dx": "ux", "global_dy": "uy", "global_rdz": "rotation",
                           "global_vx": "vx", "global_vy": "vy", "global_rvz": "spin", "global_ax": "ax",
                           "global_ay": "ay", "global_raz": "spin_rate"}),
    (("nodfor",), "node", {"x_force": "fx", "y_force": "fy", "energy": "work"}),
    (("secforc",), "section", {"x_force": "fx", "y_force": "fy", "z_moment": "moment", "x_centroid": "x", "y_centroid": "y",
                               "area": "area"})])
def test_branch_has_the_columns(run, binout, branch, entity, columns):
    table = run.results.history(branch[0])
    times = np.unique(table["time"])
    assert np.array_equal(binout.read(*branch, "time"), times)
    ids = binout.read(*branch, "ids")
    if ids.ndim == 1:
        ids = np.tile(ids, (len(times), 1))
    assert np.array_equal(ids.ravel(), table[entity])
    for name, column in columns.items():
        found = binout.read(*branch, name)
        assert np.array_equal(found.ravel(), table[column]) and np.any(found), name


def test_states_and_parts_of_elements(run, binout):
    table = run.results.history("elout")
    state = binout.read("elout", "shell", "state")
    assert np.array_equal(state.ravel(), np.where(table["plastic_strain"] > 0.0, 2, 1)) and set(state.ravel()) == {1, 2}
    assert np.all(binout.read("elout", "shell", "mat") == 1)
    assert binout.read("elout", "shell", "legend_ids").tolist() == [96, 2, 1, 3]


def test_boundaries(run, binout):
    table = run.results.history("bndout")
    n = int(np.sum(table["time"] == table["time"][0]))
    names = ("discrete/nodes", "discrete/rigidbodies", "pressure", "velocity/nodes", "velocity/rigidbodies")
    for condition, name in enumerate(names, start=1):
        branch, rows = ("bndout", *name.split("/")), table["condition"] == condition
        ids = binout.read(*branch, "ids")
        assert np.array_equal(ids, table["id"][:n][table["condition"][:n] == condition])
        for variable, column in (("x_force", "fx"), ("y_force", "fy"), ("energy", "work")):
            assert np.array_equal(binout.read(*branch, variable).ravel(), table[column][rows]), name
        assert np.allclose(binout.read(*branch, "etotal"), table["work"][rows].reshape(-1, len(ids)).sum(axis=1))
    assert np.array_equal(binout.read(*branch, "zmoment").ravel(), table["moment"][rows])


def test_groups(run, binout):
    table = run.results.history("nodfor")
    assert binout.read("nodfor", "groups").tolist() == [3, 9]
    of_first = table["group"] == 3
    assert np.allclose(binout.read("nodfor", "x_total")[:, 0], table["fx"][of_first].reshape(-1, 3).sum(axis=1))


def test_magnitudes_of_sections(run, binout):
    table = run.results.history("secforc")
    assert np.allclose(binout.read("secforc", "total_force").ravel() ** 2, table["fx"] ** 2 + table["fy"] ** 2)
    assert np.array_equal(binout.read("secforc", "total_moment").ravel(), np.abs(table["moment"]))


def test_axes_of_bodies(run, binout):
    table = run.results.history("rbdout")
    assert np.allclose(binout.read("rbdout", "dircos_21").ravel(), np.sin(table["rotation"]), rtol=0.0, atol=1e-15)
    assert binout.read("rbdout", "legend_ids").tolist() == [2, 3]
    assert binout.read("rbdout", "legend")[:70].strip() == "part 2"
