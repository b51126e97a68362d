# SPDX-License-Identifier: MIT
"""Text of the page of the stability maps."""

PAGE = """# Where each type is stable

This page and its picture are written by `tools/study.sh stability --publish`: do not edit them.

Each contact type over eight decades of penalty and steps of 0.1 to 1.5 times the smallest `L/c` of the elements, in three scenes: the patch test
under 20 kPa (2 % of the modulus) with mass damping, two blocks driven together by 0.24 m, and the sliding die with its strokes {faster:g} times faster.
Simulated times are short: {times}; an instability that is any faster shows, a slow drift does not. All elements have one point and the stiffness form of hourglass control.
The penalty is given over `K L/A`, the stiffness of the elements behind the interface (`PUNIT 2` is a factor on a tenth of it); at 1 the springs are as stiff as one row of elements.
The step is TSSFAC times `L/c`. A constant step of the deck (`LCTM`) above the stable step would not do it: the program warns once and takes TSSFAC times the stable step while it lies above. TSSFAC above 1
forces a step above `L/c`.

![Stability maps](../pictures/stability.png)

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
| stable | none of these |

- Blown up: a run ends early for a negative area or a value that is not finite. The account is the sum that
  leap-frog keeps (`total` of glstat), which a sound run keeps at any step; contact makes energy by its forces.
- Penetrating: the way is that by which the bodies are driven together.
- Chattering: in the second half, of 300 samples of the run or all its cycles; it takes two full losses of contact.
- Locked: at the end, {ENDS} nodes at either end left out.

## Is the program's limit safe, and how sharp?

Limit of the program over the smaller of the two by eigenvalues (full and dash-dotted line), smallest and largest over all penalties. Above 1 it would be unsafe; 1.00 is where the elements alone decide.

{limits}

Of {n_below} cells below the program's limit, {n_bad} blew up or chattered.

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

- *Too stiff* fails along one curve, `dt = 2/omega`, in all scenes and types. Past `K L/A` the limit falls with the root of the penalty: ten times the penalty costs three times the steps. Up to about `K L/A` a contact
  costs next to nothing. The program asks for half of that where springs may open and close: between `omega dt` 1 and 2 a contact that stays closed is stable, as most cells here, and one that bounces makes
  energy at each bounce ([ping-pong](../verification/ping_pong.md)).
- The types differ in where the curve lies, not in its shape. Type 1 gives every node the same spring: an end node has half of the mass and the whole spring. Type 3 adds its two passes. In both the curve
  lies about half a decade of penalty lower. Types 5 and 7 integrate along both chains, and their limits are predicted best; types 2, 4 and 6 stay stable a little above the program's limit, because no node gets
  the most that it could get.
- Past the curve the growth is so fast that there is hardly a zone of mere chatter: contacts that open and close at each step make energy, and within tens of steps an element turns over. Chatter shows
  in the sliding scene, where the plate yields and swallows what the contact makes: the last half decade below the curve.
- Nothing locks: at no stable penalty does the pressure of the patch or of the blocks scatter by more than {UNEVEN:.0%}. What types 1 to 3 get wrong there they get wrong at any penalty (`patch_test.md`).
- *Blown up below both curves* are types 1 and 2 between the blocks, from ten times `K L/A` on, at any step. It is not the step. The two surfaces end at the same place, and their ends do not spread alike: an end node slips
  over the end of the other surface, loses its whole spring at once and gets it back when it returns at another depth. The contact makes energy that way, the more, the stiffer the spring. With a
  second pass (type 3), or without a place at the very end that carries a whole spring (types 4 to 7), nothing failed here. `stability_shapes.md` has places that start just beyond the end, where types 3, 4 and 6 make energy too.
- Cells at a step of exactly `L/c` can be stable although the limit by eigenvalue lies one or two per cent below: so near to it growth takes longer than these runs.
- All this is without friction, which has an instability of its own at any penalty and step: [stability_friction](stability_friction.md).
- Between the two lines lies what the program gives away to be safe for all positions of the surfaces. (They are drawn straight between full decades.)

The deck of every failing cell, named by cell and verdict, is in `results/study-stability/failing/`, ready to run; meshes that cells share are written once and included.
"""
