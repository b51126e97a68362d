# SPDX-License-Identifier: MIT
"""From stage to stage through <job>.dynain: states that stay, equilibria at rest, springback, a press fit that is loaded."""
import numpy as np

from meshes import Deck, grid

RHO, YOUNG, POISSON, YIELD, TANGENT = 1000.0, 2.0e5, 0.3, 200.0, 2.0e4
HARDENING = YOUNG * TANGENT / (YOUNG - TANGENT)
SHEAR = YOUNG / (2.0 * (1.0 + POISSON))
LAWS = {
    "elastic": lambda deck: deck.elastic(RHO, YOUNG, POISSON),
    "MAT_003": lambda deck: deck.plastic(RHO, YOUNG, POISSON, YIELD, TANGENT),
    "MAT_003, mixed": lambda deck: deck.plastic(RHO, YOUNG, POISSON, YIELD, TANGENT, 0.4),
    "MAT_024": lambda deck: deck.add("*MAT_PIECEWISE_LINEAR_PLASTICITY", (1, RHO, YOUNG, POISSON), (),
                                     (0.0, 0.01), (YIELD, YIELD + 0.01 * HARDENING)),
    "MAT_098": lambda deck: deck.add("*MAT_SIMPLIFIED_JOHNSON_COOK", (1, RHO, YOUNG, POISSON),
                                     (YIELD, 1000.0, 0.5, 0.0)),
    "MAT_015": lambda deck: deck.add("*MAT_JOHNSON_COOK", (1, RHO, SHEAR, YOUNG, POISSON),
                                     (YIELD, 1000.0, 0.5, 0.0, 1.0, 1000.0, 300.0, 1.0), (1.0e6,), (0.0,)),
}
FORMS = {"plane strain": (13, 1.0), "axisymmetric": (15, 1.0), "plane stress": (12, 0.2)}


