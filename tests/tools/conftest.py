# SPDX-License-Identifier: MIT
"""A small results file in the agreed layout, written by hand, and helpers of the tool tests."""
import dataclasses
import os
import pathlib

import h5py
import numpy as np
import pytest

from slideline_tools import cli

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Two quads and a triangle:   3---4---5
#                             |   |   | \
#                             0---1---2--6
START = np.array([[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1], [3, 0]], dtype=float)
CELLS = [[0, 1, 4, 3], [1, 2, 5, 4], [2, 6, 5]]
NODE_IDS = np.array([11, 12, 13, 21, 22, 23, 99])
TIMES = np.array([0.0, 0.5, 1.0])


def displacement(time):
    """Stretch in x by 10 % of time and a lift of 0.2 t."""
    lift = np.full(len(START), 0.2 * time)
    return np.stack([0.1 * time * START[:, 0], lift, 0.0 * lift], axis=1)


def stress(time):
    values = np.arange(18.0).reshape(3, 6)
    return (values - 4.0) * time


def write_results(path, n_claimed=None, history=True):
    """The file; `n_claimed` < 3 states imitates a killed run whose arrays are longer."""
    n_node, n_cell = len(START), len(CELLS)
    flat = np.array([node for cell in CELLS for node in cell])
    with h5py.File(path, "w") as stream:
        root = stream.create_group("VTKHDF")
        root.attrs["Version"] = [2, 0]
        root.attrs.create("Type", b"UnstructuredGrid", dtype="S16")
        root["NumberOfPoints"], root["NumberOfCells"] = [n_node], [n_cell]
        root["NumberOfConnectivityIds"] = [len(flat)]
        root["Connectivity"] = flat
        root["Offsets"] = np.cumsum([0] + [len(cell) for cell in CELLS])
        root["Types"] = np.array([9 if len(cell) == 4 else 5 for cell in CELLS], dtype="uint8")
        start3 = np.hstack([START, np.zeros((n_node, 1))])
        root["Points"] = np.vstack([start3 + displacement(t) for t in TIMES])
        point, cell = root.create_group("PointData"), root.create_group("CellData")
        point["displacement"] = np.vstack([displacement(t) for t in TIMES])
        point["contact_pressure"] = np.concatenate([np.full(n_node, 5.0 * t) for t in TIMES])
        point["node_id"] = NODE_IDS
        cell["stress"] = np.vstack([stress(t) for t in TIMES])
        cell["plastic_strain"] = np.concatenate([t * np.array([0.1, 0.2, 0.0]) for t in TIMES])
        cell["mises"] = np.concatenate([t * np.array([1e6, 2e6, 3e6]) for t in TIMES])
        cell["part_id"] = np.array([1, 1, 2])
        write_steps(root, n_node, n_cell, len(TIMES) if n_claimed is None else n_claimed)
        if history:
            write_history(stream)
        run = stream.create_group("run")
        run.attrs["title"] = "three cells"
        run.attrs["deck"] = np.bytes_("three.k")
        run["effective_deck"] = "*KEYWORD\n*END\n"
    return path


def write_steps(root, n_node, n_cell, n_claimed):
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = n_claimed
    steps["Values"] = TIMES
    zero, index = np.zeros(3, dtype=int), np.arange(3)
    steps["PartOffsets"], steps["NumberOfParts"] = zero, zero + 1
    steps["PointOffsets"] = n_node * index
    steps["CellOffsets"] = steps["ConnectivityIdOffsets"] = zero
    for group, names, rows in (("PointData", root["PointData"], n_node),
                               ("CellData", root["CellData"], n_cell)):
        offsets = steps.create_group(f"{group}Offsets")
        for name in names:
            constant = len(root[group][name]) == rows
            offsets[name] = zero if constant else rows * index


def write_history(stream):
    time = np.linspace(0.0, 1.0, 11)
    glstat = stream.create_group("history/glstat")
    glstat["time"], glstat["cycle"] = time, np.arange(11) * 10
    glstat["kinetic"], glstat["internal"], glstat["total"] = 1 - time, time, 0 * time + 1
    rcforc = stream.create_group("history/rcforc")
    rcforc["time"], rcforc["interface"] = np.repeat(time, 2), np.ones(22, dtype=int)
    rcforc["side"] = np.tile([1, 2], 11)
    force = np.repeat(np.sin(np.pi * time), 2) * np.tile([1.0, -1.0], 11)
    rcforc["fy"], rcforc["fx"] = force, 0 * force
    contact = stream.create_group("history/contact")
    contact["time"], contact["interface"] = np.repeat(TIMES, 3), np.ones(9, dtype=int)
    contact["node"], contact["s"] = np.tile([11, 12, 13], 3), np.tile([0.0, 1.0, 2.0], 3)
    contact["pressure"] = np.repeat(TIMES, 3) * np.tile([1.0, 2.0, 1.0], 3)


@pytest.fixture
def results_file(tmp_path):
    return write_results(tmp_path / "three.vtkhdf")


def draw_plainly(patch):
    """Coarse pictures without a search for their layout and without formulas, whose parser takes half of the time, for tests of
    what a page says; tests of charts draw in full."""
    import matplotlib
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    from slideline_tools import plots
    from slideline_tools.report import charts
    for style in (plots.STYLE, charts.STYLE):
        for name in ("figure.dpi", "savefig.dpi"):
            patch.setitem(style, name, 60)
        patch.setitem(style, "text.parse_math", False)
    patch.setitem(matplotlib.rcParams, "text.parse_math", False)  # of what is made while it is drawn
    patch.setattr(ConstrainedLayoutEngine, "execute", lambda self, figure: None)


@pytest.fixture
def plain_pictures(monkeypatch):
    """See draw_plainly."""
    draw_plainly(monkeypatch)


@dataclasses.dataclass
class Finished:
    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def tool(capsys):
    """Run `slideline-tools` with arguments, in this process; says how it ended."""
    def run(*arguments):
        capsys.readouterr()
        try:
            status = cli.main([str(argument) for argument in arguments])
        except SystemExit as end:
            status = end.code
        return Finished(status, *capsys.readouterr())
    return run


@pytest.fixture(scope="session")
def slideline():
    """The program under test; skipped only if SLIDELINE is not set, never if it is broken."""
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    return os.environ["SLIDELINE"]
