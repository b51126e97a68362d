# SPDX-License-Identifier: MIT
"""The page doc/studies/scale.md: what processes exchange, counted, and how far that carries, predicted.

    python -m slideline_tools.studies.scale.page FOLDER DOC

FOLDER holds runs.csv of slideline_tools.studies.scale.runs.
"""
import csv
import math
import sys

import numpy as np

from slideline_tools import UserError
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.studies.common import markdown_table, page_main, save_small, write_page
from slideline_tools.studies.scale import tiles as scale_tiles
from slideline_tools.studies.scale.runs import COSTS, CYCLES, MESHES, grid_mesh

STEP_NS = 18.0       # an element and step, of speed.md: 100 000 elements, one thread, elastic
CONTACT_NS = 75.0    # a slave node and step, of speed.md: type 5, 10 000 nodes
NETWORKS = {"fast": (1.5e-6, 1.0e9), "slow": (30.0e-6, 0.1e9)}  # latency of a message in s, bytes a second of a process
FASTER = 10.0        # bandwidth over that of the fast network of one that contact by ranges is judged on as well
SIZES = (10 ** 6, 10 ** 7, 10 ** 8)
RANKS = (16, 64, 256, 1024)
POWERS = [2 ** k for k in range(1, 11)]
RECORD_BYTES = 72    # of the reduction that all take part in
LARGE = 1000         # columns and rows of the mesh whose cut is computed alone

PAGE = """# Many processes

This page is written by `tools/batch/scale.sh --publish`: do not edit it. It says what the processes of an explicit run exchange in a step
([how](../architecture.md#several-processes)), counted by the program on up to 64 processes, and what follows for clusters, which nobody here has: those
figures are **predicted** by a model that stands below, with its latency and bandwidth.

## Counted

Runs of {cycles} steps, more processes than cores. *Messages* and *bytes* are those that a process sends to single others in a step, mean and largest over the
processes; *to all* are bytes that reach each process by calls that all take part in ({record} of them are the step limit, health and
requests; the others forces on surfaces in contact). Square, bar and ring are one elastic body each without contact.

{counted}

{agreement}

## Ranges of the curve or METIS

A process has a range of the tiles along the Hilbert curve. METIS on the graph of tiles, weighted by their elements and common nodes, is the
alternative (pymetis {version}; this study alone uses it). *Load* is the elements of the fullest process over the mean. The square of a million
elements is cut here and not run.

{cut}

{verdict}

## The model

A step of a process takes

    T = t_e (N/p) load + m L + b/B + log2(p) (L + {record} bytes/B)     one body
      + t_c n + log2(p) L + S/B                                  with contact

- `t_e` = {step} ns an element and `t_c` = {contact} ns a slave node (type 5): [speed](speed.md), one thread on a quiet machine. The runs of this page share two
  logical cores with others; in them a step took {busy:.0f} ns of processor time an element.
- `load`: the fullest process over the mean, from tiles of {tile} elements that stay whole.
- `m` = {most_messages} messages and `b` = 16 bytes times {factor:.2f} sqrt(N/p): the largest that was counted or cut above, over all meshes and numbers of processes with a tile each.
- `L` and `B`, latency of a message and bandwidth of a process: *fast* {fast}, *slow* {slow}. What calls of all cost is taken as log2(p) messages in a row.
- With contact: two bodies, each with `n` = sqrt(N/2) nodes on its surface. Every process computes all of the contact and hears `S` = 2 n slots of 16 bytes.

The efficiency is t_e N/(p T): one is a p-th of the time of one process.

## Predicted efficiency

{predicted}

![Counted bytes over the elements of a process, and predicted efficiency](../pictures/scale.png)

Left: bytes that the fullest process sends in a step, counted or cut (points), and the model (line). Right: predicted efficiency on the fast network, without (full) and
with contact (dashed).

{limits}

## What would have to change

- **Memory.** The first process holds the whole model: here {bytes_element:.0f} bytes an element at the peak, while the deck is read (two sizes of the square on one process). On a machine
  with 4 GB a process that is {memory_limit:.1f} million elements; at 1e8 it would need {memory_large:.0f} GB. The others get special nodes and their own tiles
  from it: of four processes with a square of a million elements the second took 71 bytes an element at the peak and 69 in the cycles
  (`tests/lab/bench/ranks.sh`), of sixteen 35 (by hand): its share of what one process takes and some 20 for the nodes between all tiles and the lists of
  their forces, whatever p, 2 GB a process at 1e8. Beyond, these have to be left to the processes whose tiles touch them: the lists of border slots (`rank_borders`)
  already name nothing but what neighbours share.
- **Start.** The first process reads the deck and renumbers it: {start_element:.1f} microseconds of processor time an element here, {start_large:.0f} s at 1e8, whatever p, while
  the others wait.
- **Contact** is computed by all; on 1,024 processes it takes {contact_share:.1f} times what the elements take at 1e6 elements and {contact_large:.2f} times at 1e8. Shared by
  ranges of slave segments it would take t_c n/p, and one more exchange for the forces of the ranges, which all have to hear: log2(p) L + S/B. {sharing}
- **Loads.** Where a deck has nodal loads or pressures, each process forms them, and their power, over all special nodes of the model ({special:.0f} % of all nodes of the large square), not over those that are loaded. Where elements
  may leave or points may fail, each looks through the counts of all chunks.
- **Gravity and damping** send the four sums of every tile to all: {sums:.1f} MB a step at 1e8 elements. A sum of fixed order over ranges would need one number a process.
- **Output** goes through the first process: a plot state of 1e8 elements is gathered there, about {plot:.0f} GB of motion, forces and stresses. Parallel HDF5, each process its own rows, would write the same file.
- **Tiles** of {tile} elements are the grain: at a million elements and 1,024 processes a process has two at most, {grain:.2f} on average.
"""