def read_file(path):
    """Numbers of a dynain file by keyword: {element or node: array}, in the widths of their cards."""
    found, keyword, rest = {}, "", []
    for line in path.read_text().splitlines():
        if line.startswith("*"):
            keyword, rest = line.split()[0][1:], []
            found.setdefault(keyword, {})
        elif line.startswith("$") or not line.strip():
            continue
        elif keyword == "NODE":
            found[keyword][int(line[:20])] = np.array([float(line[20:40]), float(line[40:60])])
        elif keyword == "ELEMENT_SHELL":
            fields = [int(line[k:k + 8]) for k in range(0, 48, 8)]
            found[keyword][fields[0]] = np.array(fields[1:])
        elif not rest:
            head = [int(line[k:k + 10]) for k in range(0, len(line), 10)]
            cards = 2 + -(-head[3] // 5) if keyword == "INITIAL_STRESS_SHELL" else 2
            rest, element = [[] for _ in range(head[1] * cards)], head[0]
            found[keyword][element] = []
        else:
            found[keyword][element] += [float(line[k:k + 16]) for k in range(0, len(line), 16)]
            rest.pop()
    return {key: {number: np.array(values) for number, values in rows.items()} for key, rows in found.items()}


def table(file, keyword):
    """All values of a keyword, element by element."""
    return np.array([file[keyword][number] for number in sorted(file[keyword])])


def start(form, points, law, hourglass=None, elements=None):
    """A deck with section, part and material."""
    number, thickness = FORMS[form]
    deck = Deck("stage").add("*SECTION_SHELL", (1, number, None, points), (thickness,))
    deck.add("*PART", "body", (1, 1, 1))
    LAWS[law](deck)
    if form == "plane stress" and points:
        deck.add("*CONTROL_SHELL", (0, 0, 0, 1))
    return deck.hourglass(*hourglass) if hourglass else deck


def springback(deck):
    return deck.add("*INTERFACE_SPRINGBACK_LSDYNA", (0, 0))


def from_file(deck, result):
    """The mesh and state of the stage before."""
    return deck.add("*INCLUDE", str(result.folder / f"{result.job}.dynain"))


def moved_patch():
    """A mesh of 3 x 2 quads off the axis, and a smooth displacement of its nodes."""
    place, quads = grid(3, 2, 1.5, 1.0, (0.5, 0.0))
    inside = [5, 6]
    place[inside] += [(0.06, 0.05), (-0.05, 0.08)]
    x, y = place.T
    return place, quads, np.column_stack([0.02 * x + 0.03 * y * (x - 0.5), 0.01 * x * y - 0.015 * y + 0.02 * (x - 0.5) ** 2])


def check_states(run):
    """A patch is deformed, and every value comes through a stage that does nothing."""
    place, quads, moves = moved_patch()
    for law, form, points, hourglass in run.cover(LAWS, FORMS, (None, 4), (None, (4, 0.1), (6, 1.0))):
        decks = []
        for stage in range(2):
            deck = springback(start(form, points, law, hourglass))
            deck.control(2.0e-2 if stage == 0 else 1.0e-3, dt=1.0e-4)
            decks.append(deck)
        ids = decks[0].mesh(place, quads)
        decks[0].curve(1, [(0.0, 0.0), (2.0e-2, 1.0)])
        for node, (u, v) in zip(ids, moves):
            decks[0].prescribe(node, 1, 2, 1, u).prescribe(node, 2, 2, 1, v)
        first = run.program(decks[0])
        decks[1].fix(ids, x=1, y=1)
        second = run.program(from_file(decks[1], first))
        one, two = [read_file(result.folder / f"{result.job}.dynain") for result in (first, second)]
        name = f"{law}, {form}, {'2x2 points' if points else '1 point'}" + (f", IHQ {hourglass[0]}" if hourglass else "")
        for quantity, keyword in [("stresses and history", "INITIAL_STRESS_SHELL"), ("strains", "INITIAL_STRAIN_SHELL"),
                                  ("positions", "NODE"), ("elements", "ELEMENT_SHELL")]:
            a, b = table(one, keyword), table(two, keyword)
            scale = np.maximum(np.abs(a).max(axis=0), 1e-300)
            run.check(f"{name}: {quantity}", np.abs(b - a).max() if quantity == "elements" else
                      np.max(np.abs(b - a) / scale), 0.0)
        count = 4 if points else 1
        states = table(one, "INITIAL_STRESS_SHELL").reshape(len(quads), count, -1)
        if law != "elastic":
            run.true(f"{name}: it flows", states[:, :, 7].max() > 1e-3)
        run.check(f"{name}: strain in the file", table(one, "INITIAL_STRAIN_SHELL").reshape(len(quads), count, -1)[:, :, :2],
                  hencky(place, quads, moves, count))


def hencky(place, quads, moves, count):
    """ln V in x and y at the points, from F of the shape functions."""
    at = 1.0 / np.sqrt(3.0)
    points = [(0.0, 0.0)] if count == 1 else [(-at, -at), (at, -at), (at, at), (-at, at)]
    found = np.empty((len(quads), count, 2))
    for i, quad in enumerate(quads):
        for k, (a, b) in enumerate(points):
            rates = 0.25 * np.array([[-(1 - b), 1 - b, 1 + b, -(1 + b)], [-(1 - a), -(1 + a), 1 + a, 1 - a]])
            gradient = (place + moves)[list(quad)].T @ rates.T @ np.linalg.inv(place[list(quad)].T @ rates.T)
            values, axes = np.linalg.eigh(gradient @ gradient.T)
            strain = axes @ np.diag(0.5 * np.log(values)) @ axes.T
            found[i, k] = strain[0, 0], strain[1, 1]
    return found


def check_rest(run):
    """An equilibrium stays at rest in the next stage: accelerations times masses beside the forces of the stresses."""
    place, quads = grid(6, 4, 1.5, 1.0, (0.5, 0.0))
    row = np.arange(7)
    for form, points, implicit in run.cover(FORMS, (None, 4), (False, True)):
        decks, count = [], len(place)
        for stage in range(3 if implicit else 2):
            deck = start(form, points, "MAT_003, mixed", (6, 1.0) if not points and implicit else None)
            if implicit and stage != 1:
                deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.5 if stage else 0.05))
            else:
                deck.add("*CONTROL_TERMINATION", (0.5 if stage else 4.0,)).add("*CONTROL_TIMESTEP", (0.0, 0.9))
                if stage == 0:
                    deck.add("*DAMPING_GLOBAL", (0, 25.0))
            decks.append(springback(deck))
        ids = decks[0].mesh(place, quads)
        end = 1.0 if implicit else 0.4
        decks[0].curve(1, [(0.0, 0.0), (end, 1.0), (1.0e3, 1.0)])
        decks[0].fix(ids[row], x=1, y=1)
        for node in ids[28 + row]:
            decks[0].prescribe(node, 1, 2, 1, 0.004).prescribe(node, 2, 2, 1, 0.006)
        first = run.program(decks[0])
        for deck in decks[1:]:
            deck.fix([*ids[row], *ids[28 + row]], x=1, y=1)
            deck.output(nodout=0.5, nodes=ids, glstat=0.5)
        second = run.program(from_file(decks[1], first))
        rows = second.table("nodout").where(time=0.0)
        ends = second.table("nodout")
        ends = ends.where(time=ends["time"].max())
        free = np.ones(count, dtype=bool)
        free[[*row, *(28 + row)]] = False
        size = 1.5 / 6 * 1.0 / 4 * RHO * (2.0 if form == "axisymmetric" else FORMS[form][1])
        force = np.hypot(rows["ax"], rows["ay"])[free].max() * size / (YIELD * FORMS[form][1] * 0.25)
        name = f"{form}, {'2x2 points' if points else '1 point'}, {'implicit' if implicit else 'damped'}"
        run.check(f"{name}: force at rest over those of the stresses", force, 0.0)
        run.check(f"{name}: motion at rest", np.hypot(ends["ux"], ends["uy"]).max() / 0.006, 0.0)
        if implicit:  # its residual is round-off from the start, and all forces at free nodes cancel
            still = run.program(from_file(decks[2], first)).table("nodout")
            run.check(f"{name}, implicit: motion at rest", np.hypot(still["ux"], still["uy"]).max() / 0.006, 0.0)
        run.true(f"{name}: it flows", table(read_file(first.folder / f"{first.job}.dynain"),
                                            "INITIAL_STRESS_SHELL")[:, 7].max() > 1e-3)


