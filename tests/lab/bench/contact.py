# SPDX-License-Identifier: MIT
"""Runs of bench_contact: the cost of contact alone per slave node, all types."""
import csv
import subprocess

from measuring import Variant


def time_contact(program, nodes, steps=0):
    """[(variant, ns per step and slave node)] of all scenes and types with so many slave nodes, and steps in a round (0: enough).

    Also ns per contact point and the number of points, as variants of their own.
    """
    text = subprocess.run([program, str(nodes), "0", str(steps)], check=True, capture_output=True,
                          text=True).stdout
    found = []
    for row in csv.DictReader(text.splitlines()):
        case, size = f"{row['scene']} type {row['type']}", int(row["slave_nodes"])
        for part, unit, name in (("contact", "ns/slave node", "ns_slave_node"),
                                 ("contact", "ns/point", "ns_point"),
                                 ("contact", "points", "points")):
            found.append((Variant(part, case, size, 1, unit), float(row[name])))
    return found
