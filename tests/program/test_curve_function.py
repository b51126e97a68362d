# SPDX-License-Identifier: MIT
"""*DEFINE_CURVE_FUNCTION: the function at times between its points, in both methods, and its end."""
import numpy as np
import pytest
from conftest import numbers
from meshes import Deck, grid

END = 0.2


def moved(motion, implicit=False):
    """One element whose upper nodes follow a function of time."""
    deck = Deck("function").control(END, dt=None if implicit else 1.0e-3)
    deck.part(points=4).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(1, 1))
    deck.fix(nodes[:2], x=1, y=1)
    deck.add("*PARAMETER", "R rate,3.0").add("*DEFINE_CURVE_FUNCTION", (1, 0), "0.01*exp(-rate*TIME)*", "  sin(2*pi*4*TIME)")
    for node in nodes[2:]:
        deck.prescribe(node, 1, motion, 1)
    if implicit:
        deck.add("*CONTROL_IMPLICIT_GENERAL", (1, 2.0e-3)).add("*CONTROL_IMPLICIT_DYNAMICS", (1,))
    deck.add("*DATABASE_BINARY_D3DUMP", (50,))
    return deck.output(glstat=0.01, nodout=0.01, nodes=[int(nodes[2])])


def function(time):
    return 0.01 * np.exp(-3.0 * time) * np.sin(8.0 * np.pi * time)


@pytest.mark.parametrize("implicit", (False, True))
def test_nodes_follow_a_function(slideline, tmp_path, implicit):
    done = slideline("d=out", deck=moved(2, implicit).text())
    assert done.returncode == 0, done.stderr
    time, way = (numbers(tmp_path / "out/job.nodout.csv", name) for name in ("time", "ux"))
    np.testing.assert_allclose(way, function(time), rtol=0, atol=2.0e-10)


def test_a_function_goes_on_after_a_restart(slideline, tmp_path):
    done = slideline("d=out", deck=moved(2).text())
    assert done.returncode == 0, done.stderr
    done = slideline("r=out/job.dump01.h5", "d=same")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "same/job.nodout.csv").read_bytes() == (tmp_path / "out/job.nodout.csv").read_bytes()
    done = slideline("r=out/job.dump01.h5", f"endtim={2 * END}", "d=late")
    assert done.returncode == 0, done.stderr
    time, way = (numbers(tmp_path / "late/job.nodout.csv", name) for name in ("time", "ux"))
    assert time[-1] > 1.9 * END
    np.testing.assert_allclose(way, function(time), rtol=0, atol=4.0e-10)
