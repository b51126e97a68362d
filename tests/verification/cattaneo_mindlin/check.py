# SPDX-License-Identifier: MIT
"""Partial slip: a cylinder pressed on a block and drawn aside and back, static and explicit."""
import pathlib
import sys

import line_contact
from contact_types import TYPES
from slideline_tools.scenes.hertz import RADIUS
from slip import looks

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "friction_calculix"))

from scenes import POISSON, YOUNG, cylinder_on_block, slideline_deck  # noqa: E402

#: Types where not in full: 1 and 2, and 6 and 7, differ in the third digit; friction_calculix has 2 and 5.
FEW = (7,)


def check_cylinder(run, kind):
    """Static, meshes of the Hertz scene at N_r = 2."""
    scene = cylinder_on_block(True, 2)
    deck, slave = slideline_deck(scene, kind)
    result = run.program(deck)
    for look in looks(result, slave, scene.times[1:], RADIUS, YOUNG / (1.0 - POISSON ** 2) / 2.0):
        name = (f"{TYPES[kind]}, {'' if look.way > 0.0 else 'back to '}Q/(mu P) = {look.share:.2f}, "
                f"h = a/{look.a / look.cell():.1f}")
        run.check(f"{name}: edges of the stick zone, slave segments", look.edges(), 0.0)
        run.check(f"{name}: traction, L2", look.error(), 0.0)
    energies = result.table("glstat")
    run.check(f"{TYPES[kind]}: total / external work", energies["total"][-1] / energies["external_work"][-1], 1.0)


def check(run):
    for kind in TYPES if run.is_full else FEW:
        check_cylinder(run, kind)
    line_contact.check(run)
