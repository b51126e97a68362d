# SPDX-License-Identifier: MIT
"""Advice on the number of threads."""
import re

from slideline_tools.advise.report import Advice

# Elements a thread below which a further thread hardly pays (two threads took 0.7 of the time of
# one at 300 elements and 0.5 at 4000).
ELEMENTS_A_THREAD = 250


def many_threads(run) -> list[Advice]:
    """More threads than the mesh feeds."""
    found = re.search(r"\bncpu=(\d+)", run.options)
    threads = int(found[1]) if found else 1
    enough = max(1, -(-run.n_element // ELEMENTS_A_THREAD))
    if threads <= enough:
        return []
    return [Advice(
        "threads", f"{threads} threads are more than this mesh feeds.",
        f"{run.n_element} elements, {run.n_element // threads} a thread",
        f"ncpu={enough} on the command line; the results have the same bits", None,
        f"{threads - enough} cores free for {run.total:.2g} s")]


CHECKS = (many_threads,)
