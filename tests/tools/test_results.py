# SPDX-License-Identifier: MIT
"""The reader on a file written by hand."""
import conftest
import h5py
import numpy as np
import pytest

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.results import read


def test_states_and_points(results_file):
    results = read(results_file)
    np.testing.assert_array_equal(results.times, conftest.TIMES)
    assert results.points.shape == (3, 7, 3)
    np.testing.assert_allclose(results.points[2, 6], [3.3, 0.2, 0.0])


def test_cells_repeat_the_last_node_of_a_triangle(results_file):
    np.testing.assert_array_equal(read(results_file).cells,
                                  [[0, 1, 4, 3], [1, 2, 5, 4], [2, 6, 5, 5]])


def test_fields_belong_to_their_state(results_file):
    results = read(results_file)
    np.testing.assert_allclose(results.cell_field("stress")[1], conftest.stress(0.5))
    np.testing.assert_allclose(results.cell_field("plastic_strain")[:, 1], [0.0, 0.1, 0.2])
    np.testing.assert_allclose(results.point_field("displacement")[2], conftest.displacement(1.0))


def test_constant_fields_appear_in_every_state(results_file):
    results = read(results_file)
    np.testing.assert_array_equal(results.point_field("node_id")[2], conftest.NODE_IDS)
    np.testing.assert_array_equal(results.cell_field("part_id")[1], [1, 1, 2])


def test_run_texts(results_file):
    run = read(results_file).run
    assert run["title"] == "three cells"
    assert run["deck"] == "three.k"
    assert run["effective_deck"].startswith("*KEYWORD")


def test_history_sides_are_words(results_file):
    rcforc = read(results_file).history("rcforc")
    assert rcforc["side"][:2].tolist() == ["slave", "master"]
    labels = [rcforc.entity_label(entity) for entity, _ in rcforc.series()]
    assert labels == ["interface 1, slave", "interface 1, master"]


def test_killed_run_shows_the_states_it_claims(tmp_path):
    results = read(conftest.write_results(tmp_path / "killed.vtkhdf", n_claimed=2, history=False))
    assert results.n_state == 2
    assert results.points.shape == (2, 7, 3)
    assert results.histories == []


@pytest.mark.parametrize("wanted, index", [("-1", 2), ("0", 0), ("1", 1), ("0.4", 1), ("1.0", 2)])
def test_choice_of_state(results_file, wanted, index):
    assert read(results_file).state_index(wanted) == index


@pytest.mark.parametrize("wanted", ["3", "-4", "1.5", "last"])
def test_state_out_of_range(results_file, wanted):
    with pytest.raises(UserError):
        read(results_file).state_index(wanted)


def test_missing_field_names_those_there_are(results_file):
    with pytest.raises(UserError, match="no cell field 'strain'.*plastic_strain"):
        read(results_file).cell_field("strain")


def test_missing_file_and_other_file(tmp_path):
    with pytest.raises(UserError, match="no such file"):
        read(tmp_path / "none.vtkhdf")
    other = tmp_path / "other.vtkhdf"
    other.write_text("not HDF5")
    dump = tmp_path / "job.dump01.h5"
    with h5py.File(dump, "w") as stream:
        stream["cycle"] = 1
    for path in (other, dump):
        with pytest.raises(UserError) as caught:
            read(path)
        assert str(caught.value) == f"cannot read {path}: it is no results file (<job>.vtkhdf)"


def test_csv_columns(tmp_path):
    path = tmp_path / "job.rcforc.csv"
    path.write_text("time,interface,side,fx\n0.0,1,slave,-1.5E+00\n0.0,1,master,1.5E+00\n")
    table = read_csv(path)
    assert table.name == "rcforc"
    assert table["interface"].dtype.kind == "i"
    np.testing.assert_array_equal(table.where(side="master")["fx"], [1.5])


@pytest.mark.parametrize("text, message", [
    ("", "empty"),
    ("time,a\n0.0\n", "line 2 has 1 fields"),
    ("time,a\n0.0,x\n", "column a"),
    ("time,time\n0.0,1.0\n", "twice"),
])
def test_broken_csv(tmp_path, text, message):
    path = tmp_path / "job.glstat.csv"
    path.write_text(text)
    with pytest.raises(UserError, match=message):
        read_csv(path)
