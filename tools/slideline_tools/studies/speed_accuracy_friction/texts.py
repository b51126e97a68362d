# SPDX-License-Identifier: MIT
"""Text of the page of speed against accuracy with friction."""

PAGE = """# Speed against accuracy with friction

This page and its picture are written by `tools/study.sh speed-accuracy-friction --publish`: do not edit them. The sentences that name types
follow from the runs, by the rules of [speed against accuracy](speed_accuracy.md). What friction itself costs is no matter of this page, but
what each type costs with friction in it.

## Which type for the price

{advice}

![Error over computing time](../pictures/speed_accuracy_friction.png)

(Dotted and hollow: types whose die has lost its slab.)

## Partial slip: a cylinder drawn aside

Static. A steel cylinder (20 mm) is pressed on a steel block and then drawn aside, mu 0.3, penalty and meshes of the Hertz scene divided by N_r. With the forces P and Q of the run,
`a = sqrt(4 P R/(pi E*))`, `c = a sqrt(1 - Q/(mu P))`, the traction is (Cattaneo 1938, Mindlin 1949)

    q = mu p0 (sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - x^2/c^2))

The error is the distance of the nodal tractions from the means of q over the hat functions of the nodes (L2, over the norm of the latter: at single places
the cusp at c and the end at a would decide, as nodes happen to stand to them); the edge of the stick zone is half the distance of the outermost nodes that stick, so it is known to a segment (with type 4 to two: a node counts as slipping where one of the virtual nodes beside it slips). "Left by pressing": norm of the tractions before the
cylinder is drawn aside, over that of q; between half planes of one material there would be none. A static run costs what its iterations cost: contact is less than 1 % of it.

{slip}

## Ironing

The example of Fischer and Wriggers: a die with a round foot goes by 1 into a slab of 12 x 4 that is ten times softer, mu 0.3, then along it (here by 4; lengths without a unit). Explicit, one-point quads, slow against the
waves, damped. N_r = 2 has the 120 x 30 and 12 x 6 quads of the example, N_r = 1 half as many each way. Forces are judged behind the first quarter of the way along. Roughness: standard deviation from the running mean
over one element of the slab, over the mean; the largest deviation beside it. "Comes through": a mean vertical force of at least {lost:g} of the reference's, on every mesh. The reference is type 7 at N_r = 3, whose
own force is known to about {floor} (extrapolated from N_r 1, 2 and 3): smaller differences to it are no errors.

{iron}

The roughness has the period of the slab's elements: nodes of the slab come under the edge of the foot one by one, and a type is as smooth as it lets a node take its part
of the load little by little.

Times: one thread, medians of {rounds} rounds, corrected by the pace of the element loop; quartiles of the contact times lie at most {spread:.0f} % of the median apart (load of the machine {load:.1f}). Type 3 has half the penalty, its two
passes lie side by side.
"""