def check_bar(run):
    """A bar under plane stress is stretched by 1 % and released in the next stage: ln(l/L) = p, without stress."""
    for law, implicit in run.cover(("MAT_003", "MAT_003, mixed", "MAT_024"), (False, True)):
        first = springback(start("plane stress", 4, law))
        first.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.02))
        ids = first.mesh(*grid(4, 2, 2.0, 1.0)).reshape(3, 5)
        first.fix(ids[:, 0], x=1).fix(ids[0], y=1).curve(1, [(0.0, 0.0), (1.0, 0.02)])
        for node in ids[:, -1]:
            first.prescribe(node, 1, 2, 1)
        first = run.program(first)
        second = springback(start("plane stress", 4, law))
        if implicit:
            second.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
        else:
            second.control(3.0, dt=2.0e-3 * 0.9).add("*DAMPING_GLOBAL", (0, 20.0))
        second.fix(ids[:, 0], x=1).fix(ids[0], y=1)
        second = run.program(from_file(second, first))
        flow = (YOUNG * np.log(1.01) - YIELD) / (YOUNG + HARDENING)
        file = read_file(second.folder / f"{second.job}.dynain")
        name = f"{law}, {'implicit' if implicit else 'explicit'}"
        length = np.array([file["NODE"][node][0] for node in ids[:, -1]])
        stress = table(file, "INITIAL_STRESS_SHELL").reshape(8, 4, -1)
        run.check(f"{name}: residual strain of the bar", np.log(length / 2.0), np.full(3, flow))
        run.check(f"{name}: plastic strain of the bar", stress[:, :, 7], np.full((8, 4), flow))
        run.check(f"{name}: stress of the released bar", np.abs(stress[:, :, 1:5]).max() / YIELD, 0.0)


