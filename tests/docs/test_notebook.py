# SPDX-License-Identifier: MIT
"""doc/notebook.ipynb runs where it lies, and what it keeps of its last run is what it gives today."""
import ast
import contextlib
import io
import json
import re

import pytest

from conftest import ROOT

PATH = ROOT / "doc/notebook.ipynb"
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
#: of numbers that are kept: builds may differ in last digits, which the collision makes more of
AGREE = 1e-2


@pytest.fixture(scope="module")
def cells():
    return [cell for cell in json.loads(PATH.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]


def kept(cell):
    """What a cell has printed and given, without figures."""
    texts = ["".join(output["text"] if "text" in output else output["data"]["text/plain"]) for output in cell["outputs"]
             if "image/png" not in output.get("data", {})]
    return "".join(text if text.endswith("\n") else f"{text}\n" for text in texts)


def reported(source, names):
    """What a cell prints and gives now."""
    *body, last = ast.parse(source).body
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        value = None
        if isinstance(last, ast.Expr):
            exec(compile(ast.Module(body, []), str(PATH), "exec"), names)
            value = eval(compile(ast.Expression(last.value), str(PATH), "eval"), names)
        else:
            exec(compile(ast.Module([*body, last], []), str(PATH), "exec"), names)
        if value is not None:
            print(repr(value))
    return out.getvalue()


def same(one, other):
    """The same words, and numbers that agree."""
    pairs = list(zip(NUMBER.findall(one), NUMBER.findall(other)))
    return (" ".join(NUMBER.sub("0", one).split()) == " ".join(NUMBER.sub("0", other).split())
            and all(abs(float(a) - float(b)) <= AGREE * max(abs(float(a)), abs(float(b))) for a, b in pairs))


def test_it_is_stored_with_its_pictures(cells):
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    outputs = [output for cell in cells for output in cell["outputs"]]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 3
    assert all(output["output_type"] != "error" and output.get("name") != "stderr" for output in outputs)
    assert PATH.stat().st_size < 400_000


def test_cells_run(cells, exe, tmp_path, monkeypatch):
    """From its own folder."""
    (tmp_path / "input").symlink_to(ROOT / "input")
    (tmp_path / "doc").mkdir()
    monkeypatch.chdir(tmp_path / "doc")
    monkeypatch.setenv("SLIDELINE", str(exe))
    monkeypatch.setenv("MPLBACKEND", "Agg")
    names = {}
    for cell in cells:
        now = reported("".join(cell["source"]), names)
        if "<Axes" not in now and "<Figure" not in now:
            assert same(now, kept(cell)), f"{now}\nis not what is kept:\n{kept(cell)}"
    assert names["outcome"].parameters["ctype"] == 5 and names["results"].n_state == 11
    assert not (tmp_path / "doc/results").exists()
    table = names["table"].set_index(["ctype", "v0"])
    assert len(table) == 6 and (table["status"] == 0).all() and (abs(table["energy ratio"] - 1.0) < 1e-2).all()
    assert (table["largest force"].loc[:, -80.0] > table["largest force"].loc[:, -40.0]).all()


def test_what_is_compared():
    assert same("largest 1.001e+3 of -2", "largest  1.0e+03 of -2\n")
    assert not same("largest 1.1", "largest 1.0") and not same("largest 1", "smallest 1")
