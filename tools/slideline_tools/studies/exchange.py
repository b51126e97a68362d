# SPDX-License-Identifier: MIT
"""Master and slave exchanged: how much the answer of each type changes, scene by scene.

    python -m slideline_tools.studies.exchange decks FOLDER
    python -m slideline_tools.studies.exchange page FOLDER DOC

`decks` writes the decks of all scenes as FOLDER/<scene>.k and FOLDER/<scene>_exchanged.k and prints
for each its name and the penalties to run it with, of type 3 and of the others, so that the
distributed penalty stays the same.
`page` reads the runs FOLDER/<scene>[_exchanged]_type_<n>/<scene>.* and writes DOC/studies/exchange.md.
"""
import dataclasses
import re
import sys
import typing

import numpy as np

from slideline_tools import scenes
from slideline_tools.histories import energy_made, read_csv
from slideline_tools.results import read
from slideline_tools.studies.common import decks_and_page_main, label, markdown_table, write_page
from slideline_tools.studies.sliding import judged_interval
from slideline_tools.summaries import SNAPSHOT_TIME

UPPER, LOWER = 0, 1
MADE = 0.01  # of the energy of the flight


class Run:
    """One run: tables and results on demand; sides told apart by body, not by role."""

    def __init__(self, folder, scene, ctype, exchanged):
        name = f"{scene}{'_exchanged' if exchanged else ''}_type_{ctype}"
        self.path, self.scene, self.exchanged = folder / name, scene, exchanged
        self.results = read(self.path / f"{scene}.vtkhdf")

    def table(self, name):
        return read_csv(self.path / f"{self.scene}.{name}.csv")

    def force(self):
        """(time, fy) on the upper body, upwards."""
        rows = self.table("rcforc").where(side="master" if self.exchanged else "slave")
        return rows["time"], rows["fy"]

    def nodes(self, ids):
        """Rows of nodes in the point fields."""
        place = {int(node): k for k, node in enumerate(self.results.point_field("node_id")[-1])}
        return np.array([place[int(node)] for node in ids])

    def pressures(self, ids):
        """Pressure at the nodes of a face at the last state: normal force over its length."""
        rows = self.nodes(ids)
        x = self.results.points[-1][rows, 0]
        half = 0.5 * np.abs(np.diff(x))
        length = np.append(half, 0.0) + np.append(0.0, half)
        return np.abs(self.results.point_field("contact_force")[-1][rows, 1]) / length

    def made(self):
        """What contact springs made at most until any time, over the largest kinetic energy."""
        return np.max(energy_made(self.table("sleout"))) / self.table("glstat")["kinetic"].max()

    def kept(self):
        """What contact took and had not given back at the end, over the largest kinetic energy;
        below 0: it gave more than it took."""
        energy = self.table("glstat")
        return energy["contact"][-1] / energy["kinetic"].max()


@dataclasses.dataclass
class Quantity:
    """One number of a scene. `scale`: what a difference is compared with; the number itself if
    None. `factor` turns it into the unit shown."""

    name: str
    value: typing.Callable
    factor: float = 1.0
    scale: typing.Optional[float] = None


def spread(grids, side, load=None):
    """Largest deviation of the pressure on a body from the load (or from its mean)."""
    def value(run):
        pressure = run.pressures(grids[1].lower if side == UPPER else grids[0].upper)
        return np.max(np.abs(pressure / (load or pressure[1:-1].mean()) - 1.0))
    return value


def end_pressure(grids, side):
    """Pressure at the left end node of a body over the mean of the others."""
    def value(run):
        pressure = run.pressures(grids[1].lower if side == UPPER else grids[0].upper[::-1])
        return pressure[0] / pressure[1:-1].mean() - 1.0
    return value


def mean_force(run):
    """Mean vertical force in the judged part of the stroke."""
    time, force = run.force()
    first, last = judged_interval()
    return force[(time >= first) & (time <= last)].mean()


def largest_strain(when=None):
    def value(run):
        state = -1 if when is None else int(np.argmin(np.abs(run.results.times - when)))
        return run.results.cell_field("plastic_strain")[state].max()
    return value


def peak_force(run):
    return run.force()[1].max()


def impulse(run):
    time, force = run.force()
    return np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(time))


def body_velocity(run):
    """Mean velocity in y of the upper body (part 2) at the end."""
    rows = run.table("matsum").where(part=2)
    return rows["momentum_y"][-1] / rows["mass"][-1]


