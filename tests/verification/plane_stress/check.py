# SPDX-License-Identifier: MIT
"""Plane stress: paths of single elements, Kirsch's plate, a cantilever, a lug, a strip that necks, the stable step."""
import numpy as np

from meshes import Deck, grid, moduli

RHO, YOUNG, POISSON = 1000.0, 2.0e5, 0.3
YIELD, HARDENING = 20.0, 4.0e3
TANGENT = YOUNG * HARDENING / (YOUNG + HARDENING)
A, B, RUBBER_POISSON = 0.35, 0.15, 0.49
THICKNESS = 0.2
SHEAR = YOUNG / (2.0 * (1.0 + POISSON))


def root(function, low, high):
    """Zero of a rising function."""
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) < 0.0 else (low, middle)
    return 0.5 * (low + high)


# ---- paths of one element

#: Cards of each law, its flow stress of the plastic strain, and the drivers that have it.
LAWS = {
    "elastic": (lambda deck: deck.elastic(RHO, YOUNG, POISSON), lambda p: np.inf, (True, False)),
    "MAT_003": (lambda deck: deck.plastic(RHO, YOUNG, POISSON, YIELD, TANGENT), lambda p: YIELD + HARDENING * p,
                (True, False)),
    "MAT_003, kinematic": (lambda deck: deck.plastic(RHO, YOUNG, POISSON, YIELD, TANGENT, 0.0),
                           lambda p: YIELD + HARDENING * p, (True, False)),
    "MAT_024": (lambda deck: deck.add("*MAT_PIECEWISE_LINEAR_PLASTICITY", (1, RHO, YOUNG, POISSON),
                                      (), (0.0, 0.001), (YIELD, YIELD + 0.001 * HARDENING)),
                lambda p: YIELD + HARDENING * p, (True, False)),
    "MAT_098": (lambda deck: deck.add("*MAT_SIMPLIFIED_JOHNSON_COOK", (1, RHO, YOUNG, POISSON),
                                      (YIELD, 100.0, 0.5, 0.0)), lambda p: YIELD + 100.0 * p ** 0.5, (False,)),
    "MAT_015": (lambda deck: deck.add("*MAT_JOHNSON_COOK", (1, RHO, SHEAR, YOUNG, POISSON),
                                      (YIELD, 100.0, 0.5, 0.0, 1.0, 1000.0, 0.0, 1.0), (0.0,), (0.0,)),
                lambda p: YIELD + 100.0 * p ** 0.5, (False,)),
}
N_STEP, STRETCH = 400, 0.001


def square(law, implicit, points, thins, free, stretch=STRETCH, n_step=N_STEP):
    """A unit square stretched to 1 + stretch along x, along y free or stretched as well."""
    deck = Deck("square").add("*SECTION_SHELL", (1, 12, None, points), (THICKNESS,))
    deck.add("*PART", "square", (1, 1, 1))
    LAWS[law][0](deck) if law in LAWS else law(deck)
    if implicit:
        deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0 / n_step))
        deck.add("*CONTROL_IMPLICIT_SOLUTION", (12, 0, 0, 0.0, 1e-30))
        end = 1.0
    else:
        end = 1.0
        deck.control(end, dt=1.0 / n_step)
    if thins:
        deck.add("*CONTROL_SHELL", (0, 0, 0, 1))
    ids = deck.mesh(*grid(1, 1))
    deck.curve(1, [(0.0, 0.0), (end, stretch)])
    deck.fix(ids[[0, 2]], x=1).fix(ids[:2], y=1)
    for node in ids[[1, 3]]:
        deck.prescribe(node, 1, 2, 1)
    for node in () if free else ids[2:]:
        deck.prescribe(node, 2, 2, 1)
    return deck.output(plot=end, glstat=end / 10, matsum=end / 10).add("*DATABASE_SPCFORC", (end / 10,))


