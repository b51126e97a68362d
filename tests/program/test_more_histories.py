# SPDX-License-Identifier: MIT
"""Histories of elements, rigid bodies, walls and boundaries: threads, restarts, and their text files against the CSV files."""
import re
import shutil
import subprocess

import h5py
import numpy as np
import pytest
from conftest import numbers
from erosion_decks import penetration
from history_decks import HISTORIES, busy_block
from impact_decks import plates
from meshes import Deck, grid
from axisymmetric_decks import rings

#: what a run that goes on tells of
GOING_ON = ("secforc", "bndout", "nodfor")


def files_of(folder):
    """Name -> bytes of all tables and text files of the histories."""
    found = {path.name: path.read_bytes() for name in HISTORIES + ("glstat",)
             for path in (folder / f"job.{name}.csv", folder / f"job.{name}")}
    assert len(found) == 2 * len(HISTORIES) + 2
    return found


@pytest.fixture(scope="module")
def whole(exe, tmp_path_factory):
    """A run on one thread that leaves a restart file halfway."""
    folder = tmp_path_factory.mktemp("busy")
    text = busy_block().text().rsplit("*END", 1)[0] + "*DATABASE_BINARY_D3DUMP\n70,\n*END\n"
    (folder / "job.k").write_text(text)
    done = subprocess.run([exe, "i=job.k", "d=whole"], capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert numbers(folder / "whole" / "job.glstat.csv", "cycle")[-1] > 120
    return folder / "whole"


def values(folder, name, *wanted):
    return np.column_stack([numbers(folder / f"job.{name}.csv", column) for column in wanted])


def same(printed, exact, digits):
    """Printed values are the exact ones rounded to so many digits behind the point."""
    printed, exact = np.asarray(printed, float), np.asarray(exact, float)
    assert printed.shape == exact.shape and printed.size > 0
    room = 0.501 * 10.0 ** -digits * 10.0 ** np.floor(np.log10(np.maximum(np.abs(exact), 1e-98)))
    assert np.all(np.abs(printed - exact) <= room + 1e-15 * np.abs(exact))


def test_threads_and_restart_write_the_same_bytes(whole, exe, tmp_path):
    expected = files_of(whole)
    (tmp_path / "job.k").write_bytes((whole.parent / "job.k").read_bytes())
    done = subprocess.run([exe, "i=job.k", "d=three", "ncpu=3", "perthread=1"], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert files_of(tmp_path / "three") == expected
    (tmp_path / "rest").mkdir()
    for name in ("job.dump01.h5", "job.vtkhdf"):
        shutil.copy(whole / name, tmp_path / "rest" / name)
    done = subprocess.run([exe, "r=rest/job.dump01.h5"], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert files_of(tmp_path / "rest") == expected


def test_binary_2_leaves_text_out(slideline, tmp_path):
    done = slideline("d=out", "endtim=1e-3", deck=busy_block(binary="2"))
    assert done.returncode == 0, done.stderr
    for name in HISTORIES:
        assert (tmp_path / "out" / f"job.{name}.csv").exists() and not (tmp_path / "out" / f"job.{name}").exists()


def test_elout(whole):
    lines = (whole / "job.elout").read_text().splitlines()
    heads = [line for line in lines if line.startswith(" e l e m e n t   s t r e s s   c a l c u l a t i o n s   f o r   t i m e  s t e p")]
    table = values(whole, "elout", "time", "element", "sxx", "syy", "szz", "sxy", "plastic_strain")
    order = [96, 2, 1, 3]
    assert table[:4, 1].astype(int).tolist() == order
    same([re.search(r"\( at time\s*(\S+) \)", line)[1] for line in heads], table[::4, 0], 5)
    ids = [re.fullmatch(r"\s*(\d+)-\s*(\d+)", line) for line in lines]
    rows = [(int(found[1]), *lines[k + 1][17:].split()) for k, found in enumerate(ids) if found]
    assert all(found[2] == "1" for found in ids if found)
    assert [row[0] for row in rows] == table[:, 1].astype(int).tolist()
    same([row[1:5] for row in rows], table[:, 2:6], 4)
    same([row[7] for row in rows], table[:, 6], 4)
    states = [lines[k + 1][9:17].strip() for k, found in enumerate(ids) if found]
    assert [state == "plastic" for state in states] == (table[:, 6] > 0.0).tolist()
    assert {"plastic", "elastic"} == set(states)


def test_elout_is_the_cell_fields(whole):
    with h5py.File(whole / "job.vtkhdf") as stream:
        times = stream["VTKHDF/Steps/Values"][()]
        stress = stream["VTKHDF/CellData/stress"][()].reshape(len(times), -1, 6)
        strain = stream["VTKHDF/CellData/plastic_strain"][()].reshape(len(times), -1)
    table = values(whole, "elout", "time", "element", "sxx", "syy", "szz", "sxy", "plastic_strain")
    for state, time in enumerate(times):
        rows = table[table[:, 0] == time]
        cells = rows[:, 1].astype(int) - 1
        assert len(rows) == 4
        assert np.array_equal(rows[:, 2:6], stress[state, cells, :4])
        assert np.array_equal(rows[:, 6], strain[state, cells])


def test_rbdout(whole):
    lines = (whole / "job.rbdout").read_text().splitlines()
    table = values(whole, "rbdout", "time", "part", "x", "y", "ux", "uy", "rotation", "vx", "vy", "spin", "ax", "ay", "spin_rate")
    heads = [re.match(r"  r i g i d   b o d y   m o t i o n   a t  cycle=\s*(\d+)\s+time=\s*(\S+)", line) for line in lines]
    same([found[2] for found in heads if found], table[::2, 0], 6)
    starts = [k for k, line in enumerate(lines) if line.startswith(" rigid body")]
    assert [int(lines[k].split()[-1]) for k in starts] == table[:, 1].astype(int).tolist() and set(table[:, 1]) == {2, 3}
    same([lines[k + 2].split()[1:3] for k in starts], table[:, 2:4], 4)
    for line, first in ((3, 4), (4, 7), (5, 10)):
        rows = np.array([lines[k + line].split()[1:] for k in starts], float)
        same(rows[:, [0, 1, 5]], table[:, first:first + 3], 4)
        assert not np.any(rows[:, 2:5])
    # Local axes turn with the body.
    turned = np.array([[float(lines[k + 9].split()[2]), float(lines[k + 10].split()[2])] for k in starts])
    assert np.allclose(turned, np.column_stack([np.cos(table[:, 6]), np.sin(table[:, 6])]), atol=1e-4)
    assert np.abs(table[-1, 6]) > 1.0e-3 and np.abs(table[-2, 6]) > 1.0e-2
    local = np.array([lines[k + 16].split()[1:3] for k in starts], float)
    along = np.column_stack([np.sum(turned * table[:, 7:9], axis=1),
                             turned[:, 0] * table[:, 8] - turned[:, 1] * table[:, 7]])
    assert np.allclose(local, along, atol=2e-4)


def sections_of(lines, head):
    """Time and rows (id, fx, fy, energy) of each block of a file of forces, and its sums."""
    found = []
    for line in lines:
        if line.startswith(head):
            found.append([float(line.split("t=")[1]), [], []])
        elif re.match(r"( nd#| mt#|mat#)", line):
            numbers_of = re.findall(r"=\s*(\S+)", line)
            found[-1][1].append((int(line[4:12]), float(numbers_of[0]), float(numbers_of[1]), float(numbers_of[3])))
        elif "xtotal=" in line:
            numbers_of = re.findall(r"=\s*(\S+)", line)
            found[-1][2].append([float(numbers_of[k]) for k in (0, 1, 3)])
    return found


def test_bndout(whole):
    lines = (whole / "job.bndout").read_text().splitlines()
    table = values(whole, "bndout", "time", "condition", "id", "fx", "fy", "work", "moment")
    assert [int(row) for row in table[:10, 1]] == [1, 2, 3, 3, 3, 3, 4, 4, 4, 5]
    found = sections_of(lines, " n o d a l   f o r c e/e n e r g y    o u t p u t  t=")
    assert len(found) == 3 * len(table) / 10
    rows = np.array([row for block in found for row in block[1]])
    assert np.array_equal(rows[:, 0], table[:, 2])
    same(rows[:, 1:], table[:, 3:6], 4)
    ends = np.cumsum([len(block[1]) for block in found])
    sums = np.array([table[last - len(block[1]):last, 3:6].sum(axis=0) for last, block in zip(ends, found)])
    assert np.allclose([block[2][0] for block in found], sums, rtol=1e-4, atol=1e-12)
    moments = [float(re.findall(r"=\s*(\S+)", line)[2]) for line in lines if "zmoment=" in line]
    same(moments, table[table[:, 1] == 5, 6], 4)
    assert np.all(np.any(np.abs(table[10:].reshape(-1, 10, 7)[:, :, 3:]) > 0.0, axis=(0, 2)))


def test_nodfor(whole):
    lines = (whole / "job.nodfor").read_text().splitlines()
    table = values(whole, "nodfor", "time", "group", "node", "fx", "fy", "work")
    n = 3 + 9
    assert [int(group) for group in table[:n, 1]] == 3 * [3] + 9 * [4]
    found = sections_of(lines, " n o d a l   f o r c e   g r o u p    o u t p u t  t=")
    assert len(found) == len(table) / n
    rows = np.array([row for block in found for row in block[1]])
    assert np.array_equal(rows[:, 0], table[:, 2])
    same(rows[:, 1:], table[:, 3:], 4)
    blocks = table.reshape(-1, n, 6)
    assert np.allclose([block[2] for block in found], [[b[:3, 3:].sum(axis=0), b[3:, 3:].sum(axis=0)] for b in blocks],
                       rtol=1e-4, atol=1e-6)
    assert lines.count(" nodal group output number  2") == len(found)


def test_secforc(whole):
    lines = (whole / "job.secforc").read_text().splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith(" line#3")) + 2
    table = values(whole, "secforc", "section", "time", "fx", "fy", "moment", "x", "y", "area")
    assert table[:2, 0].tolist() == [1.0, 2.0] and len(lines) == start + 4 * len(table)
    rows = [[line.split() for line in lines[k:k + 3]] for k in range(start, len(lines), 4)]
    assert [int(row[0][0]) for row in rows] == table[:, 0].astype(int).tolist()
    same([row[0][1:] for row in rows], np.column_stack([table[:, 1:4], 0.0 * table[:, 0], np.hypot(table[:, 2], table[:, 3])]), 4)
    same([row[1][2:] for row in rows], np.column_stack([table[:, 4], np.abs(table[:, 4])]), 4)
    same([row[2] for row in rows], np.column_stack([table[:, 5:7], 0.0 * table[:, 0], table[:, 7]]), 4)
    assert np.all(np.abs(table[-2:, 2:]) > 0.0)


def test_works_add_up_to_the_external_work(whole):
    """Of this run: all that acts but the wall, whose work rwforc has."""
    table = values(whole, "bndout", "work").reshape(-1, 10)
    wall = values(whole, "rwforc", "work", "friction")
    work = numbers(whole / "job.glstat.csv", "external_work")
    assert table.sum(axis=1) + wall[:, 0] == pytest.approx(work, rel=1e-11, abs=1e-12 * np.abs(work).max())
    assert np.abs(work).max() > 0.1


def test_rwforc(whole):
    lines = (whole / "job.rwforc").read_text().splitlines()
    head = lines.index("    time       wall#   normal-force    x-force        y-force        z-force")
    rows = np.array([line.split() for line in lines[head + 1:]], float)
    table = values(whole, "rwforc", "time", "wall", "normal_force", "fx", "fy")
    same(rows[:, 0], table[:, 0], 5)
    assert np.array_equal(rows[:, 1], table[:, 1])
    same(rows[:, 2:5], table[:, 2:5], 6)
    assert table[:, 2].max() > 100.0


def bar_in_tension(method, asked):
    """A plastic bar under forces at its end, pressure and motion of a node that begins and ends; a section across it, and
    one with elements at both of its sides; a group of nodes. Explicit: it is thrown, and beside it a rigid body is pulled and
    one is moved. Rows come in every other step."""
    implicit = method != "explicit"
    deck = Deck("bar").control(1.0 if implicit else 0.02, dt=None if implicit else 1.0e-4)
    deck.part(points=4).plastic(1000.0, 1.0e6, 0.3, 2.0e3, 1.0e5)
    nodes = deck.mesh(*grid(12, 4, 1.2, 0.4))
    end = 1.0 if implicit else 0.02
    deck.fix(nodes[::13], x=1, y=1).curve(1, [(0.0, 0.0), (end, 1.0)]).curve(2, [(0.0, 0.0), (end, 0.002)])
    deck.add("*LOAD_NODE_POINT", *[(int(node), 1, 1, 150.0) for node in nodes[12::13]])
    deck.add("*LOAD_SEGMENT", *[(1, 80.0, 0.0, int(b), int(a)) for a, b in zip(nodes[-13:], nodes[-12:-8])])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", (int(nodes[4]), 2, 2, 2, -1.0, 0, 0.75 * end, 0.25 * end))
    deck.node_set(3, nodes[6::13]).add("*SET_SHELL_LIST", (3,), (7, 19, 31, 43))
    deck.node_set(4, nodes[6:7]).add("*SET_SHELL_LIST", (4,), (7, 6))
    deck.add("*DATABASE_CROSS_SECTION_SET", (3, 0, 0, 3), (4, 0, 0, 4)).add("*DATABASE_NODAL_FORCE_GROUP", (3, 0))
    if asked:
        deck.add(more_histories(method))
    if not implicit:
        deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), 1.0, 2.0) for node in nodes if (node - 1) % 13])
        for part in (2, 3):
            deck.part(part).add("*MAT_RIGID", (part, 3000.0, 1.0e6, 0.3), (0.0,), (0.0,))
            deck.mesh(*grid(1, 1, 0.2, 0.2, (part, 0.0)), part=part)
        deck.add("*LOAD_RIGID_BODY", (2, 1, 1, 500.0)).add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", (3, 2, 0, 1, 3.0))
    if implicit:
        deck.add("*CONTROL_IMPLICIT_GENERAL", (1, 0.05)).add("*CONTROL_IMPLICIT_SOLUTION", (12, 0, 30, 0.0, 1.0e-22))
    if method == "dynamic":
        deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1, 0.6, 0.38))
    return deck.add("*DATABASE_BINARY_D3DUMP", (3 if implicit else 50,)).text()


