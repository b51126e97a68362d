# SPDX-License-Identifier: MIT
"""Write DYNA's binout from the history tables of a run.

    from slideline_tools.binout import write_binout
    write_binout("results/collision", "binout0000")

Energies, forces and masses are those of the tables, per unit depth.
"""
import typing

import numpy as np

from slideline_tools import UserError, __version__, lsda
from slideline_tools.effective_deck import interface_titles, part_titles
from slideline_tools.files import output
from slideline_tools.finished_run import Run

#: states of an element, as DYNA numbers them
STATES = "elastic,plastic,failed"
#: condition of bndout -> its branch
CONDITIONS = {1: "discrete/nodes", 2: "discrete/rigidbodies", 3: "pressure", 4: "velocity/nodes",
              5: "velocity/rigidbodies"}
#: branches below that of their table
BRANCHES = {"rwforc": "rwforc/forces", "elout": "elout/shell"}
LEGEND_WIDTH = 70


class Rows:
    """A table by instants: `column(name)` is (n_instant, n_entity), 0 where the run has none."""

    def __init__(self, table, entity, run):
        self.table, self.run = table, run
        self.ids = table[entity][table["time"] == table["time"][0]] if entity else np.zeros(1, int)
        if len(table) % len(self.ids):
            raise UserError(f"{table.name}: an instant that is not whole")
        self.zero = np.zeros((len(table) // len(self.ids), len(self.ids)))

    def column(self, name):
        """Values of a column."""
        return (self.table[name].reshape(self.zero.shape) if name in self.table else self.zero)

    def first(self, name):
        """One value of each instant."""
        return self.column(name)[:, 0]

    def legend(self, titles):
        """Legend of the entities with a title."""
        known = [number for number in dict.fromkeys(self.ids.tolist()) if titles.get(number)]
        lines = (titles[number][:LEGEND_WIDTH].ljust(LEGEND_WIDTH) for number in known)
        return {"legend_ids": known, "legend": "".join(lines)} if known else {}


class Form(typing.NamedTuple):
    """How a table becomes a branch: the column of its entities, variables that are columns (`x`
    and `y` before a name in `vectors`, whose z is 0), and what else there is: `more` fills the
    states and gives the metadata."""

    entity: str
    columns: dict
    vectors: dict
    more: typing.Callable


def glstat(rows, states):
    """The work of the bulk viscosity counts as internal energy, and what has eroded in those of
    elements, as in DYNA."""
    states["internal_energy"] = rows.column("internal") + rows.column("viscous")
    states["sliding_interface_energy"] = sum(
        rows.column(name) for name in ("contact", "friction", "eroded_contact"))
    for name in ("kinetic", "internal", "hourglass"):
        eroded = rows.column(f"eroded_{name}")
        states[f"{name}_energy"] = states.get(f"{name}_energy", rows.zero) + eroded
        states[f"eroded_{name}_energy"] = eroded
    states["spring_and_damper_energy"] = states["global_z_velocity"] = rows.zero
    total = rows.column("total")
    left = np.divide(total - rows.column("eroded"), total, out=rows.zero + 1.0, where=total != 0.0)
    states["energy_ratio_wo_eroded"] = left * rows.column("energy_ratio")
    states["nzc"] = rows.zero.astype(int)
    if "element" in rows.table and np.all(rows.table["element"] > 0):
        states["ts_eltype"] = rows.zero.astype(int) + 1
        states["ts_element"] = rows.column("element")
        states["ts_part"] = rows.column("element_part")
    for name in set(states):
        states[name] = states[name].ravel()
    return {"element_types": "shell"}


def rcforc(rows, states):
    """Contact forces; side 0 is the slave surface, 1 the master surface."""
    states["mass"] = rows.zero
    side = rows.table["side"][:len(rows.ids)] == "master"
    return {"ids": rows.ids, "side": side.astype(int), **rows.legend(interface_titles(rows.run.deck))}


def nodout(rows, states):
    """Motion of nodes."""
    if "cycle" in rows.table:
        states["cycle"] = rows.first("cycle")
    return {"ids": rows.ids, **rows.legend(dict.fromkeys(rows.ids.tolist(), "node"))}


def matsum(rows, states):
    """Sums of parts."""
    mass = np.where(states["mass"] > 0.0, states["mass"], 1.0)
    for axis in "xyz":
        states[f"{axis}_rbvelocity"] = states[f"{axis}_momentum"] / mass
    states["added_mass"] = rows.column("added_mass")
    states["eroded_kinetic_energy"] = states["eroded_internal_energy"] = rows.zero
    return {"ids": rows.ids, **rows.legend(part_titles(rows.run.deck))}


def sleout(rows, states):
    """Energies of interfaces, one number each, and what of it friction has dissipated."""
    states["slave"] = sum(rows.column(name) for name in ("energy", "damping", "friction"))
    states["friction_energy"] = rows.column("friction")
    states["cycle"] = rows.first("cycle")
    states["total_friction"] = states["friction_energy"].sum(axis=1)
    states["total_slave"] = states["total_energy"] = states["slave"].sum(axis=1)
    states["total_master"] = rows.zero[:, 0]
    return {"ids": rows.ids, "single_sided": np.ones(len(rows.ids), dtype=int),
            **rows.legend(interface_titles(rows.run.deck))}


def spcforc(rows, states):
    """Forces of constraints on nodes, and their sums."""
    for axis in "xyz":
        states[f"{axis}_resultant"] = states[f"{axis}_force"].sum(axis=1)
    return {"force_ids": rows.ids, "ids": rows.ids}


def elout(rows, states):
    """Stress of elements: shells with one point through the thickness, as DYNA's 2D solids."""
    states["sig_yz"] = states["sig_zx"] = rows.zero
    plastic, gone = states["plastic_strain"] > 0.0, rows.column("is_gone") > 0
    states["state"] = np.where(gone, 3, np.where(plastic, 2, 1))
    states["ids"] = np.broadcast_to(rows.ids, rows.zero.shape)
    states["nip"] = states["iop"] = np.ones(rows.zero.shape, dtype=int)
    if "part" in rows.table:
        states["mat"], states["cycle"] = rows.column("part"), rows.first("cycle")
    return {"states": STATES, "system": "global",
            **rows.legend(dict.fromkeys(rows.ids.tolist(), "shell"))}


def add_totals(states, blocks):
    """Sums over blocks (slices) of the entities of an instant."""
    for name, total in (("x_force", "x_total"), ("y_force", "y_total"), ("z_force", "z_total"),
                        ("energy", "etotal")):
        sums = np.stack([states[name][:, block].sum(axis=1) for block in blocks], axis=1)
        states[total] = sums if len(blocks) > 1 else sums[:, 0]


def bndout(rows, states):
    """Forces on boundaries of one condition, and their work."""
    add_totals(states, [slice(None)])
    if rows.table["condition"][0] == 5:
        states["xmoment"] = states["ymoment"] = rows.zero
        states["zmoment"] = rows.column("moment")
    return {"ids": rows.ids}


def nodfor(rows, states):
    """Forces of groups of nodes; all groups behind each other."""
    starts = np.flatnonzero(np.diff(rows.table["group"][:len(rows.ids)], prepend=-1))
    sizes = np.diff([*starts, len(rows.ids)])
    add_totals(states, [slice(start, start + size) for start, size in zip(starts, sizes)])
    return {"ids": rows.ids, "groups": sizes, "local": np.zeros(len(sizes), dtype=int)}


def secforc(rows, states):
    """Forces and moments of cross sections, in global axes."""
    states["x_moment"] = states["y_moment"] = rows.zero
    states["z_moment"], states["area"] = rows.column("moment"), rows.column("area")
    states["total_force"] = np.hypot(states["x_force"], states["y_force"])
    states["total_moment"] = np.abs(states["z_moment"])
    none = np.zeros(len(rows.ids), dtype=int)
    return {"ids": rows.ids, "rigidbody": none, "accelerometer": none, "coordinate_system": none}


def rbdout(rows, states):
    """Motion of rigid bodies; the directions are those of axes that turn with the body."""
    for name, columns in (("global_", "x y -"), ("global_d", "ux uy -"), ("global_v", "vx vy -"),
                          ("global_a", "ax ay -"), ("global_rd", "- - rotation"),
                          ("global_rv", "- - spin"), ("global_ra", "- - spin_rate")):
        for axis, column in zip("xyz", columns.split()):
            states[f"{name}{axis}"] = rows.column(column)
    angle = rows.column("rotation")
    turned = {"11": np.cos(angle), "22": np.cos(angle), "12": -np.sin(angle), "21": np.sin(angle),
              "33": rows.zero + 1.0}
    for place in (f"{row}{column}" for row in "123" for column in "123"):
        states[f"dircos_{place}"] = turned.get(place, rows.zero)
    if "cycle" in rows.table:
        states["cycle"] = rows.first("cycle")
    return {"ids": rows.ids, "num_nodal": 0, **rows.legend(part_titles(rows.run.deck))}


FORCE = {"force": ("fx", "fy")}
FORMS = {
    "glstat": Form("", {
        "cycle": "cycle", "time_step": "dt", "kinetic_energy": "kinetic",
        "hourglass_energy": "hourglass", "system_damping_energy": "damping",
        "sliding_interface_energy": "contact", "external_work": "external_work",
        "total_energy": "total", "energy_ratio": "energy_ratio",
        "global_x_velocity": "velocity_x", "global_y_velocity": "velocity_y",
        "added_mass": "added_mass", "percent_increase": "mass_increase"}, {}, glstat),
    "rcforc": Form("interface", {}, FORCE, rcforc),
    "nodout": Form("node", {}, {"displacement": ("ux", "uy"), "velocity": ("vx", "vy"),
                                "acceleration": ("ax", "ay"), "coordinate": ("x", "y")}, nodout),
    "matsum": Form("part", {"kinetic_energy": "kinetic", "internal_energy": "internal",
                            "hourglass_energy": "hourglass", "mass": "mass"},
                   {"momentum": ("momentum_x", "momentum_y")}, matsum),
    "sleout": Form("interface", {}, {}, sleout),
    "spcforc": Form("node", {}, FORCE, spcforc),
    "rwforc": Form("wall", {"normal_force": "normal_force"}, FORCE,
                   lambda rows, states: {"ids": rows.ids}),
    "elout": Form("element", {"sig_xx": "sxx", "sig_yy": "syy", "sig_zz": "szz", "sig_xy": "sxy",
                              "plastic_strain": "plastic_strain"}, {}, elout),
    "rbdout": Form("part", {}, {}, rbdout),
    "bndout": Form("id", {"energy": "work"}, FORCE, bndout),
    "nodfor": Form("node", {"energy": "work"}, FORCE, nodfor),
    "secforc": Form("section", {}, {**FORCE, "centroid": ("x", "y")}, secforc),
}


def write_binout(run, path):
    """Write all tables of a run (folder, results file, or `Run`) to one binout; their names."""
    run = run if isinstance(run, Run) else Run(run)
    tables = {name: table for name, table in run.tables_for_dyna().items() if name in FORMS and len(table)}
    if not tables:
        raise UserError(f"{run.prefix} has no history tables")
    lsda.write(output(path, run.files()), (
        array for name, table in tables.items() for branch, rows in branches_of(name, table)
        for array in arrays_of(branch, FORMS[name], rows, run)))
    return list(tables)


def branches_of(name, table):
    """(branch, its rows) of a table: one, of boundaries one for each condition."""
    if name != "bndout":
        return [(BRANCHES.get(name, name), table)]
    return [(f"bndout/{CONDITIONS[number]}", rows) for number in CONDITIONS
            if len(rows := table.where(condition=number))]


def arrays_of(name, form, table, run):
    """(folder, name, values) of one branch: its metadata, and a directory of each state."""
    rows = Rows(table, form.entity, run)
    states = {"time": rows.first("time")}
    states |= {key: rows.column(column) for key, column in form.columns.items() if column in table}
    for vector, columns in form.vectors.items():
        states |= {f"{axis}_{vector}": rows.column(column)
                   for axis, column in zip("xyz", (*columns, "-"))}
    metadata = {"version": f"slideline {__version__}"[:10].ljust(10), "date": " " * 10,
                "title": run.title[:80].ljust(80), **form.more(rows, states)}
    for key, value in metadata.items():
        yield f"/{name}/metadata", key, value
    for k in range(len(states["time"])):
        for key, values in states.items():
            yield f"/{name}/d{k + 1:06d}", key, values[k]
