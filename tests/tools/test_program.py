# SPDX-License-Identifier: MIT
"""Running the program from Python: run, sweep, plot; names that do not exist; types and completion."""
import os
import re
import subprocess
import sys

import conftest
import numpy as np
import pytest

import slideline_tools
from slideline_tools import UserError, program
from slideline_tools.results import read

DECK = conftest.ROOT / "input" / "collision" / "collision.k"
SHORT = {"endtim": 2e-5, "p:dtplot": 1e-5}


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    return slideline_tools.run(DECK, tmp_path_factory.mktemp("run") / "new", ctype=5, v0=-60.0, **SHORT)


def test_run_takes_overrides_and_parameters(outcome):
    assert outcome.ended_well and outcome.status == 0
    assert "ctype=5 p:v0=-60.0 endtim=2e-05 p:dtplot=1e-05" in outcome.results.run["options"]
    assert outcome.results.times.tolist() == pytest.approx([0.0, 1e-5, 2e-5])
    momentum = outcome.history("matsum").where(part=2)
    assert momentum["momentum_y"][0] / momentum["mass"][0] == pytest.approx(-60.0)
    assert outcome.frame("glstat")["kinetic"].iloc[0] == outcome.history("glstat")["kinetic"][0]


def test_run_without_states_has_its_histories(slideline, tmp_path):
    deck = re.sub(r"\*DATABASE_BINARY_D3PLOT\n(\$.*\n)*.*\n", "", DECK.read_text())
    (tmp_path / "none.k").write_text(deck)
    outcome = slideline_tools.run(tmp_path / "none.k", tmp_path, program=slideline, endtim=1e-6)
    assert len(outcome.history("glstat")) > 1
    with pytest.raises(UserError, match="no such file"):
        outcome.results


@pytest.mark.parametrize("values, message", [
    ({"ctpye": 5}, "p:CTPYE .*no such parameter; the nearest is CTYPE"),
    ({"tsfac": 0.5}, "p:TSFAC .*no such parameter(.|\\n)*'tssfac'"),
    ({"v0": None}, "v0=None: expected a number"), ({"ctype": 99}, "99")])
def test_run_refuses_by_name(slideline, tmp_path, values, message):
    with pytest.raises(program.RunError, match=message):
        slideline_tools.run(DECK, tmp_path, program=slideline, **values)


def test_refused_run_has_no_results_of_an_earlier_one(slideline, tmp_path):
    slideline_tools.run(DECK, tmp_path, program=slideline, endtim=1e-6)
    outcome = slideline_tools.run(DECK, tmp_path, program=slideline, check=False, ctype=99)
    assert outcome.status == program.REFUSED
    for ask in (lambda: outcome.history("rcforc"), lambda: outcome.results):
        with pytest.raises(program.RunError, match="refused"):
            ask()


def test_run_refuses_an_array(tmp_path):
    with pytest.raises(program.RunError, match="expected a number"):
        slideline_tools.run(DECK, tmp_path, dt=np.array([1e-7, 2e-7]))


def test_run_that_fails(slideline, tmp_path):
    with pytest.raises(program.RunError, match="no such file"):
        slideline_tools.run(tmp_path / "none.k")
    with pytest.raises(program.RunError, match="cannot run the program /nowhere: .*name it by --program or program=, or .* as SLIDELINE"):
        slideline_tools.run(DECK, tmp_path, program="/nowhere")
    with pytest.raises(program.RunError, match="error termination") as caught:
        slideline_tools.run(DECK, tmp_path, program=slideline, v0=-4000.0, pen=1e15, endtim=3e-5)
    assert caught.value.outcome.status == 2 and caught.value.outcome.history("glstat")
    outcome = slideline_tools.run(DECK, tmp_path, program=slideline, check=False, ctype=99)
    assert outcome.status == 1 and "refused" in repr(outcome)


def test_program_that_is_found(tmp_path, monkeypatch):
    """The one that pip or `cmake --install` has put beside the tools, then those of source trees, then that of the path."""
    def touch(name):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
        return str(path)

    (tmp_path / "away").mkdir()
    monkeypatch.delenv("SLIDELINE", raising=False)
    monkeypatch.chdir(tmp_path / "away")
    monkeypatch.setattr(program, "__file__", str(tmp_path / "env/lib/python3/site-packages/slideline_tools/program.py"))
    assert program.find_program() == "slideline"
    above = touch("build/release/slideline")
    assert program.find_program() == above
    monkeypatch.setattr(program.sys, "prefix", str(tmp_path / "env"))
    monkeypatch.setattr(program.sysconfig, "get_path", lambda name: str(tmp_path / "env/bin"))
    by_pip = touch("env/bin/slideline")
    assert program.find_program() == by_pip
    monkeypatch.setattr(program, "__file__", str(tmp_path / "usr/share/slideline/python/slideline_tools/program.py"))
    by_cmake = touch("usr/bin/slideline")
    assert program.find_program() == by_cmake
    monkeypatch.setenv("SLIDELINE", "/named")
    assert program.find_program() == "/named" and program.find_program("/first") == "/first"


