# SPDX-License-Identifier: MIT
"""Rubbers and crushable foam: closed forms on one element, the stable step, energy, a tube, both drivers."""
import re

import numpy as np

from meshes import Deck, grid

RHO = 1000.0
A, B, POISSON, SHEAR = 4.0e5, 1.0e5, 0.49, 1.0e6
YOUNG, TENSION = 1.0e7, 1.0e5
CRUSH = ([0.0, 0.05, 0.4, 0.7], [2.0e5, 2.5e5, 4.0e5, 2.0e6])
#: form of the element: ELFORM, NIP
FORMS = {"": (13, None), ", 2x2 points": (13, 4), ", round": (15, None), ", round 2x2 points": (15, 4)}


class MooneyRivlin:
    """W of the principal stretches; derivatives by hand."""

    name, shear, poisson = "Mooney-Rivlin", 2.0 * (A + B), POISSON
    c = 0.5 * A + B
    d = (A * (5.0 * POISSON - 2.0) + B * (11.0 * POISSON - 5.0)) / (2.0 * (1.0 - 2.0 * POISSON))

    def card(self, deck):
        return deck.add("*MAT_MOONEY-RIVLIN_RUBBER", (1, RHO, POISSON, A, B), (0.0,))

    def energy(self, s):
        s = np.asarray(s) ** 2
        second, third = s[0] * s[1] + s[1] * s[2] + s[2] * s[0], s[0] * s[1] * s[2]
        return A * (s.sum(axis=0) - 3.0) + B * (second - 3.0) + self.c * (third ** -2 - 1.0) + self.d * (third - 1.0) ** 2

    def kirchhoff(self, s):
        """s_k dW/ds_k."""
        s = np.asarray(s) ** 2
        third = s[0] * s[1] * s[2]
        return 2.0 * s * (A + B * (s.sum(axis=0) - s)) - 4.0 * self.c * third ** -2 + 4.0 * self.d * third * (third - 1.0)


class BlatzKo:
    name, shear, poisson = "Blatz-Ko", SHEAR, 0.463

    def card(self, deck):
        return deck.add("*MAT_BLATZ-KO_RUBBER", (1, RHO, SHEAR))

    def energy(self, s):
        beta = self.poisson / (1.0 - 2.0 * self.poisson)
        s = np.asarray(s)
        return 0.5 * SHEAR * ((s ** 2).sum(axis=0) - 3.0 + (np.prod(s, axis=0) ** (-2.0 * beta) - 1.0) / beta)

    def kirchhoff(self, s):
        s = np.asarray(s)
        return SHEAR * (s ** 2 - np.prod(s, axis=0) ** (-2.0 * self.poisson / (1.0 - 2.0 * self.poisson)))


RUBBERS = (MooneyRivlin(), BlatzKo())


def foam(poisson=0.0):
    def card(deck):
        deck.add("*MAT_CRUSHABLE_FOAM", (1, RHO, YOUNG, poisson, 90, TENSION))
        return deck.curve(90, list(zip(*CRUSH)))
    return card


def cauchy(law, f):
    """Stress and energy of a 3x3 F, by its principal stretches."""
    axes, stretches, _ = np.linalg.svd(f)
    return axes @ np.diag(law.kirchhoff(stretches) / np.prod(stretches)) @ axes.T, law.energy(stretches)


