# SPDX-License-Identifier: MIT
"""Plane stress: the same bits at any number of threads and after a restart, erosion, loads and masses of the thickness, decks
with plane strain too."""
import subprocess

import h5py
import numpy as np
import pytest
from conftest import numbers
from meshes import Deck, grid

RHO, YOUNG, POISSON, THICKNESS = 1000.0, 2.0e5, 0.3, 0.3
WAVE = np.sqrt(YOUNG / (RHO * (1.0 - POISSON ** 2)))
CRITERIA = "*MAT_ADD_EROSION\n1,0.0,0.0,-0.02,0.05,0.0,1,1\n0.0,6e3\n"


def run(exe, folder, *words, status=0):
    done = subprocess.run([exe, *words], cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == status, done.stderr + done.stdout
    return done


def strip(points, law):
    """A strip with a weak middle that is torn, of thinning thickness."""
    deck = Deck("strip").add("*SECTION_SHELL", (1, 12, None, points), (THICKNESS,)).hourglass(4, 0.05)
    deck.add("*PART", "strip", (1, 1, 1)).control(60.0 / WAVE).add("*CONTROL_SHELL", (0, 0, 0, 1))
    if law == "plastic":
        deck.add("*MAT_PLASTIC_KINEMATIC", (1, RHO, YOUNG, POISSON, 400.0, 1000.0, 1.0), (0.0, 0.0, 0.12, 0.0))
    elif law == "hot":
        deck.add("*MAT_JOHNSON_COOK", (1, RHO, YOUNG / 2.6, YOUNG, POISSON), (400.0, 300.0, 0.5, 0.01, 1.0, 1500.0, 293.0, 1.0),
                 (5e5, 0.0, 2.0, 0.0, 0.05, 0.1, -1.5), (0.0,))
    else:
        deck.elastic(RHO, YOUNG, POISSON).add(*CRITERIA.splitlines())
    deck.add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    x, quads = grid(40, 10, 4.0, 1.0)
    x[:, 1] *= 1.0 - 0.05 * np.cos(np.pi * x[:, 0] / 8.0) ** 2
    ids = deck.mesh(x, quads).reshape(11, -1)
    deck.fix(ids[:, 0], x=1).fix([ids[5, 0]], y=1)
    deck.curve(1, [(0.0, 0.0), (6.0 / WAVE, WAVE / 50.0), (60.0 / WAVE, WAVE / 50.0)])
    for node in ids[:, -1]:
        deck.prescribe(node, 1, 0, 1)
    return deck.output(plot=12.0 / WAVE, glstat=3.0 / WAVE).add("*DATABASE_BINARY_D3DUMP", (300,))


@pytest.mark.parametrize("points, law", [(None, "plastic"), (4, "hot"), (None, "elastic"), (4, "elastic")])
def test_torn_strip(exe, tmp_path, points, law):
    """Same bits with two threads and after a restart; elements leave with their energy."""
    (tmp_path / "job.k").write_text(strip(points, law).text())
    for n in (1, 2):
        run(exe, tmp_path, "i=job.k", f"d=t{n}", f"ncpu={n}")
    (tmp_path / "again").mkdir()
    run(exe, tmp_path, "r=t1/job.dump01.h5", "d=again", "ncpu=2")
    tables = [(tmp_path / folder / "job.glstat.csv").read_text().splitlines() for folder in ("t1", "t2", "again")]
    assert tables[1] == tables[0]
    assert len(tables[2]) > 5 and tables[2][-4:] == tables[0][-4:]
    assert numbers(tmp_path / "t1/job.glstat.csv", "energy_ratio") == pytest.approx(1.0, abs=0.003)
    assert "eroded elements: " in (tmp_path / "t1/job.log").read_text()
    with h5py.File(tmp_path / "t1/job.vtkhdf") as stream:
        assert stream["VTKHDF/CellData/thickness_strain"][()].min() < -0.005
        assert np.abs(stream["VTKHDF/CellData/stress"][:, 2]).max() == 0.0


def test_loads_and_masses_of_the_thickness(exe, tmp_path):
    """A sheet beside a block in plane strain, both free: pressure times edge and depth over the mass, and a lumped mass."""
    deck = Deck("free bodies").add("*SECTION_SHELL", (1, 12), (THICKNESS,)).add("*SECTION_SHELL", (2, 13), (1.0,))
    deck.control(10.0 / WAVE).elastic(RHO, YOUNG, POISSON)
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
    for part in (1, 2):
        deck.add("*PART", "body", (part, part, 1))
        ids = deck.mesh(*grid(2, 2, origin=(0.0, 2.0 * part)), part)
        deck.add("*LOAD_SEGMENT", *[(1, 1.0, 0.0, int(ids[k]), int(ids[k + 1])) for k in (0, 1)])
        if part == 1:
            deck.add("*ELEMENT_MASS", (1, int(ids[4]), 50.0))
    run(exe, tmp_path, *write(tmp_path, deck.output(glstat=1.0 / WAVE, matsum=1.0 / WAVE)))
    rows = [line.split(",") for line in (tmp_path / "job.matsum.csv").read_text().splitlines()]
    last = {row[1]: float(row[rows[0].index("mass")]) for row in rows[1:]}
    assert (last["1"], last["2"]) == (pytest.approx(THICKNESS * RHO), pytest.approx(RHO))
    momentum = numbers(tmp_path / "job.glstat.csv", "external_work")[-1]
    time = numbers(tmp_path / "job.glstat.csv", "time")[-1]
    wanted = 0.5 * time ** 2 * (THICKNESS ** 2 / (THICKNESS * RHO + 50.0) + 1.0 / RHO)
    assert momentum == pytest.approx(wanted, rel=0.05)


def write(folder, deck):
    (folder / "job.k").write_text(deck.text())
    return ["i=job.k"]


def test_stiffness_damping_is_refused(exe, tmp_path):
    deck = Deck("damped").add("*SECTION_SHELL", (1, 12), (THICKNESS,)).add("*PART", "sheet", (1, 1, 1))
    deck.control(1.0).elastic(RHO, YOUNG, POISSON).add("*DAMPING_PART_STIFFNESS", (1, 0.1))
    deck.mesh(*grid(1, 1))
    assert "part 1 has plane stress" in run(exe, tmp_path, *write(tmp_path, deck), status=1).stderr


def test_a_thickness_that_is_not_found_is_named(exe, tmp_path):
    """One step that stretches an element by so much that no thickness is without stress across it."""
    deck = Deck("torn in one step").add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    deck.add("*SECTION_SHELL", (1, 12, None, 4), (THICKNESS,)).add("*PART", "sheet", (1, 1, 1)).elastic(RHO, YOUNG, 0.49)
    ids = deck.mesh(*grid(1, 1)).tolist()
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0)])
    for node, x, y in zip(ids, (0.0, 20.0, 0.0, 20.0), (0.0, 0.0, 20.0, 20.0)):
        deck.prescribe(node, 1, 2, 1, x).prescribe(node, 2, 2, 1, y)
    (tmp_path / "job.k").write_text(deck.text())
    done = run(exe, tmp_path, "i=job.k", "d=out", status=2)
    assert "no thickness in plane stress" in done.stderr
