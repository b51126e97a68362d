# SPDX-License-Identifier: MIT
"""Write the d3plot family from the states of a run, for LS-PrePost, lasso-python and VTK.

    from slideline_tools.d3plot import write_d3plot
    write_d3plot("results/collision", "d3plot")        # d3plot, d3plot01, ...

Single precision, as in DYNA. Elements are 2D solids, which d3plot stores among the shells: the stress and plastic strain of
the element stand at each of three through-thickness points, as DYNA writes them. Where elements may leave the mesh, each
state ends with the deletion table.

Written here and not by lasso-python: of the same arrays that makes a family which VTK's reader refuses (version word 0).
"""
import pathlib

import numpy as np

from slideline_tools import UserError
from slideline_tools.effective_deck import part_titles
from slideline_tools.files import output
from slideline_tools.finished_run import Run

N_HEADER, N_ID_HEADER = 64, 16
N_POINT = 3                      # points through the thickness
TITLE_WORDS, PART_TITLE = 10, 72
END_MARK = np.array([-999999.0], dtype="<f4").tobytes()
PART_TITLES = 90001              # kind of the block of part titles
#: bytes of states in one file of the family
FILE_LIMIT = 1 << 30
#: MAXINT is minus (points through the thickness plus this) where states end with a deletion table of elements (MDLOPT 2)
DELETION_TABLE = 10000


def write_d3plot(run, path, file_limit=FILE_LIMIT):
    """Write the states of a run (folder, results file, or `Run`) to the family `path`, `path`01 ...; number of states."""
    run = run if isinstance(run, Run) else Run(run)
    if run.results is None or not run.results.n_state:
        raise UserError(f"{run.prefix} has no states: the deck asks for none (*DATABASE_BINARY_D3PLOT)")
    path = pathlib.Path(path)
    parts = np.unique(run.results.cell_field("part_id")[0])
    output(path, run.files()).write_bytes(geometry(run, parts))
    states = (state_words(run.results, k, globals_of) for k, globals_of in
              enumerate(global_values(run, parts)))
    count, last = write_states(path, states, file_limit)
    remove_rest(path, last + 1)
    return count


def member(path, number):
    """File of the family that holds states."""
    return pathlib.Path(f"{path}{number:02d}")


def remove_rest(path, number):
    """Remove what follows of a longer earlier family, up to its first gap: readers take all that follow."""
    while member(path, number).is_file():
        member(path, number).unlink()
        number += 1


def geometry(run, parts):
    """The first file: header, mesh, ids and titles."""
    results = run.results
    start = results.points[0] - padded(results.point_field("displacement")[0])
    index = np.searchsorted(parts, results.cell_field("part_id")[0]) + 1
    cells = np.column_stack([results.cells + 1, index])
    blocks = [header(results, parts, run.title), reals(start), integers(cells),
              ids(results, parts), END_MARK, titles(run, parts), END_MARK]
    return b"".join(blocks)


def header(results, parts, title):
    """The 64 words that say what follows; those of it and ia are 0."""
    words = np.zeros(N_HEADER + 1, dtype="<i4")  # numbered from 1
    words[1:TITLE_WORDS + 1] = np.frombuffer(ascii_text(title, 4 * TITLE_WORDS), dtype="<i4")
    maxint = -(DELETION_TABLE + N_POINT) if erodes(results) else N_POINT
    narbs = N_ID_HEADER + results.n_node + results.n_cell + 3 * len(parts)
    version = np.array([971.0], dtype="<f4").view("<i4")[0]
    for number, _, value in (
            (12, "file type", 1), (15, "version", version), (16, "ndim", 4), (17, "numnp", results.n_node), (18, "icode", 6),
            (19, "nglbv", 6 + 7 * len(parts)), (21, "iu", 1), (22, "iv", 1), (32, "nel4", results.n_cell),
            (33, "nummat4", len(parts)), (34, "nv2d", 7 * N_POINT), (37, "maxint", maxint), (40, "narbs", narbs),
            (44, "ioshl1", 1000), (45, "ioshl2", 1000), (46, "ioshl3", 999), (47, "ioshl4", 999), (52, "nmmat", len(parts))):
        words[number] = value
    return words[1:].tobytes()