def driven(card, motions, form, end=1.0e-3, outputs=10, n_step=None):
    """A unit square (round: r from 1 to 2) for each motion, as parts of one deck: motion(X) gives the displacements
    of its corners at as many instants as it likes, evenly over the run; the whole, but for its corners, is free."""
    deck = Deck("driven squares").control(end, dt=end / n_step if n_step else 1.0e-5)
    deck.add("*SECTION_SHELL", (1, form[0], None, form[1]), (1.0,))
    card(deck)
    for part, motion in enumerate(motions, 1):
        deck.add("*PART", "square", (part, 1, 1))
        corners, quads = grid(1, 1, origin=(1.0 if form[0] == 15 else 0.0, 0.0))
        corners = corners + (0.07 * np.array([(0, 0), (1, 1), (-1, 1), (0, -2)]) if form[0] == 13 else 0.0)
        ids, place = deck.mesh(corners, quads, part), motion(corners)
        times = np.linspace(0.0, end, len(place))
        for k, (corner, axis) in enumerate(np.ndindex(4, 2)):
            deck.curve(1000 + 10 * part + k, list(zip(times, place[:, corner, axis])))
            deck.prescribe(ids[corner], axis + 1, 2, 1000 + 10 * part + k)
    return deck.output(plot=end / outputs, glstat=end / outputs, matsum=end / outputs)


def uniform(*f):
    """Displacements of a straight path from the unit tensor over some F."""
    changes = np.array([np.eye(2), *f]) - np.eye(2)
    return lambda x: np.einsum("tij,aj->tai", changes, x)


def turned(f, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]]) @ f


PLANE = {"uniaxial strain": [[1.0, 0.0], [0.0, 1.4]], "equibiaxial": [[1.3, 0.0], [0.0, 1.3]],
         "compression": [[1.2, 0.0], [0.0, 0.7]], "simple shear": [[1.0, 1.5], [0.0, 1.0]],
         "turned stretch": turned(np.diag([1.5, 0.8]), 1.0)}
ROUND = {"equibiaxial": [[1.4, 0.0], [0.0, 0.6]], "tension": [[0.8, 0.0], [0.0, 1.6]],
         "shear along the axis": [[1.1, 0.0], [0.9, 0.9]]}


def check_stress(run):
    """F is uniform: Cauchy stress and energy of its principal stretches; a rigid rotation does nothing."""
    small = 1.0e-8
    for law in RUBBERS:
        for name, form in FORMS.items():
            cases = dict(ROUND if form[0] == 15 else PLANE)
            strain = np.array([[0.7, 0.0], [0.4, -0.3]] if form[0] == 15 else [[0.7, 0.5], [0.1, -0.3]])
            cases["small"] = np.eye(2) + small * strain
            if form[0] == 13:
                cases["rotation"] = turned(np.eye(2), 1.0)
            result = run.program(driven(law.card, [uniform(f) for f in cases.values()], form),
                                 name=f"{law.name}_{form[0]}_{form[1] or 1}")
            stress, energy = result.cells("stress")[-1], result.table("matsum")
            for part, (case, f) in enumerate(cases.items(), 1):
                full = np.diag([1.0, 1.0, f[0][0] if form[0] == 15 else 1.0])
                full[:2, :2] = f
                expected, w = cauchy(law, full)
                found = stress[part - 1][[0, 1, 2, 3]]
                wanted = np.array([expected[0, 0], expected[1, 1], expected[2, 2], expected[0, 1]])
                where = f"{law.name}{name}, {case}"
                if case == "rotation":
                    run.check(f"{where}: stress over G", found / law.shear, 0.0)
                    continue
                if case == "small":
                    e = small * 0.5 * (strain + strain.T)
                    lame = 2.0 * law.shear * law.poisson / (1.0 - 2.0 * law.poisson)
                    hoop = e[0, 0] if form[0] == 15 else 0.0
                    p = lame * (e[0, 0] + e[1, 1] + hoop)
                    wanted = p + 2.0 * law.shear * np.array([e[0, 0], e[1, 1], hoop, e[0, 1] - 0.5 * p / law.shear])
                    run.check(f"{where}: stress", found, wanted)
                    continue
                run.check(f"{where}: stress", found, wanted)
                size = 1.5 if form[0] == 15 else volume_of(form)
                run.check(f"{where}: energy", energy.where(part=part)["internal"][-1], w * size)


def volume_of(form):
    x = grid(1, 1)[0] + 0.07 * np.array([(0, 0), (1, 1), (-1, 1), (0, -2)])
    a, b = x[3] - x[0], x[2] - x[1]
    return 0.5 * abs(a[0] * b[1] - a[1] * b[0])


