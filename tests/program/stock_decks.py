#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Decks as a client of LS-DYNA writes them: the keyword API of PyPI's ansys-dyna-core, nothing touched by hand.

    stock_decks.py FOLDER    writes every deck of stock_list.py and what it includes

tests/program/test_stock_decks.py runs the copies in tests/program/stock, and new ones where the package is
installed (pip install -e "./tools[stock]").
"""
import pathlib
import sys

import numpy as np
import pandas as pd
from ansys.dyna.core import Deck, __version__, keywords as kwd
from ansys.dyna.core.lib.format_type import format_type

from stock_list import DEFAULTS, RUN, UNSUPPORTED

STEEL = {"ro": 7800.0, "e": 2.1e11, "pr": 0.3}


def mesh(deck, part, n_x, n_y, size, corner, first, clockwise=False):
    """n_x x n_y quads of a rectangle, ids from `first`; the ids as an array (n_y + 1, n_x + 1)."""
    x, y = np.meshgrid(corner[0] + size[0] * np.arange(n_x + 1) / n_x,
                       corner[1] + size[1] * np.arange(n_y + 1) / n_y)
    node = first + np.arange(x.size).reshape(x.shape)
    deck.append(kwd.Node(nodes=pd.DataFrame(
        {"nid": node.ravel(), "x": x.ravel(), "y": y.ravel(), "z": 0.0})))
    corners = [node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]]
    if clockwise:
        corners = corners[::-1]
    table = {"eid": first + np.arange(n_x * n_y), "pid": part}
    table |= {f"n{k + 1}": ids.ravel() for k, ids in enumerate(corners)}
    deck.append(kwd.ElementShell(elements=pd.DataFrame(table)))
    return node


def part(deck, number, material, title="", section=1, hourglass=0):
    deck.append(kwd.Part(parts=pd.DataFrame({
        "heading": [title], "pid": [number], "secid": [section], "mid": [material], "eosid": [0],
        "hgid": [hourglass], "grav": [0], "adpopt": [0], "tmid": [0]})))


def section(deck, number=1, **fields):
    keyword = kwd.SectionShell(secid=number, elform=13, **fields)
    deck.append(keyword)


def curve(deck, number, points, **fields):
    deck.append(kwd.DefineCurve(lcid=number, curves=pd.DataFrame(points, columns=["a1", "o1"]), **fields))


def node_set(deck, number, nodes, title=None, kind=kwd.SetNodeList):
    keyword = kind(sid=number)
    if title:
        keyword.options["TITLE"].active = True
        keyword.title = title
    keyword.nodes.extend(int(node) for node in np.ravel(nodes))
    deck.append(keyword)


def part_set(deck, number, parts, kind=kwd.SetPartList):
    keyword = kind(sid=number)
    keyword.parts.extend(parts)
    deck.append(keyword)


def controls(deck, end_time, **step):
    """What a preprocessor puts on top of every deck."""
    for keyword in (kwd.ControlTermination(endtim=end_time), kwd.ControlTimestep(tssfac=0.5, **step),
                    kwd.ControlEnergy(hgen=2, rwen=2, slnten=2, rylen=2), kwd.ControlHourglass(ihq=4, qh=0.05),
                    kwd.ControlBulkViscosity(), kwd.ControlContact(), kwd.ControlOutput(),
                    kwd.ControlShell(), kwd.ControlAccuracy(), kwd.ControlSolution()):
        deck.append(keyword)


def output(deck, end_time, nodes=()):
    for name in ("Glstat", "Matsum", "Rcforc", "Nodout", "Spcforc", "Sleout"):
        deck.append(getattr(kwd, f"Database{name}")(dt=end_time / 50.0, binary=1))
    deck.append(kwd.DatabaseBinaryD3Plot(dt=end_time / 5.0))
    deck.append(kwd.DatabaseExtentBinary())
    if len(nodes):
        deck.append(kwd.DatabaseHistoryNode(**{f"id{k + 1}": int(node) for k, node in enumerate(nodes)}))


def impact(title="impact of two blocks", clockwise=False):
    """An elastic block hits a plastic one: part sets, TITLE options, automatic contact."""
    deck = Deck(title)
    controls(deck, 4.0e-5)
    section(deck)
    part(deck, 1, 1, "projectile, steel")
    part(deck, 2, 2, "target")
    deck.append(kwd.MatElastic(mid=1, **STEEL))
    deck.append(kwd.MatPlasticKinematic(mid=2, ro=2700.0, e=7.0e10, pr=0.33, sigy=3.0e8, etan=1.0e9, beta=1.0))
    upper = mesh(deck, 1, 3, 3, (0.01, 0.01), (0.005, 0.0201), 1001, clockwise)
    lower = mesh(deck, 2, 6, 6, (0.02, 0.02), (0.0, 0.0), 1, clockwise)
    part_set(deck, 1, [1])
    part_set(deck, 2, [2])
    node_set(deck, 1, lower[0], "foot, clamped")
    deck.append(kwd.BoundarySpcSet(nsid=1, dofx=1, dofy=1, dofz=1, dofrx=1, dofry=1, dofrz=1))
    deck.append(kwd.InitialVelocityGeneration(id=1, styp=1, vy=-50.0))
    deck.append(kwd.Contact2DAutomaticSurfaceToSurface(surfa=1, surfb=2))
    output(deck, 4.0e-5, [int(upper[0, 0]), int(lower[-1, 3])])
    return {"": deck}


def impact_long():
    """The same in LONG format."""
    decks = impact("impact of two blocks, LONG=Y")
    decks[""].format = format_type.long
    return decks


def impact_clockwise():
    """The same with every quad numbered clockwise."""
    return impact("impact of two blocks, clockwise", clockwise=True)


def pressure():
    """Pressure on segment sets with N3 = N4 = 0 and on single segments, forces, gravity, damping."""
    deck = Deck("loads")
    controls(deck, 1.0e-3)
    section(deck)
    part(deck, 7, 3, "block")
    deck.append(kwd.Mat001(mid=3, ro=1000.0, e=1.0e11, pr=0.0))
    node = mesh(deck, 7, 4, 4, (1.0, 1.0), (0.0, 0.0), 1, clockwise=True)
    curve(deck, 1, [(0.0, 0.0), (5.0e-4, 1.0), (1.0, 1.0)])
    curve(deck, 2, [(0.0, 9.81), (1.0, 9.81)])
    top = node[-1]
    deck.append(kwd.SetSegment(sid=1, segments=pd.DataFrame(
        {"n1": top[:-1], "n2": top[1:], "n3": 0, "n4": 0})))
    deck.append(kwd.LoadSegmentSet(ssid=1, lcid=1, sf=1000.0))
    deck.append(kwd.LoadSegment(lcid=1, sf=500.0, n1=int(node[1, -1]), n2=int(node[2, -1]),
                                n3=int(node[2, -1]), n4=int(node[2, -1])))
    deck.append(kwd.LoadNodePoint(nodes=pd.DataFrame(
        {"nid": [int(node[3, 0])], "dof": [1], "lcid": [1], "sf": [20.0]})))
    node_set(deck, 2, node[3:5, -1])
    deck.append(kwd.LoadNodeSet(nsid=2, dof=1, lcid=1, sf=-10.0))
    deck.append(kwd.LoadBodyY(lcid=2))
    deck.append(kwd.DampingGlobal(valdmp=10.0, stx=1.0))
    deck.append(kwd.BoundarySpcNode(nodes=pd.DataFrame(
        {"nid": node[0], "cid": 0, "dofx": 1, "dofy": 0, "dofz": 0, "dofrx": 0, "dofry": 0, "dofrz": 0})))
    output(deck, 1.0e-3, top)
    return {"": deck}


def contacts():
    """Five blocks in a row, one stock contact keyword of another kind in each joint."""
    deck = Deck("several contacts")
    controls(deck, 6.0e-5)
    section(deck)
    deck.append(kwd.MatElastic(mid=1, **STEEL))
    blocks = []
    for k in range(5):
        part(deck, k + 1, 1, f"block {k + 1}")
        blocks.append(mesh(deck, k + 1, 3, 3 + k % 2, (0.01, 0.01), (0.01001 * k, 0.0), 1 + 100 * k))
        part_set(deck, k + 1, [k + 1])
    node_set(deck, 11, blocks[3][::-1, -1], "right face of block 4")
    node_set(deck, 12, blocks[4][:, 0][::-1], "left face of block 5")
    deck.append(kwd.Contact2DAutomaticSurfaceToSurface(surfa=1, surfb=2))
    deck.append(kwd.Contact2DAutomaticSurfaceToSurfaceMortar(surfa=2, surfb=3))
    deck.append(kwd.Contact2DAutomaticNodeToSurface(surfa=3, surfb=4))
    deck.append(kwd.Contact2DPenalty(surfa=12, surfb=11))
    deck.append(kwd.Contact2DAutomaticOneWaySurfaceToSurface(surfa=1, surfb=3))
    node_set(deck, 1, blocks[0])
    deck.append(kwd.InitialVelocity(nsid=1, vx=10.0))
    output(deck, 6.0e-5)
    return {"": deck}


def includes():
    """Mesh in an include, its numbers from parameters, one of them an expression; generated sets."""
    deck = Deck("includes and parameters")
    named = kwd.Parameter()
    named.parameters = [kwd.Parameter.Parameter(*pair) for pair in (
        ("R    speed", "-50.0"), ("R  density", "7800.0"), ("I    steps", "2"))]
    deck.append(named)
    deck.append(kwd.ParameterExpression(parameters=pd.DataFrame(
        {"prmr": ["R     tend"], "expression": ["4.0e-5*&steps/2"]})))
    controls(deck, 4.0e-5)
    deck.append(kwd.Include(filename="stock_includes_mesh.k"))
    deck.append(kwd.InitialVelocityGeneration(id=1, styp=2, vy=-50.0))
    deck.append(kwd.Contact2DAutomaticSurfaceToSurface(surfa=1, surfb=2))
    deck.append("*CONTROL_TERMINATION\n&tend")
    output(deck, 4.0e-5)
    inner = Deck("mesh of the deck that includes it")
    section(inner)
    part(inner, 1, 1, "upper")
    part(inner, 2, 1, "lower")
    inner.append("*MAT_ELASTIC\n         1  &density    2.1e11       0.3")
    mesh(inner, 1, 3, 3, (0.01, 0.01), (0.005, 0.0201), 1001)
    mesh(inner, 2, 6, 6, (0.02, 0.02), (0.0, 0.0), 1)
    generated = kwd.SetPartListGenerate(sid=1)
    generated.block_ranges = [kwd.SetPartListGenerate.BlockRange(1, 1)]
    inner.append(generated)
    part_set(inner, 2, [2])
    inner.append(kwd.SetNodeListGenerate(sid=1, b1beg=1, b1end=7))
    inner.append(kwd.BoundarySpcSet(nsid=1, dofx=1, dofy=1))
    return {"": deck, "_mesh": inner}


def rigid():
    """A rigid punch on a curve, a flying rigid block, and one that spins; E and PR serve contact alone."""
    deck = Deck("rigid bodies")
    controls(deck, 2.0e-4)
    section(deck)
    for k, name in enumerate(("sheet", "punch", "flying block", "spinning block")):
        part(deck, k + 1, k + 1, name)
    deck.append(kwd.Mat003(mid=1, ro=7800.0, e=2.1e11, pr=0.3, sigy=2.5e8, etan=5.0e8, beta=0.0))
    deck.append(kwd.Mat020(mid=2, **STEEL, cmo=1.0, con1=1, con2=7))
    deck.append(kwd.MatRigid(mid=3, **STEEL))
    deck.append(kwd.MatRigid(mid=4, **STEEL, cmo=1.0, con1=4, con2=4))
    sheet = mesh(deck, 1, 20, 2, (0.1, 0.004), (0.0, 0.0), 1)
    mesh(deck, 2, 4, 3, (0.012, 0.01), (0.044, 0.0042), 1001)
    mesh(deck, 3, 3, 3, (0.01, 0.01), (0.2, 0.0), 2001)
    mesh(deck, 4, 3, 3, (0.01, 0.01), (0.3, 0.0), 3001)
    part_set(deck, 1, [1])
    part_set(deck, 2, [2])
    node_set(deck, 1, sheet[:, [0, -1]])
    deck.append(kwd.BoundarySpcSet(nsid=1, dofx=1, dofy=1))
    curve(deck, 1, [(0.0, 0.0), (1.0e-4, -20.0), (1.0, -20.0)])
    deck.append(kwd.BoundaryPrescribedMotionRigid(pid=2, dof=2, vad=0, lcid=1))
    deck.append(kwd.InitialVelocityRigidBody(pid=3, vx=3.0, vy=-2.0, vzr=100.0))
    deck.append(kwd.InitialVelocityGeneration(id=4, styp=2, omega=50.0, xc=0.305, yc=0.005, nz=1.0))
    deck.append(kwd.Contact2DAutomaticSurfaceToSurface(surfa=1, surfb=2))
    output(deck, 2.0e-4, [2001, 2016, 3001, 3016])
    return {"": deck}


def implicit():
    """Static press of two blocks, and what a stock implicit deck says besides."""
    deck = Deck("implicit press")
    deck.append(kwd.ControlTermination(endtim=1.0))
    deck.append(kwd.ControlImplicitGeneral(imflag=1, dt0=0.25))
    deck.append(kwd.ControlImplicitSolution())
    deck.append(kwd.ControlImplicitAuto(iauto=1, dtmin=0.01, dtmax=0.5))
    deck.append(kwd.ControlImplicitSolver())
    deck.append(kwd.ControlEnergy(hgen=2))
    section(deck, nip=4)
    part(deck, 1, 1, "upper")
    part(deck, 2, 1, "lower")
    deck.append(kwd.MatElastic(mid=1, **STEEL))
    upper = mesh(deck, 1, 3, 3, (0.01, 0.01), (0.0, 0.01), 101)
    lower = mesh(deck, 2, 4, 3, (0.01, 0.01), (0.0, 0.0), 1)
    part_set(deck, 1, [1])
    part_set(deck, 2, [2])
    node_set(deck, 1, lower[0])
    node_set(deck, 2, upper[-1])
    deck.append(kwd.BoundarySpcSet(nsid=1, dofx=1, dofy=1))
    curve(deck, 1, [(0.0, 0.0), (1.0, -1.0e-5)])
    deck.append(kwd.BoundaryPrescribedMotionSet(nsid=2, dof=2, vad=2, lcid=1))
    deck.append(kwd.BoundaryPrescribedMotionSet(nsid=2, dof=1, vad=2, lcid=1, sf=0.0))
    deck.append(kwd.Contact2DAutomaticSurfaceToSurfaceMortar(surfa=1, surfb=2))
    output(deck, 1.0)
    return {"": deck}


def titles():
    """A title or an id with a heading wherever a keyword can have one; commas and blanks in them."""
    deck = Deck("titles, and more, with commas")
    deck.append(kwd.ControlTermination(endtim=4.0e-5))
    keywords = [kwd.SectionShell(secid=1, elform=13), kwd.MatElastic(mid=1, **STEEL),
                kwd.MatPlasticKinematic(mid=2, ro=7800.0, e=2.1e11, pr=0.3, sigy=3.0e8),
                kwd.MatRigid(mid=3, **STEEL)]
    for k in range(1, 4):
        part(deck, k, k, f"part {k}, 1, 2, 3")
    blocks = [mesh(deck, k, 2, 2, (0.01, 0.01), (0.0, 0.02 * k), 100 * k) for k in range(1, 4)]
    keywords += [kwd.DefineCurve(lcid=4, curves=pd.DataFrame([(0.0, 1.0), (1.0, 1.0)], columns=["a1", "o1"])),
                 kwd.SetPartList(sid=1), kwd.SetNodeListGenerate(sid=2, b1beg=100, b1end=102),
                 kwd.SetSegment(sid=5, segments=pd.DataFrame({"n1": blocks[1][-1, :-1], "n2": blocks[1][-1, 1:],
                                                              "n3": 0, "n4": 0}))]
    keywords[5].parts.append(3)
    for k, keyword in enumerate(keywords):
        keyword.options["TITLE"].active = True
        keyword.title = f"title {k}, 7, 8, 9"
    conditions = [kwd.BoundarySpcSet(nsid=2, dofx=1, dofy=1),
                  kwd.BoundarySpcNode(nodes=pd.DataFrame({
                      "nid": blocks[1][0], "cid": 0, "dofx": 1, "dofy": 1, "dofz": 0, "dofrx": 0, "dofry": 0,
                      "dofrz": 0})),
                  kwd.BoundaryPrescribedMotionRigid(pid=3, dof=1, vad=0, lcid=4)]
    for k, keyword in enumerate(conditions):
        keyword.options["ID"].active = True
        keyword.id, keyword.heading = k + 1, f"heading {k}, 5, 6"
    for keyword in keywords + conditions:
        deck.append(keyword)
    deck.append(kwd.LoadSegmentSet(ssid=5, lcid=4, sf=1.0e5))
    output(deck, 4.0e-5)
    return {"": deck}


def defaults():
    """The impact with every control and output keyword once more, nothing filled in."""
    deck = impact("defaults everywhere")[""]
    for name in DEFAULTS:
        keyword = class_of(name)()
        keyword.write()  # ends what some classes still have to fill in
        deck.append(keyword)
    deck.append(kwd.DatabaseGlstat(dt=1.0e-6))
    return {"": deck}


def class_of(name):
    """The API's class of a keyword."""
    wanted = name.replace("_", "").lower()
    return next(getattr(kwd, found) for found in dir(kwd) if found.lower() == wanted)


