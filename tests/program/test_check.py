# SPDX-License-Identifier: MIT
"""`slideline check`: messages without a run, for people and for programs."""
import json
from pathlib import Path

import h5py
import numpy as np
from conftest import drop

ROOT = Path(__file__).resolve().parents[2]

WRONG = """*KEYWORD
*PARAMETER
R  young      -2.0
*CONTROL_TERMINATION
       1.0
*MAT_ELASTIC
         1      7800    &young       0.3
*NODEX
*TITLE
x
*DATABASE_SBTOUT
       1.0
"""


def findings(done):
    answer = json.loads(done.stdout)
    return answer["accepted"], answer["findings"]


def test_a_sound_deck_is_accepted_and_nothing_is_written(slideline, tmp_path):
    (tmp_path / "deck.k").write_text(drop().text())
    done = slideline("check", "deck.k")
    assert done.returncode == 0, done.stderr
    assert "accepted" in done.stdout and "16 elements" in done.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["deck.k"]
    assert findings(slideline("check", "i=deck.k", "--json")) == (True, [])


def started_model(slideline, folder, deck, *words):
    """The tables of the model in the file of the state at time zero, and its points."""
    done = slideline("check", deck, f"d={folder}", "jobid=job", *words)
    assert done.returncode == 0, done.stderr
    with h5py.File(folder / "job.start.vtkhdf") as file:
        assert file["VTKHDF/Steps"].attrs["NSteps"] == 1 and file["VTKHDF/Steps/Values"][0] == 0.0
        return ({name: {column: array[()] for column, array in table.items()} for name, table in file["model"].items()},
                {name: file[f"VTKHDF/{name}"][()] for name in ("Points", "PointData/node_id", "CellData/element_id", "CellData/part_id")})


def test_the_model_is_that_of_every_example(slideline, tmp_path):
    """As many nodes, elements and numbers of them as the cards say, columns of one length, curves and parts that exist."""
    for deck in sorted((ROOT / "doc" / "examples").glob("*.k")):
        model, mesh = started_model(slideline, tmp_path, deck)
        nodes, parts = set(mesh["PointData/node_id"].tolist()), set(model["parts"]["id"].tolist())
        curves = set(model.get("curves", {}).get("curve", np.zeros(0, int)).tolist())
        assert len(mesh["Points"]) == len(nodes) and set(mesh["CellData/part_id"].tolist()) <= parts, deck
        for name in ("fixed", "motions", "body_motions", "nodal_loads", "rigid_loads", "pressures", "body_loads", "walls"):
            columns = model.get(name, {})
            assert len({len(column) for column in columns.values()}) <= 1, (deck, name)
            assert set(columns.get("curve", np.zeros(0, int)).tolist()) <= curves, (deck, name)
            assert set(columns.get("node", np.zeros(0, int)).tolist()) <= nodes, (deck, name)
        if one := model.get("interfaces"):
            assert min(one["n_slave"]) > 0 and min(one["n_master"]) > 0 and set(one["type"].tolist()) <= set(range(1, 8))
            assert len(one["node"]) == 2 * sum(one["n_slave"] + one["n_master"]) and set(one["node"].tolist()) <= nodes


def test_the_model_has_what_the_deck_says(slideline, tmp_path):
    """Numbers to the last bit, overrides and factors of curves applied; titles in Latin-1 are taken for that."""
    deck = drop().text().replace("*END", """*SET_NODE_LIST_TITLE
 the "last" \xe9
        77
         1         2
*DEFINE_CURVE
        78         0       2.0       3.0       0.5       0.0
                 1.0               0.125
                 2.0        0.1000000001
*DATABASE_HISTORY_NODE
         2
*END""")
    (tmp_path / "deck.k").write_bytes(deck.encode("latin-1"))
    model, mesh = started_model(slideline, tmp_path, "deck.k", "ctype=5")
    sets, curves = model["node_sets"], model["curves"]
    at = sets["id"].tolist().index(77)
    assert sets["title"].decode().split("\n")[at].strip() == 'the "last" \xe9'
    assert np.split(sets["node"], np.cumsum(sets["n_node"])[:-1])[at].tolist() == [1, 2]
    assert curves["x"][curves["curve"] == 78].tolist() == [2.0 * 1.5, 2.0 * 2.5]
    assert curves["y"][curves["curve"] == 78].tolist() == [3.0 * 0.125, 3.0 * 0.1000000001]
    assert model["history_nodes"]["node"].tolist() == [1, 13, 20, 2] and model["interfaces"]["type"].tolist() == [5]
    assert len(mesh["CellData/element_id"]) == 16