GAUSS = [(x, y) for x in (-3 ** -0.5, 3 ** -0.5) for y in (-3 ** -0.5, 3 ** -0.5)]


def at(xi, eta, corners):
    n = 0.25 * np.array([(1 - xi) * (1 - eta), (1 + xi) * (1 - eta), (1 + xi) * (1 + eta), (1 - xi) * (1 + eta)])
    d = 0.25 * np.array([[-(1 - eta), 1 - eta, 1 + eta, -(1 + eta)], [-(1 - xi), -(1 + xi), 1 + xi, 1 - xi]])
    jacobian = d @ corners
    return n, np.linalg.solve(jacobian, d), np.linalg.det(jacobian)


def energy_of(law, first, now, form):
    """Energy of one element: with several points each F has the dilatation of the element; one point: mean F."""
    weights, gradients = [], []
    for xi, eta in GAUSS:
        n, d, area = at(xi, eta, first)
        f = np.eye(3)
        f[:2, :2] = (d @ now).T
        radius = n @ first[:, 0] if form[0] == 15 else 1.0
        f[2, 2] = n @ now[:, 0] / radius if form[0] == 15 else 1.0
        weights.append(area * radius)
        gradients.append(f)
    weights = np.array(weights)
    ratio = weights @ [np.linalg.det(f) for f in gradients] / weights.sum()
    if form[1] is None:
        mean = np.tensordot(weights, gradients, 1) / weights.sum()
        mean[2, 2] = ratio / np.linalg.det(mean[:2, :2])
        gradients, weights = [mean], [weights.sum()]
    return sum(w * law.energy(np.linalg.svd((ratio / np.linalg.det(f)) ** (1.0 / 3.0) * f)[1])
               for w, f in zip(weights, gradients))


def largest_frequency(law, first, now, form):
    """Of the free element with lumped masses, by differences of its energy."""
    h, e0 = 1.0e-4, energy_of(law, first, now, form)
    def energy(change):
        return energy_of(law, first, now + change.reshape(4, 2), form)
    unit = h * np.eye(8)
    hessian = np.zeros((8, 8))
    for i in range(8):
        hessian[i, i] = (energy(unit[i]) - 2.0 * e0 + energy(-unit[i])) / h ** 2
        for j in range(i):
            hessian[i, j] = hessian[j, i] = (energy(unit[i] + unit[j]) - energy(unit[i] - unit[j])
                                             - energy(unit[j] - unit[i]) + energy(-unit[i] - unit[j])) / (4.0 * h ** 2)
    mass = np.zeros(4)
    for xi, eta in GAUSS:
        n, _, area = at(xi, eta, first)
        mass += RHO * area * n * (n @ first[:, 0] if form[0] == 15 else 1.0)
    if form[0] == 13:
        mass[:] = mass.sum() / 4.0
    root = np.repeat(mass ** -0.5, 2)
    return np.sqrt(np.linalg.eigvalsh(root[:, None] * hessian * root).max())


def wave_step(law, now, f):
    """L/c of a plane quad, L its area over its longest side, c the fastest plane wave: by differences of W along
    F + s m n F over all directions m, n."""
    full = np.eye(3)
    full[:2, :2] = f
    angles = np.linspace(0.0, np.pi, 61)
    axes = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], -1)
    rates = np.einsum("ai,bj->abij", axes, axes).reshape(-1, 3, 3) @ full
    h = 1.0e-4
    w = [law.energy(np.linalg.svd(full + s * rates)[1].T) for s in (-h, 0.0, h)]
    speed = np.sqrt(np.max(w[0] - 2.0 * w[1] + w[2]) / h ** 2 / RHO)
    d31, d42 = now[2] - now[0], now[3] - now[1]
    area = 0.5 * (d31[0] * d42[1] - d31[1] * d42[0])
    return area / np.linalg.norm(np.roll(now, -1, 0) - now, axis=1).max() / speed


