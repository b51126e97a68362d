# SPDX-License-Identifier: MIT
"""d3plot and binout of a run as lasso-python and VTK's LS-DYNA reader read them, against the HDF5 file."""
import os
import pathlib
import subprocess

import numpy as np
import pytest
from lasso.dyna import Binout, D3plot
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet
from vtkmodules.vtkIOLSDyna import vtkLSDynaReader

from slideline_tools import UserError
from slideline_tools.binout import write_binout
from slideline_tools.d3plot import write_d3plot
from slideline_tools.effective_deck import part_titles
from slideline_tools.finished_run import Run

ROOT = pathlib.Path(__file__).resolve().parents[2]
#: relative room of single precision
SINGLE = 1.2e-7


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A short run of the collision with all tables, its part numbers changed to 30 and 7."""
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    folder = tmp_path_factory.mktemp("dyna")
    text = (ROOT / "input/collision/collision.k").read_text().rsplit("*END", 1)[0]
    text = renumbered(text, {1: 30, 2: 7})
    text += "*DATABASE_SLEOUT\n1.0e-5,\n*DATABASE_SPCFORC\n1.0e-5,\n*END\n"
    (folder / "hit.k").write_text(text)
    subprocess.run([os.environ["SLIDELINE"], "i=hit.k", "d=out", "endtim=1.2e-4"], cwd=folder,
                   check=True, capture_output=True)
    return Run(folder / "out")


def renumbered(deck, new):
    """The deck with other part numbers, wherever the collision has them."""
    lines, keyword, row = [], "", 0
    for line in deck.splitlines():
        if line.startswith("*"):
            keyword, row = line.split()[0].upper(), 0
        elif not line.startswith("$") and line.strip():
            row += 1
            fields = line.split(",") if "," in line else line.split()
            if keyword == "*PART" and row % 2 == 0:
                fields[0] = str(new[int(fields[0])])
                line = ",".join(fields)
            elif keyword == "*ELEMENT_SHELL":
                fields[1] = str(new[int(fields[1])])
                line = ",".join(fields)
            elif keyword.startswith("*SET_PART") and row > 1:
                line = ",".join(str(new[int(field)]) for field in fields if field.strip())
            elif keyword == "*INITIAL_VELOCITY_GENERATION" and row == 1:
                fields[0] = str(new[int(fields[0])])
                line = ",".join(fields)
        lines.append(line)
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def plot_path(run, tmp_path_factory):
    path = tmp_path_factory.mktemp("family") / "d3plot"
    assert write_d3plot(run, path) == run.results.n_state
    return path


@pytest.fixture(scope="module")
def binout(run, tmp_path_factory):
    path = tmp_path_factory.mktemp("binout") / "binout0000"
    assert write_binout(run, path) == ["glstat", "rcforc", "nodout", "matsum", "sleout", "spcforc"]
    return Binout(str(path))


def near(found, exact):
    """Equal to single precision, measured by the largest value."""
    found, exact = np.asarray(found, float), np.asarray(exact, float)
    assert found.shape == exact.shape and found.size > 0
    assert np.abs(found - exact).max() <= SINGLE * np.abs(exact).max()


def test_the_run_means_something(run):
    results = run.results
    assert results.n_state > 10 and set(results.cell_field("part_id")[0]) == {7, 30}
    assert results.cell_field("plastic_strain").max() > 0.01
    assert np.abs(results.point_field("displacement")).max() > 1.0e-3


def test_lasso_reads_d3plot(run, plot_path):
    results, arrays = run.results, D3plot(str(plot_path)).arrays
    near(arrays["timesteps"], results.times)
    near(arrays["node_coordinates"], results.points[0] - results.point_field("displacement")[0])
    near(arrays["node_displacement"], results.points)
    near(arrays["node_velocity"], results.point_field("velocity"))
    assert np.array_equal(arrays["node_ids"], results.point_field("node_id")[0])
    assert np.array_equal(arrays["element_shell_ids"], results.cell_field("element_id")[0])
    assert np.array_equal(arrays["element_shell_node_indexes"], results.cells)
    part = arrays["part_ids"][arrays["element_shell_part_indexes"]]
    assert np.array_equal(part, results.cell_field("part_id")[0])
    for k in range(3):
        near(arrays["element_shell_stress"][:, :, k], results.cell_field("stress"))
        near(arrays["element_shell_effective_plastic_strain"][:, :, k], results.cell_field("plastic_strain"))
    assert "element_shell_is_alive" not in arrays


def test_lasso_reads_sums_and_titles(run, plot_path):
    arrays, results = D3plot(str(plot_path)).arrays, run.results
    titles = dict(zip(arrays["part_titles_ids"].tolist(), (t.decode().strip() for t in arrays["part_titles"])))
    assert titles == {7: "projectile", 30: "plate"}
    whole = run.tables_for_dyna()["glstat"]
    rows = [int(np.argmin(np.abs(whole["time"] - time))) for time in results.times]
    assert np.allclose(whole["time"][rows], results.times, rtol=1e-12, atol=0.0)
    near(arrays["global_kinetic_energy"], whole["kinetic"][rows])
    near(arrays["global_total_energy"], whole["total"][rows])
    near(arrays["global_velocity"][:, 1], whole["velocity_y"][rows])
    for k, part in enumerate((7, 30)):
        sums = results.history("matsum").where(part=part)
        rows = [int(np.argmin(np.abs(sums["time"] - time))) for time in results.times]
        near(arrays["part_internal_energy"][:, k], sums["internal"][rows])
        near(arrays["part_mass"][:, k], sums["mass"][rows])
        near(arrays["part_velocity"][:, k, 1], (sums["momentum_y"] / sums["mass"])[rows])


def blocks(reader):
    """part title -> grid of the present state."""
    output, found = reader.GetOutput(), {}
    walk = output.NewIterator()
    walk.InitTraversal()
    while not walk.IsDoneWithTraversal():
        found[walk.GetCurrentMetaData().Get(vtkCompositeDataSet.NAME())] = walk.GetCurrentDataObject()
        walk.GoToNextItem()
    return found


def test_vtk_reads_d3plot(run, plot_path):
    results = run.results
    reader = vtkLSDynaReader()
    reader.SetFileName(str(plot_path))
    reader.UpdateInformation()
    assert reader.GetNumberOfTimeSteps() == results.n_state
    near([reader.GetTimeValue(k) for k in range(results.n_state)], results.times)
    for k in (0, results.n_state // 2, results.n_state - 1):
        reader.SetTimeStep(k)
        reader.Update()
        grids = blocks(reader)
        assert set(grids) == {"plate", "projectile"}
        for title, part in (("plate", 30), ("projectile", 7)):
            check_grid(grids[title], results, part, k)


def check_grid(grid, results, part, k):
    """One part in one state."""
    cells, points = grid.GetCellData(), grid.GetPointData()
    of_part = results.cell_field("part_id")[0] == part
    ids = vtk_to_numpy(cells.GetArray("UserIds"))
    assert np.array_equal(ids, results.cell_field("element_id")[0][of_part])
    for name in ("Stress", "StressInnerSurf", "StressOuterSurf"):
        near_or_zero(vtk_to_numpy(cells.GetArray(name)), results.cell_field("stress")[k][of_part])
    near_or_zero(vtk_to_numpy(cells.GetArray("EffPlastStrn")), results.cell_field("plastic_strain")[k][of_part])
    # Nodes through the cells: VTK mixes up the user numbers of nodes in files of 4-byte words.
    corners = np.array([[grid.GetCell(i).GetPointId(j) for j in range(4)] for i in range(len(ids))])
    rows = np.full(grid.GetNumberOfPoints(), -1)
    rows[corners] = results.cells[of_part]
    assert np.array_equal(rows[corners], results.cells[of_part]) and rows.min() >= 0
    near(vtk_to_numpy(grid.GetPoints().GetData()), results.points[k][rows])
    near_or_zero(vtk_to_numpy(points.GetArray("Velocity")), results.point_field("velocity")[k][rows])


def near_or_zero(found, exact):
    if np.any(exact):
        near(found, exact)
    else:
        assert np.shape(found) == np.shape(exact) and not np.any(found)


def test_elements_that_left_are_not_alive(tmp_path):
    """The deletion table of a run with erosion; a run without has none."""
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    deck = ROOT / "doc/examples/mat_add_erosion.k"
    subprocess.run([os.environ["SLIDELINE"], f"i={deck}", "d=out"], cwd=tmp_path, check=True, capture_output=True)
    run, path = Run(tmp_path / "out"), tmp_path / "d3plot"
    write_d3plot(run, path)
    eroded, arrays = run.results.cell_field("eroded"), D3plot(str(path)).arrays
    assert 0 < eroded.sum() < eroded.shape[0] and not eroded[:, 1].any()
    assert np.array_equal(arrays["element_shell_is_alive"], 1.0 - eroded)
    near(arrays["timesteps"], run.results.times)
    near(arrays["node_displacement"], run.results.points)
    near(arrays["element_shell_stress"][:, :, 0], run.results.cell_field("stress"))
    for k in (0, run.results.n_state - 1):
        assert vtk_element_ids(path, k) == run.results.cell_field("element_id")[k][eroded[k] == 0].tolist()


def vtk_element_ids(path, k):
    """User numbers of the elements that VTK draws of state `k`."""
    reader = vtkLSDynaReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    reader.SetTimeStep(k)
    reader.Update()
    return sorted(number for grid in blocks(reader).values()
                  for number in vtk_to_numpy(grid.GetCellData().GetArray("UserIds")).tolist())


def test_a_family_of_several_files(run, tmp_path):
    path = tmp_path / "few"
    for k in range(1, 60):
        (tmp_path / f"few{k:02d}").write_bytes(b"of an earlier run")
    assert write_d3plot(run, path, file_limit=100000) == run.results.n_state
    files = sorted(file.name for file in tmp_path.iterdir())
    assert len(files) < 60
    assert len(files) > 3 and files == ["few"] + [f"few{k:02d}" for k in range(1, len(files))]
    near(D3plot(str(path)).arrays["node_displacement"], run.results.points)
    reader = vtkLSDynaReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfTimeSteps() == run.results.n_state
    reader.SetTimeStep(run.results.n_state - 1)
    reader.Update()
    check_grid(blocks(reader)["plate"], run.results, 30, run.results.n_state - 1)


def test_files_of_the_user_stay(run, tmp_path):
    """A number behind the name makes no member of the family; brackets in a name are no pattern."""
    for name in ("few2019", "few[1]2019"):
        (tmp_path / name).write_bytes(b"mine")
    (tmp_path / "few[1]02").write_bytes(b"of an earlier run")
    for name in ("few", "few[1]"):
        write_d3plot(run, tmp_path / name)
        assert (tmp_path / f"{name}2019").read_bytes() == b"mine"
    assert not (tmp_path / "few[1]02").exists()


def test_binout_glstat(run, binout):
    table = run.tables_for_dyna()["glstat"]
    for name, column in {"time": "time", "time_step": "dt", "cycle": "cycle", "kinetic_energy": "kinetic",
                         "sliding_interface_energy": "contact", "total_energy": "total",
                         "energy_ratio": "energy_ratio", "global_y_velocity": "velocity_y"}.items():
        assert np.array_equal(binout.read("glstat", name), table[column]), name
    assert np.array_equal(binout.read("glstat", "internal_energy"), table["internal"] + table["viscous"])
    assert binout.read("glstat", "title").strip() == run.title


@pytest.mark.parametrize("branch, entity, columns", [
    ("rcforc", "interface", {"x_force": "fx", "y_force": "fy"}),
    ("nodout", "node", {"y_displacement": "uy", "y_velocity": "vy", "y_acceleration": "ay", "y_coordinate": "y"}),
    ("matsum", "part", {"internal_energy": "internal", "kinetic_energy": "kinetic", "y_momentum": "momentum_y",
                        "hourglass_energy": "hourglass", "mass": "mass"}),
    ("spcforc", "node", {"x_force": "fx", "y_force": "fy"})])
def test_binout_branches(run, binout, branch, entity, columns):
    table, ids = run.results.history(branch), binout.read(branch, "ids")
    times = binout.read(branch, "time")
    assert np.array_equal(times, np.unique(table["time"])) and len(ids) > 1
    assert np.array_equal(np.tile(ids, len(times)), table[entity])
    for name, column in columns.items():
        found = binout.read(branch, name)
        assert found.shape == (len(times), len(ids))
        assert np.array_equal(found.ravel(), table[column]), name
        assert np.any(found)
    if branch == "rcforc":
        assert binout.read(branch, "side").tolist() == [0, 1]
    if branch == "matsum":
        assert binout.read(branch, "legend_ids").tolist() == [30, 7]
        assert binout.read(branch, "legend")[70:].strip() == "projectile"


def test_binout_sleout(run, binout):
    table = run.results.history("sleout")
    energy = table["energy"] + table["damping"]
    assert np.array_equal(binout.read("sleout", "slave"), energy)
    assert np.array_equal(binout.read("sleout", "total_energy"), energy)
    assert binout.read("sleout", "ids").tolist() == [1]


def test_binout_counts_what_has_eroded(tmp_path):
    """Energies of glstat hold what has eroded, which stands apart too; mass scaling and friction have variables of their own."""
    (tmp_path / "a.log").write_text("")
    (tmp_path / "a.glstat.csv").write_text(
        "time,cycle,dt,kinetic,internal,hourglass,viscous,damping,contact,external_work,total,energy_ratio,leapfrog,friction,added_mass,"
        "eroded,mass_increase,by_dt2ms,eroded_kinetic,eroded_internal,eroded_hourglass,eroded_contact\n"
        "0.,0,1.,1.25,2.,0.5,0.25,0.,0.125,0.,8.,1.,0.,0.125,3.,3.75,50.,1,0.75,1.,1.5,0.5\n")
    (tmp_path / "a.sleout.csv").write_text("time,cycle,interface,energy,damping,stored,friction\n0.,0,7,1.,0.5,0.,0.25\n")
    (tmp_path / "a.effective.k").write_text("*KEYWORD\n*CONTACT_2D_SLIDELINE_TITLE\n         7anvil\n*END\n")
    write_binout(tmp_path, tmp_path / "b")
    binout = Binout(str(tmp_path / "b"))
    wanted = {"kinetic_energy": 2.0, "internal_energy": 3.25, "hourglass_energy": 2.0, "sliding_interface_energy": 0.75,
              "eroded_kinetic_energy": 0.75, "eroded_internal_energy": 1.0, "eroded_hourglass_energy": 1.5, "total_energy": 8.0,
              "energy_ratio_wo_eroded": 4.25 / 8.0, "added_mass": 3.0, "percent_increase": 50.0}
    assert {name: float(np.ravel(binout.read("glstat", name))[0]) for name in wanted} == pytest.approx(wanted, rel=1e-6)
    assert binout.read("sleout", "friction_energy") == pytest.approx(0.25) and binout.read("sleout", "slave") == pytest.approx(1.75)
    assert "anvil" in str(binout.read("sleout", "legend"))


def test_binout_as_pandas(binout):
    frame = binout.as_df("rcforc", "y_force")
    assert list(frame.columns) == ["1s", "1m"] and frame["1s"].abs().max() > 1.0e6


def test_a_killed_run_gives_binout_from_its_csv_files(run, tmp_path):
    for name in ("glstat", "nodout"):
        source = pathlib.Path(f"{run.prefix}.{name}.csv")
        (tmp_path / source.name).write_bytes(source.read_bytes())
    assert write_binout(tmp_path, tmp_path / "b") == ["glstat", "nodout"]
    table = run.results.history("nodout")
    assert np.array_equal(Binout(str(tmp_path / "b")).read("nodout", "x_velocity").ravel(), table["vx"])
    with pytest.raises(UserError, match="no states"):
        write_d3plot(tmp_path, tmp_path / "d")


def test_binout_of_a_killed_run_leaves_a_cut_instant_out(run, tmp_path):
    """Rows reach the file by the size of a buffer; a table may have its header alone."""
    text = pathlib.Path(f"{run.prefix}.nodout.csv").read_text().splitlines(keepends=True)
    n_node = len(np.unique(run.results.history("nodout")["node"]))
    assert n_node > 1
    (tmp_path / "hit.glstat.csv").write_bytes(pathlib.Path(f"{run.prefix}.glstat.csv").read_bytes())
    (tmp_path / "hit.nodout.csv").write_text("".join(text[:1 + 2 * n_node + 1]))
    (tmp_path / "hit.rcforc.csv").write_text("time,interface,side,fx,fy,n_active\n")
    assert write_binout(tmp_path, tmp_path / "b") == ["glstat", "nodout"]
    found = Binout(str(tmp_path / "b"))
    times = run.results.history("nodout")["time"][::n_node]
    assert np.array_equal(found.read("nodout", "time"), times[:2])
    assert np.array_equal(found.read("nodout", "x_velocity").ravel(), run.results.history("nodout")["vx"][:2 * n_node])
    (tmp_path / "hit.nodout.csv").write_text("".join(text[:1 + 2 * n_node]))
    write_binout(tmp_path, tmp_path / "c")
    assert np.array_equal(Binout(str(tmp_path / "c")).read("nodout", "time"), times[:2])


def test_commands(run, tool, tmp_path):
    done = tool("d3plot", f"{run.prefix}.vtkhdf", "-o", tmp_path / "new" / "d3plot")
    assert done.returncode == 0 and f"({run.results.n_state} states)" in done.stdout
    assert (tmp_path / "new" / "d3plot01").exists()
    done = tool("binout", run.prefix.parent)
    assert done.returncode == 0 and pathlib.Path(f"{run.prefix}.binout0000").exists()


def test_what_is_no_run(tool, tmp_path):
    assert tool("binout", tmp_path / "none").returncode == 2
    (tmp_path / "a.glstat.csv").write_text("time\n")
    (tmp_path / "b.glstat.csv").write_text("time\n")
    with pytest.raises(UserError, match="several runs: a.glstat.csv, b.glstat.csv"):
        Run(tmp_path)
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "c.log").write_text("")
    with pytest.raises(UserError, match="no history tables"):
        write_binout(tmp_path / "one" / "c.log", tmp_path / "x")


def test_part_titles():
    deck = "*PART\n$ a comment\nfirst\n         3         1\nsecond\n4,1,1\n*NODE\n1,0,0\n*PART_INERTIA\nno\n5\n"
    assert part_titles(deck) == {3: "first", 4: "second"}
