# SPDX-License-Identifier: MIT
"""Elements that leave the mesh: when, what they take along, and surfaces of contact that follow."""
import numpy as np

from meshes import Deck, grid, moduli

RHO, YOUNG, POISSON = 7850.0, 2.1e11, 0.3
BULK, SHEAR = moduli(YOUNG, POISSON)[:2]
WAVE = BULK + 4.0 * SHEAR / 3.0
END, N_STEP, STRETCH = 1.0e-3, 200, 0.2
TIMES = np.linspace(0.0, END, N_STEP + 1)
#: ELFORM, NIP
FORMS = {"one point": (13, None), "2x2 points": (13, 4), "round": (15, None)}


def histories(sign):
    """Uniaxial strain along y: all that criteria look at, at each step."""
    strain = np.log(1.0 + sign * STRETCH * TIMES / END)
    stress = WAVE * strain
    impulse = np.cumsum(np.maximum(0.0, np.maximum(stress, stress * (1.0 - 2.0 * SHEAR / WAVE)) - 1.0e9) ** 2) * END / N_STEP
    return {"MXPRES": -BULK * strain, "MNPRES": -BULK * strain, "SIGP1": np.maximum(stress, (BULK - 2.0 * SHEAR / 3.0) * strain),
            "SIGVM": 2.0 * SHEAR * np.abs(strain), "MXEPS": np.maximum(strain, 0.0), "MNEPS": np.minimum(strain, 0.0),
            "EFFEPS": 2.0 / 3.0 * np.abs(strain), "VOLEPS": strain, "EPSSH": 0.5 * np.abs(strain), "IMPULSE": impulse,
            "FAILTM": TIMES}


FIELDS = ("EXCL", "MXPRES", "MNEPS", "EFFEPS", "VOLEPS", "NUMFIP", "NCS", "MNPRES", "SIGP1", "SIGVM", "MXEPS", "EPSSH", "SIGTH",
          "IMPULSE", "FAILTM")


def limit_of(name, sign, step):
    """Between the values of two steps."""
    values = histories(sign)[name]
    return 0.5 * (values[step - 1] + values[step])


def cases(sign):
    """Criteria, and the step at which their element leaves: alone, two that must both hold, one that EXCL takes out."""
    alone = ("FAILTM", "SIGVM", "EFFEPS", "EPSSH", "VOLEPS") + (("MNPRES", "SIGP1", "MXEPS", "IMPULSE") if sign > 0
                                                               else ("MXPRES", "MNEPS"))
    found = []
    for k, name in enumerate(alone):
        step = 60 + 7 * k
        card = {name: limit_of(name, sign, step)}
        found.append((name, card | ({"SIGTH": 1.0e9} if name == "IMPULSE" else {}), step))
    both = {"FAILTM": limit_of("FAILTM", sign, 50), "EFFEPS": limit_of("EFFEPS", sign, 120)}
    found.append(("one of two", both, 50))
    found.append(("both of two", both | {"NCS": 2.0}, 120))
    found.append(("a field that is EXCL", {"EXCL": 77.0, "EFFEPS": 77.0, "FAILTM": limit_of("FAILTM", sign, 90)}, 90))
    return found


def gone_of(result):
    """(state, element): 1 once an element has left."""
    field = result.cells("eroded")
    return field.reshape(field.shape[0], field.shape[1])


def check_criteria(run):
    """Squares side by side, each of a material of its own, all strained alike: each leaves at its step."""
    for form, (elform, points) in FORMS.items():
        for sign in (1.0, -1.0):
            deck = Deck("criteria")
            deck.control(END, dt=END / N_STEP)
            deck.add("*SECTION_SHELL", (1, elform, None, points), (1.0,))
            deck.curve(1, [(0.0, 0.0), (END, sign * STRETCH)])
            wanted = cases(sign)
            for k, (_, card, _) in enumerate(wanted, 1):
                deck.add("*PART", f"square {k}", (k, 1, k))
                deck.elastic(RHO, YOUNG, POISSON, material=k)
                values = [k] + [card.get(name) for name in FIELDS]
                deck.add("*MAT_ADD_EROSION", values[:8], values[8:])
                nodes = deck.mesh(*grid(1, 1, origin=(10.0 + 2.0 * k, 0.0)), part=k)
                deck.fix(nodes, x=1)
                deck.fix(nodes[:2], y=1)
                for node in nodes[2:]:
                    deck.prescribe(node, 2, 2, 1)
            deck.output(plot=END / N_STEP, glstat=END / N_STEP)
            side = "tension" if sign > 0 else "compression"
            result = run.program(deck, name=f"criteria_{form.replace(' ', '_')}_{side}")
            gone = gone_of(result)
            for k, (name, _, step) in enumerate(wanted):
                run.check(f"{form}, {side}: step at which {name} takes the element", int(np.argmax(gone[:, k] > 0.5)), step)
            table = result.table("glstat")
            kept = table["total"] - table["external_work"]
            run.check(f"{form}, {side}: balance with what has gone", kept[1:], kept[1], scale=table["eroded"][-1])


