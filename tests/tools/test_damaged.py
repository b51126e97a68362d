# SPDX-License-Identifier: MIT
"""Damaged files of a run: every tool ends with one line and its status. tests/lab/fuzz/damage_results.py makes such files by
chance; these are what it has found, and their like."""
import os
import shutil
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "lab/fuzz"))
import damage_results as fuzz  # noqa: E402


def readers(name):
    """The tools that read an array of the results file, the slow ones where they tell more."""
    if name.startswith(("history", "dyna")):
        return "info", "binout", "d3plot"
    return ("info", "plot", "d3plot", "advise") if "Cell" in name or name.endswith("Types") else ("info", "d3plot", "advise")


@pytest.fixture(autouse=True)
def plain(plain_pictures):
    """What a report says, not how it is drawn."""


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    program = os.environ.get("SLIDELINE")
    if not program:
        pytest.skip("needs the program; set SLIDELINE")
    return fuzz.make_run(program, tmp_path_factory.mktemp("run"))


@pytest.fixture
def damaged(sound, tmp_path):
    """A copy of a sound run; its tables are in the results file alone."""
    shutil.copytree(sound, tmp_path / "run")
    for path in (tmp_path / "run").glob("*.csv"):
        if "timing" not in path.name:
            path.unlink()
    return tmp_path / "run"


def replaced(name, make):
    """Put `make(values)` in the place of an array, or take it away where that is None."""
    def act(stream):
        values = stream[name][()] if isinstance(stream[name], h5py.Dataset) else None
        del stream[name]
        if (new := make(values)) is None:
            return
        if new is dict:
            stream.create_group(name)
        else:
            stream[name] = new
    return act


def attribute(value):
    def act(stream):
        stream["VTKHDF/Steps"].attrs["NSteps"] = value
    return act


TEXT = np.array([b"some", b"text"])
CASES = {
    "table is no group": ("history/contact", lambda _: TEXT),
    "column is a group": ("history/rwforc/wall", lambda _: dict),
    "column is a number": ("history/rwforc/fx", lambda _: 1.5),
    "sums lack a column": ("history/matsum/momentum_x", lambda _: None),
    "column of pairs": ("history/glstat/viscous", lambda v: np.stack([v, v], axis=-1)),
    "entities of pairs": ("history/rcforc/interface", lambda v: np.stack([v, v], axis=-1)),
    "column of text": ("history/glstat/kinetic", lambda v: np.array([b"x"] * len(v))),
    "further columns are short": ("dyna/glstat", lambda _: TEXT),
    "offsets are no group": ("VTKHDF/Steps/CellDataOffsets", lambda _: TEXT),
    "no offsets": ("VTKHDF/Steps/PointDataOffsets", lambda _: None),
    "negative offsets": ("VTKHDF/Steps/PointOffsets", lambda v: -1 - np.abs(v)),
    "huge offsets": ("VTKHDF/Steps/PointOffsets", lambda v: np.full(v.shape, 10**15)),
    "field of pairs": ("VTKHDF/CellData/stress", lambda v: np.stack([v, v], axis=-1)),
    "field without components": ("VTKHDF/CellData/stress", lambda v: v.ravel()),
    "field is a group": ("VTKHDF/CellData/mises", lambda _: dict),
    "field of text": ("VTKHDF/PointData/velocity", lambda _: TEXT),
    "cells name no nodes": ("VTKHDF/Connectivity", lambda v: v + 10**6),
    "negative cells": ("VTKHDF/Connectivity", lambda v: -1 - v),
    "few cells": ("VTKHDF/Types", lambda v: v[:3]),
    "no cells": ("VTKHDF/Offsets", lambda v: v[:0]),
    "count of points is text": ("VTKHDF/NumberOfPoints", lambda _: TEXT),
    "negative count": ("VTKHDF/NumberOfCells", lambda v: -v),
    "times of pairs": ("VTKHDF/Steps/Values", lambda v: np.stack([v, v], axis=-1)),
    "no times": ("VTKHDF/Steps/Values", lambda _: 1.5),
    "run is no group": ("run", lambda _: TEXT),
    "history is no group": ("history", lambda _: 1.5),
}


def check(tool, run, sound, out):
    """One line or none, one of the statuses, no traceback; the status."""
    status, said, trace = fuzz.call(fuzz.words_of(tool, run, sound, out))
    assert not fuzz.judge(status, said, trace), (tool, said, trace)
    return status


@pytest.mark.parametrize("case", CASES)
def test_results_files(case, damaged, sound, tmp_path):
    with h5py.File(damaged / f"{fuzz.JOB}.vtkhdf", "r+") as stream:
        replaced(*CASES[case])(stream)
    statuses = [check(tool, damaged, sound, tmp_path / "out") for tool in readers(CASES[case][0])]
    assert 2 in statuses or "further" in case or case == "run is no group"


