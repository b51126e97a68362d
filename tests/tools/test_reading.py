# SPDX-License-Identifier: MIT
"""`slideline_tools.read`, tables of killed runs, and pandas frames."""
import subprocess
import typing

import conftest
import h5py
import numpy as np
import pandas
import pytest

import slideline_tools
from slideline_tools import UserError, histories, results
from slideline_tools.binout import write_binout
from slideline_tools.finished_run import Run


@pytest.mark.parametrize("name", ["", "three.vtkhdf", "three.log", "three.glstat.csv",
                                  "three.effective.k", "three.rwforc.csv"])
def test_read_takes_a_folder_or_any_file(results_file, name):
    found = slideline_tools.read(results_file.parent / name)
    assert found.path == results_file and found.n_state == 3


def test_read_says_what_is_wrong(tmp_path):
    with pytest.raises(UserError, match="no run .no .vtkhdf"):
        slideline_tools.read(tmp_path)
    for name in ("a", "b"):
        conftest.write_results(tmp_path / f"{name}.vtkhdf")
    with pytest.raises(UserError, match="several runs: a.vtkhdf, b.vtkhdf"):
        slideline_tools.read(str(tmp_path))
    with pytest.raises(UserError, match="no such file"):
        slideline_tools.read(tmp_path / "c.log")


def test_tables_of_a_killed_run(tmp_path):
    """No /history in the file: the CSV files beside it."""
    path = conftest.write_results(tmp_path / "k.vtkhdf", n_claimed=2, history=False)
    (tmp_path / "k.rcforc.csv").write_text(
        "time,interface,side,fx,fy,n_active\n0.0,1,slave,0.0,2.5,3\n0.0,1,master,0.0,-2.5,0\n")
    found = slideline_tools.read(path)
    assert found.histories == ["rcforc"] and found.n_state == 2
    assert found.history("rcforc").where(side="slave")["fy"].tolist() == [2.5]
    with pytest.raises(UserError, match="no history 'glstat'; there are rcforc"):
        found.history("glstat")


def test_every_table_of_a_killed_run(tmp_path):
    path = conftest.write_results(tmp_path / "k.vtkhdf", n_claimed=2, history=False)
    for name in histories.TABLES:
        (tmp_path / f"k.{name}.csv").write_text("time,value\n0.0,1.5\n")
    assert {"rwforc", "sleout", "spcforc"} < set(slideline_tools.read(path).histories)
    assert slideline_tools.read(path).history("sleout")["value"].tolist() == [1.5]


def test_binout_of_a_killed_run(tmp_path):
    """The last instant of a table may lack rows, and a table may have none at all."""
    (tmp_path / "k.glstat.csv").write_text("time,cycle,kinetic,internal,viscous,energy_ratio\n0.0,0,1.0,2.0,0.0,1.0\n")
    (tmp_path / "k.spcforc.csv").write_text(
        "time,node,fx,fy\n0.0,4,1.0,2.0\n0.0,9,1.0,2.0\n0.1,4,3.0,2.0\n0.1,9,1.0,2.0\n0.2,4,5.0,2.0\n")
    (tmp_path / "k.nodout.csv").write_text("time,node,x,y,ux,uy,vx,vy,ax,ay\n")
    run = Run(tmp_path)
    assert run.tables_for_dyna()["spcforc"]["time"].tolist() == [0.0, 0.0, 0.1, 0.1]
    assert write_binout(run, tmp_path / "binout0000") == ["glstat", "spcforc"]


def test_walls_are_entities(tmp_path):
    """Two walls are two series of whole numbers, from the CSV file and from the results file."""
    path = conftest.write_results(tmp_path / "w.vtkhdf")
    csv = tmp_path / "w.rwforc.csv"
    csv.write_text("time,wall,fx,n_active\n0.0,3,1.0,2\n0.0,7,5.0,0\n0.1,3,2.0,2\n0.1,7,6.0,1\n")
    with h5py.File(path, "a") as stream:
        for name, values in histories.read_csv(csv).columns.items():
            stream[f"history/rwforc/{name}"] = values
    for table in (histories.read_csv(csv), slideline_tools.read(path).history("rwforc")):
        assert table.value_columns == ["fx", "n_active"] and table["wall"].dtype.kind == "i"
        assert [(key, one["fx"].tolist()) for key, one in table.series()] == [
            ((3,), [1.0, 2.0]), ((7,), [5.0, 6.0])]
        assert table.entity_label((7,)) == "wall 7"


def test_the_file_comes_before_the_csv(results_file):
    (results_file.parent / "three.glstat.csv").write_text("time,kinetic\n0.0,77.0\n")
    assert slideline_tools.read(results_file).history("glstat")["kinetic"][0] == 1.0


def test_frames(results_file):
    frame = slideline_tools.read(results_file).frame("rcforc")
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns[:3]) == ["time", "interface", "side"] and len(frame) == 22
    assert frame.attrs == {"table": "rcforc", "title": "three cells"}
    peaks = frame.groupby("side")["fy"].max()
    assert peaks["slave"] == pytest.approx(1.0) and peaks["master"] == pytest.approx(0.0)
    assert frame["interface"].dtype.kind == "i"


def test_what_scripts_use_is_typed_and_documented():
    for owner in (results.Results, histories.History):
        for name, member in vars(owner).items():
            function = member.fget if isinstance(member, property) else member
            if callable(function) and not name.startswith("_"):
                assert function.__doc__, name
                assert "return" in function.__annotations__, name
    assert "unit" in slideline_tools.read.__doc__
    assert typing.get_type_hints(results.Results.points.fget)["return"] is np.ndarray


def test_frames_of_the_program_are_its_csv(tmp_path, slideline):
    """Same numbers by either way."""
    deck = conftest.ROOT / "input" / "collision" / "collision.k"
    subprocess.run([slideline, f"i={deck}", f"d={tmp_path}", "p:endtim=2e-6"], check=True,
                   capture_output=True)
    frame = slideline_tools.read(tmp_path).frame("glstat")
    pandas.testing.assert_frame_equal(frame, pandas.read_csv(tmp_path / "collision.glstat.csv"),
                                      check_dtype=False, check_like=True)
    with h5py.File(tmp_path / "collision.vtkhdf") as stream:
        assert "glstat" in stream["history"]
