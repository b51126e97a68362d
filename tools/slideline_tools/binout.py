# SPDX-License-Identifier: MIT
"""Write DYNA's binout from the history tables of a run.

    from slideline_tools.binout import write_binout
    write_binout("results/collision", "binout0000")

Energies, forces and masses are those of the tables, per unit depth.
"""
import numpy as np

from slideline_tools import UserError, __version__
from slideline_tools.finished_run import Run
from slideline_tools.histories import History
from slideline_tools.lsda import Writer

#: variable in binout -> column of the table
GLSTAT = {"time": "time", "cycle": "cycle", "time_step": "dt", "kinetic_energy": "kinetic",
          "hourglass_energy": "hourglass", "system_damping_energy": "damping",
          "sliding_interface_energy": "contact", "external_work": "external_work",
          "total_energy": "total", "energy_ratio": "energy_ratio",
          "global_x_velocity": "velocity_x", "global_y_velocity": "velocity_y"}
RCFORC = {"x_force": "fx", "y_force": "fy"}
NODOUT = {"x_displacement": "ux", "y_displacement": "uy", "x_velocity": "vx", "y_velocity": "vy",
          "x_acceleration": "ax", "y_acceleration": "ay", "x_coordinate": "x", "y_coordinate": "y"}
MATSUM = {"kinetic_energy": "kinetic", "internal_energy": "internal", "hourglass_energy": "hourglass",
          "x_momentum": "momentum_x", "y_momentum": "momentum_y", "mass": "mass"}
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
    with Writer(path) as file:
        for name, table in tables.items():
            metadata, states = FORMS[name](table, run)
            write_branch(file, name, {"title": run.title[:80].ljust(80), **metadata}, states)
    return list(tables)


def write_branch(file, name, metadata, states):
    """One branch: its metadata, and a directory of each state (dicts of arrays by state)."""
    version = f"slideline {__version__}"
    for key, value in {"version": version[:10].ljust(10), "date": " " * 10, **metadata}.items():
        file.write(f"/{name}/metadata", key, value)
    for k in range(len(states["time"])):
        for key, values in states.items():
            file.write(f"/{name}/d{k + 1:06d}", key, values[k])


def glstat_branch(table, _):
    """Energies; the work of the bulk viscosity counts as internal energy, as in DYNA."""
    states = {name: table[column] for name, column in GLSTAT.items() if column in table}
    states["internal_energy"] = table["internal"] + table["viscous"]
    if "friction" in table:
        states["sliding_interface_energy"] = table["contact"] + table["friction"]
    zero = np.zeros(len(table))
    for name in ("spring_and_damper_energy", "eroded_kinetic_energy", "eroded_internal_energy",
                 "eroded_hourglass_energy", "global_z_velocity"):
        states[name] = zero
    states["energy_ratio_wo_eroded"] = table["energy_ratio"]
    states["nzc"] = np.zeros(len(table), dtype=int)
    if "element" in table and np.all(table["element"] > 0):
        states["ts_eltype"] = np.ones(len(table), dtype=int)
        states["ts_element"], states["ts_part"] = table["element"], table["element_part"]
    return {"element_types": "shell"}, states


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


def rcforc_branch(table, _):
    """Contact forces; side 0 is the slave surface, 1 the master surface."""
    ids = entities(table, "interface")
    states = with_z(by_instant(table, len(ids), RCFORC), "force")
    states["mass"] = np.zeros(states["x_force"].shape)
    return {"ids": ids, "side": (table["side"][:len(ids)] == "master").astype(int)}, states


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
    for name in ("eroded_kinetic_energy", "eroded_internal_energy"):
        states[name] = np.zeros(mass.shape)
    return {"ids": ids, **legend(ids, run.part_titles())}, states


def sleout_branch(table, _):
    """Energies of interfaces, one number each."""
    ids = entities(table, "interface")
    states = by_instant(table, len(ids), {"slave": "energy"})
    for part in ("damping", "friction"):
        if part in table:
            states["slave"] = states["slave"] + by_instant(table, len(ids), {"slave": part})["slave"]
    states["cycle"] = table["cycle"].reshape(-1, len(ids))[:, 0]
    states["total_slave"] = states["total_energy"] = states["slave"].sum(axis=1)
    states["total_master"] = np.zeros(len(states["time"]))
    return {"ids": ids, "single_sided": np.ones(len(ids), dtype=int)}, states


def spcforc_branch(table, _):
    """Forces of constraints on nodes, and their sums."""
    ids = entities(table, "node")
    states = with_z(by_instant(table, len(ids), RCFORC), "force")
    for axis in "xyz":
        states[f"{axis}_resultant"] = states[f"{axis}_force"].sum(axis=1)
    return {"force_ids": ids, "ids": ids}, states


FORMS = {"glstat": glstat_branch, "rcforc": rcforc_branch, "nodout": nodout_branch,
         "matsum": matsum_branch, "sleout": sleout_branch, "spcforc": spcforc_branch}
