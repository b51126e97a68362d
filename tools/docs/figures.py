# SPDX-License-Identifier: MIT
"""Draws the figures of the tutorial and of the theory from runs of the program (gallery.py: those of the gallery).

    build/venv/bin/python tools/docs/figures.py [--program build/release/slideline]

writes doc/pictures/draw.png, first_deck.svg, first_model.png,
first_stress.png, first_history.png, contact_points.svg,
speed_accuracy.svg and the drawings of doc/theory/contact.md.
"""
import argparse
import pathlib
import re
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import slideline_tools  # noqa: E402
from slideline_tools import cli  # noqa: E402
from slideline_tools.contact_types import TYPES  # noqa: E402
from slideline_tools.decks import Deck, Grid, spaced  # noqa: E402
from slideline_tools.draw.model import check_deck  # noqa: E402
from slideline_tools.scenes.common import elastic, part, plane_strain  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURES = ROOT / "doc/pictures"
SLAVE, MASTER, INK = "#c8553d", "#33658a", "#333333"
GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
N_SLAVE, N_MASTER = 4, 5
plt.rcParams.update({"svg.hashsalt": "slideline", "axes.spines.top": False, "axes.spines.right": False})


def save(figure, name):
    """An SVG that is the same whenever it is drawn."""
    figure.savefig(PICTURES / name, metadata={"Date": None}, bbox_inches="tight")
    plt.close(figure)


def draw_bodies(axes, results, colours, lift):
    """The mesh at the start, with the nodes of part 1 lifted; returns the places of the nodes."""
    points = results.points[0][:, :2].copy()
    parts = results.cell_field("part_id")[0]
    points[np.unique(results.cells[parts == 1]), 1] += lift
    for cell, number in zip(results.cells, parts):
        axes.fill(*points[cell].T, facecolor=colours[int(number)], alpha=0.25, edgecolor=INK,
                  linewidth=0.6)
    return points


# --- the deck of the tutorial ----------------------------------------------------------------

def tutorial_deck(folder):
    """The deck as the tutorial gives it."""
    page = (ROOT / "doc/tutorial.md").read_text(encoding="utf-8")
    path = folder / "first.k"
    path.write_text(re.search(r'```text title="results/first.k"\n(.*?)```', page, re.S).group(1))
    return path


def draw_surface(axes, places, label, colour, side):
    """A surface with arrows in walking order."""
    for start, end in zip(places[:-1], places[1:]):
        axes.annotate("", xy=start + 0.8 * (end - start), xytext=start + 0.2 * (end - start),
                      arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 2.2})
    axes.plot(*places.T, color=colour, linewidth=1.2)
    right = places[places[:, 0].argmax()]
    axes.annotate(label, right, xytext=(0.46, right[1] + side), color=colour, va="center",
                  arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.6,
                              "relpos": (0.0, 0.5)})


def first_deck(program, folder):
    """Mesh and surfaces, and the pictures that the tutorial's commands make."""
    deck = tutorial_deck(folder)
    results, model = slideline_tools.run(deck, folder / "first", program=program).results, check_deck(deck, program)
    figure, axes = plt.subplots(figsize=(7.2, 4.0))
    points = draw_bodies(axes, results, {1: SLAVE, 2: MASTER}, 0.035)
    for number, (x, y) in zip(model.node_ids, points):
        axes.annotate(str(number), (x, y), xytext=(4, 4 if number < 16 else -12),
                      textcoords="offset points", fontsize=8, color=INK)
    axes.plot(*points.T, "o", markersize=3, color=INK)
    for number, label, colour, side in ((2, "slave: set 2 (1, 2, 3),\nblock on the left hand",
                                         SLAVE, 0.03),
                                        (3, "master: set 3 (20, 19 ... 16),\nplate on the left hand",
                                         MASTER, -0.02)):
        draw_surface(axes, points[model.node_sets[number].nodes], label, colour, side)
    axes.plot(*(points[model.node_sets[1].nodes] - [0.0, 0.006]).T, "^", color=INK, markersize=8)
    axes.annotate("", xy=(0.24, 0.235), xytext=(0.24, 0.275),
                  arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.6})
    axes.text(0.246, 0.255, "v0", color=INK)
    axes.set_aspect("equal")
    axes.axis("off")
    axes.set_xlim(-0.02, 0.66)
    save(figure, "first_deck.svg")
    for words in (["draw", str(deck), "--program", str(program),
                   "--output", str(PICTURES / "first_model.png")],
                  ["plot", str(results.path), "--field", "stress:yy", "--state", "0.006",
                   "--output", str(PICTURES / "first_stress.png")],
                  ["plot", str(results.path), "--history", "glstat:kinetic,internal,contact", "--history",
                   "rcforc:fy@side=slave", "--output", str(PICTURES / "first_history.png")]):
        if cli.main(words):
            sys.exit("the picture could not be drawn")