def check_step(run):
    """The step follows the stiffness: below 2/omega of the stretched element (L/c where that is the rule), and not
    far below."""
    plane = {"stretched": [[2.5, 0.0], [0.0, 0.45]], "pressed": [[0.75, 0.0], [0.0, 0.9]], "sheared": [[1.0, 1.5], [0.0, 1.0]]}
    around = {"stretched": [[1.6, 0.0], [0.0, 0.4]], "pressed": [[0.9, 0.0], [0.0, 0.8]], "sheared": [[1.0, 0.0], [1.5, 1.0]]}
    for law in RUBBERS:
        for name, form in FORMS.items():
            shapes = {"at rest": np.eye(2), **(around if form[0] == 15 else plane)}
            path = [f for f in list(shapes.values())[1:] for _ in range(2)]
            deck = driven(law.card, [uniform(*path)], form, end=0.3, outputs=12, n_step=200).hourglass(1, 1.0e-9)
            deck.lines[deck.lines.index("*CONTROL_TIMESTEP") + 1] = "0.0,1.0"
            table = run.program(deck, name=f"step_{law.name}_{form[0]}_{form[1] or 1}").table("glstat")
            corners = grid(1, 1, origin=(1.0 if form[0] == 15 else 0.0, 0.0))[0][[0, 1, 3, 2]]
            if form[0] == 13:
                corners = corners + 0.07 * np.array([(0, 0), (1, 1), (0, -2), (-1, 1)])
            for row, (case, f) in zip((0, 3, 7, 11), shapes.items()):
                now = corners @ np.array(f).T
                limit = 2.0 / largest_frequency(law, corners, now, form) if name else wave_step(law, now, f)
                found = table["dt"][row] / limit
                run.check(f"{law.name}{name}, {case}: step over that of the element", found, 1.0)
                run.check(f"{law.name}{name}, {case}: step is no smaller than need be", found, 0.3)


def check_vibration(run):
    """A block flies and swings: what it has at the start it keeps, to second order in the step."""
    for law in RUBBERS:
        for name, form in FORMS.items():
            left = 0.5 if form[0] == 15 else 0.0
            coordinates, quads = grid(4, 6, 1.0, 1.5, (left, 0.0))
            inner = (np.abs(coordinates[:, 0] - left) % 1.0 > 1e-9) & (coordinates[:, 1] % 1.5 > 1e-9)
            coordinates = coordinates + 0.05 * inner[:, None] * np.sin(17.0 * coordinates[:, ::-1])
            errors, scales = [], (0.9, 0.45) if law is RUBBERS[0] else (0.45,)
            for scale in scales:
                deck = Deck("swinging block").control(0.1, scale=scale).part(1, section=1)
                deck.add("*SECTION_SHELL", (1, form[0], None, form[1]), (1.0,)).hourglass(4, 0.05)
                law.card(deck)
                ids = deck.mesh(coordinates, quads)
                deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), -8.0 * (x - left) * (y - 0.5), 12.0 * (y - 0.75))
                                                     for node, (x, y) in zip(ids, coordinates)])
                result = run.program(deck.output(glstat=1.0e-3),
                                     name=f"swing_{law.name}_{form[0]}_{form[1] or 1}_{scale}")
                table = result.table("glstat")
                total = sum(table[key] for key in ("kinetic", "leapfrog", "internal", "hourglass"))
                run.true(f"{law.name}{name}, scale {scale}: it swings far", table["internal"].max() > 0.5 * total[0])
                errors.append(np.sqrt(np.mean((total / total[0] - 1.0) ** 2)))
            run.check(f"{law.name}{name}: error of the energy", errors[-1], 0.0)
            if len(scales) > 1:
                run.check(f"{law.name}{name}: its order", run.order(np.array(scales), errors), 2.0)


