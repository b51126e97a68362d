# SPDX-License-Identifier: MIT
"""Advice on interfaces: never touched, touched for a while or in places, long flight before."""
import numpy as np

from slideline_tools.advise.report import Advice
from slideline_tools.draw.model import Surface

# Part of the run without contact from which TBIRTH and TDEATH are worth a word.
IDLE_TIME = 0.2
# Part of the slave surface that touched below which the surface is called long.
LONG_SURFACE = 0.5
STATES_IN_CONTACT = 10
# Part of the run before the first contact that is called a long flight, and the change of energy
# (over the largest kinetic energy) that a free flight may show.
LONG_FLIGHT, FREE_FLIGHT = 0.05, 1.0e-9
# Nodes of an interface are moved one by one: they take so much of the phase `nodes` at least.
INTERFACE_NODES = 0.5


def slave_rows(run, interface):
    """Rows of rcforc of the slave side."""
    return run.tables["rcforc"].where(interface=interface.id, side="slave")


def contact_seconds(run, interface, steps=("search", "pairing", "force")) -> float:
    """Seconds of the contact steps of one interface: as timed (a run with `timing=interface`), or
    shared out by the tracked nodes."""
    timed = [run.seconds.get(f"contact_{step}.{interface.id}") for step in steps]
    if None not in timed:
        return sum(timed)

    def weight(one):
        return len(one.slave.nodes) + (len(one.master.nodes) if one.ctype == 3 else 0)
    share = weight(interface) / max(sum(map(weight, run.interfaces)), 1)
    return share * sum(run.seconds_of(f"contact_{step}") for step in steps)


def node_seconds(run, interface) -> float:
    """Seconds that moving the nodes of one interface takes beyond those inside the bodies."""
    def count(one):
        return len(one.slave.nodes) + len(one.master.nodes)
    share = count(interface) / max(sum(map(count, run.interfaces)), 1)
    return INTERFACE_NODES * share * run.seconds_of("nodes")


def read_surfaces(run) -> dict[int, tuple[Surface, Surface]]:
    """Slave and master of each interface by its number, with the indices of the results; those that
    touch themselves are left out."""
    if run.results is None or run.model is None or not np.array_equal(
            run.results.point_field("node_id")[0], run.model.node_ids):
        return {}
    return {one.id: (one.slave, one.master) for one in run.model.interfaces
            if len(one.slave.segments) and len(one.master.segments)
            and not np.isin(one.slave.segments, one.master.segments).any()}


def never_near(run, pair: tuple[Surface, Surface], largest: float = 2.0e8) -> float | None:
    """Smallest distance of the two surfaces over all states if it proves that they never met.

    Between two states no node goes farther than the largest nodal speed seen at any state, and
    a half, times half the time between them. None when that does not exclude a meeting, or when
    the comparison would be too large.
    """
    results = run.results
    slave, master = pair
    speed = np.linalg.norm(results.point_field("velocity"), axis=2).max()
    reach = 2.0 * 1.5 * speed * 0.5 * np.diff(results.times).max()
    if len(slave.nodes) * len(master.nodes) * len(results.times) > largest:
        return None
    nearest = np.inf
    for points in results.points[:, :, :2]:
        apart = np.linalg.norm(points[slave.nodes][:, None] - points[master.nodes][None], axis=2)
        half = 0.5 * max(slave.lengths(points).max(), master.lengths(points).max())
        nearest = min(nearest, float(apart.min() - half))
    return nearest if nearest > reach else None


def never_touched(run) -> list[Advice]:
    """Interfaces that provably carried no force in any cycle."""
    if "rcforc" not in run.tables:
        return []
    glstat, surfaces, advice = run.tables.get("glstat"), read_surfaces(run), []
    work_free = glstat is not None and not np.any(glstat["contact"])
    for interface in run.interfaces:
        rows = slave_rows(run, interface)
        if not len(rows) or np.any(rows["n_active"]):
            continue
        pair = surfaces.get(interface.id)
        apart = never_near(run, pair) if pair else None
        if apart is not None:
            proof = (f"the surfaces were never nearer than {apart:.3g}, farther than they could "
                     "have moved between two states")
        elif work_free:
            proof = "the contact energy of the run is exactly 0"
        else:
            continue
        advice.append(Advice(
            "never touched", f"{interface.described} never touched.",
            f"no active point in {len(rows)} rows of rcforc; {proof}",
            f"leave interface {interface.id} (its *CONTACT_2D... block) out",
            contact_seconds(run, interface) + node_seconds(run, interface),
            ("its contact time" if len(run.interfaces) == 1
             or f"contact_search.{interface.id}" in run.seconds
             else "its share of the contact time by its tracked nodes")
            + ", and what its nodes cost to move"))
    return advice


