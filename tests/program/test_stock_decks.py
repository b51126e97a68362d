# SPDX-License-Identifier: MIT
"""Decks that a client of LS-DYNA has written run untouched, and give what they say; what is not had is listed.

The decks in stock/ were written once by stock_decks.py; where ansys-dyna-core is installed they are written anew.
"""
import importlib.util
import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest

from conftest import columns, numbers
from stock_list import RUN, UNSUPPORTED

HERE = pathlib.Path(__file__).resolve().parent
LIVE = importlib.util.find_spec("ansys") is not None and importlib.util.find_spec("ansys.dyna") is not None


@pytest.fixture(scope="module", params=("kept", "live"))
def decks(request, tmp_path_factory):
    """Folder of the decks: the kept ones, or new ones from the client."""
    if request.param == "kept":
        return HERE / "stock"
    if not LIVE:
        pytest.skip("ansys-dyna-core is not installed")
    folder = tmp_path_factory.mktemp("stock")
    subprocess.run([sys.executable, HERE / "stock_decks.py", folder], check=True, timeout=120)
    return folder


@pytest.fixture(scope="module")
def results(exe, decks, tmp_path_factory):
    """results(name): folder and prefix of a finished run, made once."""
    made, folder = {}, tmp_path_factory.mktemp("runs")

    def run(name):
        if name not in made:
            done = subprocess.run([exe, f"i={decks / f'stock_{name}.k'}", f"d={folder / name}", "jobid=job"],
                                  capture_output=True, text=True, timeout=120)
            made[name] = (done, folder / name)
        done, place = made[name]
        assert done.returncode == 0, done.stderr
        return place
    return run


def table(folder, name, **wanted):
    """Columns of one history as numbers, of the rows in which each named column has that number or text."""
    text = columns(folder / f"job.{name}.csv")
    keep = np.ones(len(text["time"]), dtype=bool)
    for column, value in wanted.items():
        keep &= np.array([cell == value if isinstance(value, str) else float(cell) == value
                          for cell in text[column]])
    return {column: np.array([cell if column in ("side", "phase") else float(cell) for cell in cells],
                             dtype=None)[keep] for column, cells in text.items()}


@pytest.mark.parametrize("name", RUN)
def test_runs_untouched(results, name):
    folder = results(name)
    assert "N o r m a l" in (folder / "job.log").read_text()
    assert np.abs(numbers(folder / "job.glstat.csv", "energy_ratio") - 1.0).max() < 0.02


def test_impact_starts_with_its_momentum(results):
    start = table(results("impact"), "matsum", part=1)
    assert start["mass"][0] == pytest.approx(7800.0 * 1.0e-4, rel=1e-12)
    assert start["momentum_y"][0] == pytest.approx(-50.0 * 0.78, rel=1e-12)
    given = table(results("impact"), "rcforc", side="slave")["fy"].max()
    # before waves come back: v/2 times the impedances' harmonic mean; a part of it is reached on a coarse mesh
    impedance = [7800.0 * np.sqrt(2.1e11 * 0.7 / (1.3 * 0.4) / 7800.0),
                 2700.0 * np.sqrt(7.0e10 * 0.67 / (1.33 * 0.34) / 2700.0)]
    pressure = 50.0 / (1.0 / impedance[0] + 1.0 / impedance[1])
    assert 0.5 < given / (pressure * 0.01) < 1.5


@pytest.mark.parametrize("name, tolerance", [("impact_long", 1e-8), ("impact_clockwise", 1e-6)])
def test_impact_in_another_way_of_writing(results, name, tolerance):
    one, other = (table(results(deck), "rcforc", side="slave") for deck in ("impact", name))
    assert np.abs(one["fy"]).max() > 0.0
    assert other["fy"] == pytest.approx(one["fy"], abs=tolerance * np.abs(one["fy"]).max())


def test_pressure_pushes_into_the_body(results):
    """Momentum of the free direction: pressure on segments with N3 = N4 = 0 down, gravity down."""
    part = table(results("pressure"), "matsum", part=7)
    time = part["time"]
    ramp = np.where(time < 5e-4, time ** 2 / 1e-3, time - 2.5e-4)
    expected = -1000.0 * ramp - 9.81 * 1000.0 * time
    assert part["momentum_y"] == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())
    log = (results("pressure") / "job.log").read_text()
    assert "3 nodal loads, 5 pressure edges, 1 body loads" in log


def test_contacts_of_five_kinds(results):
    folder = results("contacts")
    momentum = sum(table(folder, "matsum", part=k)["momentum_x"] for k in range(1, 6))
    assert momentum == pytest.approx(7800.0 * 1.0e-4 * 10.0, rel=1e-9)
    for k in range(1, 6):
        force = table(folder, "rcforc", interface=k, side="slave")["fx"]
        assert (np.abs(force).max() > 0.0) == (k < 5) # the fifth is between blocks that do not meet
    assert "has been reversed" in (folder / "job.log").read_text() # node sets walked the wrong way