def collision(program):
    """The model of the collision."""
    deck = ROOT / "input/collision/collision.k"
    if cli.main(["draw", str(deck), "--program", str(program), "--output", str(PICTURES / "draw.png")]):
        sys.exit("the picture could not be drawn")


# --- contact points of the seven formulations ------------------------------------------------

def blocks_deck(folder):
    """A block of four segments pressed by 0.001 into one of five: its forces at time zero are drawn. Deck and surface nodes."""
    slave = Grid(spaced((0.0, 1.0, N_SLAVE)), [-0.001, 0.299])
    master = Grid(spaced((0.0, 1.0, N_MASTER)), [-0.3, 0.0], first_node=101, first_element=101)
    deck = Deck("uniform penetration")
    deck.keyword("CONTROL_TERMINATION").card("endtim", 1.0e-6)
    deck.database(binary_d3plot=1.0e-6)
    plane_strain(deck, 1, points=4)
    elastic(deck, 1, rho=1000.0, young=1.0e6, poisson=0.3)
    for number, name, grid, nodes in ((1, "slave", slave, slave.lower), (2, "master", master, master.upper)):
        part(deck, number, name, 1, 1)
        grid.write(deck, number)
        deck.node_set(number, name, nodes)
    deck.keyword("CONTACT_2D_SLIDELINE").card("surfa surfb ctype ngauss pen", -1, -2, 1, 2, 1.0e5)
    deck.card("tbirth tdeath punit", 0.0, 0.0, 1)
    path = folder / "points.k"
    path.write_text(deck.text())
    return path, slave.lower, master.upper


def points_of_type(kind):
    """Where a formulation looks: (x, side) with side 1 slave, 2 master."""
    slave, master = np.linspace(0, 1, N_SLAVE + 1), np.linspace(0, 1, N_MASTER + 1)

    def gauss(cuts):
        middle, half = (cuts[1:] + cuts[:-1]) / 2, np.diff(cuts) / 2
        return (middle[:, None] + half[:, None] * GAUSS).ravel()

    quarter = (slave[:-1, None] + np.diff(slave)[:, None] * [0.25, 0.75]).ravel()
    on_slave = {1: slave, 2: slave, 3: slave, 4: quarter, 5: slave, 6: gauss(slave),
                7: gauss(np.union1d(slave.round(9), master.round(9)))}[kind]
    on_master = {3: master, 5: master[1:-1]}.get(kind, [])
    return [(x, 1) for x in on_slave] + [(x, 2) for x in on_master]