def tube(law, pressure, inner, outer, n=400):
    """Displacements inside and outside of a tube whose ends are held, pressed from within: by the classical method of
    Runge and Kutta for the radius and the radial first stress, shooting for the inner radius."""
    def radial(hoop, first):
        """Radial stretch at which dW/d(stretch) is `first`."""
        s = 1.0 / hoop
        for _ in range(50):
            def value(s):
                return law.kirchhoff([s, hoop, 1.0])[0] / s - first
            change = value(s) / ((value(s * (1.0 + 1e-6)) - value(s * (1.0 - 1e-6))) / (2e-6 * s))
            s -= change
            if abs(change) < 1e-13:
                break
        return s

    def slope(x, y):
        hoop = y[0] / x
        s = radial(hoop, y[1])
        return np.array([s, (law.kirchhoff([s, hoop, 1.0])[1] / hoop - y[1]) / x])

    def shoot(r):
        x, y, h = inner, np.array([r, -pressure * r / inner]), (outer - inner) / n
        for _ in range(n):
            k1 = slope(x, y)
            k2 = slope(x + 0.5 * h, y + 0.5 * h * k1)
            k3 = slope(x + 0.5 * h, y + 0.5 * h * k2)
            k4 = slope(x + h, y + h * k3)
            x, y = x + h, y + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
        return y

    low, high = inner * 1.2, inner * 1.3
    f_low = shoot(low)[1]
    for _ in range(30):
        end = shoot(high)
        if abs(high - low) < 1e-12:
            break
        low, high, f_low = high, high - end[1] * (high - low) / (end[1] - f_low), end[1]
    return high - inner, end[0] - outer


def check_newton(run, result, name):
    """The tangent is exact: the last energy ratio of each step is far below what a constant factor would make it."""
    log = (result.folder / f"{result.job}.log").read_text()
    rows = [(int(k), float(ratio)) for k, ratio in re.findall(r"iteration (\d+): energy ratio (\S+),", log)]
    ends = [(one[1], two[1]) for one, two, three in zip(rows, rows[1:], rows[2:] + [(1, 0.0)]) if three[0] == 1]
    run.true(f"{name}: Newton's method converges as it does with an exact tangent",
             len(ends) >= 4 and all(last < before ** 1.6 for before, last in ends))


def check_tube(run):
    """A round tube and a quarter of a plane ring, implicit, pressed from within."""
    inner, outer = 1.0, 1.5
    for law, pressure in zip(RUBBERS, (2.0e5, 2.2e5)):
        exact = np.array(tube(law, pressure, inner, outer, 60))
        run.true(f"{law.name}, tube: it is much wider", exact[0] > 0.2 * inner)
        errors, sizes = [], (4, 8)
        for n in sizes:
            coordinates, quads = grid(n, 2, outer - inner, 0.2, (inner, 0.0))
            deck = Deck("tube").add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.25))
            deck.add("*SECTION_SHELL", (1, 15, None, 4), (1.0,)).part(1, section=1)
            law.card(deck)
            ids = deck.mesh(coordinates, quads)
            deck.fix(ids, y=1)
            deck.curve(1, [(0.0, 0.0), (1.0, pressure)])
            deck.add("*LOAD_SEGMENT", *[(1, 1.0, 0.0, *[int(ids[k]) for k in ((j + 1) * (n + 1), j * (n + 1), j * (n + 1),
                                                                              j * (n + 1))]) for j in range(2)])
            result = run.program(deck.output(plot=1.0, glstat=0.25), name=f"tube_{law.name}_{n}")
            check_newton(run, result, f"{law.name}, tube of {n} quads")
            u = result.points("displacement")[-1][[0, n], 0]
            errors.append(np.abs(u / exact - 1.0).max())
            run.report(f"{law.name}, tube of {n} quads: displacement inside", float(u[0]), f"exact {exact[0]}")
        run.check(f"{law.name}, tube: error of the displacements", errors[-1], 0.0)
        run.check(f"{law.name}, tube: order", run.order(1.0 / np.array(sizes), errors), 2.0)


