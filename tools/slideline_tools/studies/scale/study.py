# SPDX-License-Identifier: MIT
"""What processes exchange: some cycles of four meshes on 1 to 64 processes, which count it, and how far that carries by a
model."""
import functools
import math
import re

import numpy as np
import pandas as pd

from slideline_tools import UserError
from slideline_tools.decks import Deck
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.scenes import collision, collision_grids
from slideline_tools.scenes.common import elastic, part, plane_strain
from slideline_tools.studies.common import markdown_table, page_of, save_small
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.scale import tiles

RANKS, QUICK_RANKS = (1, 2, 4, 8, 16, 32, 64), (1, 4)
CYCLES = 10
LEVEL = 8      # of the collision
STEP = 1.0e-7  # of the collision at level 1, s
NUMBER = r"(\S+) \((\S+)\)"
EXCHANGE = re.compile(rf"messages {NUMBER}, bytes {NUMBER}, calls of all {NUMBER}, "
                      rf"bytes by them {NUMBER}")
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_mpi_yield_when_idle": "1", "OMP_WAIT_POLICY": "passive"}
STEP_NS = 18.0     # an element and step, of speed.md: 100 000 elements, one thread, elastic
CONTACT_NS = 75.0  # a slave node and step, of speed.md: type 5, 10 000 nodes
# Latency of a message in s, bytes a second of a process.
NETWORKS = {"fast": (1.5e-6, 1.0e9), "slow": (30.0e-6, 0.1e9)}
SIZES, MANY = (10 ** 6, 10 ** 7, 10 ** 8), (16, 64, 256, 1024)
POWERS = [2 ** k for k in range(1, 11)]
RECORD_BYTES = 80  # of the reduction that all take part in
SENT = ["messages", "most_messages", "bytes", "most_bytes"]


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
    for name, mesh in tiles.MESHES.items():
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


# ---- tiles -------------------------------------------------------------------------------------

@functools.lru_cache(maxsize=1)
def all_cuts():
    """What each mesh sends by its tiles; the large square is cut and not run."""
    plans = [(name, mesh(), POWERS[:6]) for name, mesh in tiles.MESHES.items()]
    plans.append(("large square", tiles.grid_mesh(1000, 1000, 1.0, 1.0), (64, 256, 1024)))
    rows = []
    for name, (points, quads), counts in plans:
        of_quads = tiles.tiles_of(points, quads)
        slots, sizes = tiles.slots_of(quads, of_quads), np.bincount(of_quads)
        for ranks in counts:
            messages, sent = tiles.traffic(slots, tiles.ranges(sizes, ranks), ranks)
            rows.append((name, len(quads), ranks, messages.mean(), messages.max(), sent.mean(),
                         sent.max()))
    return pd.DataFrame(rows, columns=["scene", "elements", "ranks", *SENT])


def counted_table(runs, cuts):
    """What the program has counted, and whether the tiles of the mesh say the same."""
    both = runs[runs["ranks"] > 1].merge(cuts, how="left", on=["scene", "elements", "ranks"],
                                         suffixes=("", "_cut"))
    apart = pd.concat([(both[name] - both[f"{name}_cut"]).abs() for name in SENT], axis=1)
    same = (apart < 0.0051).all(axis=1).map({True: "yes", False: "no"})
    shown = both[["scene", "elements", "ranks", *SENT, "bytes_to_all"]]
    return markdown_table(shown.assign(**{"as tiles say": same.where(apart.notna().all(axis=1))}))


# ---- the model ---------------------------------------------------------------------------------

def seen_sends(runs, cuts):
    """All that was counted or cut with a tile for each process, with the column `share`."""
    seen = pd.concat([runs[(runs["ranks"] > 1) & (runs["scene"] != "collision")], cuts])
    seen = seen.assign(share=seen["elements"] / seen["ranks"])
    return seen[seen["share"] >= tiles.TILE]


def constants_of(seen):
    """Largest messages, and largest border over sqrt(N/p)."""
    return seen["most_messages"].max(), (seen["most_bytes"] / (16.0 * np.sqrt(seen["share"]))).max()