def contact_points(program, folder):
    """A panel for each type: contact points, and the nodal forces of the program."""
    deck, slave, master = blocks_deck(folder)
    n_row = len(TYPES) // 2 + 1  # the last panel is the key
    figure, panels = plt.subplots(n_row, 2, figsize=(9.0, 1.8 * n_row))
    lift = 0.12  # the bodies are drawn apart, so that both surfaces can be seen
    for kind, axes in zip(TYPES, panels.flat):
        results = slideline_tools.run(deck, folder / f"type_{kind}", program=program, ctype=kind).results
        ids = results.point_field("node_id")[0]
        x = results.points[0][:, 0]
        force = results.point_field("contact_force")[0][:, 1]
        scale = 0.30 / (1.0e5 * 0.001 / N_SLAVE * 1.6)
        for side, nodes, base, up in ((SLAVE, slave, lift, 1), (MASTER, master, 0.0, -1)):
            axes.fill_between([0, 1], base, base + up * 0.34, color=side, alpha=0.16, linewidth=0)
            axes.plot([0, 1], [base, base], color=side, linewidth=1.4)
            on = np.isin(ids, nodes)
            axes.plot(x[on], 0.0 * x[on] + base, "o", color=side, markersize=4)
            for k in np.flatnonzero(on & (abs(force) > 1e-9)):
                axes.annotate("", xy=(x[k], base + scale * force[k]), xytext=(x[k], base),
                              arrowprops={"arrowstyle": "-|>", "color": side, "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0})
        for place, side in points_of_type(kind):
            axes.plot(place, lift / 2 + (0.022 if side == 1 else -0.022), "x", markersize=6,
                      color=SLAVE if side == 1 else MASTER, markeredgewidth=1.6)
        axes.set_title(f"{kind}  {TYPES[kind]}", fontsize=10, loc="left", color=INK)
        axes.set_ylim(-0.36, 0.48)
        axes.axis("off")
    for axes in panels.flat[len(TYPES):]:
        axes.axis("off")
    key = panels.flat[-1]
    for row, (mark, colour, text) in enumerate((
            ("x", SLAVE, "looks from the slave surface at the master"),
            ("x", MASTER, "looks from the master surface at the slave"),
            ("o", SLAVE, "slave node"), ("o", MASTER, "master node"))):
        key.plot(0.02, 0.85 - 0.18 * row, mark, color=colour, markersize=7, markeredgewidth=1.8)
        key.text(0.07, 0.85 - 0.18 * row, text, va="center", fontsize=10, color=INK)
    key.text(0.0, 0.08, "arrows: nodal forces of the program,\none uniform penetration", fontsize=10,
             color=INK, va="center")
    key.set_xlim(0, 1)
    key.set_ylim(0, 1)
    figure.tight_layout(h_pad=1.0)
    save(figure, "contact_points.svg")


# --- the theory of contact: drawings, no runs -------------------------------------------------

def surface(axes, x, colour, below=True, depth=0.5):
    """A surface with its nodes and the body behind it."""
    x = np.asarray(x, dtype=float)
    back = x + np.array([0.0, -depth if below else depth])
    axes.fill(*np.vstack((x, back[::-1])).T, color=colour, alpha=0.16, linewidth=0)
    axes.plot(*x.T, "-o", color=colour, linewidth=1.6, markersize=4.5)


def bare(axes, title, low, high):
    axes.set_title(title, fontsize=10, loc="left", color=INK)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.axis("off")


def arrow(axes, start, end, text, shift=(0.03, 0.0)):
    axes.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.3,
                                                        "shrinkA": 0, "shrinkB": 0})
    axes.text(end[0] + shift[0], end[1] + shift[1], text, fontsize=10, color=INK)


