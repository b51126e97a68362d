# SPDX-License-Identifier: MIT
"""What a results file holds, in words."""
import numpy as np


def describe(results):
    """Lines of text: run, mesh, states, fields with their ranges, history tables."""
    lines = [f"file       {results.path}"]
    for name in ("title", "deck", "options", "version", "build"):
        if results.run.get(name):
            lines.append(f"{name:<10} {results.run[name]}")
    lines.append(f"mesh       {results.n_node} nodes, {results.n_cell} elements"
                 + parts_text(results))
    times = results.times
    lines.append(f"states     {len(times)}, time {times[0]:g} to {times[-1]:g}" if len(times) else "states     none")
    if len(times):
        lines.append("fields     over all states: lowest, highest")
        for kind, names, field in (("node", results.point_fields, results.point_field),
                                   ("cell", results.cell_fields, results.cell_field)):
            lines += [field_text(kind, name, field(name)) for name in names]
    lines += [history_text(results.history(name)) for name in results.histories]
    return lines


def parts_text(results):
    if "part_id" not in results.cell_fields or not results.n_state:
        return ""
    parts, counts = np.unique(results.cell_field("part_id")[0], return_counts=True)
    return "; " + ", ".join(f"part {part}: {count}" for part, count in zip(parts, counts))


def field_text(kind, name, values):
    shape = f"{values.shape[2]} components" if values.ndim == 3 else ""
    return f"  {kind} {name:<18} {values.min():>13.6g} {values.max():>13.6g}  {shape}".rstrip()


def history_text(history):
    text = f"history    {history.name}: {len(history)} rows, columns {', '.join(history.columns)}"
    if history.entity_columns and len(history):
        labels = [history.entity_label(entity) for entity, _ in history.series()]
        shown = "; ".join(labels[:6]) + (f"; ... {len(labels)} in all" if len(labels) > 6 else "")
        text += f"\n           series: {shown}"
    return text
