# SPDX-License-Identifier: MIT
"""*DEFINE_CURVE_FUNCTION: the function at times between its points, in both methods, and its end."""
import numpy as np
import pytest
from conftest import numbers
from meshes import Deck, grid

END = 0.2


DAMPED = ("0.01*exp(-rate*TIME)*", "  sin(2*pi*4*TIME)")
#: short beside the end time, in step with halves of it, or with an inflection in the middle of one
SHAPES = {
    "pulse": ("IF(TIME-4e-4,0.001*SIN(PI*TIME/4e-4),0,0)", lambda t: np.where(t < 4e-4, 1e-3 * np.sin(np.pi * t / 4e-4), 0.0)),
    "zeros": ("0.001*SIN(2*PI*320*TIME)", lambda t: 1e-3 * np.sin(640.0 * np.pi * t)),
    "step": ("STEP(TIME,0,0,3.125e-3,0.001)",
             lambda t: 1e-3 * np.clip(t / 3.125e-3, 0.0, 1.0)**2 * (3.0 - 2.0 * np.clip(t / 3.125e-3, 0.0, 1.0)))}


def moved(motion, implicit=False, expression=DAMPED, step=1.0e-3, interval=0.01):
    """One element whose upper nodes follow a function of time."""
    deck = Deck("function").control(END, dt=None if implicit else step)
    deck.part(points=4).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(1, 1))
    deck.fix(nodes[:2], x=1, y=1)
    deck.add("*PARAMETER", "R rate,3.0").add("*DEFINE_CURVE_FUNCTION", (1, 0), *expression)
    for node in nodes[2:]:
        deck.prescribe(node, 1, motion, 1)
    if implicit:
        deck.add("*CONTROL_IMPLICIT_GENERAL", (1, 2.0e-3)).add("*CONTROL_IMPLICIT_DYNAMICS", (1,))
    deck.add("*DATABASE_BINARY_D3DUMP", (50,))
    return deck.output(glstat=0.01, nodout=interval, nodes=[int(nodes[2])])


def function(time):
    return 0.01 * np.exp(-3.0 * time) * np.sin(8.0 * np.pi * time)


@pytest.mark.parametrize("implicit", (False, True))
def test_nodes_follow_a_function(slideline, tmp_path, implicit):
    done = slideline("d=out", deck=moved(2, implicit).text())
    assert done.returncode == 0, done.stderr
    time, way = (numbers(tmp_path / "out/job.nodout.csv", name) for name in ("time", "ux"))
    np.testing.assert_allclose(way, function(time), rtol=0, atol=2.0e-8)


@pytest.mark.parametrize("name", SHAPES)
def test_what_is_short_or_regular_is_seen(slideline, tmp_path, name):
    text, exact = SHAPES[name]
    done = slideline("d=out", deck=moved(2, expression=(text,), step=1.0e-4, interval=1.0e-4).text())
    assert done.returncode == 0, done.stderr
    time, way = (numbers(tmp_path / "out/job.nodout.csv", column) for column in ("time", "ux"))
    np.testing.assert_allclose(way, exact(time), rtol=0, atol=2.0e-9)


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
    np.testing.assert_allclose(way, function(time), rtol=0, atol=4.0e-8)
