# SPDX-License-Identifier: MIT
"""Johnson-Cook, failure and equations of state on one element, and a shock in a column."""
import numpy as np

from meshes import Deck, grid, moduli

RHO, G = 8.93e3, 46.0e9
A, B, N, C, M, RATE = 90.0e6, 292.0e6, 0.31, 0.025, 1.09, 1.0
TM, TR, CP = 1356.0, 293.0, 383.0
SPEED, S1, GAMMA, CORRECTION = 3940.0, 1.489, 1.99, 0.47
YOUNG, POISSON = 124.0e9, 0.34
BULK = moduli(YOUNG, POISSON)[0]
END = 1.0e-4
#: form of the element: ELFORM, NIP
FORMS = {"": (13, None), ", 2x2 points": (13, 4), ", round": (15, None), ", round 2x2 points": (15, 4)}


def johnson_cook(deck, a=A, b=B, n=N, c=C, m=M, cp=CP, pc=0.0, spall=2.0, d=(0.0,) * 5, elastic=True, erod=0.0):
    return deck.add("*MAT_JOHNSON_COOK", (1, RHO, G, *((YOUNG, POISSON) if elastic else (0.0, 0.0))),
                    (a, b, n, c, m, TM, TR, RATE), (cp, pc, spall, 0.0, *d[:4]), (d[4], 0.0, erod))


def gruneisen(deck, speed=SPEED, s=(S1, 0.0, 0.0), gamma=GAMMA, correction=CORRECTION, energy=0.0):
    return deck.add("*EOS_GRUNEISEN", (1, speed, *s, gamma, correction, energy), (1.0,))


def element(write_material, paths, form=(13, None), eos=0, n_step=400, viscosity=None):
    """One unit square (round: from r = 1 to 2) whose sides x = 1 and y = 1 follow displacements over
    the run, given at n_step + 1 instants."""
    deck = Deck("one element")
    deck.control(END, dt=END / n_step)
    deck.add("*PART", "element", (1, 1, 1, eos))
    deck.add("*SECTION_SHELL", (1, form[0], None, form[1]), (1.0,))
    if viscosity:
        deck.add("*CONTROL_BULK_VISCOSITY", viscosity)
    write_material(deck)
    nodes = deck.mesh(*grid(1, 1, origin=(1.0 if form[0] == 15 else 0.0, 0.0)))
    times = np.linspace(0.0, END, n_step + 1)
    for number, path in enumerate(paths, 1):
        deck.curve(number, list(zip(times, path)))
    for node, moves in zip(nodes, ((0, 0), (1, 0), (0, 1), (1, 1))):
        for dof in (1, 2):
            if moves[dof - 1]:
                deck.prescribe(node, dof, 2, dof)
            else:
                deck.fix([node], x=int(dof == 1), y=int(dof == 2))
    return deck.output(plot=END / n_step, glstat=END / n_step)


def mises_of(result):
    xx, yy, zz, xy = result.cells("stress")[:, 0, :4].T
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy ** 2)


def scalar(result, name):
    return result.cells(name)[:, 0].ravel()


def flow(p, ratio, rise):
    return ((A + B * p ** N) * (1.0 + C * np.log(np.maximum(1.0, ratio)))
            * (1.0 - np.clip(rise / (TM - TR), 0.0, 1.0) ** M))


def isochoric(strain, n_step=400):
    """Displacements that keep the area of the square."""
    e = np.linspace(0.0, strain, n_step + 1)
    return np.expm1(e), np.expm1(-e)


def equivalent_rate(u, w, dt):
    """sqrt(2/3 d:d) of the mid-step shape in plane strain, from the displacements of two sides."""
    dx = np.diff(u) / dt / (1.0 + 0.5 * (u[1:] + u[:-1]))
    dy = np.diff(w) / dt / (1.0 + 0.5 * (w[1:] + w[:-1]))
    mean = (dx + dy) / 3.0
    return np.sqrt(2.0 / 3.0 * ((dx - mean) ** 2 + (dy - mean) ** 2 + mean ** 2))


