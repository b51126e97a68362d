# SPDX-License-Identifier: MIT
"""Text of the page of claims about friction."""

PAGE = """# Our claims about friction, answered

This page and its picture are written by `tools/study.sh claims-friction --publish`: do not edit them. The verdicts follow from the
figures by the rules stated here; "partly" means for some of the types. The claims of the paper that this program began with are in [claims](claims.md); that has no friction.

{summary}

The frictional patch test, static: two blocks whose meshes do not fit, a uniform pressure p on top, a uniform shear of 0.3 p on all outer faces, fully integrated quads, nu 0.3. In stick mu is 0.5; in full slip it is 0.3 and
one node of the top is led along until every place slips. Bodies alike under 1e-6 of Young's modulus, and one three times as stiff under 1e-12 of it (their faces would tilt); a penalty of {penalty:g} N/m per node. Meshes by their segments, slave/master; 7/5 and 4/7 are uneven. The decks are those of
[the verification case](../../tests/verification/friction_patch_static/README.md), which has other penalties too. Deviations are the largest of all nodes,
on both sides, of nodal force over length from the exact traction and pressure. Exact means at most {exact:g}.

![Deviation of the traction by type and mesh](../pictures/claims_friction.png)

## 1. Types 4, 5 and 7 transmit a uniform shear exactly where it sticks: {stick}

Yes means: traction and pressure of all three are exact on every mesh, on both sides, with both pairs of bodies, at equal springs along and across (TFAC 1) and at TFAC 0.1. Exact are
{stick_types} (largest deviation {worst_stick}). Deviation of the traction, TFAC 1:

{stick_table}

TFAC 0.1:

{weak_table}

## 2. ... and in full slip: {slip}

The same with the limit reached everywhere. Exact are {slip_types}.

{slip_table}

## 3. No other type does, on any mesh that does not fit: {fail}

Yes means: the deviation of the traction in stick is above {exact:g} with types 1, 2, 3 and 6 on every mesh. Over the meshes: {ranges}. The least of them (within a
factor of {factor:g}): {best}. It is the places and their weights that fail, as in [the patch test](patch_test.md); the law of friction is one for all.

## 4. In full slip the shear of every type errs as its pressure does: {same}

Since `T = mu p` at every place where pressure is formed, and both go to the nodes by the same shares. Yes means: for every type, mesh and side both deviations agree to {exact:g} (unlike bodies under their small load, where no face tilts by what counts). Largest differences: {differences}.

{failed}
"""
