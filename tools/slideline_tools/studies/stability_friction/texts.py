# SPDX-License-Identifier: MIT
"""Text of the page of the flutter."""

PAGE = """# How fast sliding flutters, and what damps it

This page and its picture are written by `tools/study.sh stability-friction --publish`: do not edit them.

Coulomb friction is not symmetric: the pressure moves the limit of the traction, the traction does not move the pressure. Steady sliding
without any damping may therefore flutter: some motion across and along the interface grows by itself, fed by what drives the sliding
([contact](../theory/contact.md#62-friction-lawlaw_friction-lawfriction), *Stability*). Here is how fast, for each type, coefficient and penalty, beside what the
eigenvalues of the linear system say; and what stops it.

An elastic block (10 x 3 elements, nu 0.3, one point, stiffness form of hourglass control) is pressed on another one (11 x 3, held at its bottom) by its top, to about {pressure:g} of
Young's modulus, and led along by {speed:g} m/s, so slowly that no node comes to another one. Mass damping brings it to steady sliding and fades out; then one slave node gets {kick:g} of the
sliding speed. What grows is measured by the speeds of the slave nodes across the interface, over the last factor of {stretch:g} of their amplitude
below {largest:g} of the sliding speed, where nothing sticks and nothing lifts off. Runs end after {longest} steps at the latest.

**Prediction**: with all of the surface in slip `T = mu p`, and the springs `S` of a type between displacements across the interface make the forces `-S u_y` across and
`mu S u_y` along it. The eigenvalues of `M^-1 (K + S - mu S turned)` by leap-frog at the step of the run are the growth rates; written from the equations
([elements](../theory/elements.md), springs as in [stability](stability.md)), not from the program.

Rates are **e-folds in 1000 of the shortest stable steps of the elements** (`L/c`), since it is steps that one counts.

![Growth over coefficient and penalty](../pictures/stability_friction.png)

## Does the program flutter as it should?

Of {n_cells} cells those that should grow by {telling:g} e-folds or more within the run, and those that should grow by one at most:

{agreement}

It does, with every type: the growth is what Coulomb's law makes of two elastic bodies on these meshes without damping, and no fault of the program. Single cells are
off where two motions of nearly one frequency and rate beat, or where a slower motion is still ahead at the end of the run. After the speeds of the flutter
have reached that of the sliding, slip stops for a part of each period and bounds it.

## How fast

Measured, range over the penalties, 0.1 to 10 times `K L/A`:

{ranges}

Range over the types:

{penalties}

No flutter at any penalty: {calm}.

{tables}

(measured, in brackets predicted; "-" where nothing grows that could be told.)

- The rate rises with mu, faster than in proportion. No type is free of it, and none has the lowest rate everywhere.
- A contact much softer than the elements flutters least. From about `K L/A` on the penalty matters little against mu. Rates are per step of the elements alone: a stiff contact has
  shorter steps, and by those flutters more slowly.

## What damps it

At mu 0.5 and a penalty of `K L/A`. Frequencies times `L/c`: 2 is the highest that a mesh can have, below 0.3 the bodies swing as a whole.

{cures}

Motions that grow there without a cure, by the prediction, the fastest ones: {modes}.

- **VDC, bulk viscosity and the viscous form of hourglass control** take the shortest waves first and leave the longer ones: they lower the rate, and in {growing} of {others} runs with them something
  still grew. (Damping of contact acts across the interface alone; bulk viscosity while an element is compressed.)
- **Mass damping** (`*DAMPING_GLOBAL`) takes its half from every rate, whatever moves: growth stops from `D` twice the rate on ({calm_mass} of {n_mass} runs with more than that are calm). It
  also slows what should move: use it where the answer is at rest, or give the bodies back what it takes from a steady motion, as these decks do.
- The program has no damping in proportion to stiffness (`*DAMPING_PART_STIFFNESS` is refused by name); bulk viscosity is what it has of this kind.
- In long runs of sliding bodies at mu of 0.2 and more expect some e-folds in a thousand steps, plan for damping, and look at `state` in `contact.csv`: flutter shows as places that
  stick and slip in turn under a steady drive (`slideline-tools plot RUN --zones`).
"""