def check_paths(run):
    """Stress, strain of the thickness, force and energy."""
    strain = np.log1p(STRETCH)
    for (law, (_, flow, drivers)), points, thins in run.cover(LAWS.items(), (None, 4), (False, True)):
        for implicit, free in [(True, True), (True, False), (False, False)]:
            if implicit not in drivers:
                continue
            result = run.program(square(law, implicit, points, thins, free))
            # Strain along x of a stress s: one or two directions of it.
            ratio, share = (1.0, 1.0) if free else (1.0 - POISSON, 0.5)
            stress = ratio and strain * YOUNG / ratio
            p = 0.0
            if stress > flow(0.0):
                p = root(lambda p: flow(p) * ratio / YOUNG + share * p - strain, 0.0, 1.0)
                stress = flow(p)
            across = -POISSON * stress / YOUNG * (1.0 if free else 2.0) - (0.5 if free else 1.0) * p
            name = f"{law}, {'implicit' if implicit else 'explicit'}, {'uniaxial' if free else 'equibiaxial'}" \
                + (", 2x2 points" if points else "") + (", thinning" if thins else "")
            found = result.cells("stress")[-1][0]
            run.check(f"{name}: stress", found[:4], [stress, 0.0 if free else stress, 0.0, 0.0])
            run.check(f"{name}: strain of the thickness", result.cells("thickness_strain")[-1][0], across)
            if flow(0.0) < np.inf:
                run.check(f"{name}: plastic strain", result.cells("plastic_strain")[-1][0], p)
            height = np.exp(across) if free else 1.0 + STRETCH
            force = result.table("spcforc")
            total = force["fx"][force["time"] == force["time"].max()].sum()
            run.check(f"{name}: force", -total, stress * THICKNESS * height * (np.exp(across) if thins else 1.0))


# ---- rubber

def kirchhoff(stretches):
    c, s = 0.5 * A + B, np.asarray(stretches) ** 2
    d = (A * (5.0 * RUBBER_POISSON - 2.0) + B * (11.0 * RUBBER_POISSON - 5.0)) / (2.0 * (1.0 - 2.0 * RUBBER_POISSON))
    third = np.prod(s)
    return 2.0 * s * (A + B * (s.sum() - s)) - 4.0 * c * third ** -2 + 4.0 * d * third * (third - 1.0)


def rubber_card(deck):
    deck.add("*MAT_MOONEY-RIVLIN_RUBBER", (1, RHO, RUBBER_POISSON, A, B), (0.0,))


def check_rubber(run):
    """A sheet stretched to 1.6 in both directions, or in one: W of the principal stretches."""
    for implicit, free, thins in [(True, True, True), (True, False, False), (False, False, True), (False, False, False)]:
        result = run.program(square(rubber_card, implicit, 4 if thins else None, thins, free, 0.6, 40 if implicit else 2000))
        name = f"rubber, {'implicit' if implicit else 'explicit'}, {'uniaxial' if free else 'equibiaxial'}" \
            + (", thinning" if thins else "")
        if free:
            across = root(lambda s: kirchhoff((1.6, s, s))[1], 0.5, 1.2)
            stretches = np.array([1.6, across, across])
        else:
            stretches = np.array([1.6, 1.6, root(lambda s: kirchhoff((1.6, 1.6, s))[2], 0.2, 1.2)])
        stress = kirchhoff(stretches) / np.prod(stretches)
        run.check(f"{name}: stress of rubber", result.cells("stress")[-1][0, :3], stress)
        run.check(f"{name}: stretch of the thickness", np.exp(result.cells("thickness_strain")[-1][0]), stretches[2])


# ---- Kirsch's plate

def kirsch(x, y):
    """Displacements and stresses of a plate with a hole of radius 1 under the stress 1 along x."""
    r, t = np.hypot(x, y), np.arctan2(y, x)
    k = (3.0 - POISSON) / (1.0 + POISSON)
    u = np.stack([r * (k + 1) * np.cos(t) + 2 / r * ((1 + k) * np.cos(t) + np.cos(3 * t)) - 2 / r ** 3 * np.cos(3 * t),
                  r * (k - 3) * np.sin(t) + 2 / r * ((1 - k) * np.sin(t) + np.sin(3 * t)) - 2 / r ** 3 * np.sin(3 * t)])
    s, q = 1 / r ** 2, 1.5 / r ** 4
    stress = np.stack([1 - s * (1.5 * np.cos(2 * t) + np.cos(4 * t)) + q * np.cos(4 * t),
                       -s * (0.5 * np.cos(2 * t) - np.cos(4 * t)) - q * np.cos(4 * t),
                       -s * (0.5 * np.sin(2 * t) + np.sin(4 * t)) + q * np.sin(4 * t)])
    return u / (8.0 * SHEAR), stress


