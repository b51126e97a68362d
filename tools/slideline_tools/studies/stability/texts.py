# SPDX-License-Identifier: MIT
"""Text of the page of the stability maps."""

PAGE = """# Where each type is stable

This page and its picture are written by `tools/study.sh stability --publish`: do not edit them.

Each contact type, and type 7 with implicit penalty (7i: PUNIT 4), over six decades of penalty and steps of 0.1 to 1.5 times the smallest `L/c` of the elements, in three scenes: the patch test
under 20 kPa (2 % of the modulus) with mass damping, two blocks driven together by 0.24 m, and the sliding die with its strokes {faster:g} times faster.
Simulated times are short: {times}; an instability that is any faster shows, a slow drift does not. All elements have one point and the stiffness form of hourglass control.
The penalty is given over `K L/A`, the stiffness of the elements behind the interface (`PUNIT 2` is a factor on a tenth of it); at 1 the springs are as stiff as one row of elements.
The step is TSSFAC times `L/c`. A constant step of the deck (`LCTM`) above the stable step would not do it: the program warns once and takes TSSFAC times the stable step while it lies above. TSSFAC above 1
forces a step above `L/c`.

![Stability maps](../pictures/stability.png)

The last column of maps, 7i, has implicit penalty: PEN is the factor on `K L/A`, and a column of its own at the right, `<0`, has PEN below 0: no compliance. Its steps stand at the right; the seventh is 0.995.

Full line: `dt = 2/omega` by the largest eigenvalue of `M^-1 K`, elements and the springs of the type with all of the surface in contact: what stays closed is stable below it. Dotted and dash-dotted
lines: `omega dt` = 2 and 1 with the largest `omega` of the contact springs alone; springs that open and close make energy from `omega dt` = 1 on. Broken line: the limit that the program
computes at the start by both bounds (`doc/theory/contact.md`, section 7), about which it warns (`ECDT` 0) or which it keeps (`ECDT` 2).

## Verdicts

The first that applies:

| verdict | measure |
|---|---|
| blown up | the run ends early, or of the largest energy {ENERGY_DRIFT:.0%} is unaccounted for or {ENERGY_CREATED:.0%} made by contact (below) |
| penetrating | a slave node is deeper than {DEPTH_SIDES:g} element side, or than {DEPTH_APPROACH:g} of the way that the bodies are driven |
| chattering | the ups and downs of the contact force add up to more than {SWINGS:g} times its largest value (below) |
| locked | patch and blocks: the pressure along the surface scatters by more than {UNEVEN:.0%} of its mean (below) |
| limited | it would be stable, but the energy law has limited the contact forces in more than {CUT_SHARE:.0%} of the cycles with force (below) |
| stable | none of these |

- Blown up: a run ends early for a negative area or a value that is not finite. The account is the sum that
  leap-frog keeps (`total` of glstat), which a sound run keeps at any step; contact makes energy by its forces.
- Penetrating: the way is that by which the bodies are driven together.
- Chattering: in the second half, of 300 samples of the run or all its cycles; it takes two full losses of contact.
- Locked: at the end, {ENDS} nodes at either end left out.
- Limited: contact forces return no more energy than they took (`doc/theory/contact.md`, section 6.1). Where springs are stiffer than the step bears that law cuts them in nearly every cycle to what it bears:
  the run stays whole, but the surfaces lie in each other as if the penalty were that of the limit, and the log warns.

## Is the program's limit safe, and how sharp?

Limit of the program over the smaller of the two by eigenvalues (full and dash-dotted line), smallest and largest over all penalties. Above 1 it would be unsafe; 1.00 is where the elements alone decide.

{limits}

Of {n_below} cells of the types below the program's limit, {n_bad} blew up or chattered.

There are no limits by eigenvalue of 7i, and no lines in its maps. An eigenvalue bounds the step because springs push by the gap at the start of a step: the force of a stiff one overshoots where `omega dt` is above 2. With
PUNIT 4 they push by the gap of the end of the step, which is what the solution of each step makes of it; this force never drives the sides farther apart than the springs allow, whatever their stiffness, so that they have no
`omega` that the step could exceed (`doc/theory/contact.md`, section 6.6). What is left is the limit of the elements alone, `L/c`, and the program leaves these springs out of its own. Below it: {implicit}.

{counts}

## Which penalties work

Smallest and largest penalty over `K L/A` for which all steps tried below the program's limit (0.1 and above) are stable:

{ranges}

## Reading the maps

- *Too soft* is where the springs, not the bodies, take up the motion. This is no instability, and no step cures it. The smallest penalty of the table, over `K L/A`: {soft}.
  Type 3 adds its two passes and may be softer. (The blocks and the sliding die are driven together by {ways} only; there it is half of that way, not the side of an element, that decides.)
- *Penetrating where other types are stable* are types 1 and 2 between the blocks, by the end nodes alone: the two surfaces end at the same place, and an end node that slips over the master's end has no
  spring and sinks before it comes back. The nodes away from the ends lie as deep as with the other types. Deepest slave node over the way that the blocks are driven together (penetrating above {DEPTH_APPROACH:g}), the largest
  of the cells below the program's limit that do not blow up, by penalty over `K L/A`:

{depths}

- *Too stiff* begins along one curve, `dt = 2/omega`, in all scenes and types: above it the energy law cuts the forces in nearly every cycle (limited), or the run blows up. Past `K L/A` the limit falls with the root of the penalty: ten times the penalty costs three times the steps. Up to about `K L/A` a contact
  costs next to nothing. The program asks for half of that where springs may open and close: between `omega dt` 1 and 2 a contact that stays closed is stable, as most cells here, and one that bounces makes
  energy at each bounce ([ping-pong](../../tests/verification/ping_pong/README.md)).
- The types differ in where the curve lies, not in its shape. Type 1 gives every node the same spring: an end node has half of the mass and the whole spring. Type 3 adds its two passes. In both the curve
  lies about half a decade of penalty lower. Types 5 and 7 integrate along both chains, and their limits are predicted best; types 2, 4 and 6 stay stable a little above the program's limit, because no node gets
  the most that it could get.
- Past the curve springs that open and close at each step would make energy and turn an element over within tens of steps. The energy law takes it from them at once, and a stiffer penalty then changes nothing: between the
  blocks a hundred and ten thousand times `K L/A` give the same depth at the same step. On the sliding die such contact chatters as well.
- Nothing locks: at no stable penalty does the pressure of the patch or of the blocks scatter by more than {UNEVEN:.0%}. What types 1 to 3 get wrong there they get wrong at any penalty ([paper](paper.md)).
- *Blown up below the program's limit*: {blown}. It is not the step. The two surfaces of the blocks end at the same place, and their ends do not spread alike: an end node of types 1 and 2 slips over the end of the other
  surface, loses its whole spring at once and gets it back when it returns at another depth. The contact makes energy that way, the more, the stiffer the spring. With a second pass (type 3), or without a place at
  the very end that carries a whole spring (types 4 to 7), it does not. A surface may have places that start just beyond the end, where types 3, 4 and 6 make energy too.
- Cells at a step of exactly `L/c` can be stable although the limit by eigenvalue lies one or two per cent below: so near to it growth takes longer than these runs.
- All this is without friction, which has an instability of its own at any penalty and step (flutter: [stability](stability.md)).
- Between the two lines lies what the program gives away to be safe for all positions of the surfaces. (They are drawn straight between full decades.)

The deck of every failing cell, named by cell and verdict, is in `results/study-stability/failing/`, ready to run; meshes that cells share are written once and included.
"""
