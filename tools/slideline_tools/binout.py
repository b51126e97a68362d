# SPDX-License-Identifier: MIT
"""Write DYNA's binout from the history tables of a run.

    from slideline_tools.binout import write_binout
    write_binout("results/collision", "binout0000")

Energies, forces and masses are those of the tables, per unit depth.
"""
import numpy as np

from slideline_tools import UserError, __version__
from slideline_tools.files import output
from slideline_tools.finished_run import Run
from slideline_tools.histories import History
from slideline_tools.lsda import Writer

#: variable in binout -> column of the table
GLSTAT = {"time": "time", "cycle": "cycle", "time_step": "dt", "kinetic_energy": "kinetic",
          "hourglass_energy": "hourglass", "system_damping_energy": "damping",
          "sliding_interface_energy": "contact", "external_work": "external_work",
          "total_energy": "total", "energy_ratio": "energy_ratio",
          "global_x_velocity": "velocity_x", "global_y_velocity": "velocity_y",
          "added_mass": "added_mass", "percent_increase": "mass_increase"}
RCFORC = {"x_force": "fx", "y_force": "fy"}
NODOUT = {"x_displacement": "ux", "y_displacement": "uy", "x_velocity": "vx", "y_velocity": "vy",
          "x_acceleration": "ax", "y_acceleration": "ay", "x_coordinate": "x", "y_coordinate": "y"}
MATSUM = {"kinetic_energy": "kinetic", "internal_energy": "internal", "hourglass_energy": "hourglass",
          "x_momentum": "momentum_x", "y_momentum": "momentum_y", "mass": "mass"}
RWFORC = {"x_force": "fx", "y_force": "fy", "normal_force": "normal_force"}
ELOUT = {"sig_xx": "sxx", "sig_yy": "syy", "sig_zz": "szz", "sig_xy": "sxy", "plastic_strain": "plastic_strain"}
#: variable in binout -> columns along x, along y, and about z
RBDOUT = {"global_{}": ("x", "y", None), "global_d{}": ("ux", "uy", None), "global_v{}": ("vx", "vy", None),
          "global_a{}": ("ax", "ay", None), "global_rd{}": (None, None, "rotation"),
          "global_rv{}": (None, None, "spin"), "global_ra{}": (None, None, "spin_rate")}
#: states of an element, as DYNA numbers them
STATES = ("elastic", "plastic", "failed")
#: condition of bndout -> its branch
CONDITIONS = {1: "discrete/nodes", 2: "discrete/rigidbodies", 3: "pressure", 4: "velocity/nodes",
              5: "velocity/rigidbodies"}
FORCES = {"x_force": "fx", "y_force": "fy", "energy": "work"}
#: branches below that of their table
BRANCHES = {"rwforc": "rwforc/forces", "elout": "elout/shell"}
LEGEND_WIDTH = 70


class BinoutError(UserError):
    """A run without tables."""


def write_binout(run, path):
    """Write all tables of a run (folder, results file, or `Run`) to one binout; their names."""
    run = run if isinstance(run, Run) else Run(run)
    tables = {name: whole_instants(table) for name, table in run.tables().items()
              if name in FORMS}
    tables = {name: table for name, table in tables.items() if len(table)}
    if not tables:
        raise BinoutError(f"{run.prefix} has no history tables")
    with Writer(output(path, run.files())) as file:
        for name, table in tables.items():
            for branch, metadata, states in branches_of(name, table, run):
                write_branch(file, branch, {"title": run.title[:80].ljust(80), **metadata}, states)
    return list(tables)


def branches_of(name, table, run):
    """(branch, its metadata, its states) of a table: one, of boundaries one for each condition."""
    if name == "bndout":
        return [(f"bndout/{CONDITIONS[number]}", *bndout_branch(table.where(condition=number)))
                for number in CONDITIONS if np.any(table["condition"] == number)]
    return [(BRANCHES.get(name, name), *FORMS[name](table, run))]


def write_branch(file, name, metadata, states):
    """One branch: its metadata, and a directory of each state (dicts of arrays by state)."""
    version = f"slideline {__version__}"
    for key, value in {"version": version[:10].ljust(10), "date": " " * 10, **metadata}.items():
        file.write(f"/{name}/metadata", key, value)
    for k in range(len(states["time"])):
        for key, values in states.items():
            file.write(f"/{name}/d{k + 1:06d}", key, values[k])