def plate(n, points, load=1.0e-3):
    """A quarter of a ring of radii 1 and 4, n x n quads, with the displacements of the plate at its outer edge."""
    deck = Deck("Kirsch").add("*SECTION_SHELL", (1, 12, None, points), (THICKNESS,))
    deck.add("*PART", "plate", (1, 1, 1)).elastic(RHO, YOUNG, POISSON)
    if not points:
        deck.hourglass(6, 1.0)
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    x, quads = grid(n, n)
    radius, angle = 4.0 ** x[:, 0], 0.5 * np.pi * x[:, 1]
    x = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    ids = deck.mesh(x, quads)
    deck.curve(1, [(0.0, 0.0), (1.0, load)])
    bottom, top, outer = ids[:n + 1], ids[-n - 1:], ids[n::n + 1]
    deck.fix(bottom, y=1).fix(top, x=1)
    for node in outer:
        u = kirsch(*x[node - 1])[0]
        for dof in (1, 2):
            if not (dof == 2 and node == bottom[-1]) and not (dof == 1 and node == top[-1]):
                deck.prescribe(node, dof, 2, 1, float(u[dof - 1]))
    return deck.output(plot=1.0), x, quads


def check_kirsch(run):
    for points in (None, 4):
        errors, edges, sizes = [], [], (16, 32, 64)
        for n in sizes:
            deck, x, quads = plate(n, points)
            result = run.program(deck)
            stress = result.cells("stress")[-1][:, [0, 1, 3]] / 1.0e-3
            centres = x[np.array(quads)].mean(axis=1)
            exact = kirsch(*centres.T)[1].T
            errors.append(np.sqrt(np.mean((stress - exact) ** 2)))
            # To the edge at the top by a parabola through the last three rows, along ln r.
            radii = np.log(np.hypot(*centres[-n:].T))
            edges.append(np.polynomial.polynomial.polyfit(radii[:3], stress[-n:, 0][:3], 2)[0])
        name = "Kirsch's plate" + (", 2x2 points" if points else "")
        run.check(f"{name}: stress at the edge of the hole", edges[-1], 3.0)
        run.check(f"{name}: order of the stress", run.order([1.0 / n for n in sizes], errors), 2.0)


# ---- a cantilever