def touched_for_a_while(run) -> list[Advice]:
    """Interfaces that could be born later or die earlier."""
    if "rcforc" not in run.tables or run.is_implicit:
        return []
    advice = []
    for interface in run.interfaces:
        rows = slave_rows(run, interface)
        active = np.flatnonzero(rows["n_active"] > 0)
        if len(rows) < 100 or not len(active):
            continue
        time, last_row = rows["time"], len(rows) - 1
        birth = time[max(active[0] - 2, 0)]
        death = time[min(active[-1] + 2, last_row)]
        idle = 1.0 - (death - birth) / (time[-1] - time[0])
        if idle < IDLE_TIME:
            continue
        ends = ([f"TBIRTH = {birth:.4g}"] if active[0] > 2 else []) + (
            [f"TDEATH = {death:.4g}"] if active[-1] < last_row - 2 else [])
        advice.append(Advice(
            "touched for a while", f"{interface.described} touched only from {time[active[0]]:.4g} to "
            f"{time[active[-1]]:.4g}.",
            f"{len(active)} of {len(rows)} rows of rcforc have active points; none in "
            f"{idle:.0%} of the time, before the first and after the last",
            f"{' and '.join(ends)} of interface {interface.id}; holds for this run "
            "only: a later contact would go unseen",
            contact_seconds(run, interface, ("search",)) * idle,
            "its search outside that time: at most, since far nodes sleep anyway"))
    return advice


def long_surface(run) -> list[Advice]:
    """Slave surfaces of which only a small part was ever pressed."""
    table, advice = run.tables.get("contact"), []
    for interface in run.interfaces if table is not None else ():
        rows = table.where(interface=interface.id)
        if not len(rows) or interface.ctype == 3:
            continue
        pressed = (rows["pressure"] != 0.0) | (rows["fx"] != 0.0) | (rows["fy"] != 0.0)
        states = len(np.unique(rows["time"][pressed]))
        if states < STATES_IN_CONTACT:
            continue
        first = rows["time"] == rows["time"][0]
        nodes, length = rows["node"][first], rows["length"][first]
        ever = np.isin(nodes, rows["node"][pressed])
        # One node more on both sides: what may have touched between the states.
        wide = ever | np.roll(ever, 1) | np.roll(ever, -1)
        share = float(length[wide].sum() / length.sum())
        if share >= LONG_SURFACE:
            continue
        x, y, s = (rows[name][first][wide] for name in ("x", "y", "s"))
        advice.append(Advice(
            "long surface", f"Only {share:.0%} of the slave surface of {interface.described} was ever "
            "pressed.",
            f"{ever.sum()} of {len(nodes)} slave nodes carried a force at any of {states} states "
            f"in contact (x {x.min():.4g} to {x.max():.4g}, y {y.min():.4g} to {y.max():.4g})",
            f"shorten the slave set to s = {s.min():.4g} to {s.max():.4g} with some nodes to spare",
            contact_seconds(run, interface, ("search",)) * (1.0 - share),
            "search of the nodes left out: at most, since far nodes sleep anyway"))
    return advice


def long_flight(run) -> list[Advice]:
    """Free flight before anything touches."""
    glstat = run.tables.get("glstat")
    if ("rcforc" not in run.tables or glstat is None or run.results is None
            or np.any(glstat["external_work"]) or run.is_implicit or not run.interfaces):
        return []
    rows = run.tables["rcforc"].where(side="slave")
    active = rows["n_active"] > 0
    times = np.unique(rows["time"])
    if not active.any():
        return []
    first = int(np.searchsorted(times, rows["time"][active].min()))
    start = times[first - 2] if first > 1 else 0.0
    share = start / times[-1]
    before = glstat["time"] <= start
    energy = np.abs(glstat["internal"][before]) + np.abs(
        glstat["kinetic"][before] - glstat["kinetic"][0])
    if share < LONG_FLIGHT or energy.max() > FREE_FLIGHT * glstat["kinetic"].max():
        return []
    moves = flights(run, start)
    if not moves:
        return []
    return [Advice(
        "long flight", f"Nothing happens before {start:.4g}: the bodies fly freely.",
        f"first contact after {share:.0%} of the time; until then internal energy and change of "
        f"kinetic energy are {energy.max() / glstat['kinetic'].max():.1g} of the kinetic energy",
        f"move the mesh of {' and of '.join(moves)}, and shorten ENDTIM by {0.99 * start:.4g}",
        0.99 * share * (run.seconds_of("loop") + run.seconds_of("output")),
        "the cycles of the flight")]


def flights(run, time: float) -> list[str]:
    """How far each moving part goes in `time`; none if any part does more than translate."""
    results = run.results
    parts, velocity = results.cell_field("part_id")[0], results.point_field("velocity")[0]
    moves, fastest = [], np.abs(velocity).max()
    for part in np.unique(parts):
        own = velocity[np.unique(results.cells[parts == part])][:, :2]
        if np.abs(own - own[0]).max() > 1.0e-9 * fastest:
            return []
        if np.any(own[0]):
            step = 0.99 * time * own[0]
            moves.append(f"part {part} by ({step[0]:.4g}, {step[1]:.4g})")
    return moves


CHECKS = (never_touched, touched_for_a_while, long_surface, long_flight)
