# SPDX-License-Identifier: MIT
"""Texts of the page of the study simplify; every figure is read from the runs."""
from slideline_tools.studies.simplify.figures import duration, megabytes, percent, small_share

PAGE = """# No more than a scene needs

This page and its picture are written by `tools/study.sh simplify --publish`: do not edit it.

What each simplification saves, and what it costs in accuracy. Each is a pair of runs, one with more than the scene needs and one without.
All are explicit runs of type 2 unless a type is named.

How it is measured: one thread ({processor}); processor time of the whole run with its start, median of {rounds} or more
runs in which all variants ran in turn. The quartiles of a time lie {spread} of it apart (median over the variants): savings of
less mean nothing. Contact time is the part of the processor time that its share of the clock over all runs makes, or the least that the
clock has shown in a run if that is less. Load of the machine: {load} processes that want to run; where that is above the number of cores,
contact times are less certain than the whole. Memory is the peak of the process, most of which is the program and its libraries.

*Instructions saved*: of the retired instructions of the whole run, N_r = 1. {counted}

![Processor time with and without](../pictures/simplify.png)

{quick}## What is saved, and what it costs

Force: rms of the difference over the rms of the force history. Displacement: largest difference at the last state over the largest displacement.
Plastic strain: sum of the differences over the sum. Each over what both models have.

{overviews}

"Results" are the results file and the histories. The law and the output are changed in the collision and the Hertz scene, the search in
two scenes, since its worth depends on how long nothing touches.

## Symmetry

{symmetry}

{halves}

What is more than round-off comes from the plane of symmetry:

- Type 1 gives every contact node the same spring, whatever length it stands for. A node on the plane stands for half a length and would need half of
  the penalty; the other types divide by lengths.
- Types 2 and 3: in the half model the node on the plane faces one segment, and its force takes the tilt of that when the surface bends; in the full model
  there is a segment on either side.
- Type 5: here the full model is the one that is not symmetric. The projectile drifts sideways a little, since a node
  exactly opposite another belongs to one of two segments.

Where nature may break the symmetry (buckling, a load off the centre) the half model hides it.

## Rigid die

{rigid}

## Contact search asleep

A contact node at a distance from everything sleeps until the surfaces can have come that near
([contact.md](../theory/contact.md), section 4). This is always on. `FREQ` = 1 on card 2 of `*CONTACT_2D_SLIDELINE` is the way
to have all nodes that do not touch searched for globally in each cycle; that is "searched in each cycle" here, and an upper bound: a program could follow
awake nodes for less. Nodes that touch are followed alike in both. The sliding gains, too: the ends of the crown do not
touch. Collision, N_r = {level}:

{sleep}

"Same bits": all histories, and all fields of all states, are equal.

{exception}

When is contact time spent?

{spans}

{share}

## Elastic parts without plastic history

{law}

The coarsest mesh and the cheapest types for an error: [speed_accuracy](speed_accuracy.md).

## Output

Collision, N_r = {level}:

{outputs}

{output}

## All together

{together}
"""

QUICK = """This was a quick run: the coarsest meshes alone.

"""


def saved(runs, level, more, less):
    """Share of the processor time."""
    return 1.0 - runs.seconds(less, level) / runs.seconds(more, level)


def saving_text(runs, level, more, less):
    """A share of the processor time; what is no more than the times scatter says so."""
    share = saved(runs, level, more, less)
    return percent(share) + (" (no more than times scatter)" if not share > runs.spread else "")


def symmetry(runs, level):
    """Half against full model."""
    if not runs.has("collision_full", level):
        return "Not run."
    return (f"The full model is the half model mirrored in x = 0; forces are halved before they are compared. The half model saves "
            f"{percent(saved(runs, level, 'collision_full', 'collision'))} of the time at N_r = {level} and half of the states. "
            f"What it costs depends on the type; N_r = {level}:")


def rigid(runs, levels):
    """Rigid against elastic die, beside what refinement changes."""
    levels = [level for level in levels if runs.has("sliding_rigid", level)]
    if not levels:
        return "Not run."
    parts = []
    for level in levels:
        row, more = runs.first("sliding_rigid", level), runs.first("sliding", level)
        parts.append(
            f"N_r = {level}: {percent(saved(runs, level, 'sliding', 'sliding_rigid'))} of the time saved; force history "
            f"{small_share(row['force_error'])} off, impulse {small_share(row['impulse_error'])}, plastic strain "
            f"{small_share(row['strain_shift'])} in sum and {row['strain_error']:.2g} at most (the largest is {row['largest_strain']:.2g}).")
        if "force_error" in more:
            parts.append(
                f"Refining the elastic model from N_r = {level - 1} to {level} changes the force by {small_share(more['force_error'])} and the impulse by "
                f"{small_share(more['impulse_error'])}: " + (
                    "more than the rigid die does." if more["force_error"] > row["force_error"]
                    else "less than the rigid die does."))
    return ("A die of steel on aluminium, `make-deck sliding --rigid-die`: no stresses in its elements, its nodes follow its motion, contact as usual. "
            + " ".join(parts) + " The die then has no stresses to show. The limit of the elements on the time step grows from "
            f"{1e9 * runs.first('sliding', levels[-1])['element_limit']:.0f} to {1e9 * runs.first('sliding_rigid', levels[-1])['element_limit']:.0f} ns at N_r = {levels[-1]}: "
            "a longer step would save more; both runs have the same step here.")