def turned_spin(run):
    """Turning rate of the turned block at the end: that of its lower edge."""
    rows = run.nodes(scenes.oblique_grids()[1].lower[[0, -1]])
    edge = np.diff(run.results.points[-1][rows, :2], axis=0)[0]
    motion = np.diff(run.results.point_field("velocity")[-1][rows, :2], axis=0)[0]
    return (edge[0] * motion[1] - edge[1] * motion[0]) / (edge @ edge)


def scene_quantities():
    """The numbers of every scene."""
    patch, block = scenes.patch_grids(), scenes.block_grids()
    percent = dict(factor=100.0, scale=1.0)
    return {
        "patch": [
            Quantity("upper side: max abs(p/p0 - 1), %", spread(patch, UPPER, 1.0), **percent),
            Quantity("lower side: max abs(p/p0 - 1), %", spread(patch, LOWER, 1.0), **percent)],
        "block": [
            Quantity("upper side: max abs(p/p_mean - 1), %", spread(block, UPPER), **percent),
            Quantity("lower side: max abs(p/p_mean - 1), %", spread(block, LOWER), **percent),
            Quantity("upper end node: p/p_mean - 1, %", end_pressure(block, UPPER), **percent),
            Quantity("total force, N/m", lambda run: run.force()[1][-1])],
        "sliding": [
            Quantity("mean force, MN/m", mean_force, 1.0e-6),
            Quantity("largest plastic strain", largest_strain())],
        "collision": [
            Quantity("plastic strain at 0.7 ms", largest_strain(SNAPSHOT_TIME)),
            Quantity("impulse, kN s/m", impulse, 1.0e-3),
            Quantity("rebound velocity, m/s", body_velocity, 1.0, 80.0),
            Quantity("energy kept by contact, % of the initial", Run.kept, **percent),
            Quantity("energy made by contact, % of the initial", Run.made, **percent)],
        "oblique": [
            Quantity("spin, rad/s", turned_spin),
            Quantity("velocity of the block in y, m/s", body_velocity, 1.0, 1.0),
            Quantity("energy kept by contact, % of the initial", Run.kept, **percent),
            Quantity("energy made by contact, % of the initial", Run.made, **percent)],
    }


# ---- decks -------------------------------------------------------------------------------------

def mean_lengths():
    """(slave, master) mean segment lengths of every scene as it is."""
    die, plate = scenes.sliding_grids(1)[::-1]
    arc = die.points[:, 0]
    return {
        "patch": (1.0 / 5.0, 1.0 / 4.0),
        "block": (10.0 / 51.0, 10.0 / 50.0),
        "sliding": (np.mean(np.linalg.norm(np.diff(arc, axis=0), axis=1)),
                    0.036 / (len(plate.lower) - 1)),
        "collision": (0.020 / 24.0, 0.025 / 20.0),
        "oblique": (0.1, 0.15),
    }


PENALTIES = {"patch": 1.0e6, "block": 1.0e6, "sliding": 10.0e9, "collision": 1.0e9,
             "oblique": 5.0e5}


def with_interface_energies(deck):
    """The deck with *DATABASE_SLEOUT at the times of *DATABASE_GLSTAT."""
    return re.sub(r"\*DATABASE_GLSTAT\n((?:[^*\n].*\n)+)", r"\g<0>*DATABASE_SLEOUT\n\1", deck)


def write_decks(folder):
    """All decks; prints `name scene penalty penalty_of_type_3` for each, for the script."""
    folder.mkdir(parents=True, exist_ok=True)
    for scene, (slave, master) in mean_lengths().items():
        for exchanged in (False, True):
            name = f"{scene}{'_exchanged' if exchanged else ''}"
            text = with_interface_energies(getattr(scenes, scene)(exchanged=exchanged))
            (folder / f"{name}.k").write_text(text, encoding="ascii")
            # eps_hat = eps / mean slave segment; each pass of type 3 has its own mean segment.
            penalty = PENALTIES[scene] * (master / slave if exchanged else 1.0)
            print(name, scene, f"{penalty:.10g}", f"{PENALTIES[scene]:.10g}")


# ---- the page ----------------------------------------------------------------------------------