def load_of(elements, ranks):
    """The fullest process over the mean where tiles stay whole."""
    n_tile = -(-elements // tiles.TILE)
    sizes = np.full(n_tile, elements / n_tile)
    load = np.bincount(tiles.ranges(sizes, ranks), sizes, ranks)
    return load.max() / load.mean()


def efficiency(elements, ranks, network, constants, contact):
    """Predicted t_e N/(p T), with contact between two bodies, or without."""
    latency, bandwidth = NETWORKS[network]
    messages, factor = constants
    depth = math.ceil(math.log2(ranks))
    one = 1e-9 * STEP_NS * elements
    step = one / ranks * load_of(elements, ranks) + messages * latency
    step += 16.0 * factor * math.sqrt(elements / ranks) / bandwidth
    step += depth * (latency + RECORD_BYTES / bandwidth)
    if contact:
        nodes = math.sqrt(elements / 2)
        one += 1e-9 * CONTACT_NS * nodes
        step += 1e-9 * CONTACT_NS * nodes + depth * latency + 2.0 * nodes * 16.0 / bandwidth
    return one / (ranks * step)


def power(elements):
    """'1e6'."""
    return f"{elements:.0e}".replace("e+0", "e")


def predicted_table(constants):
    """Efficiency over size, processes, network and contact."""
    ways = [(network, contact) for network in NETWORKS for contact in (False, True)]
    lines = [[power(elements), ranks,
              *(f"{efficiency(elements, ranks, network, constants, contact):.2f}"
                for network, contact in ways)] for elements in SIZES for ranks in MANY]
    names = [f"{network}, {'contact' if contact else 'one body'}" for network, contact in ways]
    return markdown_table(["elements", "processes", *names], lines)


def limit_table(constants):
    """The largest number of processes that keeps 80 % on the fast network."""
    def most(elements, contact):
        return max((ranks for ranks in POWERS
                    if efficiency(elements, ranks, "fast", constants, contact) >= 0.8), default=1)
    return markdown_table(["elements", "one body", "contact"], [
        [power(elements), most(elements, False), most(elements, True)] for elements in SIZES])


def contact_share(elements, ranks=1024):
    """What contact takes on each process over what its elements take."""
    return CONTACT_NS * math.sqrt(elements / 2) / (STEP_NS * elements / ranks)


# ---- picture and page --------------------------------------------------------------------------

def draw(seen, constants):
    """Bytes that the fullest process sends and the model's; predicted efficiency, fast network."""
    figure, (left, right) = plt.subplots(1, 2, layout="constrained",
                                         figsize=(1.25 * PAGE_WIDTH, 3.4))
    line = np.array([seen["share"].min(), seen["share"].max()])
    left.loglog(seen["share"], seen["most_bytes"], "o", color="#333333", markersize=3.5,
                fillstyle="none")
    left.loglog(line, 16.0 * constants[1] * np.sqrt(line), color="#888888", linewidth=1.0)
    left.set(xlabel="elements of a process", ylabel="bytes a step, fullest process")
    for elements, colour in zip(SIZES, ("#0072b2", "#d55e00", "#009e73")):
        for contact, style in ((False, "-"), (True, "--")):
            found = [efficiency(elements, ranks, "fast", constants, contact) for ranks in POWERS]
            right.semilogx(POWERS, found, style, base=2, color=colour, linewidth=1.2,
                           label=None if contact else power(elements))
    right.set(xlabel="processes", ylabel="predicted efficiency", ylim=(0.0, 1.05))
    right.legend(title="elements (with contact: dashed)", fontsize=7)
    for axes in (left, right):
        axes.grid(True)
    return figure


def chart(table, folder):
    """The picture of the page."""
    seen = seen_sends(finished(table), all_cuts())
    with plt.rc_context(STYLE):
        save_small(draw(seen, constants_of(seen)), folder / "scale.png", colours=64, lines=True)


def page(table):
    """Text of DOC/studies/scale.md."""
    runs, cuts = finished(table), all_cuts()
    constants = constants_of(seen_sends(runs, cuts))
    shares = ", ".join(f"{contact_share(one):.2f} at {power(one)} elements" for one in SIZES)
    return page_of(
        "# Many processes", "![Counted bytes and predicted efficiency](../pictures/scale.png)",
        "## Counted in a cycle, mean and largest of the processes", counted_table(runs, cuts), "## Cut", markdown_table(cuts),
        "## Predicted efficiency", f"By the model of doc/studies/scale.md with m = {constants[0]:.0f} messages and b = 16 bytes times "
        f"{constants[1]:.1f} sqrt(N/p).", predicted_table(constants),
        "Largest number of processes, of powers of two, that keeps 80 % on the fast network:", limit_table(constants),
        f"Contact over elements on 1,024 processes: {shares}.")


STUDY = Study("scale", jobs, measure, chart, page=page, build="mpi")