def exception(runs, level):
    """What differs, and where it comes from."""
    row = runs.first("collision_awake_type_3", level)
    other = runs.first("collision_wider_awake_type_3", level)
    if not row or not other:
        return ""
    if row["same_bits"]:
        return "No type differs."
    return (f"Type 3 differs by round-off ({small_share(row['displacement_error'])}): there some nodes of the plate lie exactly opposite nodes of the projectile, so "
            "that two segments are equally near, and a search may take the one where memory has the other. With a projectile 0.65 % wider, in which no two nodes "
            f"face each other but on the plane of symmetry, type 3 gives {'the same bits' if other['same_bits'] else 'other bits, too'}.")


def share(runs, level):
    """Cycles by what the bodies did; the paper's finding."""
    count = runs.first("collision_every_row", level)
    if not count:
        return ""
    between = count["rows"] - count["rows_before"] - count["rows_touching"] - count["rows_after"]
    part = {name: percent(value / count["rows"]) for name, value in
            {**{key: count[key] for key in ("rows_before", "rows_touching", "rows_after")},
             "between": between}.items()}
    idle = percent(1.0 - count["rows_touching"] / count["rows"])
    seconds = [runs.seconds(name, level, "contact") for name in ("collision_awake_type_2", "collision")]
    return (f"Of {count['rows']} cycles {part['rows_before']} come before the first contact, {part['rows_touching']} have contact, "
            f"{part['between']} lie between contacts and {part['rows_after']} after the last: nothing touches in {idle} of them. The paper's collision spends most of its contact "
            f"time (section 4.3) on detection while nothing touches; asleep, contact takes {duration(seconds[1])} instead of {duration(seconds[0])}, "
            f"{percent(seconds[1] / runs.seconds('collision', level))} of the run instead of "
            f"{percent(seconds[0] / runs.seconds('collision_awake_type_2', level))}. What is left in a sleeping cycle is one pass over the "
            "nodes of the interface for the bound on their motion, and the clock.")


def law(runs, level):
    """An elastic law for a plastic one that never yields."""
    if not runs.has("hertz_plastic", level):
        return "Not run."
    rows = [runs.first(name, level) for name in ("collision_plastic_projectile", "hertz_plastic")]
    same = ("Forces and the fields of all states are the same to the last bit, sums of internal energy differ in their last digits."
            if all(row["same_states"] and row["force_error"] == 0.0 for row in rows)
            else "Results differ by round-off.")
    bytes_ = [runs.first(name, level)["bytes"] for name in ("hertz_plastic", "hertz")]
    return (f"A plastic law whose yield stress is out of reach: in the projectile alone it costs "
            f"{saving_text(runs, level, 'collision_plastic_projectile', 'collision')} of the collision, in all elements "
            f"{saving_text(runs, level, 'hertz_plastic', 'hertz')} of the Hertz scene. {same} The results have {megabytes(bytes_[0])} and {megabytes(bytes_[1])} MB: plastic strain is written for every element "
            "whatever its law, so there is nothing to save in bytes.")


def output(runs, level):
    """What output costs."""
    least = "collision_no_output"
    if not runs.has(least, level):
        return ""
    return (f"States are the dear part: without them {percent(saved(runs, level, 'collision', 'collision_no_states'))} of the time and "
            f"{percent(1.0 - runs.first('collision_no_states', level)['bytes'] / runs.first('collision', level)['bytes'])} of the bytes go. What is computed does not change. "
            "A study of one force history needs no more than that history.")


def together(runs, level):
    """Everything needless against the lean model."""
    if not runs.has("collision_too_much", level):
        return "Not run."
    more, less = "collision_too_much", "collision_force_alone"
    ratio = runs.seconds(more, level) / runs.seconds(less, level)
    return (f"A full model, searched in each cycle, with a plastic law in the projectile and all output takes {duration(runs.seconds(more, level))}; the half model, asleep, "
            f"elastic, with the force history alone {duration(runs.seconds(less, level))}: {ratio:.1f} times less, and "
            f"{runs.first(more, level)['bytes'] / runs.first(less, level)['bytes']:.0f} times fewer bytes.")