def check_tension(run):
    """Plane strain tension with free sides, implicit: the side stretch is where the stress across is 0."""
    for law in RUBBERS:
        deck = Deck("tension").add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.2))
        deck.part(1, points=4)
        law.card(deck)
        ids = deck.mesh(*grid(2, 2))
        deck.fix(ids[[0, 3, 6]], x=1).fix(ids[[0, 1, 2]], y=1)
        deck.curve(1, [(0.0, 0.0), (1.0, 0.8)])
        for node in ids[6:]:
            deck.prescribe(node, 2, 2, 1)
        result = run.program(deck.output(plot=1.0, glstat=0.2), name=f"tension_{law.name}")
        check_newton(run, result, f"{law.name}, tension")
        low, high = 0.3, 1.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if law.kirchhoff([middle, 1.8, 1.0])[0] > 0.0 else (middle, high)
        wanted = law.kirchhoff([low, 1.8, 1.0]) / (1.8 * low)
        run.check(f"{law.name}, tension: stress", result.cells("stress")[-1][:, 1],
                  np.full(4, wanted[1]))
        run.check(f"{law.name}, tension: stress out of the plane", result.cells("stress")[-1][:, 2],
                  np.full(4, wanted[2]))
        run.check(f"{law.name}, tension: side stretch", 1.0 + result.points("displacement")[-1][8, 0], low)
        energy = result.table("glstat")
        run.check(f"{law.name}, tension: energy", energy["internal"][-1], law.energy([low, 1.8, 1.0]))


def check_foam(run):
    """Uniaxial strain, PR 0: E ln(J) up to the curve, back by E, up to TSC; the energy is the area under the path."""
    n = 800
    v = np.concatenate([np.linspace(1.0, 0.35, n // 2 + 1), np.linspace(0.35, 0.5, n // 2 + 1)[1:]])
    stress = [0.0]
    for before, after in zip(v[:-1], v[1:]):
        stress.append(max(-np.interp(1.0 - after, *CRUSH), min(TENSION, stress[-1] + YOUNG * np.log(after / before))))
    stress = np.array(stress)
    area = np.concatenate([[0.0], np.cumsum(0.5 * (stress[1:] + stress[:-1]) * np.diff(v))])
    run.true("foam: the path is crushed, unloaded and pulled", stress[n // 2] < -1.6e6 and stress[-1] == TENSION)
    for name, form in FORMS.items():
        def motion(x):
            return (v - 1.0)[:, None, None] * x[None, :, 1:] * np.array([0.0, 1.0])
        result = run.program(driven(foam(), [motion], form, outputs=40, n_step=n), name=f"foam_{form[0]}_{form[1] or 1}")
        step = n // 40
        found = result.cells("stress")[:, 0, :4]
        run.check(f"foam{name}: stress along the axis", found[:, 1], stress[::step])
        crushed = slice(4, 20)
        run.check(f"foam{name}: stress where it is crushed", found[crushed, 1],
                  -np.interp(1.0 - v[::step][crushed], *CRUSH))
        run.check(f"foam{name}: stress across over E", found[:, [0, 2, 3]] / YOUNG, 0.0)
        size = 1.5 if form[0] == 15 else volume_of(form)
        run.check(f"foam{name}: energy", result.table("matsum")["internal"], size * area[::step])


def check_isotropic_crush(run):
    """Uniform pressing in and out of the plane of an axisymmetric body: the pressure is the curve's value, whatever PR."""
    result = run.program(driven(foam(0.3), [uniform([[0.8, 0.0], [0.0, 0.8]])], (15, 4)), name="foam_pressed")
    volume = (1.0 - 0.2 * np.linspace(0.0, 1.0, 11)[2:]) ** 3
    run.check("foam: pressure of uniform pressing", result.cells("pressure")[2:, 0].ravel(),
              np.interp(1.0 - volume, *CRUSH))


def check(run):
    check_stress(run)
    check_step(run)
    check_vibration(run)
    check_tension(run)
    check_tube(run)
    check_foam(run)
    check_isotropic_crush(run)