def projection_figure():
    """Projection on a segment; the regions at a convex and at a re-entrant vertex."""
    figure, panels = plt.subplots(1, 3, figsize=(10.0, 3.0))
    axes = panels[0]
    a, b = np.array([1.0, 0.0]), np.array([0.0, 0.25])
    surface(axes, [b, a], MASTER)
    t = (b - a) / np.hypot(*(b - a))
    n = np.array([t[1], -t[0]])
    projected = a + 0.45 * (b - a)
    x = projected - 0.22 * n
    axes.plot(*x, "o", color=SLAVE, markersize=6)
    axes.plot(*np.array([x, projected]).T, ":", color=INK, linewidth=1.2)
    axes.text(*(x + [0.03, -0.07]), "x", fontsize=11, color=SLAVE)
    axes.text(*(0.5 * (x + projected) + [-0.24, -0.03]), r"$g < 0$", fontsize=10, color=INK)
    arrow(axes, projected, projected + 0.3 * n, r"$n$")
    arrow(axes, a, a + 0.3 * t, r"$t$", shift=(-0.02, 0.05))
    axes.text(*(projected + [0.03, 0.04]), r"$\xi$", fontsize=11, color=INK)
    bare(axes, "projection", (-0.1, -0.4), (1.15, 0.65))
    for axes, apex, title, text, where in (
            (panels[1], 0.3, "convex vertex", "closest: the vertex, g > 0", (0.5, 0.3)),
            (panels[2], -0.3, "re-entrant vertex", r"$g = -|x - x_{vertex}|$", (0.5, -0.3))):
        nodes = np.array([[0.0, 0.0], [0.5, apex], [1.0, 0.0]])
        surface(axes, nodes[::-1], MASTER, depth=0.45)
        way = 1.0 if apex > 0 else -1.0
        flanks = [np.array([-way * apex, 0.5 * way]) / np.hypot(apex, 0.5) * np.array([1.0, 1.0]),
                  np.array([way * apex, 0.5 * way]) / np.hypot(apex, 0.5)]
        ends = [nodes[1] + 0.38 * flank for flank in flanks]
        axes.fill(*np.array([nodes[1], ends[0], ends[1]]).T, color=SLAVE, alpha=0.25, linewidth=0)
        for end in ends:
            axes.plot(*np.array([nodes[1], end]).T, "--", color=INK, linewidth=0.8)
        axes.text(0.5, apex + way * 0.42, text, fontsize=9, ha="center", va="center", color=INK)
        bare(axes, title, (-0.1, -0.85), (1.1, 0.85))
    save(figure, "contact_projection.svg")


def candidates_figure():
    """The row of a slave segment on its bucket grid."""
    figure, axes = plt.subplots(figsize=(8.0, 3.4))
    x = np.linspace(2.6, -0.1, 10)
    master = np.column_stack((x, 0.08 * np.sin(2.3 * x)))
    master = np.vstack(([3.0, -0.7], [2.8, -0.35], master))
    slave = np.array([[0.2, 0.62], [0.75, 0.42], [1.3, 0.4], [1.85, 0.5], [2.4, 0.75]])
    surface(axes, slave, SLAVE, below=False, depth=0.4)
    cell, radius = 0.32, 0.36
    own = slave[1:3]
    low, high = own.min(axis=0) - radius, own.max(axis=0) + radius
    for k in range(-1, 11):
        axes.axvline(k * cell, color=INK, linewidth=0.3, alpha=0.5)
    for k in range(-3, 4):
        axes.axhline(k * cell, color=INK, linewidth=0.3, alpha=0.5)
    axes.fill([low[0], high[0], high[0], low[0]], [low[1], low[1], high[1], high[1]], color=SLAVE, alpha=0.10, linewidth=0)
    axes.plot(*own.T, color=SLAVE, linewidth=4.0)
    for a, b in zip(master, master[1:]):
        near = np.all(np.minimum(a, b) <= high) and np.all(np.maximum(a, b) >= low)
        axes.plot(*np.array([a, b]).T, "-", color=MASTER, linewidth=4.0 if near else 1.4, alpha=1.0 if near else 0.6)
    axes.plot(*master.T, "o", color=MASTER, markersize=4)
    axes.text(high[0] + 0.05, 0.3, "box of the slave segment\n+ radius + skin", fontsize=9, va="top", color=SLAVE)
    axes.text(0.55, -0.28, "row: its candidate pairs", fontsize=9, color=MASTER)
    bare(axes, "", (-0.2, -0.75), (3.2, 1.2))
    save(figure, "contact_candidates.svg")