def check_flow(run):
    """In each step with flow the von Mises stress is the flow stress of the plastic strain at its end, of its rate and
    of the temperature at its start."""
    u, w = isochoric(0.3)
    rate = equivalent_rate(u, w, END / 400)
    for name, form in list(FORMS.items())[:2]:
        for kind in ("015", "015 with an equation of state", "098"):
            def material(deck, kind=kind):
                if kind == "098":
                    deck.add("*MAT_SIMPLIFIED_JOHNSON_COOK", (1, RHO, YOUNG, POISSON), (A, B, N, C, 0.0, 0.0, 0.0, RATE))
                else:
                    gruneisen(johnson_cook(deck, elastic=kind == "015"))
            job = f"flow_{kind[:4].strip()}{'_eos' if 'equation' in kind else ''}_{form[1] or 1}"
            result = run.program(element(material, (u, w), form, int("equation" in kind)), name=job)
            p = scalar(result, "plastic_strain")
            rise = np.zeros(len(p)) if kind == "098" else scalar(result, "temperature") - TR
            flows = np.diff(p) > 0.0
            run.true(f"{kind}{name}: it flows", flows.sum() > 350)
            run.check(f"{kind}{name}: flow stress", mises_of(result)[1:][flows],
                      flow(p[1:], rate / RATE, rise[:-1])[flows])
            if kind == "098":
                continue
            middle = (1.0 + 0.5 * (u[1:] + u[:-1])) * (1.0 + 0.5 * (w[1:] + w[:-1]))
            heat = np.cumsum(middle * mises_of(result)[1:] * np.diff(p)) / (RHO * CP)
            run.check(f"{kind}{name}: heat of plastic work", rise[1:], heat)


def check_axisymmetric(run):
    """In one column, u_r = 0 at both sides is uniaxial strain: the plane element has the same stresses."""
    path = (np.zeros(401), np.linspace(0.0, -0.1, 401))
    for law, eos in (("015", 0), ("015", 1)):
        found = {}
        for name, form in FORMS.items():
            result = run.program(element(lambda deck: gruneisen(johnson_cook(deck, d=(0.3, 0.1, -1.0, 0.01, 0.5))),
                                         path, form, eos), name=f"form_{eos}_{form[0]}_{form[1] or 1}")
            found[name] = [np.sort(result.cells("stress")[:, 0, :3], axis=1), scalar(result, "temperature"),
                           scalar(result, "damage"), result.table("glstat")["internal"] / (1.5 if form[0] == 15 else 1)]
        for name in list(FORMS)[1:]:
            for field, values, first in zip(("stresses", "temperature", "damage", "internal energy"),
                                            found[name], found[""]):
                run.check(f"{law}{' with equation of state' if eos else ''}: {field}{name} beside one point", values, first)


def check_heat(run):
    """A alone, m = 1: T* = 1 - exp(-k p) with k = A/(rho c_p (TM - TR)), and q = A exp(-k p) = 2 sqrt(3) G e - 3 G p."""
    errors, strain = [], 1.0
    for n_step in (400, 800):
        result = run.program(element(lambda deck: johnson_cook(deck, a=1.0e9, b=0.0, c=0.0, m=1.0),
                                     isochoric(strain, n_step), n_step=n_step), name=f"heat_{n_step}")
        k = 1.0e9 / (RHO * CP * (TM - TR))
        p = 0.0
        for _ in range(60):
            p = (2.0 * np.sqrt(3.0) * G * strain - 1.0e9 * np.exp(-k * p)) / (3.0 * G)
        expected = (TM - TR) * (1.0 - np.exp(-k * p))
        errors.append(abs(scalar(result, "temperature")[-1] - TR - expected) / expected)
        run.check(f"temperature of a homogeneous bar, {n_step} steps",
                  scalar(result, "temperature")[-1] - TR, expected)
    run.true("and its error falls with the step", errors[1] < 0.6 * errors[0])


