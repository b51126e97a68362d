# SPDX-License-Identifier: MIT
"""Friction in implicit steps: what slipped slips on in the first iteration of the next step, unless that leaves a body free."""
import re

import pytest
from conftest import numbers
from meshes import grid
from test_implicit import implicit

from slideline_tools.contact_types import ALL_TYPES

LOAD, FRICTION = 1000.0, 0.3


def drawn(kind):
    """A block pressed on a held row of quads, drawn along it by its top until time 1, and let go."""
    deck = implicit(2.0, 0.25, automatic=(0.0, 0.25)).part(1, points=4).elastic(1000.0, 1.0e7, 0.3, 1)
    upper = deck.mesh(*grid(2, 2, 1.0, 1.0, (-0.5, 0.0)), part=1).reshape(3, 3)
    lower = deck.mesh(*grid(5, 1, 4.0, 0.5, (-2.0, -0.5)), part=1).reshape(2, 6)
    deck.fix(lower.ravel(), x=1, y=1).node_set(1, upper[0]).node_set(2, lower[-1][::-1]).node_set(3, upper[-1])
    deck.curve(1, [(0.0, 0.0), (0.25, 1.0), (2.0, 1.0)]).curve(2, [(0.0, 0.0), (0.25, 0.0), (1.0, 0.1), (2.0, 0.1)])
    deck.add("*LOAD_NODE_POINT", *[(node, 2, 1, -LOAD * share)
                                   for node, share in zip(upper[-1].tolist(), (0.25, 0.5, 0.25))])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (3, 1, 2, 2, 1.0, 0, 1.0, 0.0))
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, 1.0e6, FRICTION))
    return deck.output(glstat=0.25, rcforc=0.25)


@pytest.mark.parametrize("kind", ALL_TYPES)
def test_drawn_and_let_go(slideline, tmp_path, kind):
    """Drawn on, a step needs no more iterations than without friction; let go, friction alone holds the block."""
    done = slideline("d=x", deck=drawn(kind))
    assert done.returncode == 0, done.stderr
    log = (tmp_path / "x" / "job.log").read_text()
    assert len(re.findall(r"step to 1\.000000E\+00 iteration", log)) <= 4
    assert ("step to 1.250000E+00: the matrix is singular" in log), "all of it slipped"
    # Friction has taken what the springs and bodies do not store.
    assert "has passed a limit point" not in log.split("step to 1.250000E+00")[0]
    table = tmp_path / "x" / "job.rcforc.csv"
    time, down, along = (numbers(table, column)[::2] for column in ("time", "fy", "fx"))
    pulled = [abs(f) for t, f in zip(time, along) if t == 1.0]
    # The block's lower side, whose normals types 3 and 5 press along too, bends a little.
    assert pulled == [pytest.approx(FRICTION * LOAD, rel=1.0e-9 if kind not in (3, 5) else 1.0e-2)]
    assert abs(down[-1]) == pytest.approx(LOAD, rel=1.0e-9)
    assert abs(along[-1]) < 1.0e-9 * LOAD