def erodes(results):
    """Whether elements of the run may leave the mesh."""
    return "eroded" in results.cell_fields


def ids(results, parts):
    """User ids of nodes, elements and parts."""
    head = np.zeros(N_ID_HEADER, dtype=int)
    head[0], head[5], head[8] = -1, results.n_node, results.n_cell
    head[13] = head[15] = len(parts)
    order = np.arange(1, len(parts) + 1)
    return integers(np.concatenate([head, results.point_field("node_id")[0],
                                    results.cell_field("element_id")[0], parts, order, parts]))


def titles(run, parts):
    """Titles of the parts."""
    known = part_titles(run.deck)
    names = b"".join(integers([part]) + ascii_text(known.get(int(part)) or f"part {part}", PART_TITLE)
                     for part in parts)
    return integers([PART_TITLES, len(parts)]) + names


def global_values(run, parts):
    """For each state kinetic, internal and total energy, mean velocity, and the sums of parts, from
    the rows of the history tables at the time of the state; 0 where there is none."""
    tables, n = run.tables_for_dyna(), len(parts)
    for time in run.results.times:
        values = np.zeros(6 + 7 * n)
        whole = row_at(tables.get("glstat"), time)
        values[:5] = [whole.get(name, 0.0) for name in ("kinetic", "internal", "total",
                                                        "velocity_x", "velocity_y")]
        for k, part in enumerate(parts):
            row = row_at(tables.get("matsum"), time, part)
            for block, name in ((0, "internal"), (1, "kinetic"), (5, "mass"), (6, "hourglass")):
                values[6 + block * n + k] = row.get(name, 0.0)
            for axis, name in enumerate(("momentum_x", "momentum_y")):
                values[6 + 2 * n + 3 * k + axis] = row.get(name, 0.0) / (row.get("mass") or 1.0)
        yield values


def row_at(table, time, part=None):
    """The row of a table at a time (and of a part) by names, empty where there is none."""
    if table is None or not len(table):
        return {}
    near = np.abs(table["time"] - time) <= 1.0e-9 * max(abs(table["time"][-1]), abs(time))
    if part is not None:
        near &= table["part"] == part
    rows = np.flatnonzero(near)
    return {name: column[rows[-1]] for name, column in table.columns.items()} if len(rows) else {}


def state_words(results, k, global_row):
    """One state: time, sums, coordinates, velocities, stress and plastic strain, and which elements are alive (0: gone)."""
    stress = results.cell_field("stress")[k]
    point = np.column_stack([stress[:, :6], results.cell_field("plastic_strain")[k]])
    alive = 1.0 - results.cell_field("eroded")[k] if erodes(results) else []
    return b"".join([reals([results.times[k]]), reals(global_row), reals(results.points[k]),
                     reals(padded(results.point_field("velocity")[k])),
                     reals(np.tile(point, (1, N_POINT))), reals(alive)])


def write_states(path, states, file_limit):
    """The states into `path`01 and so on, each file closed by its mark; number of states and of
    files."""
    files, written = [], file_limit + 1
    for count, state in enumerate(states, start=1):
        if written + len(state) > file_limit:
            files.append(output(member(path, len(files) + 1)))
            written = 0
        with open(files[-1], "ab") as stream:
            stream.write(state)
        written += len(state)
    for file in files:
        with open(file, "ab") as stream:
            stream.write(END_MARK)
    return count, len(files)


def padded(values):
    """(n, 3): vectors with a z component."""
    return values if values.shape[1] == 3 else np.pad(values, ((0, 0), (0, 3 - values.shape[1])))


def reals(values):
    """Bytes of single precision numbers."""
    return np.asarray(values, dtype="<f4").tobytes()


def integers(values):
    """Bytes of 4-byte integers."""
    return np.asarray(values, dtype="<i4").tobytes()


def ascii_text(text, size):
    """`size` bytes of text, filled with blanks."""
    return text.encode("ascii", "replace")[:size].ljust(size)