def more_histories(method):
    """The keywords that ask for them."""
    interval = 2.0e-3 if method == "explicit" else 0.1
    return "\n".join(f"*DATABASE_{name.upper()}\n{interval}," for name in GOING_ON)


def rows_of(path):
    """The rows of a table but for the works, and the works."""
    header, *rows = (line.split(",") for line in path.read_text().splitlines())
    work = header.index("work") if "work" in header else None
    return [[value for k, value in enumerate(row) if k != work] for row in rows], np.array(
        [float(row[work]) for row in rows if work is not None])


@pytest.mark.parametrize("method", ("static", "dynamic", "explicit"))
def test_a_run_that_goes_on_has_the_same_rows(exe, tmp_path, method):
    """Asked for from the start, from a state without rows and one with them: the same bytes. Asked for only then: the same rows
    from there on, with works that begin at 0."""
    def go(*arguments):
        done = subprocess.run([exe, *arguments], capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stderr

    for name, asked in (("whole", True), ("without", False)):
        (tmp_path / "job.k").write_text(bar_in_tension(method, asked))
        go("i=job.k", f"d={name}")
    assert not (tmp_path / "without" / "job.secforc.csv").exists()
    (tmp_path / "more.k").write_text(f"*KEYWORD\n{more_histories(method)}\n*END\n")
    for dump in ("job.dump01.h5", "job.dump02.h5"):
        (tmp_path / "rest").mkdir()
        shutil.copy(tmp_path / "whole" / dump, tmp_path / "rest")
        go(f"r=rest/{dump}")
        for name in GOING_ON:
            assert (tmp_path / "rest" / f"job.{name}.csv").read_bytes() == (tmp_path / "whole" / f"job.{name}.csv").read_bytes()
        shutil.rmtree(tmp_path / "rest")
    go("r=without/job.dump02.h5", "i=more.k")
    for name in GOING_ON:
        expected, works = rows_of(tmp_path / "whole" / f"job.{name}.csv")
        late, late_works = rows_of(tmp_path / "without" / f"job.{name}.csv")
        assert 10 < len(late) < len(expected) and late == expected[-len(late):]
        if name == "bndout":
            assert {int(row[1]) for row in late} == ({1, 2, 3, 4, 5} if method == "explicit" else {1, 3, 4})
        if len(works):
            rows = len(late) // len({row[0] for row in late})
            since = works[-len(late):] - np.tile(works[-len(late):][:rows], len(late) // rows)
            assert late_works == pytest.approx(since, abs=1e-13 * np.abs(works).max()) and np.abs(late_works).max() > 0.0


def with_sections(text, implicit=False):
    """A deck with a section that every element of its mesh is cut by, reported in each cycle, and the same without it."""
    nodes, shells = (max(int(line.split(",")[0]) for block in re.findall(rf"^\*{name}\n([^*]*)", text, re.M)
                         for line in block.split()) for name in ("NODE", "ELEMENT_SHELL"))
    deck = Deck("").add("*SET_NODE_LIST_GENERATE", (91,), (1, nodes)).add("*SET_SHELL_LIST_GENERATE", (92,), (1, shells))
    plain = re.sub(r"\*DATABASE_[A-Z]*\n.*\n", "", text).rsplit("*END", 1)[0] + "*DATABASE_GLSTAT\n1e-12,\n*DATABASE_MATSUM\n1e-12,\n"
    cards = "\n".join(deck.add("*DATABASE_CROSS_SECTION_SET", (91, 0, 0, 92)).lines[3:])
    return plain + "*END\n", f"{plain}{cards}\n*DATABASE_SECFORC\n1e-12,\n*END\n"


@pytest.mark.parametrize("scene", ("plates", "plates, four points", "rings", "erosion"))
def test_telling_of_sections_changes_nothing(exe, tmp_path, scene):
    """Elements of all laws and forms are what they were before their forces were asked for."""
    text = {"plates": lambda: plates(2, n=9, end=2.4e-6), "plates, four points": lambda: plates(2, n=9, end=2.4e-6, points=4),
            "rings": lambda: rings(2, n=11, end=0.012), "erosion": lambda: penetration(2, n=4, end=30.0e-6)}[scene]()
    if scene == "rings":
        text = text.replace("*CONTROL_HOURGLASS\n2,0.1\n", "*CONTROL_HOURGLASS\n4,0.1\n*DAMPING_PART_STIFFNESS\n1,0.05\n")
        assert "STIFFNESS" in text
    tables = []
    for name, deck in zip(("without", "with"), with_sections(text)):
        (tmp_path / "job.k").write_text(deck)
        done = subprocess.run([exe, "i=job.k", f"d={name}"], capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        tables.append([(tmp_path / name / f"job.{table}.csv").read_bytes() for table in ("glstat", "matsum")])
    assert tables[0] == tables[1]
    rows = values(tmp_path / "with", "secforc", "fx", "fy")
    assert len(rows) == len(numbers(tmp_path / "with" / "job.glstat.csv", "time")) > 15 and np.abs(rows).max() > 0.0
    if scene == "erosion":
        assert numbers(tmp_path / "with" / "job.glstat.csv", "eroded")[-1] > 0.0