def check_least_step(run):
    """ERODE: the element that is crushed leaves when its step has fallen to DTMIN of the first one, and the run goes on."""
    for erode in (0, 1):
        deck = Deck("crushed")
        end = 1.0
        deck.add("*CONTROL_TERMINATION", (end, 0, 0.5))
        deck.add("*CONTROL_TIMESTEP", (0.0, 0.9, 0, 0.0, 0.0, 0, erode))
        deck.curve(1, [(0.0, 0.0), (end, -0.9)])
        deck.add("*PART", "squares", (1, 1, 1))
        deck.add("*SECTION_SHELL", (1, 13), (1.0,))
        deck.elastic(RHO, 2.1e8, 0.0)
        nodes = deck.mesh(*grid(1, 1))
        deck.fix(nodes, x=1)
        deck.fix(nodes[:2], y=1)
        for node in nodes[2:]:
            deck.prescribe(node, 2, 2, 1)
        deck.mesh(*grid(1, 1, origin=(3.0, 0.0)))
        deck.output(plot=end / 400, glstat=end / 100)
        result = run.program(deck, name=f"least_step_{erode}", expect_status=2 - 2 * erode)
        if erode:
            gone = gone_of(result)
            height = 1.0 - 0.9 * result.times / end
            first = int(np.argmax(gone[:, 0] > 0.5))
            # p = -K ln v: waves run with sqrt(v) of their first speed, and the step falls as sqrt(v).
            run.check("ERODE: height at which the step is half of the first one", height[first], 0.25)
            run.true("and the other element stays", gone[-1, 1] < 0.5)


def falling_squares(friction, is_damped, is_axisymmetric):
    """Squares that come to a wall in one cycle after another and all leave in the same one."""
    deck, step, speed, last = Deck("squares on a wall"), 1.0e-6, 100.0, 12
    deck.control(2 * last * step, dt=step)
    deck.add("*SECTION_SHELL", (1, 15 if is_axisymmetric else 13), (1.0,))
    deck.add("*PART", "squares", (1, 1, 1))
    deck.elastic(RHO, YOUNG, POISSON)
    deck.add("*MAT_ADD_EROSION", (1,), (None,) * 7 + ((last - 0.5) * step,))
    nodes = []
    for k in range(last):
        nodes += list(deck.mesh(*grid(1, 1, 0.02, 0.02, (0.1 * k + 0.05, speed * step * (k + 6.3)))))
    deck.node_set(1, nodes)
    deck.add("*INITIAL_VELOCITY", (1,), (30.0, -speed))
    deck.add("*RIGIDWALL_PLANAR", (0,), (0.0, 0.0, 0.0, 0.0, 1.0, 0.0, friction))
    if is_damped:
        deck.add("*DAMPING_GLOBAL", (0, 2.0e4))
        deck.curve(1, [(0.0, 1.0), (1.0, 1.0)])
        deck.add("*LOAD_BODY_Y", (1, 1.0e6))
    return deck.output(glstat=step)


def check_walls(run):
    """Nodes that lose their last element while a wall pushes them: what the wall does on them yet goes with them."""
    for friction, is_damped, is_axisymmetric in ((0.0, False, False), (0.3, True, False), (0.3, True, True)):
        name = f"wall_{friction:g}_{'damped_' if is_damped else ''}{'round' if is_axisymmetric else 'plane'}"
        table = run.program(falling_squares(friction, is_damped, is_axisymmetric), name=name).table("glstat")
        kept = table["total"] - table["external_work"]
        run.check(f"{name}: balance of squares that leave as they meet a wall", kept, kept[0])
        run.true(f"{name}: all have left", table["kinetic"][-1] == 0.0 and table["eroded"][-1] > 0.0)