def check_cantilever(run):
    """Tip of a beam of 10 x 1 under a load at its end: P l^3/(3 E I) and what shear adds."""
    length, load = 10.0, 1.0e-3
    found = []
    for n in (4, 8):
        deck = Deck("cantilever").add("*SECTION_SHELL", (1, 12), (THICKNESS,)).hourglass(6, 1.0)
        deck.add("*PART", "beam", (1, 1, 1)).elastic(RHO, YOUNG, POISSON)
        deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
        ids = deck.mesh(*grid(10 * n, n, length, 1.0)).reshape(n + 1, -1)
        deck.fix(ids[:, 0], x=1).fix([ids[n // 2, 0]], y=1)
        deck.curve(1, [(0.0, 0.0), (1.0, load)])
        # The shear stress of the beam at both ends, a parabola.
        y = np.linspace(-0.5, 0.5, n + 1)
        share = np.array([np.trapezoid(np.interp(z, y, np.eye(n + 1)[k]) * (1.5 - 6.0 * z * z), z)
                          for k in range(n + 1) for z in [np.linspace(-0.5, 0.5, 4001)]])
        for end, sign in ((-1, 1.0), (0, -1.0)):
            for node, part in zip(ids[:, end], share):
                if not (end == 0 and node == ids[n // 2, 0]):
                    deck.add("*LOAD_NODE_POINT", (int(node), 2, 1, sign * float(part)))
        found.append(run.program(deck.output(plot=1.0)).points("displacement")[-1][ids[n // 2, -1] - 1, 1])
    inertia = THICKNESS / 12.0
    tip = load * length ** 3 / (3.0 * YOUNG * inertia) + load * length * (4.0 + 5.0 * POISSON) / (24.0 * YOUNG * inertia)
    run.check("cantilever: deflection of the tip", found[-1] + (found[-1] - found[0]) / 3.0, tip)


# ---- a lug on a pin

def half_ring(n, inner, outer):
    """n rows of quads from one line of points to another, finer at the first."""
    s, m = np.linspace(0.0, 1.0, n + 1)[:, None, None] ** 1.5, len(inner) - 1
    quads = [(i * (m + 1) + j, (i + 1) * (m + 1) + j, (i + 1) * (m + 1) + j + 1, i * (m + 1) + j + 1)
             for i in range(n) for j in range(m)]
    return ((1.0 - s) * inner + s * outer).reshape(-1, 2), quads


def check_lug(run):
    """A pin without clearance and friction in a lug of d/H = 0.4 with a long end: the largest stress at the edge of the
    hole over that of the net section, 2.85 by photoelasticity (Frocht & Hill 1940, Peterson)."""
    width, n, m = 2.5, 20, 48
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, m + 1)
    ray = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    ray[[0, -1], 0] = 0.0
    far = np.minimum(width / np.maximum(ray[:, 0], 1e-9), np.where(ray[:, 1] > 0.0, 5.0, 8.0) / np.maximum(abs(ray[:, 1]), 1e-9))
    deck = Deck("lug").add("*SECTION_SHELL", (1, 12, None, 4), (THICKNESS,))
    for part in (1, 2):
        deck.add("*PART", "lug and pin", (part, 1, part)).elastic(RHO, YOUNG, POISSON, part)
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.5))
    x, quads = half_ring(n, ray, far[:, None] * ray)
    lug = deck.mesh(x, quads, 1).reshape(n + 1, -1)
    points, faces = half_ring(8, ray, 0.3 * ray)
    pin = deck.mesh(points, [face[::-1] for face in faces], 2).reshape(9, -1)
    deck.fix([*lug[:, [0, -1]].ravel(), *pin[:, [0, -1]].ravel()], x=1)
    deck.fix(lug[-1][np.isclose(x[lug[-1] - 1][:, 1], -8.0)], y=1)
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0e-3)])
    for node in pin[-1]:
        deck.prescribe(node, 2, 2, 1)
    deck.node_set(1, pin[0]).node_set(2, lug[0][::-1]).contact(1, 2, 5, 20.0 * YOUNG, 1)
    result = run.program(deck.output(plot=1.0, rcforc=1.0))
    force = result.table("rcforc")
    load = abs(force["fy"][(force["side"] == "slave") & (force["time"] > 0.9)][0])
    stress = result.cells("stress")[-1][:n * m, 1].reshape(n, m)
    radius = np.linalg.norm(x[np.array(quads)].mean(axis=1), axis=1).reshape(n, m)
    edge = [np.polynomial.polynomial.polyfit(radius[:3, k] - 1.0, stress[:3, k], 2)[0] for k in range(m)]
    run.check("lug: largest stress over that of the net section", max(edge) * (width - 1.0) * THICKNESS / load, 2.85)


# ---- a strip that necks

def check_neck(run):
    """A strip with a weak middle pulled beyond its largest force: energy, and the neck is thinner."""
    for thins in (False, True):
        deck = Deck("necking strip").add("*SECTION_SHELL", (1, 12), (THICKNESS,)).hourglass(4, 0.05)
        deck.add("*PART", "strip", (1, 1, 1))
        deck.add("*MAT_PIECEWISE_LINEAR_PLASTICITY", (1, RHO, YOUNG, POISSON), (), (0.0, 0.5), (400.0, 500.0))
        wave = np.sqrt(YOUNG / (RHO * (1.0 - POISSON ** 2)))
        end = 200.0 / wave
        deck.control(end)
        if thins:
            deck.add("*CONTROL_SHELL", (0, 0, 0, 1))
        x, quads = grid(30, 8, 3.0, 0.5)
        x[:, 1] *= 1.0 - 0.02 * np.cos(np.pi * x[:, 0] / 6.0) ** 2
        ids = deck.mesh(x, quads).reshape(9, -1)
        deck.fix(ids[:, 0], x=1).fix(ids[0], y=1)
        deck.curve(1, [(0.0, 0.0), (0.2 * end, 0.5 / end), (end, 0.5 / end)])
        for node in ids[:, -1]:
            deck.prescribe(node, 1, 0, 1)
        table = run.program(deck.output(plot=end, glstat=end / 50)).table("glstat")
        name = "necking strip" + (", thinning" if thins else "")
        run.check(f"{name}: energy", table["energy_ratio"], 1.0)
        run.true(f"{name}: it flows", table["internal"][-1] > 5.0)


# ---- the stable step

def check_step(run):
    """A free square in its fastest mode at TSSFAC 0.9 keeps its energy; the step is that of its eigenvalue."""
    wave = np.sqrt(YOUNG / (RHO * (1.0 - POISSON ** 2)))
    for points in (None, 4):
        deck = Deck("free square").add("*SECTION_SHELL", (1, 12, None, points), (THICKNESS,))
        deck.add("*PART", "square", (1, 1, 1)).elastic(RHO, YOUNG, POISSON)
        deck.control(2000.0 / wave, scale=0.9)
        x, quads = grid(1, 1, origin=(-0.5, -0.5))
        ids = deck.mesh(x, quads)
        deck.add("*INITIAL_VELOCITY_NODE", *[(int(i), *(1e-4 * wave * place)) for i, place in zip(ids, x)])
        table = run.program(deck.output(glstat=20.0 / wave)).table("glstat")
        name = "free square" + (", 2x2 points" if points else "")
        run.check(f"{name}: step over 0.9 L/c", table["dt"][1] * wave / 0.9, 1.0 / np.sqrt(1.0 + POISSON))
        run.check(f"{name}: energy", table["energy_ratio"], 1.0)


# ---- thickness in contact

def blocks(thickness, points, other=None):
    """Two blocks that meet obliquely, with friction."""
    deck = Deck("two sheets").hourglass(4, 0.1).control(2.0)
    for part, t in ((1, thickness), (2, other or thickness)):
        deck.add("*SECTION_SHELL", (part, 12, None, points), (t,))
        deck.add("*PART", "sheet", (part, part, part)).elastic(RHO, YOUNG, POISSON, part)
    low = deck.mesh(*grid(6, 4, 1.2, 0.5, (-0.1, -0.5)), part=1)
    up = deck.mesh(*grid(5, 4, 1.0, 0.5, (0.0, 0.001)), part=2)
    deck.fix(low[:7], x=1, y=1)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(i), 0.05, -0.1) for i in up])
    deck.node_set(1, up[:6]).node_set(2, low[-7:][::-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, 5, 2, 1.0, 0.2, 0.2), (0.0, 1e20, 2))
    return deck.output(plot=0.1, glstat=0.1, rcforc=0.1)


def check_thickness(run):
    """Motion and pressures do not know the thickness; masses, forces and energies are in proportion."""
    one, thin = (run.program(blocks(t, None)) for t in (1.0, THICKNESS))
    run.check("two sheets: displacement", thin.points("displacement"), one.points("displacement"))
    run.check("two sheets: pressure", thin.points("contact_pressure"), one.points("contact_pressure"))
    run.check("two sheets: contact force", thin.points("contact_force"), THICKNESS * one.points("contact_force"))
    for column in ("kinetic", "internal", "hourglass", "contact"):
        run.check(f"two sheets: {column} energy", thin.table("glstat")[column], THICKNESS * one.table("glstat")[column])
    run.check("two sheets: energy ratio", thin.table("glstat")["energy_ratio"], 1.0)
    result = run.program(blocks(THICKNESS, None, 0.3), expect_status=None)
    run.true("two sheets of unlike thickness: refused by name", result.status != 0 and "unlike thickness" in result.stderr)


def check(run):
    check_paths(run)
    check_rubber(run)
    check_kirsch(run)
    check_cantilever(run)
    check_lug(run)
    check_neck(run)
    check_step(run)
    check_thickness(run)
