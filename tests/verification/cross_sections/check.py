# SPDX-License-Identifier: MIT
"""Forces of cross sections (secforc) against closed forms and balances."""
import numpy as np

from meshes import Deck, grid, lumped_mass, moduli

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.3
BULK, SHEAR, _ = moduli(YOUNG, POISSON)


def add_section(deck, number, nodes, elements):
    """A section of these nodes and elements (user numbers)."""
    deck.node_set(100 + number, nodes)
    elements = [int(element) for element in elements]
    deck.add("*SET_SHELL_LIST", (number,), *[elements[k:k + 8] for k in range(0, len(elements), 8)])
    return deck.add("*DATABASE_CROSS_SECTION_SET_ID", f"{number:10d}section {number}", (100 + number, 0, 0, number))


def column(deck, number, nodes, n_x, n_y, i, right=True):
    """The nodes of column i of a grid and the elements at its right, or left; the numbers of both start at 1."""
    k = i if right else i - 1
    return add_section(deck, number, nodes[i::n_x + 1], [j * n_x + k + 1 for j in range(n_y)])


def static(deck, dt=0.1):
    return deck.add("*CONTROL_IMPLICIT_GENERAL", (1, dt)).add("*CONTROL_IMPLICIT_SOLUTION", (12, 0, 30, 0.0, 1e-24))


def cantilever(force, name, run):
    """Held at the left, a force at the right end; sections of both kinds in its middle."""
    n_x, n_y = 20, 4
    deck = Deck("cantilever").control(1.0)
    deck.part(points=4).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(*grid(n_x, n_y, 2.0, 0.2))
    right = nodes[n_x::n_x + 1]
    deck.fix(nodes[::n_x + 1], x=1, y=1).curve(1, [(0.0, 0.0), (1.0, 1.0)])
    for k in range(2):
        if force[k]:
            deck.add("*LOAD_NODE_POINT", *[(int(node), k + 1, 1, force[k] / len(right)) for node in right])
    column(deck, 1, nodes, n_x, n_y, 8).add("*DATABASE_SECFORC", (0.5,))
    column(deck, 2, nodes, n_x, n_y, 8, right=False)
    static(deck, 0.25).output(nodout=0.5, nodes=right)
    result = run.program(deck, name=name)
    return result.table("secforc"), result.table("nodout").where(time=1.0)


def check_statics(run):
    """A bar under a force along it, and across it: force and moment, from both sides of the section."""
    table, _ = cantilever((40.0, 0.0), "pulled", run)
    at_end = [table.where(section=k, time=1.0) for k in (1, 2)]
    run.check("secforc, implicit: force by the loaded side / end load", at_end[0]["fx"] / 40.0, [1.0])
    run.check("secforc, implicit: force by the held side / end load", at_end[1]["fx"] / 40.0, [-1.0])
    table, ends = cantilever((0.0, 0.05), "bent", run)
    one = table.where(section=2, time=1.0)
    run.check("secforc, implicit: transverse force / end load", one["fy"] / 0.05, [-1.0])
    arm = np.mean(ends["x"]) - one["x"]
    run.check("secforc, implicit: moment / end load", one["moment"] / 0.05, -arm)
    run.check("secforc, implicit: moment of a bent beam", one["moment"], [-0.05 * 1.2])
    run.check("secforc: area and centroid", np.stack([one["area"], one["x"]]), [[0.2], [0.8]])


def check_wave(run):
    """One-dimensional wave: the end nodes of a long bar in uniaxial strain come to a constant speed."""
    n_x, n_y, length, speed = 1600, 2, 16.0, 0.01
    wave = np.sqrt((BULK + 4.0 * SHEAR / 3.0) / RHO)
    deck = Deck("wave").control(0.8 * length / wave)
    deck.part().elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(*grid(n_x, n_y, length, 0.02))
    deck.fix(nodes, y=1).curve(1, [(0.0, 0.0), (0.05 * length / wave, speed), (1.0, speed)])
    for node in nodes[::n_x + 1]:
        deck.prescribe(node, 1, 0, 1)
    column(deck, 1, nodes, n_x, n_y, 400).add("*DATABASE_SECFORC", (0.4 * length / wave,))
    column(deck, 2, nodes, n_x, n_y, n_x - 100)
    result = run.program(deck, name="wave")
    table = result.table("secforc")
    # At 0.4 and 0.8 of the time that the wave takes to the end; the sections stand at 0.25 and 0.94.
    run.check("secforc, explicit: force behind a wave", table.where(section=1)["fx"][1:],
              np.full(2, -RHO * wave * speed * 0.02))
    run.check("secforc, explicit: force before a wave, in tiles that rest",
              table.where(section=2)["fx"], np.zeros(3))
    run.true("tiles rest in this run", "the others are quiescent or in rigid translation" in (result.folder / "wave.log").read_text())