def entry_figure():
    """Gap and gap of the law over slip, for a point through a face and for one from beside."""
    figure, panels = plt.subplots(1, 2, figsize=(9.0, 2.8), sharey=True)
    time = np.linspace(0.0, 1.0, 300)
    for axes, title in zip(panels, ("entered through the face", "edge entry")):
        if title.startswith("entered"):
            gap = 0.25 - 1.0 * time + 0.35 * time**2
            law = gap
        else:
            gap = -0.25 - 0.12 * time
            start, offset, law = 0.3, np.zeros_like(time), np.full_like(time, np.nan)
            now = 0.27
            for k, at in enumerate(time):
                if at < start:
                    continue
                now = min(now, -gap[k])
                now = max(0.0, now - (time[1] - time[0]) * max(2.0 * now / 0.6, 0.05))
                offset[k], law[k] = now, gap[k] + now
            axes.fill_between(time, law, gap, where=time >= start, color=SLAVE, alpha=0.18, linewidth=0)
            axes.annotate("offset $o$, fades with slip", xy=(0.42, -0.2), xytext=(0.38, 0.12), fontsize=9, color=INK,
                          arrowprops={"arrowstyle": "-", "linewidth": 0.7, "color": INK})
            axes.axvline(start, color=INK, linewidth=0.7, linestyle=":")
            axes.text(start - 0.01, -0.46, "over the end", fontsize=8, ha="right", color=INK)
        axes.axhline(0.0, color=INK, linewidth=0.8)
        axes.plot(time, gap, color=MASTER, linewidth=1.8, label="$g$")
        axes.plot(time, np.where(np.isnan(law), np.nan, np.minimum(law, 0.0)), color=SLAVE, linewidth=1.8,
                  label=r"$\min(0, g + o)$: law")
        axes.set_title(title, fontsize=10, loc="left", color=INK)
        axes.set_xlabel("slip", fontsize=9)
        axes.set_xticks([])
        axes.set_yticks([0.0])
        axes.set_yticklabels(["0"])
        axes.set_ylim(-0.5, 0.3)
    panels[0].legend(fontsize=9, frameon=False)
    save(figure, "contact_entry.svg")