def read_runs(path):
    """Rows of runs.csv, numbers as floats where there are any."""
    if not path.exists():
        raise UserError(f"{path} is missing: run tools/batch/scale.sh")
    with path.open(newline="", encoding="utf-8") as stream:
        return [{name: value if name == "scene" else float(value) if value else None for name, value in row.items()}
                for row in csv.DictReader(stream)]


def cut_mesh(points, quads):
    """(slots, elements of the tiles) of a mesh."""
    tiles = scale_tiles.tiles_of(points, quads)
    return scale_tiles.slots_of(quads, tiles), np.bincount(tiles)


def agreement(runs, cuts):
    """In words: whether the program counts what its tiles and ranges say."""
    compared, apart = 0, []
    for row in runs:
        if row["scene"] not in cuts or row["ranks"] == 1:
            continue
        slots, sizes = cuts[row["scene"]]
        n = int(row["ranks"])
        messages, sent = scale_tiles.traffic(slots, scale_tiles.ranges(sizes, n), n)
        expected = (messages.mean(), messages.max(), sent.mean(), sent.max())
        counted = (row["messages"], row["most_messages"], row["bytes"], row["most_bytes"])
        compared += 1
        if any(abs(a - b) > 0.0051 for a, b in zip(expected, counted)):
            apart.append(f"{row['scene']} on {n}: {expected} and not {counted}")
    if apart:
        return "**Not what the tiles of these meshes say**: " + "; ".join(apart) + "."
    return (f"Cut independently (`slideline_tools/studies/scale/tiles.py` forms tiles, ranges and common nodes from the mesh), all {compared} runs of square, bar "
            "and ring have to exchange exactly these messages and bytes.")


def counted_table(runs):
    """What the program has counted."""
    rows = [[row["scene"], int(row["elements"]), int(row["ranks"]), f"{row['messages']:.2f} ({row['most_messages']:.0f})",
             f"{row['bytes']:.0f} ({row['most_bytes']:.0f})", int(row["bytes_to_all"])]
            for row in runs if row["scene"] not in COSTS and row["ranks"] > 1]
    return markdown_table(["scene", "elements", "processes", "messages, mean (most)", "bytes, mean (most)", "to all"], rows)


def cut_rows(cuts):
    """(scene, elements, processes, way, messages, bytes, load) of all cuts; messages and bytes are (mean, most)."""
    found = []
    for scene, (slots, sizes) in cuts.items():
        for n in (64, 256, 1024) if sizes.sum() >= LARGE ** 2 else (4, 8, 16, 32, 64):
            ways = {"ranges": scale_tiles.ranges(sizes, n), "METIS": scale_tiles.metis(slots, sizes, n)}
            for way, owner in ways.items():
                if owner is None:
                    continue
                messages, sent = scale_tiles.traffic(slots, owner, n)
                load = np.bincount(owner, sizes, n)
                found.append((scene, int(sizes.sum()), n, way, (messages.mean(), int(messages.max())),
                              (sent.mean(), int(sent.max())), load.max() / load.mean()))
    return found


def cut_table(rows):
    """The same in Markdown."""
    return markdown_table(["scene", "elements", "processes", "way", "messages, mean (most)", "bytes, mean (most)", "load"],
                          [[scene, elements, n, way, f"{messages[0]:.2f} ({messages[1]})", f"{sent[0]:.0f} ({sent[1]})", f"{load:.3f}"]
                           for scene, elements, n, way, messages, sent, load in rows])