def test_parameters_reach_the_include(results):
    folder = results("includes")
    assert table(folder, "matsum", part=2)["mass"][0] == pytest.approx(7800.0 * 4.0e-4, rel=1e-12)
    assert table(folder, "glstat")["time"][-1] == pytest.approx(4.0e-5, rel=1e-2)
    assert np.abs(table(folder, "rcforc", side="slave")["fy"]).max() > 0.0
    assert "7 fixed" in (folder / "job.log").read_text() or "14 fixed" in (folder / "job.log").read_text()


def test_rigid_bodies_move_as_said(results):
    folder = results("rigid")
    mass, cell = 0.78, 0.01 / 3.0
    inertia = mass / 12.0 * (2.0 * 0.01 ** 2 + 4.0 * cell ** 2)
    flying, spinning = (table(folder, "matsum", part=k) for k in (3, 4))
    assert flying["momentum_x"] == pytest.approx(3.0 * mass, rel=1e-10)
    assert flying["momentum_y"] == pytest.approx(-2.0 * mass, rel=1e-10)
    assert flying["kinetic"] == pytest.approx(0.5 * mass * 13.0 + 0.5 * inertia * 100.0 ** 2, rel=1e-6)
    assert spinning["kinetic"] == pytest.approx(0.5 * inertia * 50.0 ** 2, rel=1e-6)
    punch = table(folder, "matsum", part=2)
    speed = np.interp(punch["time"], [0.0, 1.0e-4, 1.0], [0.0, -20.0, -20.0])
    assert punch["momentum_y"] / (7800.0 * 1.2e-4) == pytest.approx(speed, abs=2e-4 * 20.0) # the corner
    assert table(folder, "rcforc", side="slave")["fy"].min() < 0.0


def test_implicit_press_is_static(results):
    folder = results("implicit")
    force = table(folder, "rcforc", side="slave")["fy"]
    penalty = float(re.search(r"= (\S+) per unit length", (folder / "job.log").read_text()).group(1))
    # 1e-5 m on the contact spring and two blocks of 0.01 m in a row: sides free and sides held
    free, held = (1e-5 * 0.01 / (1.0 / penalty + 0.02 / modulus) for modulus in (2.1e11 / 0.91,
                                                                              2.1e11 * 0.7 / (1.3 * 0.4)))
    assert free < abs(force[-1]) < held
    assert force == pytest.approx(force[-1] * table(folder, "rcforc", side="slave")["time"], rel=1e-3)


def test_step_and_penalty_by_default_bring_no_warning(exe, decks, tmp_path):
    """The bounds may be that much too low; a penalty that somebody chose is warned of."""
    def said(name, *words):
        done = subprocess.run([exe, f"i={decks / f'stock_{name}.k'}", f"d={tmp_path}", "jobid=job", "quiet=1", "tssfac=0.9",
                               *words], capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr
        return done.stderr.count("requires a time step"), (tmp_path / "job.log").read_text().count("for the default penalty")

    for name, n in (("impact", 1), ("contacts", 5), ("includes", 1)):
        assert said(name) == (0, n)
    assert said("impact", "pen=1.001") == (1, 0)
    assert said("impact", "pen=0.5") == (0, 0)


def test_titles_are_no_cards(results):
    folder = results("titles")
    log = (folder / "job.log").read_text()
    assert 'part 2 "part 2, 1, 2, 3": 4 elements' in log
    assert "12 fixed and 0 prescribed degrees of freedom, 0 nodal loads, 2 pressure edges" in log
    assert table(folder, "matsum", part=3)["momentum_x"] == pytest.approx(7800.0 * 1.0e-4, rel=1e-9)


def test_defaults_change_nothing_but_the_bulk_viscosity_and_hourglass_control(results):
    """Fields as a client leaves them ask for nothing that is not had."""
    rows = table(results("defaults"), "glstat")
    assert rows["kinetic"][0] == pytest.approx(0.5 * 0.78 * 50.0 ** 2, rel=1e-12)
    assert "is not" not in (results("defaults") / "job.log").read_text()


def test_everything_that_is_not_had_is_listed(exe, decks, tmp_path):
    deck = decks / "stock_unsupported.k"
    done = subprocess.run([exe, f"i={deck}", f"d={tmp_path}"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    lines = deck.read_text().splitlines()
    said = [line for line in done.stderr.splitlines() if line.startswith(f"{deck}:")]
    for keyword, field in UNSUPPORTED:
        pattern = rf":(\d+): \*{keyword}(?=[ :]).*" + (rf"\({field}\)" if field else "not available in slideline")
        found = [re.search(pattern, line) for line in said]
        found = [match for match in found if match and not match.group(0).startswith("warning")]
        assert len(found) == 1, (keyword, field, done.stderr)
        line = int(found[0].group(1))
        if not field:
            assert lines[line - 1].startswith("*" + keyword)
    assert f"refused, {len(UNSUPPORTED)} errors" in done.stderr