def check_damage(run):
    """D is the sum of dp/eps_f, eps_f with the mean stress before the step; at 1 the stress goes."""
    d = (0.02, 0.05, -1.5, 0.014, 1.12)
    path = (np.zeros(401), np.linspace(0.0, 0.06, 401))
    rate = equivalent_rate(*path, END / 400)
    for name, form in list(FORMS.items())[:2]:
        result = run.program(element(lambda deck: gruneisen(johnson_cook(deck, d=d, erod=1.0)), path, form, 1),
                             name=f"damage_{form[1] or 1}")
        p, damage, q = scalar(result, "plastic_strain"), scalar(result, "damage"), mises_of(result)
        rise = scalar(result, "temperature") - TR
        mean = -scalar(result, "pressure")
        n = int(np.argmax(damage >= 1.0))
        run.true(f"damage{name}: the element breaks on the way", 20 < n < 380)
        fracture = ((d[0] + d[1] * np.exp(d[2] * mean[:-1] / np.maximum(q[1:], 1.0)))
                    * (1.0 + d[3] * np.log(np.maximum(1.0, rate / RATE))) * (1.0 + d[4] * rise[:-1] / (TM - TR)))
        run.check(f"damage{name}: sum of dp/eps_f", damage[1:n], np.cumsum(np.diff(p) / fracture)[:n - 1])
        run.check(f"damage{name}: 1 once broken", damage[n:], 1.0)
        run.check(f"damage{name}: no deviator once broken", q[n:], 0.0)
        run.check(f"damage{name}: no tension once broken", mean[n + 1:], 0.0)
        run.true(f"damage{name}: tension before", mean[n - 1] > 0.0)
        check_balance(run, result, f"damage{name}")


def check_balance(run, result, name):
    """What the sides do is what the element keeps, beside its motion."""
    table = result.table("glstat")
    moving = table["kinetic"] + table["leapfrog"] - table["external_work"]
    held = table["internal"] + (table["eroded"] if "eroded" in table else 0.0)
    kept = held - held[1]
    run.check(f"{name}: internal energy is the work of the sides", kept[1:], moving[1] - moving[1:])


def check_failure(run):
    """FAIL of 003, 024, 010 and PSFAIL of 098: no stress from there on; energy and plastic strain stay."""
    path = (np.zeros(401), np.linspace(0.0, 0.06, 401))
    laws = {"003": lambda deck: deck.add("*MAT_PLASTIC_KINEMATIC", (1, RHO, YOUNG, POISSON, A, 1.0e9, 0.5), (0.0, 0.0, 0.02)),
            "024": lambda deck: deck.add("*MAT_PIECEWISE_LINEAR_PLASTICITY", (1, RHO, YOUNG, POISSON, A, 1.0e9, 0.02)),
            "098": lambda deck: deck.add("*MAT_SIMPLIFIED_JOHNSON_COOK", (1, RHO, YOUNG, POISSON), (A, B, N, C, 0.02, 0.0, 0.0, RATE)),
            "010": lambda deck: gruneisen(deck.add("*MAT_ELASTIC_PLASTIC_HYDRO", (1, RHO, G, A, 1.0e9, 0.0, 0.02)))}
    for law, material in laws.items():
        for name, form in list(FORMS.items())[:2]:
            result = run.program(element(material, path, form, int(law == "010")), name=f"fail_{law}_{form[1] or 1}")
            p = scalar(result, "plastic_strain")
            n = int(np.argmax(p >= 0.02))
            run.true(f"FAIL of {law}{name}: it fails on the way", 20 < n < 390)
            run.check(f"FAIL of {law}{name}: no stress", result.cells("stress")[n:, 0], 0.0)
            run.check(f"FAIL of {law}{name}: plastic strain stays", p[n:], p[n])
            run.true(f"FAIL of {law}{name}: there was stress", mises_of(result)[n - 1] > 0.9 * A)
            check_balance(run, result, f"FAIL of {law}{name}")
            log = (result.folder / f"{result.job}.log").read_text()
            run.true(f"FAIL of {law}{name}: the element leaves the mesh",
                     result.cells("eroded")[n:].min() > 0.5 and result.cells("eroded")[n - 1].max() < 0.5
                     and "eroded elements: 1," in log)


