# SPDX-License-Identifier: MIT
"""The scenes: each function returns the text of one complete deck (SI units, plane strain)."""
import pathlib
import sys

import numpy as np

from slideline_tools.decks import Deck, Grid, spaced

STEEL = dict(rho=7850.0, young=210.0e9, poisson=0.3)
ALUMINIUM = dict(rho=2700.0, young=69.0e9, poisson=0.33, yield_stress=276.0e6)

CONTACT_TYPES = ("1 NTS, 2 NTS-AR, 3 two-pass NTS-AR, 4 VTS-PPT, 5 NTS-mAR, 6 mortar, "
                 "7 segmented mortar")


def part(deck, number, heading, section, material):
    deck.keyword("PART", heading)
    return deck.card("pid secid mid eosid hgid", number, section, material, 0, 0)


def plane_strain(deck, section):
    """One-point plane-strain section; the thickness is not used (unit depth)."""
    deck.keyword("SECTION_SHELL")
    deck.card("secid elform shrf nip", section, 13, 1.0, 1)
    return deck.card("t1 t2 t3 t4", 1.0, 1.0, 1.0, 1.0)


def elastic(deck, number, rho, young, poisson):
    deck.keyword("MAT_ELASTIC")
    return deck.card("mid ro e pr", number, rho, young, poisson)


def perfectly_plastic(deck, number, rho, young, poisson, yield_stress):
    deck.keyword("MAT_PLASTIC_KINEMATIC")
    deck.card("mid ro e pr sigy etan beta", number, rho, young, poisson, yield_stress, 0.0, 1.0)
    return deck.card("src srp fs vp", 0.0, 0.0, 0.0, 0.0)


def energies_on(deck):
    """All energies are computed and enter the balance of glstat."""
    deck.keyword("CONTROL_ENERGY")
    return deck.card("hgen rwen slnten rylen", 2, 2, 2, 2)


def slideline(deck, slave, master):
    """*CONTACT_2D_SLIDELINE between two node sets; type, points and penalty are parameters."""
    deck.keyword("CONTACT_2D_SLIDELINE")
    return deck.card("surfa surfb ctype ngauss pen fs fd dc",
                     -slave, -master, "&ctype", "&ngauss", "&pen", 0.0, 0.0, 0.0)


# ---- collision -------------------------------------------------------------------------------

def collision_grids(level):
    """Plate and projectile of the collision scene at refinement level N_r."""
    n = level
    rows = 4 * n
    plate = Grid(spaced((0.0, 0.025, 20 * n), (0.025, 0.065, 16 * n)),
                 spaced((-0.005, 0.0, rows)))
    projectile = Grid(spaced((0.0, 0.020, 24 * n)), spaced((0.0005, 0.0055, rows)),
                      first_node=10001, first_element=10001)
    return plate, projectile


