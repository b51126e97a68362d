# SPDX-License-Identifier: MIT
"""Stick and slip over time: places and states of chains, mu p, pictures, the frictional work of reports."""
import os
import re
import subprocess

import h5py
import numpy as np
import pytest

from conftest import ROOT
from slideline_tools import zones
from slideline_tools.histories import History, read_csv
from slideline_tools.report import write_report
from slideline_tools.results import read
from slideline_tools.draw.model import model_of
from test_pictures import assert_picture

EXAMPLE = ROOT / "doc/examples/contact_2d_slideline_friction.k"
def table(states):
    """A contact table at times 0, 1, 2: nodes 7, 3 and 5 of one chain, 8 and 2 of another."""
    nodes, s = [7, 3, 5, 8, 2], [0.0, 1.0, 3.0, 0.0, 2.0]
    return History("contact", {
        "time": np.repeat([0.0, 1.0, 2.0], 5), "interface": np.ones(15, dtype=int), "node": np.tile(nodes, 3),
        "s": np.tile(s, 3) * np.repeat([1.0, 1.1, 1.2], 5), "pressure": np.full(15, 10.0), "traction": np.full(15, -2.0),
        "state": np.ravel(states).astype(float)})


STATES = [[0, 0, 0, 0, 1], [1, 1, 0, 2, 1], [1, 2, 0, 2, 2]]


def test_chains_places_and_states():
    first, second = zones.chains_of(table(STATES))
    times, places, states = zones.state_grid(first)
    assert times.tolist() == [0.0, 1.0, 2.0] and places.tolist() == [0.0, 1.0, 3.0]
    assert states.tolist() == [[0, 1, 1], [0, 1, 2], [0, 0, 0]]
    assert zones.state_grid(second)[2].tolist() == [[0, 2, 2], [1, 1, 2]]
    assert zones.edges(places).tolist() == [0.0, 0.5, 2.0, 3.0] and zones.edges(np.array([4.0])).tolist() == [3.5, 4.5]


def test_a_time_that_lacks_rows_is_left_out():
    """A killed run may have written a state in part."""
    whole = table(STATES)
    cut = whole.rows(np.arange(len(whole)) < 12)
    assert zones.state_grid(zones.chains_of(cut)[0])[0].tolist() == [0.0, 1.0]


def test_the_picture_has_the_states_as_shades():
    figure = zones.zones_figure(table(STATES), [2.0], None)
    quads = figure.axes[0].collections[0]
    assert quads.get_array().reshape(3, 3).tolist() == [[0, 1, 1], [0, 1, 2], [0, 0, 0]]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["open", "stick", "slip"]
    broken = np.where(np.array(STATES) == 2, 4, STATES)
    assert zones.zones_figure(table(broken), [2.0], None).legends[0].get_texts()[-1].get_text() == "broken"


def test_refused_without_friction(results_file, tool, tmp_path):
    finished = tool("plot", results_file, "--zones", "--output", tmp_path / "x.png")
    assert finished.returncode == 2 and "no slave node ever stuck or slipped" in finished.stderr
    finished = tool("plot", results_file, "--zones", "--contact", "--output", tmp_path / "x.png")
    assert finished.returncode == 2 and "choose one" in finished.stderr


@pytest.fixture(scope="module")
def sliding(tmp_path_factory):
    """The block of the example that slides to a stop, with states and energies of its interface."""
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    folder = tmp_path_factory.mktemp("sliding")
    deck = folder / "block.k"
    text = EXAMPLE.read_text()
    text = re.sub(r"(\*DATABASE_BINARY_D3PLOT\n) *0\.05", r"\1      0.01", text)
    deck.write_text(text.replace("*END", "*DATABASE_SLEOUT\n0.01,\n*DATABASE_RCFORC\n0.01,\n*END"))
    done = subprocess.run([os.environ["SLIDELINE"], f"i={deck}", f"d={folder}"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_results_have_traction_slip_and_state(sliding):
    contact, results = read_csv(sliding / "block.contact.csv"), read(sliding / "block.vtkhdf")
    last = contact.where(time=contact["time"][-1])
    assert set(np.unique(contact["state"])) == {0.0, 1.0, 2.0}
    assert np.all(np.abs(contact["traction"]) <= 0.5 * contact["pressure"] * (1.0 + 1.0e-12))
    ids = results.point_field("node_id")[-1].tolist()
    for name in ("traction", "slip", "state"):
        field = results.point_field(f"contact_{name}")[-1]
        assert [field[ids.index(node)] for node in last["node"]] == pytest.approx(last[name].tolist(), rel=1e-15)
    with h5py.File(results.path) as stream:
        assert {"traction", "slip", "state"} <= set(stream["history/contact"])


def test_zones_of_a_run_that_slides_and_stops(sliding, tool, tmp_path):
    path = tmp_path / "zones.png"
    finished = tool("plot", sliding, "--zones", "--state", "5", "--state", "-1", "--output", path)
    assert finished.returncode == 0, finished.stderr
    assert_picture(path)
    results, model = read(sliding / "block.vtkhdf"), model_of(sliding / "block")
    assert zones.limit_of(model, 1) == 0.5 and zones.limit_of(model, 2) is None and zones.limit_of(None, 1) is None
    model.interfaces[0].sliding_friction = 0.2
    assert zones.limit_of(model, 1) is None
    _, _, states = zones.state_grid(zones.chains_of(results.history("contact"))[0])
    assert np.all(states[:, 3:9] == 2.0) and np.all(states[:, -1] == 1.0)  # it slides, then it stands


def test_frictional_work_is_in_the_report(sliding, tmp_path, plain_pictures):
    """As glstat has it, and half m v^2: by sleout, and by glstat where there is none."""
    work = read_csv(sliding / "block.glstat.csv")["friction"][-1]
    assert work == pytest.approx(0.5 * 50.0 * 0.5 ** 2, rel=0.01)

    def reported():
        page = re.sub(r"<[^>]+>", " ", write_report(sliding, tmp_path / "r.html").read_text(encoding="utf-8"))
        assert "Where interface 1 sticks and slips" in page
        return re.search(r"frictional work\s+([-0-9.e+]+)\s+[-0-9.e+]+\s+coefficient 0.5", page)[1]

    assert float(reported()) == pytest.approx(work, rel=1e-5)
    for name in ("glstat", "sleout"):
        path = sliding / f"block.{name}.csv"
        words = path.read_text()
        head, last = words.splitlines()[0].split(","), words.splitlines()[-1].split(",")
        last[head.index("friction")] = "3.25"
        path.write_text("\n".join([*words.splitlines()[:-1], ",".join(last)]) + "\n")
        assert (float(reported()) == 3.25) is (name == "sleout")
        path.write_text(words)
