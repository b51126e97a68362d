# SPDX-License-Identifier: MIT
"""Decks of OpenRadioss for blocks of plane quads, its runs and the histories that it writes.

Its plane is y-z (plane strain: N2D3D 2), so our x is its y and our y its z. The program comes as source: whoever has
built it names its two programs by OPENRADIOSS_STARTER and OPENRADIOSS_ENGINE; what else they need, such as
RAD_CFG_PATH, is taken from the environment.
"""
import os
import pathlib
import resource
import struct
import subprocess

import numpy as np

PROGRAMS = ("OPENRADIOSS_STARTER", "OPENRADIOSS_ENGINE")
ONE_POINT, FOUR_POINTS = 2, 17  # ISOLID
SMALL, LARGE = 1, 4             # ISMSTR: strain
LONG_HEADS = 3050               # the first version of histories with lengths of titles and units in the head


def programs():
    """Paths of the starter and of the engine, or None where none is set."""
    found = [os.environ.get(name) for name in PROGRAMS]
    return found if all(found) else None


def whole(*values):
    """Integers, ten columns each; None leaves them blank."""
    return "".join(f"{'' if value is None else value:>10}" for value in values)


def real(*values):
    """Reals, twenty columns each."""
    return "".join(f"{value:20.12E}" for value in values)


class Deck:
    """Cards of the starter; `name` is that of the run and of its files."""

    def __init__(self, name):
        self.name = name
        units = "".join(f"{unit:>20}" for unit in ("kg", "m", "s"))
        self.lines = ["#RADIOSS STARTER", "/BEGIN", name, whole(2023, 0), units, units, "/ANALY", whole(2, None, 2)]

    def card(self, keyword, *lines):
        """A keyword with its lines; the title that most have is among them."""
        self.lines += [keyword, *lines]

    def elastic(self, number, density, young, poisson):
        self.card(f"/MAT/ELAST/{number}", "elastic", real(density), real(young, poisson))

    def solid(self, number, points, strain):
        """Property of quads: without bulk viscosity (0 would mean the default)."""
        self.card(f"/PROP/SOLID/{number}", "quads", whole(points, strain, 0, 0, 0, 0, 0, 0) + real(0.0),
                  real(1.0e-20, 1.0e-20, 0.0, 0.0, 0.0), real(0.0))

    def block(self, part, points, quads, first_node, first_quad, prop=1, material=1):
        """A part of quads: places (n, 2) and nodes (m, 4) from 0, counter-clockwise."""
        self.card(f"/PART/{part}", "block", whole(prop, material, 0))
        self.card("/NODE", *(f"{number:>10}" + real(0.0, *place)
                             for number, place in enumerate(np.asarray(points).tolist(), first_node)))
        self.card(f"/QUAD/{part}", *(whole(number, *nodes) for number, nodes
                                     in enumerate((np.asarray(quads) + first_node).tolist(), first_quad)))

    def nodes(self, number, nodes):
        """A group of nodes."""
        nodes = [int(node) for node in nodes]
        self.card(f"/GRNOD/NODE/{number}", "nodes", *(whole(*nodes[k:k + 10]) for k in range(0, len(nodes), 10)))

    def held(self, number, group, code):
        """Hold directions of a group: 1 for each of x, y, z and the turns about them."""
        self.card(f"/BCS/{number}", "held", f"   {code[:3]} {code[3:]}" + whole(0, group))

    def velocity(self, number, group, v_x, v_y):
        """That of a group at the start, in our axes."""
        self.card(f"/INIVEL/TRA/{number}", "start", real(0.0, v_x, v_y) + whole(group, 0))

    def surface(self, number, segments):
        """Segments of two nodes each."""
        self.card(f"/SURF/SEG/{number}", "surface",
                  *(whole(k, a, b) for k, (a, b) in enumerate(np.asarray(segments).tolist(), 1)))

    def one_pass(self, number, slave_group, master, factor):
        """INTER/TYPE5: springs between nodes and a surface, `factor` times the bulk modulus of a square quad."""
        self.card(f"/INTER/TYPE5/{number}", "contact", whole(slave_group, master) + " " * 40 + whole(0, 0),
                  real(factor, 0.0, 0.0, 0.0, 0.0), " " * 7 + "000" + " " * 10 + whole(0, 0),
                  whole(0, 0) + real(0.0) + " " * 10 + whole(0) + real(0.0))

    def history(self, number, kind, objects, names):
        """What is written of nodes or parts."""
        self.card(f"/TH/{kind}/{number}", "history", "".join(f"{name:<10}" for name in names),
                  *(whole(one, 0) if kind == "NODE" else whole(one) for one in objects))

    def write(self, folder, step, steps):
        """Both files: so many steps of one size, and one more, in which histories get the end of those; they hold the start too."""
        end = (steps + 0.5) * step
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{self.name}_0000.rad").write_text("\n".join([*self.lines, "/END", ""]), encoding="ascii")
        (folder / f"{self.name}_0001.rad").write_text("\n".join([
            "#RADIOSS ENGINE", f"/RUN/{self.name}/1", f"{end:.14E}", "/VERS/2023", "/DT/QUAD", "0.9 0.", "/DTIX",
            f"{step:.14E} {step:.14E}", "/TFILE/1", f"{end - step:.14E}", f"/PRINT/-{10 * steps}", "/PARITH/OFF",
            "/MON/OFF", "/RFILE", f"{10 * steps}", ""]), encoding="ascii")


