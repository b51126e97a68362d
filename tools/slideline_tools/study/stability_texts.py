# SPDX-License-Identifier: MIT
"""Text of the page of the stability maps."""

PAGE = """# Where each type is stable

This page and its picture are written by `tools/study.sh stability --publish`: do not edit them.

Each contact type over eight decades of penalty and steps of 0.1 to 1.5 times the smallest `L/c` of the elements, in three scenes: the patch test
under 20 kPa (2 % of the modulus) with mass damping, two blocks driven together by 0.24 m, and the sliding die with its strokes {faster:g} times faster.
Simulated times are short: {times}; an instability that is any faster shows, a slow drift does not. All elements have one point and the stiffness form of hourglass control.
The penalty is given over `K L/A`, the stiffness of the elements behind the interface (`PUNIT 2` is a factor on a tenth of it); at 1 the springs are as stiff as one row of elements.
Steps above the elements' own limit are refused by the program where the deck gives a constant one; TSSFAC above 1 forces them, with a warning.

![Stability maps](../pictures/stability.png)

Full line: largest stable step by the largest eigenvalue of `M^-1 K`, elements and the springs of the type with all of the surface in contact. Broken line: the limit that the program
computes at the start (`doc/theory/contact.md`, section 7), about which it warns (`ECDT` 0) or which it keeps (`ECDT` 2).

## Verdicts

The first that applies:

| verdict | measure |
|---|---|
| blown up | the run ends early (a negative area, a value that is not finite), or {ENERGY_DRIFT:.0%} of the largest energy is not accounted for, or the contact forces have made {ENERGY_CREATED:.0%} of it |
| penetrating | a slave node is deeper than {DEPTH_SIDES:g} element side, or than {DEPTH_APPROACH:g} of the way that the bodies are driven together |
| chattering | in the second half, {SWITCHING:.0%} of the contact points open or close between two of 300 samples |
| locked | patch and blocks: at the end the pressure along the surface scatters by more than {UNEVEN:.0%} of its mean ({ENDS} nodes at either end left out) |
| stable | none of these |

## Is the program's limit safe, and how sharp?

Limit of the program over that by eigenvalue, smallest and largest over all penalties. Above 1 it would be unsafe; 1.00 is where the elements alone decide.

{limits}

Of {n_below} cells below the program's limit, {n_bad} blew up or chattered.

{counts}

## Which penalties work

Smallest and largest penalty over `K L/A` for which all steps tried below the program's limit (0.1 and above) are stable:

{ranges}

## Reading the maps

- *Too soft* fails for every type alike: below about a tenth of `K L/A` the springs, not the bodies, take up the motion. This is no instability, and no step cures it.
- *Too stiff* fails along one curve: `dt = 2/omega`. Past `K L/A` the limit falls with the root of the penalty; ten times the penalty costs three times the steps. The penalty that costs nothing is about `K L/A` and below.
- The types differ in where the curve lies, not in its shape. Type 1 gives every node the same spring: an end node has half the mass and the whole spring, so type 1 leaves first. Type 3 adds its two passes: twice the spring.
  Types 5 and 7 integrate along both chains and their limits are predicted best; types 2, 4 and 6 stay stable a little above the program's limit, because no node gets the most that it could get.
- Past the curve the growth is so fast that there is hardly a zone of mere chatter: contacts that open and close at each step make energy, and within tens of steps an element turns over.
- Between the two lines lies what the program gives away to be safe for all positions of the surfaces.

Decks of failing cells (the first of each verdict, and every one below the program's limit) are in `results/study-stability/failing/`, ready to run.
"""