def test_sweep(slideline, tmp_path):
    sweep = slideline_tools.sweep(DECK, tmp_path, program=slideline, jobs=2, ctype=[1, 5], v0=[-40.0, -80.0],
                                  endtim=1e-6)
    assert [(one.parameters["ctype"], one.parameters["v0"]) for one in sweep] == [
        (1, -40.0), (1, -80.0), (5, -40.0), (5, -80.0)]
    assert {path.name for path in tmp_path.iterdir()} == {
        f"ctype_{t}_v0_{v}_endtim_1e-06" for t in (1, 5) for v in ("-40.0", "-80.0")}
    frame = sweep.frame(lambda one: {"kinetic": one.history("glstat")["kinetic"][0]})
    # Half the mass per metre times the speed squared.
    assert frame["kinetic"].tolist() == pytest.approx([0.5 * 0.785 * v**2 for v in (40.0, 80.0)] * 2, rel=1e-9)
    assert repr(sweep) == "<Sweep of collision.k over ctype, v0, endtim: 4 runs, 4 ended well>"


def test_sweep_refuses(slideline, tmp_path):
    for values, message in (({"ctype": []}, "no value"), ({"ctype": [1, 1]}, "given twice"), ({"ctpye": [1]}, "CTPYE")):
        with pytest.raises(program.RunError, match=message):
            slideline_tools.sweep(DECK, tmp_path, program=slideline, **values)
    assert program.folder_names([{"p:a": "x/y"}, {"p:a": "X:y"}, {}]) == ["a_x_y", "a_X_y-2", "run"]


def test_plot(outcome, tmp_path):
    figure = slideline_tools.plot(outcome, "mises", 0, "-1", output=tmp_path / "x.png")
    assert len(figure.axes) == 3 and (tmp_path / "x.png").stat().st_size > 1000
    assert len(slideline_tools.plot(outcome.folder, history="glstat:kinetic").axes) == 1
    with pytest.raises(UserError, match="choose one"):
        slideline_tools.plot(outcome, contact=True, zones=True)


def test_objects_fit_a_line(outcome, results_file):
    for thing in (outcome, outcome.results, *map(outcome.history, ("glstat", "rcforc", "contact", "timing"))):
        assert len(repr(thing)) <= 79 and "\n" not in repr(thing)
    results = read(results_file)
    assert repr(results) == "<Results three: 3 states to t = 1, 7 nodes, 3 elements, 3 histories>"
    assert repr(results.history("glstat")) == "<History glstat: 11 rows, time 0 to 1; time, cycle, internal, kinetic, total>"


@pytest.mark.parametrize("ask, near", [
    (lambda one: one.cell_field("misses"), "mises"), (lambda one: one.point_field("Displacment"), "displacement"),
    (lambda one: one.history("glsat"), "glstat"), (lambda one: one.history("glstat")["kinetc"], "kinetic"),
    (lambda one: one.history("rcforc").where(side="slav"), "slave"),
    (lambda one: slideline_tools.plot(one, "plastic_stran"), "plastic_strain")])
def test_nearest_name(results_file, ask, near):
    with pytest.raises(UserError, match=f"the nearest name is '{near}'; there are .*{near}"):
        ask(read(results_file))


def test_nothing_near_is_offered_for_nonsense(results_file):
    with pytest.raises(UserError) as caught:
        read(results_file).history("qqq")
    assert "nearest" not in str(caught.value) and "glstat" in str(caught.value)


TYPED = """
import slideline_tools
outcome = slideline_tools.run("a.k", ctype=5, v0=-60.0)
reveal_type(outcome)
reveal_type(outcome.results)
reveal_type(outcome.history("glstat"))
reveal_type(slideline_tools.read("a").n_state)
reveal_type(slideline_tools.sweep("a.k", ctype=[1, 5])[0])
slideline_tools.plot(outcome, "mises", -1, 0.5)
slideline_tools.read(5)
slideline_tools.raed("a.k")
"""


def test_mypy_knows_the_public_names(tmp_path):
    """Without the types of numpy and matplotlib, which take mypy half a minute to read."""
    pytest.importorskip("mypy")
    (tmp_path / "typed.py").write_text(TYPED)
    tools = conftest.ROOT / "tools"
    done = subprocess.run([sys.executable, "-m", "mypy", "--no-site-packages", "--ignore-missing-imports", "--config-file", tools / "pyproject.toml",
                           "--cache-dir", tmp_path / "cache", "typed.py"], cwd=tmp_path, capture_output=True, text=True, check=False,
                          env={**os.environ, "MYPYPATH": str(tools)})
    found = re.findall(r"Revealed type is \"([\w.]+)", done.stdout)
    assert found == ["slideline_tools.program.Outcome", "slideline_tools.results.Results",
                     "slideline_tools.histories.History", "int", "slideline_tools.program.Outcome"], done.stdout
    errors = re.findall(r"^(.*): error: (.*)", done.stdout, re.M)
    assert [place for place, _ in errors] == ["typed.py:10", "typed.py:11"], done.stdout
    assert 'incompatible type "int"' in errors[0][1] and 'no attribute "raed"' in errors[1][1], done.stdout
    assert (tools / "slideline_tools" / "py.typed").exists()
