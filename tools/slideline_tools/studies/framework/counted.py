# SPDX-License-Identifier: MIT
"""What pages say of counted instructions: jobs, tables and the words beside them."""
import dataclasses

from slideline_tools import counting
from slideline_tools.counting import HARDWARE
from slideline_tools.studies.common import label, markdown_table
from slideline_tools.studies.framework.table import COUNTED, counted, grouped


def counted_job(job, options=()):
    """The job again, counted once; `options` shorten it."""
    return dataclasses.replace(job, name=f"{job.name}_counted", options=(*job.options, *options),
                               labels={**job.labels, "shortened": " ".join(options)}, alone=False, turns=1,
                               once=True, counted=True, limit=None, cost=50.0 * job.cost)


def counted_row(folder, **labels):
    """The row of a run that a script had counted into `folder` (`python -m slideline_tools.counting`); [] if it was not."""
    if not (folder / counting.COUNTS).exists():
        return []
    return [{**labels, **counting.columns(folder), "state": COUNTED}]


def whole(number):
    """An integer with its thousands apart."""
    return f"{number:,}".replace(",", " ")


def instruction_table(rows, base=1):
    """Instructions of each type, in millions, and over those of type `base`; of contact where it can be told apart.

    `rows`: counted runs of one scene and mesh.
    """
    found = {row["type"]: row for row in rows}
    parts = all("contact_instructions" in row for row in rows)
    names = ["type", "whole run, millions", f"over type {base}"]
    names += ["contact, millions", f"contact over type {base}", "share of contact"] * parts
    lines = []
    for ctype, row in sorted(found.items()):
        line = [label(ctype), f"{1e-6 * row['instructions']:.1f}",
                f"{row['instructions'] / found[base]['instructions']:.3f}" if base in found else ""]
        if parts:
            contact = row["contact_instructions"]
            line += [f"{1e-6 * contact:.1f}",
                     f"{contact / found[base]['contact_instructions']:.3f}" if base in found else "",
                     f"{100.0 * contact / row['instructions']:.1f} %"]
        lines.append(line)
    return markdown_table(names, lines)


def who_counted(rows):
    """'Counted by ...', with what was cut short and what a count is good for."""
    rows = counted(rows)
    if not rows:
        return "No instructions were counted: the machine lent no counters and valgrind was not installed."
    by = sorted({row["counted_by"] for row in rows})
    text = (f"Counted by {', '.join(by)}" + (", of the program as it is." if by == [HARDWARE] else
            ", which emulates the program built for that processor (no AVX-512, so more of them than there are here).")
            + " Two counts of a run agree to 1e-4, on a busy machine too. Instructions differ in what they cost: a count "
            "tells work, not time.")
    short = {row["scene"]: row["shortened"] for row in rows if row.get("shortened")}
    if short:
        text += " Cut short: " + ", ".join(f"{scene} ({words})" for scene, words in short.items()) + "."
    return text


def instruction_section(rows, titles):
    """A section of a page: a table for each scene and mesh that was counted. `titles`: {scene: words}."""
    parts = ["## Instructions", "The same cost in retired instructions, the whole run with its start and end. "
             + who_counted(rows)]
    for (scene, level), same in grouped(counted(rows), "scene", "level").items():
        parts.append(f"{titles[scene]}, N_r = {level}:\n\n{instruction_table(same)}")
    return "\n\n".join(parts)
