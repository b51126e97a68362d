# SPDX-License-Identifier: MIT
"""What a run says, and does, about penalties, springs and facets that are not fine enough for the answer."""
import re

import numpy as np
import pytest
from conftest import columns, drop, numbers, some_types
from meshes import Deck, grid
from test_implicit import implicit
from test_restart import assert_same, part_of, with_files

STOCK = "*CONTACT_2D_AUTOMATIC_"
MATERIALS = {"steel": (7.85e-9, 2.1e5, 0.3), "aluminium": (2.7e-9, 7.0e4, 0.33), "brass": (8.5e-9, 1.0e5, 0.35),
             "lead": (11.34e-9, 1.6e4, 0.42), "rubber": (1.1e-9, 5.0, 0.49)}
OBEYS = "the time step follows its springs, since penalty and step have their defaults"


def blow(keyword, upper, lower, form=13, contact=(1, 2), end=2.0e-5):
    """A block hits another one that lies on rollers, in N, mm, s and t: (material, columns, rows, height) of each."""
    deck = Deck("small elements").add("*CONTROL_TERMINATION", (end,)).add("*SECTION_SHELL", (1, form), (1.0,))
    below = lower[3]
    ids = []
    for part, ((material, n_x, n_y, height), y) in enumerate(((upper, below + 1.0e-4), (lower, 0.0)), 1):
        deck.add("*PART", "block", (part, 1, part)).elastic(*MATERIALS[material], part)
        ids.append(deck.mesh(*grid(n_x, n_y, 2.0, height, (0.0, y)), part=part))
        deck.add("*SET_PART_LIST", (part,), (part,))
    deck.node_set(3, ids[0]).add("*INITIAL_VELOCITY", (3,), (0.0, -1.0e3)).fix(ids[1][:lower[1] + 1], y=1)
    deck.add(keyword, contact)
    return deck.output(plot=end, glstat=end / 50, matsum=end / 50)


SMALL = {
    "plane, nodes": ((STOCK + "NODE_TO_SURFACE", ("brass", 4, 2, 0.2), ("lead", 40, 2, 0.05)), {"end": 3.0e-6}),
    "plane, two passes": ((STOCK + "SURFACE_TO_SURFACE", ("steel", 4, 4, 0.4), ("brass", 40, 4, 0.2)), {"end": 2.0e-6}),
    "round, mortar": ((STOCK + "SURFACE_TO_SURFACE_MORTAR", ("steel", 4, 2, 2.0), ("aluminium", 10, 4, 0.4)), {"form": 15, "end": 8.0e-6}),
    "round, two passes": ((STOCK + "SURFACE_TO_SURFACE", ("rubber", 10, 2, 0.2), ("rubber", 4, 4, 0.4)), {"form": 15, "end": 1.2e-4}),
}