def verdict(rows):
    """What METIS would save of the slowest process, in words, by the model on the fast network."""
    pairs = {}
    for scene, elements, n, way, messages, sent, load in rows:
        pairs.setdefault((scene, elements, n), {})[way] = (messages[1], sent[1], load, sent[0])
    pairs = {key: pair for key, pair in pairs.items() if "METIS" in pair}
    if not pairs:
        return "pymetis is not installed: not compared."
    total = [pair["METIS"][3] / pair["ranges"][3] for pair in pairs.values()]
    most = [pair["METIS"][1] / pair["ranges"][1] for pair in pairs.values()]
    latency, bandwidth = NETWORKS["fast"]

    def seconds(key, way):
        messages, sent, load, _ = pairs[key][way]
        return 1e-9 * STEP_NS * key[1] / key[2] * load + messages * latency + sent / bandwidth
    steps = [seconds(key, "METIS") / seconds(key, "ranges") for key in pairs]
    wins = sum(step < 0.98 for step in steps)
    words = (f"METIS sends {min(total):.2f} to {max(total):.2f} times the bytes in all (median {np.median(total):.2f}) and {min(most):.2f} to {max(most):.2f} times those of the fullest "
             f"process (median {np.median(most):.2f}). By the model below, on the fast network, a step takes {min(steps):.2f} to {max(steps):.2f} times as long with METIS "
             f"(median {np.median(steps):.2f}); it is faster by more than 2 % in {wins} of {len(steps)} cuts.")
    if wins > len(steps) / 2:
        return words + " METIS is the better way."
    return words + " That does not pay for a library more: ranges of the curve it is."


def model_constants(runs, rows):
    """Largest messages and largest border over sqrt(N/p), of all that was counted or cut with a tile for each process."""
    seen = [(row["elements"] / row["ranks"], row["most_messages"], row["most_bytes"]) for row in runs
            if row["scene"] in MESHES and row["ranks"] > 1]
    seen += [(elements / n, messages[1], sent[1]) for _, elements, n, way, messages, sent, _ in rows if way == "ranges"]
    seen = [(share, messages, sent) for share, messages, sent in seen if share >= scale_tiles.TILE]
    return seen, max(int(messages) for _, messages, _ in seen), max(sent / (16.0 * math.sqrt(share)) for share, _, sent in seen)