def unsupported():
    """A long deck that asks for very much: keywords, options and fields."""
    deck = impact("much that is not here")[""]
    for name, field in UNSUPPORTED:
        if not field:
            text = class_of(name)().write()
            deck.append(text if text.count("\n") > 1 else text.rstrip("\n") + "\n         1\n")
    deck.append(kwd.MatPlasticKinematic(mid=12, ro=2700.0, e=7.0e10, pr=0.33, sigy=3.0e8, etan=1.0e9,
                                        src=40.0))
    deck.append(kwd.MatRigid(mid=13, **STEEL, couple=1.0))
    deck.append(kwd.Part(parts=pd.DataFrame({
        "heading": ["with an equation of state"], "pid": [12], "secid": [12], "mid": [12], "eosid": [3],
        "hgid": [0], "grav": [0], "adpopt": [0], "tmid": [0]})))
    deck.append(kwd.SectionShell(secid=12, elform=2))
    deck.append(kwd.InitialVelocity(nsid=1, icid=9, vx=1.0))
    deck.append(kwd.Contact2DAutomaticSurfaceToSurface(surfa=2, surfb=1, fs=0.2, fd=0.1, sldsoa=1.0e-4))
    return {"": deck}


def write(folder):
    """Write all decks and what they include into a folder."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name in (*RUN, "unsupported"):
        for suffix, deck in globals()[name]().items():
            text = f"$ written by ansys-dyna-core {__version__} (stock_decks.py)\n{deck.write()}\n"
            (folder / f"stock_{name}{suffix}.k").write_text(text, encoding="ascii")


if __name__ == "__main__":
    write(sys.argv[1])