@pytest.mark.parametrize("scene", SMALL)
def test_default_penalty_and_step_fit_each_other(slideline, tmp_path, scene):
    """No warning, one line, and the answer of less than a quarter of the step; restarts go on so."""
    args, more = SMALL[scene]
    text = with_files(blow(*args, **more), dump=100)
    for name, words in (("own", ()), ("fine", ("tssfac=0.2",))):
        done = slideline(f"d={name}", *words, deck=text)
        assert done.returncode == 0, done.stderr
    log = (tmp_path / "own/job.log").read_text()
    assert log.count(OBEYS) == 1 and "warning: interface" not in log and "time step of at most" not in log
    stable, alone = (float(found) for found in re.search(r"stable step (\S+), of the elements alone (\S+);", log).groups())
    steps = numbers(tmp_path / "own/job.glstat.csv", "dt")
    assert stable < 0.78 * alone and steps[0] == pytest.approx(0.9 * stable, rel=1e-6) and max(steps) < 0.95 * alone
    assert abs(numbers(tmp_path / "own/job.glstat.csv", "energy_ratio") - 1.0).max() < 2.0e-3
    own, fine = (numbers(tmp_path / name / "job.matsum.csv", "momentum_y")[::2] for name in ("own", "fine"))
    assert own[-1] == pytest.approx(fine[-1], abs=0.01 * abs(own[0]))
    rest = part_of(tmp_path / "own", tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    assert slideline("r=rest/job.dump01.h5").returncode == 0
    assert_same(tmp_path / "own", rest)


def test_a_written_penalty_and_a_written_step_keep_their_warning(slideline, tmp_path):
    args, more = SMALL["plane, nodes"]
    for words, deck in ((("pen=1.001",), blow(*args, **more)), ((), blow(*args, contact=(1, 2, 1.001), **more)),
                        (("dt=1.15e-8",), blow(*args, **more))):
        done = slideline(*words, deck=deck)
        assert done.returncode == 0, done.stderr
        log = (tmp_path / "job.log").read_text()
        assert OBEYS not in log and log.count("its penalty requires a time step of at most") == 1


def hard_on_soft(factor=1.0, modulus=1.0e10, layers=False, n=6, wide=1, ecdt=0, rows=1.0e-3):
    """A block of one modulus falls on a soft one on rollers, `wide` times as wide as high; `layers`: its upper half is another part."""
    deck = Deck("hard on soft").add("*CONTROL_TERMINATION", (0.1,)).add("*SECTION_SHELL", (1, 13), (1.0,))
    for part, young in enumerate((modulus, 1.0e6, 1.0e6), 1):
        deck.add("*PART", "block", (part, 1, part)).elastic(1000.0, young, 0.3, part)
    upper = deck.mesh(*grid(n // 2, n // 2, 0.5, 0.5, (0.5 * wide - 0.25, 1.0)), part=1)
    points, quads = grid(wide * n, n, wide)
    first = len(upper) + np.arange(1, len(points) + 1)
    deck.add("*NODE", *[(int(i), *x) for i, x in zip(first, points)])
    deck.add("*ELEMENT_SHELL", *[(10000 + k, 3 if layers and 2 * k >= len(quads) else 2, *[int(first[i]) for i in quad])
                                 for k, quad in enumerate(quads)])
    deck.add("*SET_PART_LIST", (1,), (1,)).add("*SET_PART_LIST", (2,), (2, 3) if layers else (2,))
    deck.node_set(3, upper).add("*INITIAL_VELOCITY", (3,), (0.0, -1.0)).fix(first[:wide * n + 1], y=1)
    deck.add("*CONTROL_CONTACT", (0.0,), (0, 0, 0, 0, 0.0, 0, ecdt))
    deck.add(STOCK + "SURFACE_TO_SURFACE", (1, 2, factor))
    return deck.output(plot=0.01, glstat=rows, matsum=rows, rcforc=1.0e-3).add("*DATABASE_SLEOUT", (1.0e-3,))


def reported(log, words):
    return [line for line in log.splitlines() if words in line]


@pytest.fixture
def fall(slideline, tmp_path):
    """fall(name, ...): the log of such a run, what it says of its springs, and the speed of the block at the end."""
    def run(name, *args, **more):
        done = slideline(f"d={name}", deck=with_files(hard_on_soft(*args, **more), dump=400))
        assert done.returncode == 0, done.stderr
        parts = columns(tmp_path / name / "job.matsum.csv")
        speed = np.array([float(p) for p, k in zip(parts["momentum_y"], parts["part"]) if k == "1"]) / 250.0
        log = (tmp_path / name / "job.log").read_text()
        return log, reported(log, "its springs stored up to"), speed[-1]
    return run


def named(line):
    """What the line of a stock keyword names: a factor, and the step that bears it."""
    factor, step = re.search(r"SFACT (\S+), or PEN with PUNIT 2, with the step of the springs \(ECDT (\d) of", line).groups()
    return {"factor": float(factor), "ecdt": int(step)}


@pytest.mark.parametrize("penalty, unit, warns", [(1.0, 0, True), (1.0, 1, True), (1.0, 2, False), (1.0e6, 0, False)])
def test_a_factor_without_its_punit_is_named(slideline, penalty, unit, warns):
    """PEN 1 with a blank PUNIT is 1 N/m: bodies of 1e6 N/m^2 pass through each other."""
    done = slideline(f"pen={penalty}", f"punit={unit}", deck=drop(end_time=0.001))
    assert done.returncode == 0, done.stderr
    assert (f"with PUNIT {unit} (0 where blank) is" in done.stderr) == warns, done.stderr


def test_springs_that_store_much_of_a_blow_on_a_soft_body_are_reported(slideline, tmp_path, fall):
    log, lines, _ = fall("stock")
    # Ten elements of the soft side by either pass, beside one of the soft and one of the hard row, which is 1e4 times as stiff.
    found = re.search(r"compliance of its springs is (\S+) times that of the elements", log)
    assert float(found[1]) == pytest.approx(5.0 / (1.0 + 1.0e-4), rel=1.0e-4)
    line, = lines
    assert line.strip().startswith("warning:")
    stored, share, bodies = (float(text) for text in re.search(r"up to (\S+), (\S+) % of .* sides, (\S+): the springs return", line).groups())
    assert stored == pytest.approx(numbers(tmp_path / "stock/job.sleout.csv", "stored").max(), rel=1.0e-6)
    assert bodies == pytest.approx(numbers(tmp_path / "stock/job.glstat.csv", "internal").max(), rel=1.0e-6)
    assert share == pytest.approx(100.0 * stored / bodies, abs=0.01) and share > 50.0
    # A body may be of several parts; a restarted run tells of all of it.
    assert fall("layers", layers=True)[1] == lines
    rest = part_of(tmp_path / "stock", tmp_path / "rest", "job.dump01.h5", "job.vtkhdf")
    assert slideline("r=rest/job.dump01.h5").returncode == 0
    assert reported((rest / "job.log").read_text(), "its springs stored up to") == lines
    # Plot states alone show it too.
    line, = fall("plots", rows=1.0)[1]
    assert float(re.search(r" sides, (\S+): the springs", line)[1]) == pytest.approx(bodies, rel=0.05)


@pytest.mark.parametrize("modulus, warns, scene, stock, right", [
    (1.0e10, True, {}, 0.62, 0.49), (1.0e10, True, {"n": 8, "wide": 2}, 0.60, 0.38), (1.0e7, True, {}, 0.62, 0.51),
    (9.9e6, False, {}, 0.62, 0.51), (1.0e6, False, {}, 0.66, 0.41)])
def test_the_penalty_and_step_that_are_named_make_the_rebound_right(fall, modulus, warns, scene, stock, right):
    """Right: what meshes two to eight times as fine agree on. Bodies within a factor of ten: a line, no warning."""
    _, (line,), speed = fall("stock", modulus=modulus, **scene)
    assert line.strip().startswith("warning: interface 1" if warns else "interface 1:")
    assert speed == pytest.approx(stock, abs=0.02)
    log, _, better = fall("named", modulus=modulus, **scene, **named(line))
    assert better == pytest.approx(right, abs=0.04) and "warning: interface" not in log


def ring(n, rows, inner, outer, start=0.0, centre=0.0):
    """Nodes and quads of a full ring, row by row from the bore."""
    angle = start + 2.0 * np.pi * np.arange(n) / n
    radius = np.linspace(inner, outer, rows + 1)[:, None]
    points = np.stack([centre + radius * np.cos(angle), radius * np.sin(angle)], axis=-1).reshape(-1, 2)
    return points, [(j * n + i, (j + 1) * n + i, (j + 1) * n + (i + 1) % n, j * n + (i + 1) % n)
                    for j in range(rows) for i in range(n)]


#: Card 3 of contact with facets in place of arcs (SMOOTH -1).
FLAT = (*[None] * 7, -1)


def press_fit(kind, shaft=48, hub=60, static=False, fit=1.0e-3, form=13, turn=0.01):
    """A hollow shaft in a hub, radii 0.5, 1 and 2, too thick by `fit`."""
    deck = implicit(1.0, 1.0) if static else Deck("press fit").add("*CONTROL_TERMINATION", (0.2,))
    deck.hourglass(4, 0.05).add("*SECTION_SHELL", (1, form, None, 4 if static else None), (1.0,))
    bodies = ring(shaft, 4, 0.5, 1.0 + 0.5 * fit, 0.0, 3.0 * (form == 15)), ring(hub, 4, 1.0 - 0.5 * fit, 2.0, turn, 3.0 * (form == 15))
    ids = []
    for part, body in enumerate(bodies, 1):
        deck.add("*PART", "ring", (part, 1, part)).elastic(1.0, 1.0, 0.3, part).add("*SET_PART_LIST", (part,), (part,))
        ids.append(deck.mesh(*body, part=part))
        if static:
            deck.fix(ids[-1][:1], x=1, y=1).fix(ids[-1][len(ids[-1]) // 10:len(ids[-1]) // 10 + 1], y=1)
    deck.add("*CONTACT_2D_SLIDELINE", (1, 2, kind, 2, 16.0), (0.0, 1.0e20, 1), FLAT)
    return deck.output(plot=1.0, glstat=0.1)


FACETS = re.compile(r"warning: interface 1: flat facets govern the contact pressure: its slave \(radius (\S+), (\d+) segments on a full "
                    r"circle\) is up to (\S+) inside its arcs, .* penetration (\S+) \(interference .*\(SMOOTH 0, not -1\) or (\d+) segments")


@pytest.mark.parametrize("static", (False, True))
@pytest.mark.parametrize("kind", some_types(2, release=7))
def test_facets_of_a_press_fit_are_reported(slideline, tmp_path, kind, static):
    """48 facets of the shaft stand off by R (pi/48)^2/2, twice the interference; a tenth of it needs some 220."""
    done = slideline(deck=press_fit(kind, static=static))
    assert done.returncode == 0, done.stderr
    found, = FACETS.findall((tmp_path / "job.log").read_text())
    radius, height, depth = (float(found[k]) for k in (0, 2, 3))
    assert radius == pytest.approx(1.0005, abs=1.0e-4)
    assert height == pytest.approx(0.5 * radius * (np.pi / 48.0) ** 2, rel=0.01)
    # The interference, and what it makes curvatures differ by over one radian; the gap of type 4 is that of another place.
    assert depth == pytest.approx(1.125e-3, rel=1.0 if kind == 4 else 0.02)
    assert int(found[1]) == 48 and int(found[4]) == pytest.approx(np.pi * np.sqrt(radius / (0.2 * depth)), rel=0.01)


@pytest.mark.parametrize("more, warns", [
    ({"form": 15}, True), ({"shaft": 60, "hub": 48}, True), ({"hub": 48, "turn": 0.05}, True), ({"shaft": 24, "hub": 20}, True),
    ({"fit": 0.01}, True), ({"shaft": 225, "hub": 230}, False), ({"hub": 48, "turn": 0.0}, False), ({"fit": -0.05}, False),
    ({"hub": 48, "turn": 0.0, "fit": 0.01}, False), ({"hub": 48, "turn": 0.0, "fit": 0.01, "form": 15}, False)])
def test_facets_that_match_or_are_fine_or_never_touch_are_not(slideline, tmp_path, more, warns):
    """Nodes that lie opposite each other match at any interference, though one circle is larger than the other by that."""
    done = slideline(deck=press_fit(5, **more))
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "job.log").read_text().count("flat facets govern the contact pressure") == int(warns)


def test_facets_that_would_do_are_the_same_in_all_units(slideline, tmp_path):
    """Nodes of 48 and 60 facets meet at twelve places, where round-off alone says which segment they are on."""
    found = []
    for unit in (0.05, 50.0):  # of length, with that of force per length such that the penalty per area keeps its number
        deck, block = press_fit(3, turn=0.0), ""
        for i, line in enumerate(deck.lines):
            fields = line.split(",")
            block = line if line.startswith("*") else block
            if block == "*NODE" and len(fields) > 1:
                fields[1:] = [repr(unit * float(text)) for text in fields[1:]]
            elif block == "*MAT_ELASTIC" and len(fields) > 1:
                fields[1:3] = [repr(1.0 / unit), repr(unit)]
            deck.lines[i] = ",".join(fields)
        assert slideline(deck=deck).returncode == 0
        found += FACETS.findall((tmp_path / "job.log").read_text())
    assert found[0][1::3] == found[1][1::3]
    assert float(found[1][3]) == pytest.approx(1.0e3 * float(found[0][3]), rel=1.0e-5)


def test_a_cylinder_on_a_plane_is_made_by_facets_where_few_of_them_touch(slideline, tmp_path):
    """Where many segments touch, bodies are flattened by much more than these stand off."""
    for n, speed, warns in ((48, 0.005, True), (48, 0.5, False), (192, 0.02, False)):
        deck = Deck("cylinder").add("*CONTROL_TERMINATION", (2.0,)).add("*SECTION_SHELL", (1, 13), (1.0,))
        for part in (1, 2):
            deck.add("*PART", "body", (part, 1, part)).elastic(1.0, 1.0, 0.3, part).add("*SET_PART_LIST", (part,), (part,))
        roller = deck.mesh(*ring(n, n // 12, 0.5, 1.0), part=1)
        plane = deck.mesh(*grid(n // 2, n // 12, 2.0, 0.5, (-1.03, -1.501)), part=2)
        deck.node_set(1, roller).add("*INITIAL_VELOCITY", (1,), (0.0, -speed)).fix(plane[:n // 2 + 1], x=1, y=1)
        deck.add("*CONTACT_2D_SLIDELINE", (1, 2, 7, 2, 2.0 * n), (0.0, 1.0e20, 1), FLAT)
        done = slideline(deck=deck.output(plot=2.0, glstat=0.02))
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "job.log").read_text().count("flat facets govern the contact pressure") == int(warns), (n, speed)


@pytest.mark.parametrize("hub, words, warns", [(16, (), True), (16, ("smooth=23",), False), (60, (), False), (16, ("smooth=-1",), False)])
def test_a_circle_too_coarse_for_arcs_is_named(slideline, tmp_path, hub, words, warns):
    """16 segments turn by 22.5 degrees: facets, beside the arcs of the shaft, unless SMOOTH allows that."""
    done = slideline(*(words or ("smooth=0",)), "endtim=1e-3", deck=press_fit(5, hub=hub))
    assert done.returncode == 0, done.stderr
    assert ("a circle of its master surface, whose segments turn by up to 2.250000E+01 degrees, more than SMOOTH (16)"
            in (tmp_path / "job.log").read_text()) == warns


def fan(sides):
    """A punch on a body whose elements are 0.5 mm high at its face and 200 mm below; contact of `sides`, parts or faces."""
    deck = Deck("fan").add("*CONTROL_TERMINATION", (1.0e-8,)).add("*SECTION_SHELL", (1, 13), (1.0,))
    coordinates, quads = grid(20, 10, 20.0, 10.0, (-10.0, -10.0))
    below = np.maximum(-coordinates[:, 1] - 4.0, 0.0)
    coordinates[:, 1] = np.where(below > 0.0, -2.0 - 200.0 * below, 0.5 * coordinates[:, 1])
    coordinates[:, 0] *= 1.0 + 16.0 * below
    bodies = (coordinates, quads), grid(10, 20, 5.0, 10.0, (-2.6, 1.0e-4))
    for part, ((nodes, elements), face) in enumerate(zip(bodies, (0.0, 1.0e-4)), 1):
        deck.add("*PART", "body", (part, 1, part)).elastic(*MATERIALS["steel"], part)
        ids = deck.mesh(nodes, elements, part=part)
        deck.add("*SET_PART_LIST", (part,), (part,)).node_set(part, ids[np.abs(nodes[:, 1] - face) < 1.0e-9])
    return deck.add(STOCK + "SURFACE_TO_SURFACE", (2, 1) if sides == "parts" else (-2, -1)).output(glstat=1.0e-8).text()


def test_a_coarse_far_side_does_not_soften_the_springs(slideline, tmp_path):
    """The built-in penalty of parts is near that of the faces that touch; as a mean over the length it was 50 times softer."""
    found = []
    for sides in ("parts", "faces"):
        done = slideline(f"d={sides}", deck=fan(sides))
        assert done.returncode == 0, done.stderr
        found.append(float(re.search(r"penalty: .*?= (\S+) per unit length", (tmp_path / sides / "job.log").read_text()).group(1)))
    assert 0.25 < found[0] / found[1] < 4.0
