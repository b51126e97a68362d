# SPDX-License-Identifier: MIT
"""The code cells of doc/notebook.ipynb run, one after the other."""
import json

import pytest

from conftest import ROOT


@pytest.fixture(scope="module")
def cells():
    notebook = json.loads((ROOT / "doc/notebook.ipynb").read_text(encoding="utf-8"))
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def test_no_output_is_stored(cells):
    """What a notebook keeps of its last run ages with the program."""
    assert cells and all(not cell["outputs"] and cell["execution_count"] is None for cell in cells)


def test_cells_run(cells, exe, tmp_path, monkeypatch):
    (tmp_path / "input").symlink_to(ROOT / "input")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SLIDELINE", str(exe))
    monkeypatch.setenv("MPLBACKEND", "Agg")
    names = {}
    for cell in cells:
        exec(compile("".join(cell["source"]), "doc/notebook.ipynb", "exec"), names)
    assert names["outcome"].parameters["ctype"] == 5 and names["results"].n_state == 11
    table = names["table"].set_index(["ctype", "v0"])
    assert len(table) == 6 and (table["status"] == 0).all() and (abs(table["energy ratio"] - 1.0) < 1e-2).all()
    assert (table["largest force"].loc[:, -80.0] > table["largest force"].loc[:, -40.0]).all()