def glstat_branch(table, _):
    """Energies; the work of the bulk viscosity counts as internal energy, and what has eroded in those of elements, as in DYNA."""
    states = {name: table[column] for name, column in GLSTAT.items() if column in table}
    zero = np.zeros(len(table))
    states["internal_energy"] = table["internal"] + table["viscous"]
    states["sliding_interface_energy"] = optional(table, "contact") + optional(table, "friction") + optional(table, "eroded_contact")
    for name in ("kinetic", "internal", "hourglass"):
        eroded = optional(table, f"eroded_{name}")
        states[f"{name}_energy"] = states.get(f"{name}_energy", zero) + eroded
        states[f"eroded_{name}_energy"] = eroded
    for name in ("spring_and_damper_energy", "global_z_velocity"):
        states[name] = zero
    total = optional(table, "total")
    left = np.divide(total - optional(table, "eroded"), total, out=zero + 1.0, where=total != 0.0)
    states["energy_ratio_wo_eroded"] = left * table["energy_ratio"]
    states["nzc"] = np.zeros(len(table), dtype=int)
    if "element" in table and np.all(table["element"] > 0):
        states["ts_eltype"] = np.ones(len(table), dtype=int)
        states["ts_element"], states["ts_part"] = table["element"], table["element_part"]
    return {"element_types": "shell"}, states


def optional(table, column):
    """A column, or zeros where a run has none."""
    return table[column] if column in table else np.zeros(len(table))


def whole_instants(table):
    """The table without a last instant that a killed run did not write to the end."""
    if table.name == "glstat" or not len(table):
        return table
    times = table["time"]
    starts = np.concatenate([[0], np.flatnonzero(np.diff(times)) + 1, [len(times)]])
    sizes = np.diff(starts)
    end = starts[-2] if sizes[-1] < sizes[0] else len(times)
    return History(table.name, {name: column[:end] for name, column in table.columns.items()})


def by_instant(table, size, columns):
    """variable -> (n_instant, size) array of the named columns, and the times."""
    states = {"time": table["time"].reshape(-1, size)[:, 0]}
    states.update((name, table[column].reshape(-1, size)) for name, column in columns.items())
    return states


def entities(table, column):
    """Ids of the rows of the first instant."""
    first = table["time"] == table["time"][0] if len(table) else np.zeros(0, dtype=bool)
    ids = table[column][first]
    if len(ids) and len(table) % len(ids) == 0:
        return ids
    raise BinoutError(f"{table.name}: no rows, or an instant that is not whole")


def legend(ids, titles):
    """Legend of entities with a title."""
    known = [int(number) for number in dict.fromkeys(ids.tolist()) if titles.get(int(number))]
    if not known:
        return {}
    return {"legend_ids": known,
            "legend": "".join(titles[number][:LEGEND_WIDTH].ljust(LEGEND_WIDTH) for number in known)}


def with_z(states, *names):
    """The same with z components of zero."""
    shape = next(values for name, values in states.items() if name.startswith("x_")).shape
    states.update((f"z_{name}", np.zeros(shape)) for name in names)
    return states


def rcforc_branch(table, run):
    """Contact forces; side 0 is the slave surface, 1 the master surface."""
    ids = entities(table, "interface")
    states = with_z(by_instant(table, len(ids), RCFORC), "force")
    states["mass"] = np.zeros(states["x_force"].shape)
    return {"ids": ids, "side": (table["side"][:len(ids)] == "master").astype(int), **legend(ids, run.interface_titles())}, states


def nodout_branch(table, _):
    """Motion of nodes."""
    ids = entities(table, "node")
    states = with_z(by_instant(table, len(ids), NODOUT), "displacement", "velocity",
                    "acceleration", "coordinate")
    if "cycle" in table:
        states["cycle"] = table["cycle"].reshape(-1, len(ids))[:, 0]
    return {"ids": ids, **legend(ids, {int(number): "node" for number in ids})}, states


def matsum_branch(table, run):
    """Sums of parts."""
    ids = entities(table, "part")
    states = with_z(by_instant(table, len(ids), MATSUM), "momentum", "rbvelocity")
    mass = np.where(states["mass"] > 0.0, states["mass"], 1.0)
    for axis in "xy":
        states[f"{axis}_rbvelocity"] = states[f"{axis}_momentum"] / mass
    states["added_mass"] = optional(table, "added_mass").reshape(mass.shape)
    for name in ("eroded_kinetic_energy", "eroded_internal_energy"):
        states[name] = np.zeros(mass.shape)
    return {"ids": ids, **legend(ids, run.part_titles())}, states


def sleout_branch(table, run):
    """Energies of interfaces, one number each, and what of it friction has dissipated."""
    ids = entities(table, "interface")
    states = by_instant(table, len(ids), {"slave": "energy"})
    for part in ("damping", "friction"):
        if part in table:
            states["slave"] = states["slave"] + by_instant(table, len(ids), {"slave": part})["slave"]
    states["cycle"] = table["cycle"].reshape(-1, len(ids))[:, 0]
    states["friction_energy"] = optional(table, "friction").reshape(-1, len(ids))
    states["total_friction"] = states["friction_energy"].sum(axis=1)
    states["total_slave"] = states["total_energy"] = states["slave"].sum(axis=1)
    states["total_master"] = np.zeros(len(states["time"]))
    return {"ids": ids, "single_sided": np.ones(len(ids), dtype=int), **legend(ids, run.interface_titles())}, states


def spcforc_branch(table, _):
    """Forces of constraints on nodes, and their sums."""
    ids = entities(table, "node")
    states = with_z(by_instant(table, len(ids), RCFORC), "force")
    for axis in "xyz":
        states[f"{axis}_resultant"] = states[f"{axis}_force"].sum(axis=1)
    return {"force_ids": ids, "ids": ids}, states