def load_of(elements, ranks):
    """The fullest process over the mean where tiles stay whole."""
    n_tile = -(-elements // scale_tiles.TILE)
    sizes = np.full(n_tile, elements / n_tile)
    load = np.bincount(scale_tiles.ranges(sizes, ranks), sizes, ranks)
    return load.max() / load.mean()


def efficiency(elements, ranks, network, constants, contact, shared=False):
    """Predicted, by the model of the page; `network` by name or (latency, bandwidth), `shared`: contact by ranges."""
    latency, bandwidth = NETWORKS[network] if isinstance(network, str) else network
    messages, factor = constants
    depth = math.ceil(math.log2(ranks))
    one = 1e-9 * STEP_NS * elements
    step = one / ranks * load_of(elements, ranks) + messages * latency
    step += 16.0 * factor * math.sqrt(elements / ranks) / bandwidth + depth * (latency + RECORD_BYTES / bandwidth)
    if contact:
        nodes = math.sqrt(elements / 2)
        one += 1e-9 * CONTACT_NS * nodes
        exchange = depth * latency + 2.0 * nodes * 16.0 / bandwidth
        step += 1e-9 * CONTACT_NS * nodes / (ranks if shared else 1) + exchange * (2 if shared else 1)
    return one / (ranks * step)


def predicted_table(constants):
    """Efficiency over size, processes, network and contact."""
    rows = [[f"{elements:.0e}".replace("e+0", "e"), ranks,
             *(f"{efficiency(elements, ranks, network, constants, contact):.2f}" for network in NETWORKS for contact in (False, True))]
            for elements in SIZES for ranks in RANKS]
    return markdown_table(["elements", "processes", *(f"{network}, {what}" for network in NETWORKS for what in ("one body", "contact"))], rows)


def limits(constants):
    """What the table says, in words."""
    words = []
    for contact, what in ((False, "one body"), (True, "two bodies in contact")):
        for elements in SIZES:
            good = [ranks for ranks in POWERS if efficiency(elements, ranks, "fast", constants, contact) >= 0.8]
            words.append(f"- {what}, {elements:.0e} elements: predicted to keep 80 % on {max(good, default=1)} processes, of powers of two up to "
                         f"{POWERS[-1]}.".replace("e+0", "e"))
    return "\n".join(words)


def sharing(constants):
    """What contact by ranges would gain, in words: efficiency with contact by all and shared."""
    latency, bandwidth = NETWORKS["fast"]
    networks = {"the fast network": "fast", "the slow one": "slow", f"one of {1e-9 * FASTER * bandwidth:g} GB/s": (latency, FASTER * bandwidth)}
    parts = []
    for words, network in networks.items():
        pairs = [[efficiency(elements, ranks, network, constants, True, shared) for shared in (False, True)]
                 for elements in SIZES for ranks in RANKS[:-1]]
        gains = [after / before for before, after in pairs]
        parts.append(f"{min(gains):.2f} to {max(gains):.2f} times on {words}")
    return f"The efficiencies with contact in the table, up to {RANKS[-2]} processes, would become " + ", ".join(parts) + "."


def contact_share(elements, ranks=1024):
    """What contact takes on each process over what its elements take."""
    return CONTACT_NS * math.sqrt(elements / 2) / (STEP_NS * elements / ranks)


def slope(runs, name, cycles):
    """What an element more costs, least of the repeats, from the two sizes of COSTS."""
    values = {}
    for row in runs:
        if row["scene"] in COSTS and row["cycles"] == cycles:
            values.setdefault(row["elements"], []).append(row[name])
    small, large = sorted(values)
    return (min(values[large]) - min(values[small])) / (large - small)


def draw(seen, constants):
    """Counted bytes and predicted efficiency."""
    with plt.rc_context(STYLE):
        figure, (left, right) = plt.subplots(1, 2, layout="constrained", figsize=(1.25 * PAGE_WIDTH, 3.4))
        shares = np.array([share for share, _, _ in seen])
        line = np.array([shares.min(), shares.max()])
        left.loglog(shares, [sent for _, _, sent in seen], "o", color="#333333", markersize=3.5, fillstyle="none")
        left.loglog(line, 16.0 * constants[1] * np.sqrt(line), color="#888888", linewidth=1.0)
        left.set_xlabel("elements of a process")
        left.set_ylabel("bytes a step, fullest process")
        for elements, colour in zip(SIZES, ("#0072b2", "#d55e00", "#009e73")):
            for contact, style in ((False, "-"), (True, "--")):
                right.semilogx(POWERS, [efficiency(elements, n, "fast", constants, contact) for n in POWERS], style, base=2, color=colour,
                               linewidth=1.2, label=None if contact else f"{elements:.0e}".replace("e+0", "e"))
        right.set_xlabel("processes")
        right.set_ylabel("predicted efficiency")
        right.set_ylim(0.0, 1.05)
        right.legend(title="elements", fontsize=7)
        for axes in (left, right):
            axes.grid(True, linewidth=0.3, color="#bbbbbb")
        return figure


def network_words(name):
    """Latency and bandwidth of a network."""
    latency, bandwidth = NETWORKS[name]
    return f"{1e6 * latency:g} microseconds and {1e-9 * bandwidth:g} GB/s"


def metis_version():
    """Of the wheel, where it is there."""
    try:
        import pymetis
    except ImportError:
        return "not installed"
    return pymetis.version if isinstance(pymetis.version, str) else ".".join(map(str, pymetis.version.VERSION))


def write(folder, doc):
    """The page and its chart."""
    runs = read_runs(folder / "runs.csv")
    cuts = {name: cut_mesh(*mesh()) for name, mesh in MESHES.items()}
    agreed = agreement(runs, cuts)
    cuts["large square"] = cut_mesh(*grid_mesh(LARGE, LARGE, 1.0, 1.0))
    rows = cut_rows(cuts)
    seen, most_messages, factor = model_constants(runs, rows)
    constants = (most_messages, factor)
    few, many = sorted({row["cycles"] for row in runs if row["scene"] in COSTS})
    memory = 1024.0 * slope(runs, "kilobytes", many)
    step = (slope(runs, "processor_seconds", many) - slope(runs, "processor_seconds", few)) / (many - few)
    start = slope(runs, "processor_seconds", few) - few * step
    save_small(draw(seen, constants), doc / "pictures" / "scale.png", colours=64, lines=True)
    write_page(doc, "scale", PAGE.format(
        cycles=CYCLES, record=RECORD_BYTES, counted=counted_table(runs), agreement=agreed, version=metis_version(), cut=cut_table(rows),
        verdict=verdict(rows), step=STEP_NS, contact=CONTACT_NS, busy=1e9 * step, tile=scale_tiles.TILE, most_messages=most_messages,
        factor=factor, fast=network_words("fast"), slow=network_words("slow"), predicted=predicted_table(constants),
        limits=limits(constants), bytes_element=memory, memory_limit=4.0e3 / memory, memory_large=0.1 * memory, start_element=1e6 * start,
        start_large=1e8 * start, sums=1e8 / scale_tiles.TILE * 32 / 1e6, plot=1e8 * (48 + 40) / 1e9, grain=1e6 / scale_tiles.TILE / 1024,
        contact_share=contact_share(1e6), contact_large=contact_share(1e8), sharing=sharing(constants),
        special=100.0 * len(np.unique(cuts["large square"][0][0])) / (LARGE + 1) ** 2))


def main(arguments=None):
    """Returns the exit status."""
    return page_main(__doc__, write, arguments)


if __name__ == "__main__":
    sys.exit(main())