def check_beam(run):
    """A beam of a perfectly plastic sheet is bent to three times its elastic curvature and released: the elastic
    part of the moment, 1.5 (1 - 1/27) of that of first yield, springs back."""
    length, height, n, flow = 4.0, 1.0, 16, 0.1 * YIELD
    curvature = 3.0 * 2.0 * flow / (YOUNG * height)
    decks = []
    for stage in range(2):
        deck = Deck("beam").add("*SECTION_SHELL", (1, 12, None, 4), (1.0,)).add("*PART", "beam", (1, 1, 1))
        deck.plastic(RHO, YOUNG, POISSON, flow)
        deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.05 if stage == 0 else 1.0))
        decks.append(springback(deck))
    m = 32
    place, quads = grid(m, n, length, height, (0.0, -0.5 * height))
    ids = decks[0].mesh(place, quads).reshape(n + 1, m + 1)
    decks[0].curve(1, [(0.0, 0.0), (1.0, 1.0)])
    for deck in decks:
        deck.fix(ids[:, 0], x=1).fix([ids[n // 2, 0]], y=1)
    # The end comes nearer by what the bent axis is longer than its chord.
    for j in range(n + 1):
        decks[0].prescribe(ids[j, -1], 1, 2, 1, -curvature * length * place[(m + 1) * j, 1] - curvature ** 2 * length ** 3 / 6.0)
    first = run.program(decks[0])
    second = run.program(from_file(decks[1], first))

    def turn(result):
        file = read_file(result.folder / f"{result.job}.dynain")
        x = np.array([file["NODE"][node][0] for node in ids[:, -1]])
        return -np.polyfit(place[m::m + 1, 1], x, 1)[0] / (curvature * length)

    elastic = 1.5 * (1.0 - 1.0 / 27.0) / 3.0
    run.check("turn of the bent beam", turn(first), 1.0)
    run.check("turn of the released beam", turn(second), 1.0 - elastic)
    file = read_file(second.folder / f"{second.job}.dynain")
    top = table(file, "INITIAL_STRESS_SHELL").reshape(n, m, 4, -1)[-1, m // 2 - 1:m // 2 + 1, :, 1].mean()
    # In the upper row: yield stress in compression, less the elastic stress of the moment there.
    run.check("stress at the surface of the released beam", top / flow, -1.0 + 3.0 * elastic * (1.0 - 1.0 / n))


def check_bend(run):
    """The V bend of input/: springback of the implicit stage beside that of the explicit run that is damped."""
    text = (run.root / "input/v_bend/v_bend.k").read_text().replace("*END", "*INTERFACE_SPRINGBACK_LSDYNA\n1,\n*END")
    nodes = [1, 241, 361]
    # With the punch down, and lifted, with the damping of the deck.
    held = run.program(text, "p:endtim=0.0025", "p:dtplot=1.0", name="held")
    free = run.program(text, "p:endtim=0.005", "p:dtplot=1.0", name="free")
    deck = Deck("springback").add("*SECTION_SHELL", (1, 13, None, 4), (1.0,)).add("*PART", "sheet", (1, 1, 1))
    deck.plastic(7850.0, 2.1e11, 0.3, 2.5e8, 1.0e9)
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    shape = read_file(held.folder / "held.dynain")["NODE"]
    axis = [node for node, (x, _) in shape.items() if abs(x) < 1e-9]
    deck.fix(axis, x=1).fix([nodes[0]], y=1)
    free_stage = run.program(springback(from_file(deck, held)), name="implicit")

    def angle(result):
        file = read_file(result.folder / f"{result.job}.dynain")["NODE"]
        (x1, y1), (x2, y2) = file[nodes[1]], file[nodes[2]]
        return np.degrees(np.arctan2(y2 - y1, x2 - x1))

    before, explicit, implicit = angle(held), angle(free), angle(free_stage)
    run.report("V bend held", before, "degrees")
    run.check("angle of the V bend", implicit, explicit)
    run.check("springback of the V bend", implicit - before, explicit - before)


def check_press_fit(run):
    """A press fit by LCINT stays pressed in the next stage, whose contact is found anew, and resists the pull by friction."""
    bore, outer, tight, mu, penalty = 0.5, 2.0, 1.0e-4, 0.2, 1.0e7
    decks = []
    for stage in range(2):
        deck = Deck("press fit").add("*SECTION_SHELL", (1, 15, None, 4), (1.0,))
        deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.1))
        for part in (1, 2):
            deck.part(part, section=1).elastic(RHO, YOUNG, POISSON, part)
        deck.add("*SET_PART_LIST", (11,), (1,)).add("*SET_PART_LIST", (12,), (2,))
        decks.append(deck)
    columns, rows = 6, (4, 6)
    shaft = decks[0].mesh(*grid(columns, rows[0], 1.0 + tight - bore, 1.0, (bore, 0.0)), part=1).reshape(rows[0] + 1, -1)
    hub = decks[0].mesh(*grid(columns, rows[1], outer - 1.0, 1.0, (1.0, 0.0)), part=2).reshape(rows[1] + 1, -1)
    for deck in decks:
        deck.node_set(1, shaft[:, -1]).node_set(2, hub[::-1, 0])
    decks[0].curve(7, [(0.0, 0.0), (1.0, 1.0)])
    decks[0].add("*CONTACT_2D_SLIDELINE", (-1, -2, 5, 2, penalty), (0.0, 1.0e20, 1), (0.0, 1.0, 0, None, None, 7))
    decks[0].fix([*shaft[0], *shaft[-1], *hub[0], *hub[-1]], y=1).output(rcforc=0.1)
    first = run.program(springback(decks[0]))
    pull = 1.0e-4
    decks[1].curve(8, [(0.0, 0.0), (0.1, 0.0), (1.0, pull)]).output(rcforc=0.1)
    decks[1].add("*CONTACT_2D_SLIDELINE", (-1, -2, 5, 2, penalty, mu), (0.0, 1.0e20, 1))
    decks[1].fix([*hub[0], *hub[-1]], y=1)
    for node in [*shaft[0], *shaft[-1]]:
        decks[1].prescribe(node, 2, 2, 8)
    second = run.program(from_file(decks[1], first))
    before = first.table("rcforc").where(side="master")
    after = second.table("rcforc").where(side="master")
    # Lame, plane strain in z: shaft with a bore and hub, with the layer of springs.
    ratio = POISSON / (1.0 - POISSON)
    give = (1.0 - POISSON ** 2) / YOUNG * ((1.0 + bore ** 2) / (1.0 - bore ** 2) - ratio
                                           + (outer ** 2 + 1.0) / (outer ** 2 - 1.0) + ratio) + 1.0 / penalty
    run.check("pressure of the press fit", before["fx"][-1], tight / give)
    run.check("press fit in the second stage", after["fx"][0], before["fx"][-1])
    run.check("friction of the press fit when pulled", abs(after["fy"][-1]), mu * after["fx"][-1])
    run.check("force before the pull", after["fy"][1] / (mu * after["fx"][1]), 0.0)


def check_same_bits(run):
    """Threads and a restart leave the bits of the file, of a first and of a second stage."""
    place, quads, moves = moved_patch()
    result = None
    for stage in ("first", "second"):
        deck = springback(start("plane strain", None, "MAT_003, mixed", (4, 0.1)))
        deck.control(2.0e-2, dt=1.0e-4).add("*DATABASE_BINARY_D3DUMP", (100,))
        ids = from_file(deck, result) and range(1, 13) if result else deck.mesh(place, quads)
        deck.curve(1, [(0.0, 0.0), (2.0e-2, 1.0)])
        for node, (u, v) in zip(ids, moves):
            deck.prescribe(node, 1, 2, 1, u).prescribe(node, 2, 2, 1, v)
        result = run.program(deck, name=stage)
        two = run.program(deck, "ncpu=4", name=f"{stage}_threads")
        again = run.program(deck, f"r={result.folder / f'{stage}.dump01.h5'}", name=f"{stage}_again")
        files = [(one.folder / f"{one.job}.dynain").read_bytes() for one in (result, two, again)]
        run.true(f"{stage} stage: four threads write the same bits", files[1] == files[0])
        run.true(f"{stage} stage: a restart writes the same bits", files[2] == files[0])
    strains = table(read_file(result.folder / "second.dynain"), "INITIAL_STRAIN_SHELL").reshape(len(quads), 1, -1)
    run.check("both stages: strain in the file", strains[:, :, :2], hencky(place, quads, 2.0 * moves, 1))


def check(run):
    check_states(run)
    check_rest(run)
    check_bar(run)
    check_beam(run)
    check_press_fit(run)
    check_bend(run)
    check_same_bits(run)