def check_balance(run, kind):
    """Two blocks that hit each other, plastic and with hourglass control: of the nodes that a section cuts off, at
    every instant, the sum of mass times acceleration is the force of the section and of contact."""
    n_x, n_y = 10, 6
    deck = Deck("two blocks").control(0.02).hourglass(4, 0.1)
    deck.part(1).elastic(RHO, YOUNG, POISSON).part(2)
    deck.plastic(RHO, YOUNG, POISSON, 5.0e3, 1.0e5, material=2).add("*DAMPING_PART_STIFFNESS", (1, 0.05))
    lower, upper = grid(n_x, n_y, 0.5, 0.3), grid(7, 4, 0.35, 0.2, (0.08, 0.3005))
    nodes = deck.mesh(*lower)
    above = deck.mesh(*upper, part=2)
    deck.node_set(1, nodes).node_set(2, above).node_set(3, above[:8]).node_set(4, nodes[-(n_x + 1):][::-1])
    deck.contact(3, 4, kind, 2.0e5).add("*INITIAL_VELOCITY", (2,), (0.3, -2.0))
    # Upwards from its fourth row of nodes the lower block is cut off; the surface alone is the second section.
    rows = nodes.reshape(n_y + 1, n_x + 1)
    add_section(deck, 1, rows[4], range(3 * n_x + 1, 4 * n_x + 1))
    add_section(deck, 2, rows[-1], range((n_y - 1) * n_x + 1, n_y * n_x + 1))
    add_section(deck, 3, above[:8], range(n_x * n_y + 1, n_x * n_y + 8))
    deck.add("*DATABASE_SECFORC", (1.0e-4,))
    deck.output(nodout=1.0e-4, rcforc=1.0e-4, nodes=[*nodes, *above])
    result = run.program(deck, name=f"balance_{kind}")
    table, motion, contact = (result.table(name) for name in ("secforc", "nodout", "rcforc"))
    masses = np.concatenate([lumped_mass(*lower, RHO), lumped_mass(*upper, RHO)])
    n = len(masses)
    inertia = masses[None, None, :] * np.stack([motion[c].reshape(-1, n) for c in ("ax", "ay")])
    pressed = {side: np.stack([contact.where(side=side)[c] for c in ("fx", "fy")]) for side in ("slave", "master")}
    scale = np.abs(pressed["master"]).max()
    run.check(f"secforc, type {kind}: contact force", scale, 100.0)
    for number, cut, side, reported in ((1, rows[4:].ravel(), "master", "part cut off inside"), (2, rows[-1], "master", "master surface"),
                                    (3, above[:8], "slave", "slave surface, plastic")):
        one = table.where(section=number)
        force = np.stack([one["fx"], one["fy"]])
        rest = inertia[:, :, np.asarray(cut) - 1].sum(axis=2) - pressed[side] - force
        run.check(f"secforc, type {kind}: {reported}: (inertia - contact - section) / contact",
                  rest / scale, np.zeros_like(rest))


def check_two_materials(run):
    """Two layers of other stiffness side by side, stretched, without lateral contraction."""
    deck = Deck("two layers").control(1.0)
    deck.part(1).elastic(RHO, YOUNG, 0.0).part(2).elastic(RHO, 3.0 * YOUNG, 0.0, material=2)
    coordinates, quads = grid(4, 4, 2.0, 1.0)
    nodes = deck.mesh(coordinates, quads[:12])
    deck.add("*ELEMENT_SHELL", *[(13 + k, 2, *(nodes[list(quad)].tolist())) for k, quad in enumerate(quads[12:])])
    deck.fix(nodes[::5], x=1).fix(nodes[:1], y=1).curve(1, [(0.0, 0.0), (1.0, 0.02)])
    for node in nodes[4::5]:
        deck.prescribe(node, 1, 2, 1)
    column(deck, 1, nodes, 4, 4, 2).add("*DATABASE_SECFORC", (1.0,))
    table = run.program(static(deck), name="layers").table("secforc").where(time=1.0)
    # Ten steps of 1e-3 of strain: their mid-step sums leave (1e-3)^2/12.
    run.check("secforc, two materials: force", table["fx"], [(0.75 + 3.0 * 0.25) * YOUNG * np.log(1.01)])
    moment = -np.log(1.01) * YOUNG * (0.75 * (0.375 - 0.5) + 0.75 * (0.875 - 0.5))
    run.check("secforc, two materials: moment", table["moment"], [moment])


