# SPDX-License-Identifier: MIT
"""Advice on friction: none that counts, and sliding that flutters because nothing damps it."""
import numpy as np

from slideline_tools.advise.report import Advice
from slideline_tools.effective_deck import read_blocks

SLIP = 2  # states 1 and 2: stick and slip
# Friction counts for nothing: largest traction over mu p, and work over the largest energy of the run, below these at so
# many states in contact.
NO_TRACTION, NO_WORK, STATES_IN_CONTACT = 0.01, 1.0e-4, 10
# Flutter: share of the pressed nodes that change between stick and slip from one state to the next, the fewest such
# changes that could have been, and the e-folds by which it could have grown.
CHANGING, FEWEST, GROWN = 0.2, 50, 10.0
# E-folds in 1000 of the shortest stable steps of the elements by coefficient, at a penalty of K L/A: the slowest of all types
# (doc/studies/stability.md).
GROWTH = ((0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.8), (0.0, 0.0, 0.8, 3.9, 8.4, 14.7, 32.9))


def with_friction(run):
    """(interface, its rows of the contact table) of all that have friction and tell of it."""
    table = run.tables.get("contact")
    if table is None or "state" not in table:
        return
    for interface in run.interfaces:
        rows = table.where(interface=interface.id)
        if interface.friction and len(rows):
            yield interface, rows


def largest_energy(run) -> float:
    """Largest energy of the run, J per unit of depth; 0 when unknown."""
    glstat = run.tables.get("glstat")
    if glstat is None:
        return 0.0
    return float(max(np.abs(glstat[name]).max() for name in ("total", "kinetic", "internal", "external_work")))


def needless_friction(run) -> list[Advice]:
    """Interfaces whose friction carries and takes nothing worth naming."""
    advice = []
    for interface, rows in with_friction(run):
        pressed = rows["pressure"] > 0.0
        states = len(np.unique(rows["time"][pressed]))
        scale = largest_energy(run)
        if states < STATES_IN_CONTACT or not scale:
            continue
        most = interface.friction * rows["pressure"].max()
        traction = float(np.abs(rows["traction"]).max()) / most
        work = np.abs(run.tables["glstat"]["friction"]).max() / scale  # of all interfaces
        if traction > NO_TRACTION or work > NO_WORK:
            continue
        advice.append(Advice(
            "needless friction", f"Friction of {interface.described} does nothing worth naming.",
            f"its largest traction at {states} states in contact is {traction:.1%} of mu times the largest pressure, the work of friction "
            f"{work:.1g} of the largest energy", f"leave FS out on the contact card of interface {interface.id} (command line: fs.{interface.id}=0)",
            None, "contact without tangential springs"))
    return advice


def changes(rows) -> tuple[int, int]:
    """How often a pressed node was in the other state, stick or slip, at the next of the states, and how often it could
    have been."""
    changed = possible = 0
    times = np.unique(rows["time"])
    before = None
    for time in times:
        now = rows.where(time=time)
        if before is not None and np.array_equal(now["node"], before["node"]):
            closed = (now["state"] > 0) & (before["state"] > 0) & (now["state"] <= SLIP) & (before["state"] <= SLIP)
            possible += int(np.sum(closed))
            changed += int(np.sum(closed & (now["state"] != before["state"])))
        before = now
    return changed, possible


def is_damped(run, interface) -> bool:
    """Whether contact damping acts: by sleout; without it where a contact card or the command line has VDC."""
    if (sleout := run.tables.get("sleout")) is not None:
        return bool(np.any(sleout.where(interface=interface.id)["damping"]))
    cards = [block.fields(1 + block.is_titled) for block in read_blocks(run.deck, "CONTACT_2D_AUTOMATIC")]
    return "vdc" in run.options or any(card[4:5] not in ([], [""]) and float(card[4]) > 0.0 for card in cards)


def undamped_sliding(run) -> list[Advice]:
    """Interfaces that slide, change between stick and slip all the time, and have nothing that damps them."""
    glstat = run.tables.get("glstat")
    if run.is_implicit or glstat is None or not (limit := run.element_limit) > 0.0:
        return []
    if np.any(glstat["damping"]) or np.any(glstat["viscous"]):
        return []
    advice = []
    for interface, rows in with_friction(run):
        if is_damped(run, interface) or interface.sliding_friction < GROWTH[0][1]:
            continue
        changed, possible = changes(rows)
        slid = rows["time"][rows["state"] == SLIP]
        if possible < FEWEST or changed < CHANGING * possible:
            continue
        rate = float(np.interp(interface.sliding_friction, *GROWTH)) / 1000.0 / limit
        folds = rate * (slid.max() - slid.min())
        if folds < GROWN:
            continue
        advice.append(Advice(
            "undamped sliding", f"{interface.described} slides without any damping, and may flutter.",
            f"{changed / possible:.0%} of the pressed nodes are in the other state, stick or slip, at the next of the states; at mu "
            f"{interface.sliding_friction:g} a small motion grows by {rate * limit * 1000.0:.2g} e-folds or more in 1000 steps of the "
            f"elements (doc/studies/stability.md), {folds:.2g} while it slid",
            f"*DAMPING_GLOBAL with D of {2.0 * rate:.2g} or more stops it, and slows what moves steadily; VDC, bulk viscosity or "
            "the viscous form of hourglass control hold down its short waves", None, "a smoother contact force, no time"))
    return advice


CHECKS = (needless_friction, undamped_sliding)
