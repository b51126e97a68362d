# SPDX-License-Identifier: MIT
"""Text of the page of contact between bodies of revolution."""

PAGE = """# Contact of bodies of revolution: speed against accuracy

This page and its picture are written by `tools/study.sh round-contact --publish`: do not edit them. Axisymmetric quads (ELFORM 15) with
one point. The decks and the answers are those of the verification cases `press_fit`, `hertz_spheres` and `hertz_impact`, whose pages
say what is measured and what keeps it from the closed forms.

- **Exact in the press fit, at every node of both sides: {exact}.**
- **The best pressure between spheres: {best}** (on the finer mesh; less than a factor of {error_factor:g} counts as alike).
- **The cheapest contact there: {cheap}** (less than a factor of {cost_factor:g} counts as alike).
- **Among the best and among the cheapest: {both}.**

## Accuracy

Press fit (Lame, ends held, 7 rows of quads against 5): largest deviation of a nodal pressure on either side. Spheres (Hertz, with the
penalty as a layer of springs; 4 segments of the slave in the contact radius, and 8): radius and peak over the answer, and the error of the
pressure over its norm. Collision of two steel spheres (Hertz, likewise): contact time and largest force over the answer.

{errors}

Radius and time err alike for all types: that is the mesh (`h^2.5` at the edge of contact) and, in the collision, that a sphere is
not a half space. The error of the pressure holds the edge too, where a node is in or out; what tells the types apart is the press fit and the peak.

![error of the pressure between spheres over contact time](../pictures/round_contact.png)

## Cost

Contact time per cycle over that of type {base}, and the share of contact in the computing time (elements, nodes, contact). These scenes are small, with
a tenth of their nodes in contact: no measure of large ones, for which see [speed](speed.md). The quickest of the repeats; where the
machine does other work beside it, they scatter by tens of per cent.

{costs}

{counts}
"""