def check_axisymmetric(run, points):
    """A solid cylinder in uniaxial strain along its axis: all per radian."""
    n_x, n_y, radius, stretch = 5, 4, 0.5, 0.1
    deck = Deck("cylinder").control(1.0, dt=0.01)
    deck.part(section=7).add("*SECTION_SHELL", (7, 15, None, points), (1.0,)).elastic(RHO, YOUNG, POISSON)
    coordinates, quads = grid(n_x, n_y, radius, 1.0)
    nodes = deck.mesh(coordinates, quads)
    deck.fix(nodes, x=1).curve(1, [(0.0, 0.0), (1.0, stretch)])
    for node, place in zip(nodes, coordinates):
        deck.prescribe(node, 2, 2, 1, float(place[1]))
    rows = nodes.reshape(n_y + 1, n_x + 1)
    add_section(deck, 1, rows[2], range(2 * n_x + 1, 3 * n_x + 1)).add("*DATABASE_SECFORC", (1.0,))
    table = run.program(deck, name=f"cylinder_{points or 1}").table("secforc")
    table = {name: values[-1:] for name, values in table.items()}
    name = "four points" if points else "one point"
    stress = (BULK + 4.0 * SHEAR / 3.0) * np.log(1.0 + stretch)
    run.check(f"secforc, round, {name}: force per radian", table["fy"], [stress * radius ** 2 / 2.0])
    run.check(f"secforc, round, {name}: area and centroid", np.stack([table["area"], table["x"], table["y"]]).ravel(),
              [radius ** 2 / 2.0, 2.0 * radius / 3.0, 0.5 * (1.0 + stretch)])
    run.check(f"secforc, round, {name}: moment / (force r)",
              table["moment"] / (stress * radius ** 3), [0.0])


def check_erosion(run):
    """A link that breaks: one element of two leaves the mesh. Both sections together are what nodfor tells."""
    deck = Deck("a link that breaks").control(1.0e-2, dt=1.0e-5)
    deck.part(1).elastic(0.01, YOUNG, 0.0).part(2).elastic(0.01, YOUNG, 0.0, material=2)
    deck.add("*MAT_ADD_EROSION", (1,), (0.0, 0.0, 0.0, float(np.log(1.05))))
    coordinates, quads = grid(2, 1, 2.0, 1.0)
    nodes = deck.mesh(coordinates, quads[:1])
    deck.add("*ELEMENT_SHELL", (2, 2, *nodes[list(quads[1])].tolist()))
    deck.curve(1, [(0.0, 0.0), (0.01, 0.1)]).fix(nodes, y=1).fix(nodes[::3], x=1)
    for node, factor in zip(nodes[[1, 4, 2, 5]], (1.0, 1.0, 3.0, 3.0)):
        deck.prescribe(node, 1, 2, 1, factor)
    for number in (1, 2):
        add_section(deck, number, nodes[1::3], (number,))
    deck.node_set(7, nodes[1::3]).add("*DATABASE_NODAL_FORCE_GROUP", (7, 0))
    for name in ("SECFORC", "NODFOR"):
        deck.add(f"*DATABASE_{name}", (1.0e-5,))
    result = run.program(deck, name="erosion")
    table, nodes = result.table("secforc"), result.table("nodfor")
    sides = np.stack([table.where(section=k)["fx"] for k in (1, 2)])
    gone = table.where(section=1)["time"] > 0.006
    scale = np.abs(sides).max()
    run.check("secforc, erosion: both sides + nodfor / force",
              (sides.sum(axis=0) + nodes["fx"].reshape(-1, 2).sum(axis=1)) / scale, np.zeros(len(gone)))
    run.check("secforc, erosion: by an element that has left", sides[0][gone], np.zeros(gone.sum()))
    run.check("secforc, erosion: before it left, by the other now",
              np.stack([-sides[0][~gone].min(), np.abs(sides[1][gone]).min()]) / scale, [0.25, 0.5])


def check(run):
    check_statics(run)
    check_wave(run)
    for kind in (2, 5):
        check_balance(run, kind)
    check_two_materials(run)
    for points in (None, 4):
        check_axisymmetric(run, points)
    check_erosion(run)