def start(deck_name, folder):
    """Run the starter, which leaves the file that the engine goes on from."""
    call([programs()[0], "-i", f"{deck_name}_0000.rad", "-nt", "1"], folder, f"{deck_name}_0000_0001.rst")


def command(deck_name):
    """The engine on a deck that the starter has read, to be run in its folder."""
    return [programs()[1], "-i", f"{deck_name}_0001.rad", "-nt", "1"]


def run(deck_name, folder):
    """Processor seconds of the engine, and the histories."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    call(command(deck_name), folder, f"{deck_name}T01")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
            read_histories(pathlib.Path(folder) / f"{deck_name}T01"))


def call(words, folder, leaves):
    """Run one of the programs; what it is to leave must be there and be new."""
    left = pathlib.Path(folder) / leaves
    left.unlink(missing_ok=True)
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode or not left.exists():
        raise SystemExit(f"{' '.join(map(str, words))}: status {done.returncode}, {left} "
                         f"{'is' if left.exists() else 'is not'} there\n{done.stdout[-2000:]}{done.stderr[-2000:]}")


def records(data):
    """Records of a sequential file of Fortran."""
    at = 0
    while at + 8 <= len(data):
        (size,) = struct.unpack_from("<i", data, at)
        if at + 8 + size > len(data):
            return
        yield data[at + 4:at + 4 + size]
        at += 8 + size


def integers(record):
    return np.frombuffer(record, "<i4")


def read_histories(path):
    """{("NODE" or "PART", number, variable): values}, and "time"; variables are numbers of the program's own.

    Behind the head come lists of what is written, then for each time a record of global values, one of the parts and one
    of each group (/TFILE/1: reals of eight bytes, /TH of nodes).
    """
    found = list(records(path.read_bytes()))
    take = iter(found[2 if integers(found[0][:4])[0] < LONG_HEADS else 5:])
    n_part, n_material, n_property, n_subset, n_group, n_global = integers(next(take))[:6].tolist()
    if n_subset > 1:
        raise SystemExit(f"{path}: {n_subset} subsets, one is understood")
    if n_global:
        next(take)
    columns = [[]]  # keys of the record of parts and of those of groups
    for _ in range(n_part):
        head = next(take)
        number, n_variable = int(integers(head[:4])[0]), int(integers(head[-4:])[0])
        columns[0] += [("PART", number, int(name)) for name in integers(next(take))] if n_variable else []
    for _ in range(n_material + n_property):
        next(take)
    for _ in range(n_subset):
        for count in integers(next(take))[2:5].tolist():
            if count:
                next(take)
    for _ in range(n_group):
        _, _, _, n_object, n_variable = integers(next(take)[:20]).tolist()
        numbers = [int(integers(next(take)[:4])[0]) for _ in range(n_object)]
        names = [int(name) for name in integers(next(take))] if n_variable else []
        columns.append([("NODE", number, name) for number in numbers for name in names])
    rest = [np.frombuffer(record, "<f8") for record in take]  # the last time may be there in part
    keys = [["time"], [None] * n_global, *columns]
    each = [part for part in keys if part]
    rest = rest[:len(rest) // len(each) * len(each)]
    if any(len(record) < len(part) for record, part in zip(rest, each)):
        raise SystemExit(f"{path}: records are shorter than what they hold")
    return {key: np.array([record[k] for record in rest[number::len(each)]])
            for number, part in enumerate(each) for k, key in enumerate(part) if key}