def rwforc_branch(table, _):
    """Forces of rigid walls on the nodes."""
    ids = entities(table, "wall")
    return {"ids": ids}, with_z(by_instant(table, len(ids), RWFORC), "force")


def elout_branch(table, _):
    """Stress of elements: shells with one point through the thickness, as DYNA's 2D solids."""
    ids = entities(table, "element")
    states = by_instant(table, len(ids), ELOUT)
    zero = np.zeros(states["sig_xx"].shape)
    states["sig_yz"] = states["sig_zx"] = zero
    plastic = states["plastic_strain"] > 0.0
    gone = table["is_gone"].reshape(plastic.shape) > 0 if "is_gone" in table else zero > 0.0
    states["state"] = np.where(gone, 3, np.where(plastic, 2, 1))
    states["ids"] = np.broadcast_to(ids, zero.shape)
    states["nip"] = states["iop"] = np.ones(zero.shape, dtype=int)
    if "part" in table:
        states["mat"] = table["part"].reshape(zero.shape)
        states["cycle"] = table["cycle"].reshape(zero.shape)[:, 0]
    return {"states": ",".join(STATES), "system": "global", **legend(ids, {int(n): "shell" for n in ids})}, states


def with_totals(states, blocks):
    """The same with sums over blocks (slices) of the rows of an instant."""
    for name, total in (("x_force", "x_total"), ("y_force", "y_total"), ("z_force", "z_total"), ("energy", "etotal")):
        sums = np.stack([states[name][:, block].sum(axis=1) for block in blocks], axis=1)
        states[total] = sums if len(blocks) > 1 else sums[:, 0]
    return states


def bndout_branch(table):
    """Forces on boundaries of one condition, and their work."""
    ids = entities(table, "id")
    states = with_totals(with_z(by_instant(table, len(ids), FORCES), "force"), [slice(None)])
    if table["condition"][0] == 5:
        states["xmoment"] = states["ymoment"] = np.zeros(states["x_force"].shape)
        states["zmoment"] = table["moment"].reshape(states["x_force"].shape)
    return {"ids": ids}, states


def nodfor_branch(table, _):
    """Forces of groups of nodes; all groups behind each other."""
    nodes = entities(table, "node")
    states = with_z(by_instant(table, len(nodes), FORCES), "force")
    group = table["group"][:len(nodes)]
    starts = np.flatnonzero(np.diff(group, prepend=-1))
    sizes = np.diff([*starts, len(nodes)])
    blocks = [slice(start, start + size) for start, size in zip(starts, sizes)]
    return {"ids": nodes, "groups": sizes, "local": np.zeros(len(sizes), dtype=int)}, with_totals(states, blocks)


def secforc_branch(table, _):
    """Forces and moments of cross sections, in global axes."""
    ids = entities(table, "section")
    states = with_z(by_instant(table, len(ids), {**RCFORC, "x_centroid": "x", "y_centroid": "y", "area": "area"}),
                    "force", "centroid")
    states["x_moment"] = states["y_moment"] = np.zeros(states["area"].shape)
    states["z_moment"] = table["moment"].reshape(states["area"].shape)
    states["total_force"] = np.hypot(states["x_force"], states["y_force"])
    states["total_moment"] = np.abs(states["z_moment"])
    none = np.zeros(len(ids), dtype=int)
    return {"ids": ids, "rigidbody": none, "accelerometer": none, "coordinate_system": none}, states


def rbdout_branch(table, run):
    """Motion of rigid bodies; the directions are those of axes that turn with the body."""
    ids = entities(table, "part")
    states = {"time": table["time"].reshape(-1, len(ids))[:, 0]}
    shape = table["x"].reshape(-1, len(ids)).shape
    for name, columns in RBDOUT.items():
        for axis, column in zip("xyz", columns):
            states[name.format(axis)] = table[column].reshape(shape) if column else np.zeros(shape)
    for row in (1, 2, 3):
        for column in (1, 2, 3):
            states[f"dircos_{row}{column}"] = np.full(shape, float(row == column))
    angle = table["rotation"].reshape(shape)
    states["dircos_11"] = states["dircos_22"] = np.cos(angle)
    states["dircos_12"], states["dircos_21"] = -np.sin(angle), np.sin(angle)
    if "cycle" in table:
        states["cycle"] = table["cycle"].reshape(shape)[:, 0]
    return {"ids": ids, "num_nodal": 0, **legend(ids, run.part_titles())}, states


#: that of bndout is found by condition (`branches_of`)
FORMS = {"glstat": glstat_branch, "rcforc": rcforc_branch, "nodout": nodout_branch,
         "matsum": matsum_branch, "sleout": sleout_branch, "spcforc": spcforc_branch, "rwforc": rwforc_branch,
         "elout": elout_branch, "rbdout": rbdout_branch, "bndout": None, "nodfor": nodfor_branch,
         "secforc": secforc_branch}