def check_common(run):
    """Nodes of two squares move alike: the one that leaves first takes nothing from the other, and after both the run goes on."""
    deck, step, speed = Deck("two squares that move alike"), 1.0e-6, 100.0
    deck.control(30 * step, dt=step)
    deck.add("*SECTION_SHELL", (1, 13), (1.0,))
    nodes = []
    for k, leaves in enumerate((10.5, 20.5), 1):
        deck.add("*PART", f"square {k}", (k, 1, k))
        deck.elastic(RHO, YOUNG, POISSON, material=k)
        deck.add("*MAT_ADD_EROSION", (k,), (None,) * 7 + (leaves * step,))
        nodes.append(deck.mesh(*grid(1, 1, 0.02, 0.02, (0.1 * k, 0.0)), part=k))
    deck.node_set(1, [nodes[0][1], nodes[1][0], nodes[1][3]])
    deck.add("*CONSTRAINED_NODE_SET", (1, 1))
    deck.node_set(2, [*nodes[0], *nodes[1]])
    deck.add("*INITIAL_VELOCITY", (2,), (speed, 0.0))
    result = run.program(deck.output(glstat=step, matsum=step), name="common")
    second = result.table("matsum").where(part=2)
    run.check("common: velocity of the square that stays", second["momentum_x"][:20] / second["mass"][:20], speed)
    table = result.table("glstat")
    run.check("common: balance", table["total"], table["total"][0])
    run.true("common: both have left", table["kinetic"][-1] == 0.0 and table["eroded"][-1] > 0.0)


def check_led(run):
    """Squares that move as a whole, led or alike, with damping, weight or forces on their nodes, and leave: what leads a node pays
    for the half step ahead, which does not come any more. Nothing strains, so that the balance is exact."""
    step = 1.0e-6
    prescribed = ("*BOUNDARY_PRESCRIBED_MOTION_SET", (2, 1, 0, 1, 100.0))
    alike = ("*CONSTRAINED_NODE_SET", (2, 1))
    for name, cards in {
            "led, damped": (prescribed, ("*DAMPING_GLOBAL", (0, 3.0e4))),
            "led, with weight": (prescribed, ("*LOAD_BODY_X", (1, 3.0e6))),
            "led, under forces": (prescribed, ("*LOAD_NODE_SET", (2, 1, 1, 1.0e5))),
            "alike, under forces": (alike, ("*LOAD_NODE_SET", (2, 1, 1, 1.0e5))),
            "alike, one set each, under forces": (("*CONSTRAINED_NODE_SET", (3, 1)), ("*CONSTRAINED_NODE_SET", (4, 1)),
                                                  ("*LOAD_NODE_SET", (2, 1, 1, 1.0e5)))}.items():
        deck = Deck(name)
        deck.control(30 * step, dt=step)
        deck.add("*SECTION_SHELL", (1, 13), (1.0,))
        nodes = []
        for k, leaves in enumerate((10.5, 20.5), 1):
            deck.add("*PART", f"square {k}", (k, 1, k))
            deck.elastic(RHO, YOUNG, POISSON, material=k)
            deck.add("*MAT_ADD_EROSION", (k,), (None,) * 7 + (leaves * step,))
            nodes.append(deck.mesh(*grid(1, 1, 0.02, 0.02, (0.1 * k, 0.0)), part=k))
            deck.node_set(2 + k, nodes[-1])
        deck.node_set(2, [*nodes[0], *nodes[1]])
        deck.add("*INITIAL_VELOCITY", (2,), (100.0, 0.0))
        deck.add("*DEFINE_CURVE", (1,), (0.0, 1.0), (1.0, 1.0))
        for card in cards:
            deck.add(*card)
        table = run.program(deck.output(glstat=step), name=name.replace(" ", "_").replace(",", "")).table("glstat")
        run.check(f"{name}: balance / largest energy", table["total"] - table["external_work"] - table["total"][0], 0.0,
                  scale=np.max(np.abs(table["total"])))
        run.true(f"{name}: both have left", table["eroded"][-1] > 0.0 and abs(table["kinetic"][-1]) == 0.0)


