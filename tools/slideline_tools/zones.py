# SPDX-License-Identifier: MIT
"""Where a surface sticks and slips: places along the slave over time, and tractions beside mu p."""
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from slideline_tools import UserError
from slideline_tools.draw.model import model_of
from slideline_tools.plots import COLOURS, PAGE_WIDTH, STYLE, beside, plt, run_title

#: Column `state` of the contact table: words and shade of 0, 1, ...
STATES = (("open", "#f4f4f4"), ("stick", "#0b559f"), ("slip", "#f0a030"), ("tied", "#2e7d32"), ("broken", "#8c8c8c"))
ALWAYS = 3  # open, stick and slip are always in the legend
PANEL = 2.3


def chains_of(contact):
    """Rows of one interface, chain by chain: `s` begins anew with each chain of the slave."""
    first = contact.where(time=contact["time"][0])
    cuts = np.flatnonzero(np.diff(first["s"]) <= 0.0) + 1
    return [contact.rows(np.isin(contact["node"], nodes)) for nodes in np.split(first["node"], cuts)]


def edges(places):
    """Borders half-way between increasing places, the outer ones at the places themselves."""
    if len(places) == 1:
        return np.array([places[0] - 0.5, places[0] + 0.5])
    return np.concatenate([places[:1], 0.5 * (places[1:] + places[:-1]), places[-1:]])


def state_grid(chain):
    """Times, places of the nodes at the first of them, and states (node, time) of one chain; times at which rows
    of some of its nodes are missing are left out."""
    nodes = chain.where(time=chain["time"][0])["node"]
    order, wanted = np.argsort(nodes), np.sort(nodes)
    times, columns = [], []
    for time in np.unique(chain["time"]):
        rows = chain.where(time=time)
        if np.array_equal(np.sort(rows["node"]), wanted):
            times.append(time)
            columns.append(rows["state"][np.argsort(rows["node"])][np.argsort(order)])
    return np.array(times), chain.where(time=chain["time"][0])["s"], np.array(columns).T


def draw_zones(axes, chain):
    """The space-time diagram of one chain; each state holds half-way to the next."""
    times, places, states = state_grid(chain)
    norm = BoundaryNorm(np.arange(len(STATES) + 1) - 0.5, len(STATES))
    axes.pcolormesh(edges(times), edges(places), states, cmap=ListedColormap([shade for _, shade in STATES]), norm=norm,
                    shading="flat", rasterized=True)
    axes.set_xlabel("time")
    axes.set_ylabel("arc length s along the slave")


def add_legend(figure, contact):
    """The shades with their words; tied and broken where they occur."""
    there = set(np.unique(contact["state"]).astype(int).tolist())
    figure.legend(handles=[Patch(facecolor=shade, edgecolor="#555555", linewidth=0.4, label=words)
                           for number, (words, shade) in enumerate(STATES) if number < ALWAYS or number in there],
                  loc=beside("lower center"), ncols=len(STATES), frameon=False, fontsize=8)


def limit_of(model, interface):
    """Coefficient of friction of an interface; None without a model, and where it depends on the speed."""
    for one in model.interfaces if model else ():
        if one.id == interface and one.friction == one.sliding_friction:
            return one.friction or None
    return None


def draw_tractions(axes, chain, times, limit):
    """|traction| along one chain at some times; mu p as a broken line where mu, the `limit`, is known."""
    known = np.unique(chain["time"])
    for count, wanted in enumerate(times):
        time = known[np.argmin(np.abs(known - wanted))]
        rows, colour = chain.where(time=time), COLOURS[count % len(COLOURS)]
        axes.plot(rows["s"], np.abs(rows["traction"]), color=colour, marker="o", markersize=2.0,
                  linewidth=1.0, label=f"t = {time:.4g}")
        if limit:
            axes.plot(rows["s"], limit * rows["pressure"], color=colour, linestyle="--", linewidth=0.8,
                      label=f"mu p, mu {limit:g}")
    axes.set_xlabel("arc length s along the slave")
    axes.set_ylabel("|traction|")
    axes.set_ylim(bottom=0.0)
    axes.grid(True)
    axes.legend(fontsize=7)


def zones_figure(contact, times, model):
    """One row for each chain of each interface with friction: stick and slip over time, tractions
    at some times with mu p of the model; None where no node ever stuck or slipped."""
    if "state" not in contact or not np.any(contact["state"]):
        return None
    chains = [(number, chain) for number in np.unique(contact["interface"]).tolist()
              if np.any((rows := contact.where(interface=number))["state"])
              for chain in chains_of(rows)]
    with plt.rc_context(STYLE):
        figure, panels = plt.subplots(len(chains), 2, squeeze=False, layout="constrained",
                                      figsize=(PAGE_WIDTH + 1.5, 0.6 + PANEL * len(chains)))
        for (left, right), (number, chain) in zip(panels, chains):
            draw_zones(left, chain)
            left.set_title(f"interface {number}", loc="left")
            draw_tractions(right, chain, times, limit_of(model, number))
        add_legend(figure, contact)
        return figure


def zones_of(results, states=("-1",)):
    """The same of a run at its states; the deck as run beside its results tells the coefficient."""
    times = [results.times[results.state_index(state)] for state in states]
    figure = zones_figure(results.history("contact"), times, model_of(results.path.with_suffix("")))
    if figure is None:
        raise UserError(f"{results.path}: no slave node ever stuck or slipped (its contact table "
                           "tells of no friction)")
    figure.suptitle(run_title(results), fontsize=9)
    return figure