def check_gas(run):
    """An ideal gas without heat: p v^gamma is constant; of second order in the step."""
    gamma, p0, errors = 1.4, 1.0e5, []
    for n_step in (200, 400):
        path = (np.zeros(n_step + 1), np.linspace(0.0, -0.6, n_step + 1))
        result = run.program(element(lambda deck: deck.add("*MAT_NULL", (1, 1.2)).add(
            "*EOS_LINEAR_POLYNOMIAL", (1, 0.0, 0.0, 0.0, 0.0, gamma - 1.0, gamma - 1.0, 0.0),
            (p0 / (gamma - 1.0), 1.0)), path, eos=1, n_step=n_step), name=f"gas_{n_step}")
        expected = p0 * (1.0 + path[1]) ** -gamma
        run.check(f"adiabatic compression, {n_step} steps", scalar(result, "pressure"), expected)
        errors.append(np.abs(scalar(result, "pressure") - expected).max())
        energy = result.table("glstat")["internal"]
        run.check(f"energy of the gas, {n_step} steps", energy, expected * (1.0 + path[1]) / (gamma - 1.0))
    run.check("order of the energy", np.log2(errors[0] / errors[1]), 2.0)


def hugoniot_free(v, gamma=GAMMA, s=(S1, 0.0, 0.0)):
    """A(mu) and B(mu) of Gruneisen's equation."""
    mu = 1.0 / v - 1.0
    low = 1.0 - (s[0] - 1.0) * mu - s[1] * mu ** 2 / (1.0 + mu) - s[2] * mu ** 3 / (1.0 + mu) ** 2
    a = RHO * SPEED ** 2 * mu * np.where(mu > 0.0, (1.0 + (1.0 - 0.5 * gamma) * mu - 0.5 * CORRECTION * mu ** 2)
                                         / low ** 2, 1.0)
    return a, gamma + CORRECTION * mu


def isentrope(path, energy, functions, n_sub=20):
    """dE = -p dv by the classical method of Runge and Kutta, finer than the steps."""
    pressures = []
    e = energy
    for start, end in zip(path[:-1], path[1:]):
        a, b = functions(start)
        pressures.append(a + b * e)
        h = (end - start) / n_sub
        for k in range(n_sub):
            v = start + k * h

            def slope(v, e):
                a, b = functions(v)
                return -(a + b * e)
            k1 = slope(v, e)
            k2 = slope(v + 0.5 * h, e + 0.5 * h * k1)
            k3 = slope(v + 0.5 * h, e + 0.5 * h * k2)
            k4 = slope(v + h, e + h * k3)
            e = e + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
    a, b = functions(path[-1])
    return np.array(pressures + [a + b * e]), e


def check_isentrope(run):
    """Compression by 15 % and release into expansion, along the isentrope."""
    w = np.concatenate([np.linspace(0.0, -0.15, 201), np.linspace(-0.15, 0.03, 201)[1:]])
    s = (S1, 0.3, -0.2)
    for name, form in FORMS.items():
        result = run.program(element(lambda deck: gruneisen(deck.add("*MAT_NULL", (1, RHO)), s=s, energy=2.0e8),
                                     (np.zeros(401), w), form, 1), name=f"isentrope_{form[0]}_{form[1] or 1}")
        expected, _ = isentrope(1.0 + w, 2.0e8, lambda v: hugoniot_free(np.asarray(v), s=s))
        run.check(f"isentropic compression and release{name}", scalar(result, "pressure"), expected)
    c = (1.0e9, 120.0e9, 90.0e9, 40.0e9, 1.5, 1.2, 0.4)

    def polynomial(v):
        mu = 1.0 / v - 1.0
        up = max(0.0, mu)
        return (c[0] + c[1] * mu + c[2] * up ** 2 + c[3] * mu ** 3, c[4] + c[5] * mu + c[6] * up ** 2)
    result = run.program(element(lambda deck: deck.add("*MAT_NULL", (1, RHO)).add(
        "*EOS_LINEAR_POLYNOMIAL", (1, *c), (3.0e8, 1.0)), (np.zeros(401), w), eos=1), name="polynomial")
    expected, _ = isentrope(1.0 + w, 3.0e8, polynomial)
    run.check("isentrope of the polynomial", scalar(result, "pressure"), expected)


