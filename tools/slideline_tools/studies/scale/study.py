# SPDX-License-Identifier: MIT
"""What processes exchange: some cycles of four meshes on 1 to 64 processes, which count it."""
import re

import numpy as np

from slideline_tools import UserError
from slideline_tools.decks import Deck
from slideline_tools.scenes import collision, collision_grids
from slideline_tools.scenes.common import elastic, part, plane_strain
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.scale.page import chart, page
from slideline_tools.studies.scale.tiles import MESHES

RANKS, QUICK_RANKS = (1, 2, 4, 8, 16, 32, 64), (1, 4)
CYCLES = 10
LEVEL = 8      # of the collision
STEP = 1.0e-7  # of the collision at level 1, s
NUMBER = r"(\S+) \((\S+)\)"
EXCHANGE = re.compile(rf"messages {NUMBER}, bytes {NUMBER}, calls of all {NUMBER}, "
                      rf"bytes by them {NUMBER}")
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_mpi_yield_when_idle": "1", "OMP_WAIT_POLICY": "passive"}


def body(points, quads, title):
    """The deck of an elastic body of which one node is held."""
    deck = Deck(title)
    deck.parameters(("cycles", CYCLES, "cycles of the run"))
    deck.keyword("CONTROL_TERMINATION").card("endtim endcyc", 1.0, "&cycles")
    plane_strain(deck, 1)
    elastic(deck, 1, 1000.0, 1.0e6, 0.3)
    part(deck, 1, "body", 1, 1)
    deck.nodes(np.arange(1, len(points) + 1), points)
    deck.quads(np.arange(1, len(quads) + 1), 1, quads + 1)
    deck.node_set(1, "held", [1]).spc_set(1, True, True)
    deck.database(glstat=1.0)
    return deck.text()


def decks():
    """(scene, elements, deck, words of the command line) of each scene."""
    for name, mesh in MESHES.items():
        points, quads = mesh()
        yield name, len(quads), body(points, quads, name), ()
    elements = sum(grid.element.size for grid in collision_grids(LEVEL))
    yield "collision", elements, collision(LEVEL, 5), (f"p:endtim={CYCLES * STEP / LEVEL}",)


def jobs(options):
    """Each scene on each number of processes; these may be more than the cores."""
    return [Job(f"{name}_{ranks}", deck, options=words, environment=ENVIRONMENT, alone=True,
                labels={"scene": name, "elements": elements, "ranks": ranks}, cost=1.0 + ranks,
                launcher=("mpirun", "--oversubscribe", "-n", str(ranks)))
            for name, elements, deck, words in decks()
            for ranks in (QUICK_RANKS if options.quick else RANKS)]


def measure(job, folder):
    """What the processes exchange in a cycle, mean and largest over the processes."""
    if job.labels["ranks"] == 1:
        return {}
    found = EXCHANGE.search((folder / f"{job.jobid}.log").read_text(encoding="utf-8"))
    if not found:
        raise UserError("the log tells of no exchange")
    names = ("messages", "most_messages", "bytes", "most_bytes", "calls", "most_calls",
             "bytes_to_all", "most_bytes_to_all")
    return dict(zip(names, map(float, found.groups())))


STUDY = Study("scale", jobs, measure, chart, page=page, build="mpi")
