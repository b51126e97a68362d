# SPDX-License-Identifier: MIT
"""Axisymmetric runs turned into solids, as VTK reads them."""
import h5py
import numpy as np
import pytest
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from slideline_tools import revolve


@pytest.fixture
def round_file(results_file):
    """The three cells as an axisymmetric run: their left edge lies on the axis."""
    with h5py.File(results_file, "a") as stream:
        root = stream["VTKHDF"]
        root["CellData/hoop_strain"], root["Steps/CellDataOffsets/hoop_strain"] = np.zeros(3), np.zeros(3, dtype=int)
    return results_file


def read(path, state):
    """The grid of a state."""
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    reader.SetStep(state)
    reader.Update()
    return reader.GetOutput()


@pytest.mark.parametrize("degrees, sectors", [(360.0, 24), (90.0, 6)])
def test_volumes_are_those_of_the_areas_times_their_way(tool, round_file, tmp_path, degrees, sectors):
    """A sector is a prism of the cell: 2 sin(half the angle) cos(half the angle) for the angle (Pappus)."""
    path = tmp_path / "solid.vtkhdf"
    assert tool("revolve", round_file, "--degrees", degrees, "--sectors", sectors, "-o", path).returncode == 0
    grid = read(path, 0)
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    volumes = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume")).reshape(sectors, 3)
    # Two unit squares from r = 0 and 1, and the triangle (2,0), (3,0), (2,1).
    moments = np.array([0.5, 1.5, 0.5 * 7.0 / 3.0])
    assert np.allclose(volumes, moments * np.sin(np.radians(degrees / sectors)), rtol=1e-12)
    assert read(path, 2).GetBounds()[3] > grid.GetBounds()[3]


def test_vectors_and_stresses_turn_along():
    """A uniform stress in x of the plane turned by 90 degrees is one in z; its invariants stay at any angle."""
    stress = np.array([[5.0, 2.0, 1.0, 0.5, 0.0, 0.0]])
    for angle in (0.0, 0.7, np.pi / 2):
        xx, yy, zz, xy, yz, xz = revolve.turned(stress, np.array([angle]))[0, 0]
        rotation = np.array([[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]])
        expected = rotation @ np.array([[5.0, 0.5, 0.0], [0.5, 2.0, 0.0], [0.0, 0.0, 1.0]]) @ rotation.T
        assert np.allclose([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], expected, atol=1e-14)
        assert np.allclose(revolve.turned(np.array([[1.0, 2.0, 0.0]]), np.array([angle]))[0, 0],
                           rotation @ [1.0, 2.0, 0.0], atol=1e-15)


def test_picture(tool, round_file, tmp_path):
    assert tool("revolve", round_file, "--field", "mises", "-o", tmp_path / "x.png").returncode == 0
    assert (tmp_path / "x.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("words, message", [
    (["--degrees", "400"], "at most 360 degrees"), (["--sectors", "1"], "3 to 720 sectors"), (["-o", "x.jpg"], ".vtkhdf or .png")])
def test_refused(tool, round_file, tmp_path, words, message):
    done = tool("revolve", round_file, "-o", tmp_path / "x.vtkhdf", *words)
    assert done.returncode == 2 and message in done.stderr


def test_plane_run_is_refused(tool, results_file, tmp_path):
    done = tool("revolve", results_file, "-o", tmp_path / "x.vtkhdf")
    assert done.returncode == 2 and "not axisymmetric" in done.stderr
