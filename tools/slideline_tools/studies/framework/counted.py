# SPDX-License-Identifier: MIT
"""What pages say of counted instructions: jobs, tables and the words beside them."""
import dataclasses

import pandas as pd

from slideline_tools.contact_types import in_order
from slideline_tools.counting import HARDWARE
from slideline_tools.studies.common import label, markdown_table
from slideline_tools.studies.framework.table import counted


def counted_job(job, options=()):
    """The job again, counted once; `options` shorten it."""
    return dataclasses.replace(job, name=f"{job.name}_counted", options=(*job.options, *options),
                               labels={**job.labels, "shortened": " ".join(options)}, alone=False, turns=1,
                               once=True, counted=True, limit=None, cost=50.0 * job.cost)


def instruction_table(table):
    """Instructions of each type, in millions, and over those of type 1; of contact where it can be told apart.

    `table`: counted runs of one scene and mesh.
    """
    runs = table.set_index("type").loc[in_order(table["type"])]
    lines = pd.DataFrame({"type": [label(ctype) for ctype in runs.index]}, index=runs.index)
    for title, column in (("whole run", "instructions"), ("contact", "contact_instructions")):
        if column in runs and runs[column].notna().all():
            lines[f"{title}, millions"] = (1e-6 * runs[column]).map("{:.1f}".format)
            lines[f"{title} over type 1"] = (runs[column] / runs[column].get(1)).map("{:.3f}".format) if 1 in runs.index else ""
    return markdown_table(lines)


def who_counted(table):
    """'Counted by ...', with what was cut short and what a count is good for."""
    runs = counted(table)
    if runs.empty:
        return "No instructions were counted: the machine lent no counters and valgrind was not installed."
    by = sorted(set(runs["counted_by"]))
    text = (f"Counted by {', '.join(by)}" + (", of the program as it is." if by == [HARDWARE] else
            ", which emulates the program built for that processor (no AVX-512, so more of them than there are here).")
            + " Two counts of a run agree to 1e-4, on a busy machine too. Instructions differ in what they cost: a count "
            "tells work, not time.")
    short = dict(zip(runs["scene"], runs["shortened"])) if "scene" in runs and "shortened" in runs else {}
    short = {scene: words for scene, words in short.items() if words}
    if short:
        text += " Cut short: " + ", ".join(f"{scene} ({words})" for scene, words in short.items()) + "."
    return text


def instruction_section(table, titles):
    """A section of a page: a table for each scene and mesh that was counted. `titles`: {scene: words}."""
    parts = ["## Instructions", "The same cost in retired instructions, the whole run with its start and end. "
             + who_counted(table)]
    for (scene, level), same in counted(table).groupby(["scene", "level"], sort=False):
        parts.append(f"{titles[scene]}, N_r = {level}:\n\n{instruction_table(same)}")
    return "\n\n".join(parts)
