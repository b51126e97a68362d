# SPDX-License-Identifier: MIT
"""*PART_INERTIA: impact of a body whose mass is not that of its elements; same bits, restart; what nodes cannot carry."""
import numpy as np
import pytest
from conftest import numbers
from meshes import Deck, grid
from test_restart import histories


def impact(mass=40.0, moment=2.4, n=3):
    """A rigid block of its own inertia falls on an elastic one."""
    deck = Deck("inertia").control(0.02, dt=1.0e-4)
    deck.add("*SECTION_SHELL", (1, 13, 1.0, 1), (1.0,)).add("*MAT_RIGID", (1, 1000.0, 1.0e7, 0.3), (0.0,))
    deck.add("*PART_INERTIA", "block", (1, 1, 1), (0.45, 0.202, 0.0, mass), (0.0, 0.0, 0.0, 0.0, 0.0, moment),
             (0.1, -2.0, 0.0, 0.0, 0.0, 1.0))
    deck.add("*PART", "seat", (2, 1, 2)).elastic(1000.0, 1.0e6, 0.3, 2)
    upper = deck.mesh(*grid(n, max(n - 1, 1), 0.6, 0.4, (0.2, 0.002)), part=1)
    lower = deck.mesh(*grid(7, 3, 1.0, 0.4, (0.0, -0.4)), part=2)
    deck.node_set(1, upper[:n + 1]).node_set(2, lower[-8:][::-1])
    deck.contact(1, 2, 5, 1.0e6).output(glstat=1.0e-3, matsum=1.0e-3)
    return deck.add("*DATABASE_RBDOUT", (1.0e-3,)).add("*DATABASE_BINARY_D3DUMP", (100,))


def test_momentum_goes_from_the_body_to_the_seat(slideline, tmp_path):
    for threads in (1, 2):
        done = slideline(f"d=out{threads}", f"ncpu={threads}", "perthread=1", deck=impact())
        assert done.returncode == 0, done.stderr
    assert histories(tmp_path / "out1") == histories(tmp_path / "out2")
    parts = {name: numbers(tmp_path / "out1/job.matsum.csv", name).reshape(-1, 2) for name in ("momentum_x", "momentum_y", "mass")}
    assert np.allclose(parts["mass"][:, 0], 40.0, rtol=1e-12)
    assert np.allclose(parts["momentum_y"].sum(1), -80.0, rtol=1e-10) and parts["momentum_y"][-1, 1] < -1.0
    assert np.allclose(parts["momentum_x"].sum(1), 4.0, rtol=1e-9)
    speed = numbers(tmp_path / "out1/job.rbdout.csv", "vy")
    assert np.allclose(40.0 * speed, parts["momentum_y"][:, 0], rtol=1e-9)
    kinetic = numbers(tmp_path / "out1/job.glstat.csv", "kinetic")
    assert kinetic[0] == pytest.approx(0.5 * 40.0 * (0.1**2 + 2.0**2) + 0.5 * 2.4, rel=1e-9)
    assert np.allclose(numbers(tmp_path / "out1/job.glstat.csv", "energy_ratio")[1:], 1.0, atol=2e-3)
    done = slideline("r=out1/job.dump01.h5", "d=on")
    assert done.returncode == 0, done.stderr
    assert histories(tmp_path / "on") == histories(tmp_path / "out1")


@pytest.mark.parametrize("deck", (impact(moment=40.0), impact(moment=0.001), impact(n=1)), ids=("far", "near", "one element"))
def test_what_nodes_cannot_carry_is_named(slideline, deck):
    done = slideline("d=out", deck=deck)
    assert done.returncode == 1
    found = done.stderr.replace("4.000000E+01", "40")
    assert ".k:21: *PART_INERTIA: rigid part 1: no masses above 0 at its nodes have the mass 40" in found


def test_elements_that_share_its_nodes_are_named(slideline, tmp_path):
    """Their mass there, and that of *ELEMENT_MASS, is part of TM: a warning with file and line."""
    heavy = impact().text().replace("*ELEMENT_SHELL\n", "*ELEMENT_MASS\n1,3,5.0\n*ELEMENT_SHELL\n", 1)
    done = slideline("d=out", deck=heavy.replace("*ELEMENT_SHELL\n", "*ELEMENT_SHELL\n900,2,1,2,6,5\n", 1))
    assert "*PART_INERTIA: 5 nodes of this part have an *ELEMENT_MASS or belong to elements" in done.stderr + done.stdout
    assert slideline("d=heavy", deck=heavy).returncode == 0
    assert numbers(tmp_path / "heavy/job.matsum.csv", "mass")[0] == pytest.approx(40.0, rel=1e-12)


def test_a_light_wall_is_named(slideline):
    text = impact().text().replace("*END", "*RIGIDWALL_PLANAR_MOVING\n0,\n0.0,-0.5,0.0,0.0,0.0,0.0,0.0\n0.1,1.0\n*END")
    done = slideline("d=out", deck=text)
    assert done.returncode == 1
    assert "*RIGIDWALL_PLANAR_MOVING: the mass 1.000000E-01 of the wall is not above that of a node" in done.stderr