HEAD = """# Master and slave exchanged

This page is written by `tools/batch/exchange.sh`: do not edit it.

Every scene is run as it is and with the roles of the two surfaces exchanged
(`slideline-tools make-deck SCENE --exchanged`). The penalty of the exchanged run is scaled by the ratio
of the mean segment lengths, so that the distributed penalty `eps_hat` (eps over the mean
slave segment, `doc/theory/contact.md`) is the same; otherwise the exchange would change the stiffness of the interface too. In
type 3 each pass has its own mean segment and keeps its `eps_hat` without that. *Upper* and
*lower*, force and velocity belong to the same body in both runs. A difference is in per cent of the
value as it is; for quantities that are given in per cent, in per cent of the reference (the load, the
mean pressure, the initial energy); for the rebound of the collision, of the 80 m/s of the impact;
for the velocity of the turned block, of its 1 m/s.

A symmetric treatment of the interface would leave no difference. Type 3 is symmetric by construction: what
is left with it is rounding, and its growth in long runs by contacts that open and close.

## Largest difference of each type, %

"""

TITLES = {
    "patch": "Patch test (meshes 5 above, 4 below; explicit with damping)",
    "block": "Block-to-block, explicit (51 above, 50 below)",
    "sliding": "Sliding, N_r = 1 (die 0.5 mm, plate 1 mm segments)",
    "collision": "Collision, N_r = 1 (projectile 0.83 mm, plate 1.25 mm segments)",
    "oblique": "Oblique impact, block turned by 30 degrees (0.1 m above, 0.15 m below)",
}

NOTES = {
    "oblique": "Exchanged, the slave is the flat, coarser face and the corner that hits is on the master. Types 1 "
               "and 2 see the corner only through slave nodes. The mortar types average gaps over slave segments "
               "longer than the part of the corner that is in contact: contact begins late and deep, and points "
               "that come and go carry force. Energy made is the most that contact springs had given beyond "
               "what they took, at any time; kept is what they had not given back at the end. {made}",
    "collision": "Plastic strain is that of the clamped corner, far from the contact, and hardly depends on "
                 "it. The rebound velocity is a small difference of large impulses.",
}


def difference(quantity, one, other):
    """Difference in per cent of the scale."""
    scale = abs(one) if quantity.scale is None else quantity.scale
    return 100.0 * (other - one) / scale


def significant(value, digits=4, sign=""):
    """So many digits; what is rounding is shown as a bound, the same on every machine."""
    return "< 1e-8" if abs(value) < 1e-8 else f"{value:{sign}.{digits}g}"


def scene_table(folder, scene, quantities, types):
    """Table of one scene, and the largest difference of each type."""
    rows, largest = [], []
    for ctype in types:
        runs = [Run(folder, scene, ctype, exchanged) for exchanged in (False, True)]
        row = [label(ctype)]
        largest.append(0.0)
        for quantity in quantities:
            one, other = (float(quantity.value(run)) for run in runs)
            row += [significant(quantity.factor * one), significant(quantity.factor * other),
                    significant(difference(quantity, one, other), 2, "+")]
            largest[-1] = max(largest[-1], abs(difference(quantity, one, other)))
        rows.append(row)
    names = ["type"]
    for quantity in quantities:
        names += [quantity.name, "exchanged", "difference, %"]
    return markdown_table(names, rows), largest


def made_text(folder, types):
    """How much energy contact made or kept in the oblique impact, where that is above MADE."""
    parts = []
    for exchanged, when in ((False, "as it is"), (True, "exchanged")):
        runs = {ctype: Run(folder, "oblique", ctype, exchanged) for ctype in types}
        for what, value in (("made", Run.made), ("kept", Run.kept)):
            shares = {ctype: value(run) for ctype, run in runs.items()}
            found = [f"type {ctype} {100.0 * share:.1f} %" for ctype, share in shares.items()
                     if share > MADE]
            if found:
                parts.append(f"{when} contact {what}: {', '.join(found)}")
    return (f"Of the energy of the flight, where it is more than {100.0 * MADE:.0f} %: " + "; ".join(parts) + ".") \
        if parts else ""


def write(folder, doc, types):
    """Read the runs below `folder`, write the page below `doc`."""
    parts, largest = [], []
    for scene, quantities in scene_quantities().items():
        table, worst = scene_table(folder, scene, quantities, types)
        largest.append([scene, *(significant(value, 2) for value in worst)])
        parts.append(f"## {TITLES[scene]}\n\n{table}\n")
        if scene in NOTES:
            parts.append(NOTES[scene].format(made=made_text(folder, types) if "{made}" in NOTES[scene] else "")
                         + "\n")
    summary = markdown_table(["scene", *(label(ctype) for ctype in types)], largest)
    write_page(doc, "exchange", "\n".join([HEAD + summary + "\n", *parts]))


def main(arguments=None):
    return decks_and_page_main(__doc__, write_decks, write, arguments)


if __name__ == "__main__":
    sys.exit(main())