def overlaps_figure():
    """A slave segment over three master segments: breakpoints, overlaps, points of types 5 and 7."""
    figure, axes = plt.subplots(figsize=(8.0, 3.0))
    master = np.array([[2.2, -0.15], [1.55, 0.0], [0.7, 0.05], [-0.2, -0.1]])
    slave = np.array([[0.1, 0.42], [1.9, 0.38]])
    surface(axes, master, MASTER, depth=0.35)
    surface(axes, slave, SLAVE, below=False, depth=0.35)
    t = slave[1] - slave[0]
    cuts = [0.0] + [float((node - slave[0]) @ t / (t @ t)) for node in (master[2], master[1])] + [1.0]
    for node, xi in zip((master[2], master[1]), cuts[1:3]):
        on = slave[0] + xi * t
        axes.plot(*np.array([node, on]).T, ":", color=INK, linewidth=1.0)
        axes.plot(*on, "|", color=INK, markersize=12, markeredgewidth=1.6)
        axes.plot(*node, "x", color=MASTER, markersize=9, markeredgewidth=2.0)
    for k, (low, high) in enumerate(zip(cuts, cuts[1:])):
        middle = slave[0] + 0.5 * (low + high) * t
        axes.annotate("", xy=slave[0] + low * t + [0.01, 0.12], xytext=slave[0] + high * t + [-0.01, 0.12],
                      arrowprops={"arrowstyle": "<->", "color": INK, "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0})
        axes.text(*(middle + [0.0, 0.15]), f"overlap {k + 1}", fontsize=9, ha="center", color=INK)
        for point in GAUSS:
            axes.plot(*(slave[0] + (0.5 * (low + high) + 0.5 * point * (high - low)) * t), "x", color=SLAVE, markersize=6,
                      markeredgewidth=1.6)
    axes.text(1.98, 0.45, "x  Gauss points (type 7)", fontsize=9, color=SLAVE)
    axes.text(1.98, 0.25, "x  master nodes at breakpoints (type 5)", fontsize=9, color=MASTER)
    bare(axes, "", (-0.35, -0.55), (3.4, 0.85))
    save(figure, "contact_overlaps.svg")


def energy_limit_figure():
    """What scaled forces return, and the largest admissible factor."""
    figure, axes = plt.subplots(figsize=(6.0, 2.8))
    s = np.linspace(0.0, 1.0, 200)
    linear, square, limit = 0.25, 0.9, 0.6
    best = (-linear + np.sqrt(linear**2 + 4.0 * square * limit)) / (2.0 * square)
    axes.plot(s, linear * s + square * s**2, color=SLAVE, linewidth=1.8)
    axes.axhline(limit, color=MASTER, linewidth=1.4)
    axes.plot([best, best], [0.0, limit], ":", color=INK, linewidth=1.0)
    axes.plot(best, limit, "o", color=INK, markersize=5)
    axes.text(0.02, limit + 0.03, r"limit $= e + E_{max}/100$", fontsize=10, color=MASTER)
    axes.text(0.88, linear + square - 0.12, r"$S\,s + C\,s^2$", fontsize=10, color=SLAVE, ha="right")
    axes.text(best + 0.01, 0.03, "$s_2$", fontsize=11, color=INK)
    axes.set_xlabel("factor $s$ on all forces of the interface", fontsize=9)
    axes.set_ylabel("energy returned", fontsize=9)
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, 1.2)
    save(figure, "contact_energy_limit.svg")


# --- speed against accuracy: the published table -----------------------------------------------

def speed_accuracy_figure():
    """Error over contact time of the seven types, both over type 1, as doc/studies/speed_accuracy.md gives them."""
    page = (ROOT / "doc/studies/speed_accuracy.md").read_text(encoding="utf-8")
    head, *rows = [[cell.strip() for cell in line.strip("| ").split("|")] for line in page.splitlines()
                   if re.match(r"\| (type \| exact pressure|\d \w)", line)][:1 + len(TYPES)]
    figure, panels = plt.subplots(1, 3, figsize=(9.0, 3.2), sharey=True)
    for axes, name in zip(panels, ("Hertz profile", "sliding roughness", "plastic work")):
        for row in rows:
            time, error = float(row[head.index("contact time")].split()[0]), float(row[head.index(name)])
            is_exact = row[1] == "yes"
            axes.plot(time, error, "o", markersize=13, color=MASTER, markerfacecolor=MASTER if is_exact else "white")
            axes.text(time, error, row[0].split()[0], ha="center", va="center_baseline", fontsize=9, color="white" if is_exact else INK)
        axes.set(yscale="log", xlim=(0.8, 4.0), ylim=(0.05, 1.5), xlabel="contact time over type 1")
        axes.set_yticks([0.1, 0.3, 1.0], ["0.1", "0.3", "1"])
        axes.set_title(name, fontsize=10, loc="left", color=INK)
        axes.grid(True, linewidth=0.3, color="#bbbbbb")
    panels[0].set_ylabel("error over type 1")
    figure.text(0.5, -0.02, "lower left is better; filled: transmits a uniform pressure exactly", fontsize=9, ha="center", color=INK)
    figure.tight_layout()
    save(figure, "speed_accuracy.svg")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=str(ROOT / "build/release/slideline"))
    program = parser.parse_args().program
    with tempfile.TemporaryDirectory() as folder:
        collision(program)
        first_deck(program, pathlib.Path(folder))
        contact_points(program, pathlib.Path(folder))
        for draw in (projection_figure, candidates_figure, entry_figure, overlaps_figure, energy_limit_figure, speed_accuracy_figure):
            draw()


if __name__ == "__main__":
    main()