def plate_and_rod(speed, is_axisymmetric, is_rigid, radius=0.04, fail=0.4, is_self=False):
    """A blunt rod, 80 mm long and of 10 mm radius, on a clamped plate of 12 mm."""
    deck = Deck("penetration")
    end = 30.0e-3 / speed
    deck.add("*CONTROL_TERMINATION", (end, 0, 0.02))
    deck.add("*CONTROL_TIMESTEP", (0.0, 0.8, 0, 0.0, 0.0, 0, 1))
    deck.add("*PART", "plate", (1, 1, 1))
    deck.add("*PART", "rod", (2, 1, 2))
    deck.add("*SECTION_SHELL", (1, 15 if is_axisymmetric else 13), (1.0,))
    deck.add("*MAT_PLASTIC_KINEMATIC", (1, RHO, YOUNG, POISSON, 6.0e8, 1.0e9, 1.0), (0.0, 0.0, fail))
    if is_rigid:
        deck.add("*MAT_RIGID", (2, RHO, YOUNG, POISSON))
    else:
        deck.add("*MAT_PLASTIC_KINEMATIC", (2, RHO, YOUNG, POISSON, 1.5e9, 5.0e9, 1.0), (0.0,))
    sides = 1 if is_axisymmetric else 2
    left = 0.0 if is_axisymmetric else -1.0
    plate = deck.mesh(*grid(sides * 24 if is_axisymmetric else 40, 8, sides * radius, 0.012, (left * radius, 0.0)), part=1)
    rod = deck.mesh(*grid(sides * 5, 10, sides * 0.01, 0.08, (left * 0.01, 0.012)), part=2)
    n = (sides * 24 if is_axisymmetric else 40) + 1
    edge = list(plate[n - 1::n]) + ([] if is_axisymmetric else list(plate[::n]))
    deck.fix(edge, x=1, y=1)
    for number, parts in ((1, (1,)), (2, (2,)), (3, (1, 2))):
        deck.add("*SET_PART_LIST", (number,), parts if len(parts) > 1 else (*parts, None))
    deck.add("*CONTACT_2D_SLIDELINE", (3, 0, 5, 2, 1.0) if is_self else (1, 2, 5, 2, 1.0), (0.0, 1.0e20, 2))
    if is_rigid:
        deck.add("*INITIAL_VELOCITY_RIGID_BODY", (2, 0.0, -speed))
    else:
        deck.node_set(8, rod)
        deck.add("*INITIAL_VELOCITY", (8,), (0.0, -speed))
    return deck.output(glstat=end / 100, matsum=end / 100)


def residual(run, speed, is_axisymmetric, is_rigid, **options):
    """Velocity behind the plate; the balance on the way."""
    name = f"{'round' if is_axisymmetric else 'plane'}_{'rigid' if is_rigid else 'deformable'}{'_self' if options else ''}_{speed:g}"
    result = run.program(plate_and_rod(speed, is_axisymmetric, is_rigid, **options), name=name)
    table = result.table("glstat")
    run.check(f"{name}: balance with what has gone", table["total"], table["total"][0])
    run.true(f"{name}: elements have gone", table["eroded"][-1] > 0.01 * table["total"][0])
    rod = result.table("matsum").where(part=2)
    return -rod["momentum_y"][-1] / rod["mass"][-1]


def check_penetration(run):
    """Behind a plate that loses a plug: V_r = M/(M + m) sqrt(V_i^2 - V_bl^2) (Recht & Ipson 1963), V_bl from one of the runs."""
    share = 0.080 / (0.080 + 0.012)
    speeds = (200.0, 400.0, 600.0)
    known = residual(run, 300.0, True, True)
    square = 300.0 ** 2 - (known / share) ** 2
    run.report("round, rigid: ballistic limit by the run at 300 m/s", float(np.sqrt(square)), "m/s")
    for speed in speeds:
        run.check(f"round, rigid, {speed:g} m/s: residual velocity",
                  residual(run, speed, True, True), share * np.sqrt(speed ** 2 - square))
    for is_axisymmetric, is_rigid, options in ((False, True, {}), (True, False, {}), (False, False, {}), (False, False, {"is_self": True})):
        run.report(f"{'round' if is_axisymmetric else 'plane'}, {'rigid' if is_rigid else 'deformable'}"
                   f"{', one surface with itself' if options else ''}, 300 m/s: residual velocity",
                   residual(run, 300.0, is_axisymmetric, is_rigid, **options), "m/s")


def check(run):
    check_criteria(run)
    check_least_step(run)
    check_walls(run)
    check_common(run)
    check_led(run)
    check_penetration(run)