def collision(level=1, ctype=2, ngauss=4):
    """A steel projectile hits an aluminium plate; half model.

    `level` = N_r >= 1 (1 to 4 in the seed): cells and steps times N_r, step and penalty over N_r.
    """
    if level < 1 or level > 8:
        raise ValueError("level of the collision scene: 1 to 8")
    plate, projectile = collision_grids(level)
    steps = 10000 * level
    step = 100.0e-9 / level
    deck = Deck(f"collision of a projectile with a plate N_r = {level}", [
        "A steel block 40 mm wide and 5 mm high hits the middle of a clamped aluminium "
        "plate at 80 m/s. Half model: x = 0 is the plane of symmetry. SI units (m, kg, "
        "s, N, Pa), plane strain, per metre of depth.",
        "",
        f"Refinement level N_r = {level}: all cell and step counts times N_r, time step and "
        "penalty divided by it.",
        "",
        "Dimensions not given by the seed's text, so ours: plate 65 mm x 5 mm in the half "
        "model, projectile 20 mm x 5 mm in the half model, first gap 0.5 mm, 80 m/s.",
        "",
        "Parameters can be set from the command line, for example",
        "  slideline i=collision.k p:ctype=3 p:v0=-60",
    ])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("ngauss", ngauss, "Gauss points of a slave segment (type 6 only; others ignore it)"),
        ("pen", 1.0e9 / level, "penalty of a contact node in N/m: 1 GN/m over N_r"),
        ("v0", -80.0, "velocity of the projectile in y in m/s"),
        ("dt", step, "time step in s: 100 ns over N_r"),
        ("endtim", 1.0e-3, f"end time in s: {steps} steps"),
        ("ihq", 1, "hourglass control: 1 viscous form, 4 stiffness form"),
        ("qh", 0.1, "hourglass coefficient"),
        ("dtplot", 2.0e-5, "time between the states for pictures in s"),
        ("dthist", 5.0e-6, "time between the rows of the histories in s"),
        ("dtforc", 1.0e-6, "time between the rows of the contact force history in s"))
    deck.block("When to stop, and a constant time step: the curve LCTM caps the step and lies "
               "below the stable step of the mesh (about 0.13 microseconds over N_r).")
    deck.keyword("CONTROL_TERMINATION")
    deck.card("endtim", "&endtim")
    deck.constant_step(1, "&dt", 1.0)
    deck.block("One-point elements need hourglass control; every energy is in the balance.")
    deck.keyword("CONTROL_HOURGLASS")
    deck.card("ihq qh", "&ihq", "&qh")
    energies_on(deck)
    deck.block("Output: energies, contact force, parts, four nodes, and states for pictures.",
               "The four nodes lie on the plane of symmetry: lower and upper face of the "
               "projectile, upper and lower face of the plate.")
    deck.database(glstat="&dthist", matsum="&dthist", nodout="&dthist", rcforc="&dtforc",
                  binary_d3plot="&dtplot")
    deck.history_nodes([projectile.node[0, 0], projectile.node[0, -1],
                        plate.node[0, -1], plate.node[0, 0]])
    deck.block("Two bodies of one-point plane-strain quads (ELFORM 13).")
    part(deck, 1, "plate", 1, 1)
    part(deck, 2, "projectile", 1, 2)
    plane_strain(deck, 1)
    deck.comment("aluminium, elastic and perfectly plastic")
    perfectly_plastic(deck, 1, **ALUMINIUM)
    deck.comment("steel, elastic")
    elastic(deck, 2, **STEEL)
    deck.block("The projectile starts with its velocity.")
    deck.keyword("INITIAL_VELOCITY_GENERATION")
    deck.card("id styp omega vx vy vz", 2, 2, 0.0, 0.0, "&v0", 0.0)
    deck.card("xc yc zc nx ny nz", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    deck.block("Symmetry at x = 0 (u_x = 0); the plate is clamped at x = 65 mm (u = 0).")
    deck.node_set(1, "symmetry plane", np.concatenate([plate.left, projectile.left]))
    deck.spc_set(1, True, False)
    deck.node_set(2, "clamped end of the plate", plate.right)
    deck.spc_set(2, True, True)
    deck.block("The two surfaces as node sets in walking order: the body lies on the left hand, "
               "so a lower face runs from left to right, an upper face from right to left.")
    deck.node_set(3, "slave: lower face of the projectile", projectile.lower)
    deck.node_set(4, "master: upper face of the plate (0 to 25 mm)",
                  plate.upper[-(20 * level + 1):])
    deck.comment("A negative SURFA or SURFB is a node set. PEN is in N/m per contact node.")
    slideline(deck, 3, 4)
    deck.block(f"Mesh of the plate: {36 * level} x {4 * level} quads.")
    plate.write(deck, 1)
    deck.block(f"Mesh of the projectile: {24 * level} x {4 * level} quads.")
    projectile.write(deck, 2)
    return deck.text()


# ---- symmetric plate -------------------------------------------------------------------------

HOURGLASS_FORMS = {"viscous": (1, 0.1), "stiffness": (4, 0.05)}


def symmetric_plate_grid(n_x, n_y):
    """Half plate of 8 m x 1 m."""
    return Grid(spaced((0.0, 8.0, n_x)), spaced((0.0, 1.0, n_y)))


def symmetric_plate(n_x=8, n_y=4, elastoplastic=False, hourglass="viscous", coefficient=None):
    """A plate on two pins under a sudden upward load (after Flanagan and Belytschko 1981).

    `n_x` must be a multiple of 8 and `n_y` even, so that x = 7 m is a grid line and there is a
    node at mid-height. `hourglass` is 'viscous' or 'stiffness'; `coefficient` its coefficient.
    """
    if n_x < 8 or n_x % 8 or n_y < 2 or n_y % 2:
        raise ValueError("symmetric_plate: nx must be a multiple of 8 and ny even")
    form, usual = HOURGLASS_FORMS[hourglass]
    coefficient = usual if coefficient is None else coefficient
    grid = symmetric_plate_grid(n_x, n_y)
    law = "elastic-plastic" if elastoplastic else "elastic"
    deck = Deck(f"symmetric plate {n_x} x {n_y} {law}", [
        "A plate rests on two pins and is loaded at time zero by a constant upward load "
        "of 80 kN/m on its whole upper edge (after Flanagan and Belytschko 1981). It tests "
        "the solid element without contact. Half model: x = 0 is the plane of symmetry. "
        "SI units (m, kg, s, N, Pa), plane strain, per metre of depth.",
        "",
        "Dimensions and load not given by the seed's text, so ours: half plate 8 m x 1 m, "
        "load 80 kN/m" + ("; the end x > 7 m stays elastic, since a plastic pin punches through."
                          if elastoplastic else "."),
        "",
        "Result: deflection in y of the mid-span node (x = 0, mid-height) for 0.6 s.",
        "The pin excites hourglass modes: compare the two forms of hourglass control,",
        "  slideline i=DECK p:ihq=1 p:qh=0.1      viscous form",
        "  slideline i=DECK p:ihq=4 p:qh=0.05     stiffness form",
    ])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("load", 80.0e3, "load on the upper edge in N/m, upward"),
        ("ihq", form, "hourglass control: 1 viscous form, 4 stiffness form"),
        ("qh", coefficient, "hourglass coefficient"),
        ("endtim", 0.6, "end time in s"),
        ("dthist", 1.0e-3, "time between the rows of the histories in s"),
        ("dtplot", 2.0e-2, "time between the states for pictures in s"))
    deck.block("The program chooses the time step: 0.9 of the stable step of the smallest element.")
    deck.keyword("CONTROL_TERMINATION")
    deck.card("endtim", "&endtim")
    deck.keyword("CONTROL_TIMESTEP")
    deck.card("dtinit tssfac", 0.0, 0.9)
    deck.keyword("CONTROL_HOURGLASS")
    deck.card("ihq qh", "&ihq", "&qh")
    energies_on(deck)
    deck.block("Output: energies, parts, the mid-span node and the mid-span upper node, states.")
    deck.database(glstat="&dthist", nodout="&dthist", matsum="&dthist", binary_d3plot="&dtplot")
    deck.history_nodes([grid.node[0, n_y // 2], grid.node[0, -1]])
    material = dict(rho=1000.0, young=1.0e9, poisson=0.3)
    of_element = np.ones(grid.element.shape, dtype=int)
    deck.block("One-point plane-strain quads (ELFORM 13).")
    if elastoplastic:
        of_element[7 * n_x // 8:, :] = 2
        part(deck, 1, "plate from the middle to x = 7 m", 1, 1)
        part(deck, 2, "elastic end of the plate", 1, 2)
        plane_strain(deck, 1)
        deck.comment("elastic and perfectly plastic")
        perfectly_plastic(deck, 1, yield_stress=10.0e6, **material)
        elastic(deck, 2, **material)
    else:
        part(deck, 1, "plate", 1, 1)
        plane_strain(deck, 1)
        elastic(deck, 1, **material)
    deck.block("Symmetry at x = 0 (u_x = 0); the mid-height node at x = 8 m is pinned (u = 0).")
    deck.node_set(1, "symmetry plane", grid.left)
    deck.spc_set(1, True, False)
    deck.keyword("BOUNDARY_SPC_NODE")
    deck.card("nid cid dofx dofy", grid.node[-1, n_y // 2], 0, 1, 1)
    _plate_load(deck, grid, 8.0 / n_x)
    deck.block(f"Mesh: {n_x} x {n_y} quads.")
    grid.write(deck, of_element)
    return deck.text()


def _plate_load(deck, grid, length):
    deck.block("The step load: the curve is the load in N/m, the factor SF the length of edge that "
               "belongs to a node in m (half a segment at the two ends).")
    deck.curve(1, "load", [(0.0, "&load"), (10.0, "&load")])
    deck.node_set(2, "upper edge without its ends", grid.upper[1:-1])
    deck.keyword("LOAD_NODE_SET")
    deck.card("nsid dof lcid sf cid", 2, 2, 1, length, 0)
    deck.keyword("LOAD_NODE_POINT")
    deck.table("nid dof lcid sf cid", [10] * 5,
               [(grid.upper[0], 2, 1, 0.5 * length, 0), (grid.upper[-1], 2, 1, 0.5 * length, 0)])


# ---- the decks kept under input/ -------------------------------------------------------------

def committed_decks():
    """Path below `input/` and text of every deck kept in the repository."""
    for level in (1, 2, 3, 4):
        suffix = "" if level == 1 else f"_{level}"
        yield f"collision/collision{suffix}.k", collision(level)
    for n_x, n_y in ((8, 4), (16, 8), (32, 16)):
        for law in ("elastic", "elastoplastic"):
            yield (f"symmetric_plate/plate_{n_x}x{n_y}_{law}.k",
                   symmetric_plate(n_x, n_y, elastoplastic=law == "elastoplastic"))


def main(folder):
    """Write the decks kept in the repository below `folder`."""
    for name, text in committed_decks():
        path = pathlib.Path(folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="ascii")
        print(f"wrote {path}")


if __name__ == "__main__":
    main(sys.argv[1])