def test_files_of_a_check(slideline, tmp_path):
    """A deck that can be read but can not start has its model, undeformed; a refused one has none; a file that can not be
    made is reported."""
    (tmp_path / "wrong.k").write_text(WRONG)
    assert slideline("check", "wrong.k", "d=new").returncode == 1 and not (tmp_path / "new").exists()
    apart = (ROOT / "doc/examples/contact_2d_tied.k").read_text()
    for node in ("      13             0.0", "      14             1.0"):
        apart = apart.replace(f"{node}             3.0", f"{node}             3.5")
    (tmp_path / "tied.k").write_text(apart)
    done = slideline("check", "tied.k", "d=new")
    assert done.returncode == 1 and "ties nothing" in done.stderr, done.stderr
    with h5py.File(tmp_path / "new/tied.start.vtkhdf") as file:
        assert not file["VTKHDF/PointData/displacement"][()].any() and len(file["model/interfaces/id"]) == 3
    (tmp_path / "deck.k").write_text(drop().text())
    (tmp_path / "job.start.vtkhdf").mkdir()
    done = slideline("check", "deck.k", "d=.", "jobid=job")
    assert done.returncode == 3 and "job.start.vtkhdf" in done.stderr


def test_messages_say_where(slideline, tmp_path):
    (tmp_path / "wrong.k").write_text(WRONG)
    done = slideline("check", "wrong.k", "--json")
    assert done.returncode == 1
    accepted, found = findings(done)
    assert not accepted
    young = next(entry for entry in found if entry.get("name") == "E")
    assert (young["file"], young["line"], young["keyword"]) == ("wrong.k", 7, "*MAT_ELASTIC")
    assert (young["card"], young["field"], young["severity"]) == (1, 3, "error")
    unknown = next(entry for entry in found if entry.get("line") == 8)
    assert unknown["keyword"] == "*NODEX" and "card" not in unknown
    assert any(entry["severity"] == "warning" and entry["keyword"] == "*DATABASE_SBTOUT" for entry in found)
    assert len(found) == len([line for line in done.stderr.splitlines() if ": *" in line or
                              line.startswith("wrong.k: the") or line.startswith("wrong.k: has")])


def test_a_field_has_its_columns(slideline, tmp_path):
    text = drop().text().replace("*CONTROL_TERMINATION\n", "*CONTROL_TERMINATION\n       abc\n", 1)
    (tmp_path / "field.k").write_text(text)
    _, found = findings(slideline("check", "field.k", "--json"))
    entry = next(entry for entry in found if entry.get("found") == "abc")
    line = text.splitlines()[entry["line"] - 1]
    assert line[entry["first_column"] - 1:entry["last_column"]] == "abc"


def test_an_error_shows_the_line_as_it_was_written(slideline, tmp_path):
    (tmp_path / "wrong.k").write_text(WRONG)
    done = slideline("i=wrong.k")
    assert '"-2.0"' in done.stderr and "&young" in done.stderr


def test_what_a_run_warns_of_at_its_start(slideline, tmp_path):
    (tmp_path / "stiff.k").write_text(drop(penalty=1.0e12).text())
    done = slideline("check", "stiff.k", "--json")
    assert done.returncode == 0
    accepted, found = findings(done)
    assert accepted and any("time step" in entry["message"] for entry in found)
    reported = [line for line in slideline("i=stiff.k", "endtim=1e-4").stderr.splitlines() if "penalty" in line]
    assert reported and reported[0] == "warning: " + next(
        entry["message"] for entry in found if "penalty" in entry["message"])


def test_other_words(slideline, tmp_path):
    (tmp_path / "deck.k").write_text(drop().text())
    assert slideline("deck.k", "--json").returncode == 1
    assert slideline("check", "r=some.h5").returncode == 1
    assert slideline("check").returncode == 1
    done = slideline("check", "absent.k", "--json")
    accepted, found = findings(done)
    assert done.returncode == 1 and not accepted and "absent.k" in found[0]["message"]
    assert slideline("check", "deck.k", "ctype=9").returncode == 1


def test_an_unreadable_abscissa_is_no_slope(slideline, tmp_path):
    """Of a hardening curve: where the value stood for zero a checked build divided by it."""
    (tmp_path / "curve.k").write_text("""*KEYWORD
*CONTROL_TERMINATION
1.0
*NODE
1,0.0,0.0
2,1.0,0.0
3,1.0,1.0
4,0.0,1.0
*ELEMENT_SHELL
1,1,1,2,3,4
*PART
block
1,1,1
*SECTION_SHELL
1,13
1.0
*MAT_PIECEWISE_LINEAR_PLASTICITY
1,7800.0,2.0e11,0.3
0.0,0.0,7
0.0
0.0
*DEFINE_CURVE
7
0.0,1.0e8
abc,2.0e8
*END
""")
    done = slideline("check", "curve.k", "--json")
    assert done.returncode == 1, done.stderr
    _, found = findings(done)
    assert [entry["found"] for entry in found] == ["abc"]