@pytest.mark.parametrize("value", [-5, b"\xff\xfe", np.array([1.5, np.nan])])
def test_attributes(value, damaged, sound, tmp_path):
    with h5py.File(damaged / f"{fuzz.JOB}.vtkhdf", "r+") as stream:
        attribute(value)(stream)
    for tool in ("info", "d3plot", "advise"):
        check(tool, damaged, sound, tmp_path / "out")


@pytest.mark.parametrize("ending", [".vtkhdf", ".glstat.csv", ".timing.csv", ".log", ".effective.k"])
@pytest.mark.parametrize("content", [b"", b"\x00" * 100, b"\xff\xfe\x00x,y\n", b"time\n", b"time,fx\n1,2,3\n", b"*\n*NODE\n$"])
def test_contents(ending, content, sound, tmp_path):
    run = tmp_path / "run"
    shutil.copytree(sound, run)
    (run / f"{fuzz.JOB}{ending}").write_bytes(content)
    for tool in ("info", "compare", "binout", "advise json"):
        check(tool, run, sound, tmp_path / "out")


def test_a_report_is_made_of_what_is_whole(damaged, sound, tmp_path):
    with h5py.File(damaged / f"{fuzz.JOB}.vtkhdf", "r+") as stream:
        replaced("VTKHDF/CellData/mises", lambda _: dict)(stream)
    assert check("report", damaged, sound, tmp_path) == 0
    page = (tmp_path / "f.html").read_text(encoding="utf-8")
    assert "This section could not be made" in page and "Energies" in page


def test_what_no_reader_has_noticed_is_one_line_too(monkeypatch, sound, capsys):
    from slideline_tools import cli, describe

    def fail(_):
        raise ZeroDivisionError("of two\nlines")
    monkeypatch.setattr(describe, "describe", fail)
    assert cli.main(["info", str(sound)]) == 2
    assert capsys.readouterr().err.startswith("slideline-tools: ZeroDivisionError: of two lines (a damaged file")
    monkeypatch.setenv("SLIDELINE_TRACEBACK", "1")
    with pytest.raises(ZeroDivisionError):
        cli.main(["info", str(sound)])


#: what a tool writes, beside the run
WRITERS = {"report": ("report", ".report.html"), "binout": ("binout", ".binout0000"), "d3plot": ("d3plot", ".d3plot"),
           "d3plot01": ("d3plot", ".d3plot01")}


@pytest.mark.parametrize("kind, ending", [("pipe", ".vtkhdf"), ("pipe", ".log"), ("pipe", ".effective.k"),
                                          ("device", ".glstat.csv")])
def test_no_tool_waits_at_what_is_no_file(damaged, capsys, kind, ending):
    from slideline_tools import cli
    path, run = damaged / f"{fuzz.JOB}{ending}", str(damaged / f"{fuzz.JOB}.vtkhdf")
    path.unlink(missing_ok=True)
    if kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("/dev/zero")
    for tool in ("report", "binout"):
        assert cli.main([tool, run]) in (0, 2)
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize("name", WRITERS)
def test_no_tool_writes_through_links(damaged, capsys, name):
    """As the program: a symbolic link and a pipe are refused, other names of a file (hard links) keep what they have."""
    from slideline_tools import cli
    tool, ending = WRITERS[name]
    path, mine, run = damaged / f"{fuzz.JOB}{ending}", damaged / "mine", str(damaged / f"{fuzz.JOB}.vtkhdf")
    mine.write_text("mine\n")
    path.symlink_to(mine)
    assert cli.main([tool, run]) == 2 and "is a symbolic link" in capsys.readouterr().err
    path.unlink()
    os.mkfifo(path)
    assert cli.main([tool, run]) == 2 and "is a pipe" in capsys.readouterr().err
    path.unlink()
    os.link(mine, path)
    assert cli.main([tool, run]) == 0
    assert mine.read_text() == "mine\n" and path.stat().st_size > 10


@pytest.mark.parametrize("tool", ["report", "binout", "d3plot", "plot"])
def test_no_tool_writes_over_what_it_reads(damaged, capsys, tool):
    from slideline_tools import cli
    path = damaged / f"{fuzz.JOB}.vtkhdf"
    before = path.read_bytes()
    (damaged / "again.png").symlink_to(damaged)
    assert cli.main([tool, str(path), "-o", str(damaged / "again.png" / path.name)]) == 2
    assert "which is read" in capsys.readouterr().err and path.read_bytes() == before
