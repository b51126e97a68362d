# SPDX-License-Identifier: MIT
"""Counted instructions: jobs, and the words beside their figures."""
import dataclasses

from slideline_tools.studies.framework.table import counted


def counted_job(job, options=()):
    """The job again, counted once; `options` shorten it."""
    return dataclasses.replace(job, name=f"{job.name}_counted", options=(*job.options, *options),
                               labels={**job.labels, "shortened": " ".join(options)}, alone=False, turns=1,
                               once=True, counted=True, limit=None, cost=50.0 * job.cost)


def who_counted(table):
    """'Counted by ...', with what was cut short and what a count is good for."""
    runs = counted(table)
    if runs.empty:
        return "No instructions were counted: valgrind was not installed."
    text = (f"Counted by {', '.join(sorted(set(runs['counted_by'])))}, which emulates the program built for that "
            "processor. Two counts of a run agree to 1e-4, on a busy machine too. Instructions differ in what they "
            "cost: a count tells work, not time.")
    short = dict(zip(runs["scene"], runs["shortened"])) if "scene" in runs and "shortened" in runs else {}
    short = {scene: words for scene, words in short.items() if words}
    if short:
        text += " Cut short: " + ", ".join(f"{scene} ({words})" for scene, words in short.items()) + "."
    return text
