# SPDX-License-Identifier: MIT
"""Two scenes of one kind: the top of a body is led down onto another one and then aside and back, static, for both programs."""
import numpy as np

from meshes import Deck
from slideline_tools.decks import Grid, spaced
from slideline_tools.scenes.hertz import CYLINDER_CELL, GRADED_CELLS, PENALTY, hertz_grids

YOUNG, POISSON, RHO, FRICTION = 2.1e11, 0.3, 7850.0, 0.3
#: Increments of a way, each of which takes one unit of time.
INCREMENTS = 4
#: Ways of the top aside, m, in full and else.
CYLINDER_WAYS = {True: (0.0, 4.0e-6, 8.0e-6, 1.2e-5, 4.0e-6), False: (0.0, 8.0e-6, 1.2e-5, 4.0e-6)}
BLOCK_WAYS = {True: (0.0, 2.0e-6, 4.0e-6, 6.0e-6, 1.0e-5, 1.4e-5, 1.0e-5, 4.0e-6, -4.0e-6), False: (0.0, 4.0e-6, 1.4e-5, 4.0e-6)}


class Scene:
    """`ways`: of the top aside, m, the first while it goes down. `penalty`: N/m per contact node; `side`: slave segment."""

    def __init__(self, grids, young, down, ways, penalty, side, outside):
        """`outside`: slave and master columns at each end that are no part of the contact surfaces."""
        self.lower, self.upper = grids
        self.young, self.down, self.ways, self.penalty, self.side = young, down, ways, penalty, side
        inner = slice(outside, -outside or None)
        self.slave, self.master = self.upper.node[inner, 0], self.lower.node[inner, -1]
        self.slave_elements, self.master_elements = self.upper.element[inner, 0], self.lower.element[inner, -1]

    @property
    def row(self):
        """Places of the elements above the contact surface in slideline's numbering, from 0."""
        return self.lower.element.size + self.slave_elements - self.upper.element.min()

    @property
    def times(self):
        return 1.0 + np.arange(len(self.ways))


def cylinder_on_block(is_full, level=1):
    """The cylinder and block of the Hertz scene, N_r = `level`, both of steel."""
    return Scene(hertz_grids(level)[:2], YOUNG, 3.0e-5, CYLINDER_WAYS[is_full], PENALTY, CYLINDER_CELL, GRADED_CELLS * level)


def block_on_block(is_full):
    """1 x 0.5 m, 20 x 10 quads, on 2 x 0.5 m, 36 x 9: first sticks, then slides, and back. Strains of 1e-5: laws of elasticity
    differ in the second order."""
    lower = Grid(spaced((-1.0, 1.0, 36)), spaced((-0.5, 0.0, 9)))
    upper = Grid(spaced((-0.5, 0.5, 20)), spaced((0.0, 0.5, 10)), first_node=100001, first_element=100001)
    return Scene((lower, upper), 1.0e9, 1.0e-5, BLOCK_WAYS[is_full], 20.0e9 * 0.05, 0.05, 0)


def slideline_deck(scene, kind):
    """The deck and the slave nodes; elements count from 1, those of the lower body first."""
    deck = Deck(f"a body led down and aside, type {kind}")
    step = 1.0 / INCREMENTS
    deck.add("*CONTROL_TERMINATION", (float(len(scene.ways)),)).add("*CONTROL_IMPLICIT_GENERAL", (1, step))
    deck.add("*CONTROL_IMPLICIT_AUTO", (1, 11, 5, 0.0, step))
    deck.part(1, points=4).elastic(RHO, scene.young, POISSON, 1)
    new = {}
    for grid in (scene.lower, scene.upper):
        first = grid.node.min()
        ids = deck.mesh(grid.points.reshape(-1, 2), grid.quads.reshape(-1, 4) - first)
        new.update(zip(grid.node.ravel().tolist(), np.asarray(ids).tolist()))
    slave, master, base, top = ([new[node] for node in nodes.tolist()] for nodes in (
        scene.slave, scene.master, scene.lower.lower, scene.upper.upper))
    deck.node_set(1, slave).node_set(2, master[::-1]).fix(base, x=1, y=1)
    deck.curve(1, [(0.0, 0.0), (1.0, -scene.down), (99.0, -scene.down)])
    deck.curve(2, [(0.0, 0.0), *zip(scene.times.tolist(), scene.ways)])
    for node in top:
        deck.prescribe(node, 2, 2, 1).prescribe(node, 1, 2, 2)
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, scene.penalty / (2.0 if kind == 3 else 1.0), FRICTION))
    return deck.output(plot=1.0, glstat=1.0, rcforc=1.0), slave


def calculix_deck(scene):
    """The same for CalculiX: springs at points of the slave faces, of the stiffness of a contact node over its length."""
    lines = ["*NODE, NSET=NALL"]
    for grid in (scene.lower, scene.upper):
        # A field holds 20 characters.
        lines += [f"{node},{x:.12g},{y:.12g},0.0" for node, (x, y)
                  in zip(grid.node.ravel().tolist(), grid.points.reshape(-1, 2).tolist())]
    for name, grid in (("LOWER", scene.lower), ("UPPER", scene.upper)):
        lines.append(f"*ELEMENT, TYPE=CPE4, ELSET={name}")
        lines += [",".join(map(str, (element, *quad))) for element, quad
                  in zip(grid.element.ravel().tolist(), grid.quads.reshape(-1, 4).tolist())]
    for name, elements, face in (("SLAVE", scene.slave_elements, "S1"), ("MASTER", scene.master_elements, "S3")):
        lines += [f"*SURFACE, NAME={name}, TYPE=ELEMENT", *(f"{element},{face}" for element in elements.tolist())]
    for name, nodes in (("BASE", scene.lower.lower), ("TOP", scene.upper.upper)):
        lines += [f"*NSET, NSET={name}", *(f"{node}," for node in nodes.tolist())]
    lines += ["*ELSET, ELSET=ROW", *(f"{element}," for element in scene.slave_elements.tolist())]
    stiffness = scene.penalty / scene.side
    lines += ["*ELSET, ELSET=EALL", "LOWER,UPPER", "*MATERIAL, NAME=BODY", "*ELASTIC", f"{scene.young:.9g},{POISSON}",
              "*SOLID SECTION, ELSET=EALL, MATERIAL=BODY", "1.0", "*SURFACE INTERACTION, NAME=SPRINGS",
              "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness:.9g},0.0",
              "*FRICTION", f"{FRICTION},{stiffness:.9g}",
              "*CONTACT PAIR, INTERACTION=SPRINGS, TYPE=SURFACE TO SURFACE", "SLAVE,MASTER", "*BOUNDARY", "BASE,1,2"]
    for way in scene.ways:
        step = 1.0 / INCREMENTS
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", f"{step},1.0,1e-4,{step}", "*BOUNDARY", f"TOP,1,1,{way:.9g}",
                  f"TOP,2,2,{-scene.down:.9g}", "*NODE PRINT, NSET=TOP, TOTALS=ONLY, FREQUENCY=1000", "RF",
                  "*EL PRINT, ELSET=ROW, FREQUENCY=1000", "S", "*END STEP"]
    return "\n".join(lines) + "\n"