def check_spall(run):
    """Cut-offs in expansion. The largest stress is 2/3 of the flow stress above the mean one, some steps' worth, so that 2 and 3 break
    at steps of their own."""
    path, broke = (np.zeros(401), np.linspace(0.0, 0.05, 401)), {}
    for spall in (1, 2, 3):
        result = run.program(element(lambda deck, spall=spall: gruneisen(johnson_cook(deck, pc=-2.0e9, spall=float(spall))),
                                     path, eos=1), name=f"spall_{spall}")
        mean, q = -scalar(result, "pressure"), mises_of(result)
        largest = result.cells("stress")[:, 0, :3].max(axis=1)
        if spall == 1:
            run.check("least pressure", mean.max(), 2.0e9)
            run.true("least pressure: the deviator stays", q[-1] > A)
            continue
        watched = largest if spall == 2 else mean
        n = int(np.argmax(watched > 2.0e9))
        run.true(f"spall {spall}: it breaks on the way", 20 < n < 380)
        run.check(f"spall {spall}: it stands till then", q[:n].argmin(), 0)
        run.check(f"spall {spall}: mean stress at the break", mean[n],
                  2.0e9 - (2.0 / 3.0 * q[n] if spall == 2 else 0.0), tol=mean[n] - mean[n - 1])
        broke[spall] = n
        run.check(f"spall {spall}: nothing behind", result.cells("stress")[n + 1:, 0, :3], 0.0)
    run.check("the largest stress breaks before the mean one", broke[3] - broke[2], 3)
    fluid = run.program(element(lambda deck: gruneisen(deck.add("*MAT_NULL", (1, RHO, -1.0e8))), path, eos=1), name="cavity")
    run.check("fluid: least pressure", -scalar(fluid, "pressure")[-1], 1.0e8)


def check_viscous(run):
    """A fluid in steady stretch: s_xx = 2 mu dev(D)."""
    u, w = isochoric(0.3)
    result = run.program(element(lambda deck: gruneisen(deck.add("*MAT_NULL", (1, RHO, 0.0, 50.0))), (u, w), eos=1),
                         name="viscous")
    rate = equivalent_rate(u, w, END / 400)
    run.check("deviator of a viscous fluid", mises_of(result)[1:], 3.0 * 50.0 * rate)


def check_piston(run):
    """A piston at u drives a shock U = C + S1 u: p = rho0 U u, v = 1 - u/U, E = rho0 u^2/2 behind it."""
    u, n, length = 600.0, 200, 0.1
    shock = SPEED + S1 * u
    end = 0.7 * length / shock
    deck = Deck("piston")
    deck.control(end, scale=0.6)
    deck.add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    deck.add("*PART", "column", (1, 1, 1, 1))
    deck.add("*SECTION_SHELL", (1, 13), (1.0,))
    gruneisen(deck.add("*MAT_NULL", (1, RHO)))
    nodes = deck.mesh(*grid(n, 1, length, length / n))
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
    deck.fix(nodes, y=1)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), u) for node in nodes[[0, n + 1]]])
    for node in nodes[[0, n + 1]]:
        deck.prescribe(node, 1, 0, 1, u)
    result = run.program(deck.output(plot=end, glstat=end / 20), name="piston")
    pressure = result.cells("pressure")[-1].ravel()
    x = result.points("Points")[-1][:n + 1, 0]
    middle = 0.5 * (x[1:] + x[:-1])
    behind = (middle > u * end + 0.15 * length) & (middle < 0.9 * shock * end)
    run.true("piston: a plateau of elements", behind.sum() > 30)
    run.check("piston: pressure behind the front", pressure[behind],
              np.full(behind.sum(), RHO * shock * u))
    run.check("piston: volume behind the front", np.diff(x)[behind] * n / length,
              np.full(behind.sum(), 1.0 - u / shock))
    a, b = hugoniot_free(np.diff(x) * n / length)
    run.check("piston: energy behind the front", ((pressure - a) / b)[behind],
              np.full(behind.sum(), 0.5 * RHO * u ** 2))
    front = middle[np.argmax(pressure < 0.5 * RHO * shock * u)]
    run.check("piston: place of the front", front, shock * end)
    table = result.table("glstat")
    total = table["kinetic"] + table["internal"] + table["hourglass"] + table["viscous"] + table["leapfrog"]
    run.check("piston: balance", total - total[0], table["external_work"])


def check(run):
    check_flow(run)
    check_axisymmetric(run)
    check_heat(run)
    check_damage(run)
    check_failure(run)
    check_gas(run)
    check_isentrope(run)
    check_spall(run)
    check_viscous(run)
    check_piston(run)
