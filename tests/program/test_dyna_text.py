# SPDX-License-Identifier: MIT
"""DYNA's text files: read by columns and labels as scripts do, and compared with the CSV files."""
import re
import subprocess

import numpy as np
import pytest
from conftest import columns, drop, numbers
from erosion_decks import penetration
from meshes import Deck, grid

NAMES = ("glstat", "rcforc", "nodout", "matsum", "sleout", "spcforc")
GRAVITY = 9.81


def with_all(deck, binary="", interval=1.0e-3):
    """The deck with sleout and spcforc, BINARY given in each of the six cards."""
    text = deck.text().rsplit("*END", 1)[0]
    text += f"*DATABASE_SLEOUT\n{interval},\n*DATABASE_SPCFORC\n{interval},\n*END\n"
    return re.sub(r"(\*DATABASE_(?:GLSTAT|RCFORC|NODOUT|MATSUM|SLEOUT|SPCFORC)\n)([^\n]*)",
                  lambda found: f"{found[1]}{found[2].split(',')[0][:10].strip()},{binary}", text)


@pytest.fixture(scope="module")
def run(exe, tmp_path_factory):
    """Folder of one run that writes all files."""
    folder = tmp_path_factory.mktemp("dyna")
    (folder / "drop.k").write_text(with_all(drop()))
    done = subprocess.run([exe, "i=drop.k", "d=out"], capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder / "out"


def lines_of(run, name):
    return (run / f"drop.{name}").read_text().splitlines()


def same(printed, exact, digits):
    """Printed values are the exact ones rounded to so many digits behind the point."""
    printed, exact = np.asarray(printed, float), np.asarray(exact, float)
    assert printed.shape == exact.shape and printed.size > 0
    room = 0.501 * 10.0 ** -digits * 10.0 ** np.floor(np.log10(np.maximum(np.abs(exact), 1e-98)))
    assert np.all(np.abs(printed - exact) <= room + 1e-15 * np.abs(exact))


def table(run, name, *wanted):
    return np.column_stack([numbers(run / f"drop.{name}.csv", column) for column in wanted])


@pytest.mark.parametrize("name", NAMES)
def test_head_has_the_title_and_lines_are_short(run, name):
    lines = lines_of(run, name)
    assert lines[0] == " drop" and "slideline" in lines[1]
    assert max(map(len, lines)) <= 160
    assert (run / f"drop.{name}").read_bytes().endswith(b"\n")


def blocks_of(lines):
    """Cycles of glstat, and label and number of each line."""
    blocks, cycles = [], []
    for line in lines:
        found = re.match(r" dt of cycle\s*(\d+) is controlled by (load curve|shell\s+\d+ of part\s+\d+)$",
                         line)
        if found:
            cycles.append(int(found[1]))
            blocks.append({})
        elif blocks and len(line) > 33 and line[1] != " ":
            blocks[-1][line[1:32].rstrip(". ")] = line[32:46]
    return cycles, blocks


def test_glstat_of_a_run_that_loses_elements(slideline, tmp_path):
    """The lines add up to the total without what leap-frog adds; of the ratio without what has gone too."""
    done = slideline("d=out", deck=penetration(5, n=6))
    assert done.returncode == 0, done.stderr
    blocks = [{label: float(number) for label, number in block.items()}
              for block in blocks_of((tmp_path / "out" / "job.glstat").read_text().splitlines())[1]]
    csv = {name: numbers(tmp_path / "out" / "job.glstat.csv", name) for name in ("total", "leapfrog", "eroded", "energy_ratio")}
    assert min(blocks[-1][f"eroded {kind} energy"] for kind in ("kinetic", "internal", "hourglass")) > 0.0
    kept = [sum(block[f"{kind} energy"] for kind in ("kinetic", "internal", "hourglass", "system damping", "sliding interface"))
            for block in blocks]
    assert kept == pytest.approx(csv["total"] - csv["leapfrog"], rel=3e-5)
    assert [block["energy ratio w/o eroded energy"] for block in blocks] == pytest.approx(
        csv["energy_ratio"] * (1.0 - csv["eroded"] / csv["total"]), rel=1e-5)


def test_glstat(run):
    cycles, blocks = blocks_of(lines_of(run, "glstat"))
    csv = {name: numbers(run / "drop.glstat.csv", name) for name in columns(run / "drop.glstat.csv")}
    assert cycles == csv["cycle"].astype(int).tolist()
    wanted = {"time": csv["time"], "time step": csv["dt"], "kinetic energy": csv["kinetic"],
              "internal energy": csv["internal"] + csv["viscous"], "hourglass energy": csv["hourglass"],
              "system damping energy": csv["damping"], "sliding interface energy": csv["contact"],
              "external work": csv["external_work"], "total energy": csv["total"],
              "total energy / initial energy": csv["energy_ratio"],
              "energy ratio w/o eroded energy": csv["energy_ratio"]}
    for label, exact in wanted.items():
        same([block[label] for block in blocks], exact, 5)
    assert list(blocks[0]) == [
        "time", "time step", "kinetic energy", "internal energy", "stonewall energy",
        "spring and damper energy", "hourglass energy", "system damping energy",
        "sliding interface energy", "external work", "eroded kinetic energy",
        "eroded internal energy", "eroded hourglass energy", "total energy",
        "total energy / initial energy", "energy ratio w/o eroded energy", "global x velocity",
        "global y velocity", "global z velocity", "time per zone cycle.(nanosec)"]
    # The mean velocity from the sums of the parts.
    mass, momentum = table(run, "matsum", "mass", "momentum_y").reshape(-1, 2, 2).sum(axis=1).T
    assert [float(block["global y velocity"]) for block in blocks] == pytest.approx(
        momentum / mass, rel=1e-5, abs=1e-9)


def test_rcforc(run):
    pattern = re.compile(r"\s+(slave|master)\s+(\d+) time\s*(\S+)\s+x\s+(\S+)\s+y\s+(\S+)\s+z\s+(\S+)\s+mass\s+(\S+)")
    found = [pattern.fullmatch(line) for line in lines_of(run, "rcforc")]
    rows = [match.groups() for match in found if match]
    csv = columns(run / "drop.rcforc.csv")
    assert [row[0] for row in rows] == csv["side"] and [row[1] for row in rows] == csv["interface"]
    same([[row[k] for k in (2, 3, 4)] for row in rows], table(run, "rcforc", "time", "fx", "fy"), 5)
    assert np.abs(table(run, "rcforc", "fy")).max() > 100.0


def test_nodout(run):
    rows, time, cycles = [], None, []
    for line in lines_of(run, "nodout"):
        if line.startswith(" n o d a l   p r i n t   o u t   f o r   t i m e  s t e p"):
            time = line.split()[-2]
            cycles.append(int(line.split()[-6]))
            assert line[104:118].strip() == time
        elif time and re.fullmatch(r"[ \d]{10}", line[:10]) and line.strip():
            rows.append([time, line[:10], *(line[k:k + 12] for k in range(10, 154, 12))])
    rows = np.array(rows, float)
    exact = table(run, "nodout", "time", "node", "ux", "uy", "vx", "vy", "ax", "ay", "x", "y")
    same(rows[:, 0], exact[:, 0], 7)
    assert np.array_equal(rows[:, 1], exact[:, 1])
    same(rows[:, [2, 3, 5, 6, 8, 9, 11, 12]], exact[:, 2:], 4)
    assert np.all(rows[:, [4, 7, 10, 13]] == 0.0)
    assert cycles == [10 * k for k in range(len(cycles))]
    assert "       13     node" in lines_of(run, "nodout")


def test_matsum(run):
    time, rows = None, []
    for line in lines_of(run, "matsum"):
        if line.startswith(" time ="):
            time = float(line[7:])
        elif line.startswith(" mat.#="):
            rows.append([time, line[7:15], line[31:44], line[56 - 1:68]])
        elif line.startswith((" x-mom=", " x-rbv=")):
            rows[-1] += re.findall(r"-?\d\.\d{4}E[+-]\d\d", line)[:2]
        elif "hgeng=" in line:
            rows[-1] += [line[31:44], line.split("+mass=")[1]]
    rows = np.array(rows, float)
    exact = table(run, "matsum", "time", "part", "internal", "kinetic", "momentum_x", "momentum_y",
                  "hourglass", "mass")
    same(rows[:, [0, 1, 2, 3, 4, 5, 8]], exact[:, :7], 4)
    assert not rows[:, 9].any()                      # +mass is what mass scaling has added
    same(rows[:, 6:8], exact[:, 4:6] / exact[:, 7:], 4)


def test_sleout(run):
    text = (run / "drop.sleout").read_text()
    found = re.findall(r" contact interface energy file, time=\s*(\S+)\n.*cycle=\s*(\d+)\n\n\s*(\d+)\s*(\S+) +0.0000E\+00 +0.0000E\+00\n\n"
                       r" summary   total slave side=\s*(\S+)\n.*\n           total energy    =\s*(\S+)", text)
    rows = np.array(found, float)
    exact = table(run, "sleout", "time", "cycle", "interface", "energy", "damping")
    exact = np.column_stack([exact[:, :3], exact[:, 3] + exact[:, 4]])
    same(rows[:, :3], exact[:, :3], 7)
    same(rows[:, 3], exact[:, 3], 4)
    same(rows[:, 4:], np.repeat(exact[:, 3:], 2, axis=1), 7)
    assert exact[:, 3] == pytest.approx(numbers(run / "drop.glstat.csv", "contact"), rel=1e-14, abs=0.0)
    assert exact[:, 3].max() > 0.0


def line_of(text, label, k=-1):
    """Values of the lines of a label of glstat."""
    return float(re.findall(rf"^ {re.escape(label)}\.* +(\S+)$", text, re.M)[k])


def test_added_mass(slideline, tmp_path):
    """Free squares of mass 2 and 6; DT2MS -2 makes both 8: +mass of matsum is what was added, of a rigid part none."""
    deck = Deck("added").control(4.0)
    deck.lines[deck.lines.index("*CONTROL_TIMESTEP") + 1] = "0.0,0.9,0,0.0,-2.0"
    deck.part(1).part(2).part(3).elastic(2.0, 2.0, 0.0, 1).elastic(6.0, 2.0, 0.0, 2).add("*MAT_RIGID", (3, 1.0, 1.0, 0.3))
    for k in (1, 2, 3):
        deck.mesh(*grid(1, 1, origin=(2.0 * k, 0.0)), part=k)
    assert slideline("d=o", deck=deck.output(glstat=2.0, matsum=2.0)).returncode == 0
    assert re.findall(r"\+mass= +(\S+)", (tmp_path / "o/job.matsum").read_text()) == ["6.0000E+00", "2.0000E+00", "0.0000E+00"] * 4
    assert numbers(tmp_path / "o/job.matsum.csv", "added_mass") == pytest.approx([6.0, 2.0, 0.0] * 4, rel=1e-14)
    text = (tmp_path / "o/job.glstat").read_text()
    assert text.count("is controlled by dt2ms") == 4
    deck.lines[deck.lines.index("*CONTROL_TIMESTEP") + 1] = "0.0,0.9,0,0.0,-0.01"
    assert slideline("d=none", deck=deck).returncode == 0
    assert "dt2ms" not in (tmp_path / "none/job.glstat").read_text()
    assert line_of(text, "added mass") == 8.0
    increase = numbers(tmp_path / "o/job.glstat.csv", "mass_increase")
    assert increase[-1] == pytest.approx(100.0 * 8.0 / 9.0) and line_of(text, "percentage increase") == pytest.approx(increase[-1], rel=1e-5)


def test_eroded_energies_are_counted(slideline, tmp_path):
    """Four squares fly at speed 1; two leave: kinetic energy still 2.0, of which eroded 0.75 (a node stays with the rest)."""
    deck = Deck("eroded").control(2.0).part(1).part(2).elastic(1.0, 1.0, 0.0, 1).elastic(1.0, 1.0, 0.0, 2)
    deck.add("*MAT_ADD_EROSION", (2,), (None,) * 7 + (1.0,))
    coordinates, quads = grid(4, 1, 4.0, 1.0)
    deck.add("*NODE", *[(i + 1, *x) for i, x in enumerate(coordinates)])
    deck.add("*ELEMENT_SHELL", *[(i + 1, 1 if i < 2 else 2, *[n + 1 for n in quad]) for i, quad in enumerate(quads)])
    deck.add("*INITIAL_VELOCITY", (0,), (1.0, 0.0))
    assert slideline("d=o", deck=deck.output(glstat=0.5)).returncode == 0
    text = (tmp_path / "o/job.glstat").read_text()
    assert line_of(text, "kinetic energy") == 2.0 and line_of(text, "eroded kinetic energy") == 0.75
    assert line_of(text, "total energy") == 2.0 and line_of(text, "energy ratio w/o eroded energy") == 0.625
    assert line_of(text, "eroded kinetic energy", 0) == 0.0 and "added mass" not in text


def test_legend_and_friction_of_interfaces(slideline, tmp_path):
    """Titles of interfaces stand in rcforc and sleout; sleout has what friction has dissipated."""
    deck = drop(dt=1.0e-4, end_time=0.02)
    at = deck.lines.index("*CONTACT_2D_SLIDELINE")
    deck.lines[at:at + 2] = ["*CONTACT_2D_SLIDELINE_TITLE", "         7anvil", deck.lines[at + 1] + ",0.3"]
    deck.add("*DATABASE_SLEOUT", (1.0e-3,))
    done = slideline("d=o", deck=deck)
    assert done.returncode == 0, done.stderr
    for name in ("rcforc", "sleout"):
        assert "        7     anvil\n" in (tmp_path / f"o/job.{name}").read_text()
    text = (tmp_path / "o/job.sleout").read_text()
    friction = numbers(tmp_path / "o/job.sleout.csv", "friction")
    assert friction[-1] > 0.0
    assert [float(word) for word in re.findall(r"friction energy = *(\S+)", text)] == pytest.approx(friction, rel=1e-6)
    assert float(re.findall(r"^ +7(?: +\S+){2} +(\S+)$", text, re.M)[-1]) == pytest.approx(friction[-1], rel=1e-4)


def test_spcforc(run):
    time, rows, sums = None, [], []
    for line in lines_of(run, "spcforc"):
        if line.startswith(" output at time ="):
            time = line.split("=")[1]
        elif line.startswith(" node="):
            rows.append([time, *re.match(r"\s*node=\s*(\d+) local x,y,z forces =\s+(\S+)\s+(\S+)\s+(\S+)",
                                         line).groups()])
        elif "force resultants" in line:
            sums.append(line.split("=")[1].split())
    rows, exact = np.array(rows, float), table(run, "spcforc", "time", "node", "fx", "fy")
    assert sorted(set(exact[:, 1])) == list(range(13, 19))
    same(rows[:, :1], exact[:, :1], 5)
    assert np.array_equal(rows[:, 1], exact[:, 1])
    same(rows[:, 2:4], exact[:, 2:], 4)
    same(np.array(sums, float)[:, :2], exact[:, 2:].reshape(len(sums), 6, 2).sum(axis=1), 4)


def test_reactions_change_the_momentum(slideline, tmp_path):
    """p(n+1) - p(n) = dt/2 (F(n) + F(n+1)) with F = reactions less weight, step by step."""
    dt, deck = 1.0e-4, drop()
    deck.output(glstat=dt, matsum=dt)
    text = with_all(deck, interval=dt)
    assert slideline("d=o", deck=text, name="drop").returncode == 0
    run = tmp_path / "o"
    mass, *momentum = table(run, "matsum", "mass", "momentum_x", "momentum_y").reshape(
        -1, 2, 3).sum(axis=1).T
    force = table(run, "spcforc", "fx", "fy").reshape(len(mass), 6, 2).sum(axis=1)
    assert len(mass) == 201 and np.abs(force).max() > 1000.0
    force[:, 1] -= mass[0] * GRAVITY
    change = np.diff(np.array(momentum).T, axis=0)
    scale = np.abs(force).max() * dt
    # At time zero v(0) is given, and v(1/2) half a step of a(0) away.
    assert np.abs(change - 0.5 * dt * (force[1:] + force[:-1])).max() < 1.0e-11 * scale


def test_implicit_reactions_carry_the_weight(slideline, tmp_path):
    deck = Deck("column")
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    deck.part(1, points=4).elastic(1000.0, 1.0e6, 0.3)
    nodes = deck.mesh(*grid(2, 3))
    deck.fix(nodes[:3], x=1, y=1).curve(1, [(0.0, GRAVITY), (10.0, GRAVITY)])
    deck.add("*LOAD_BODY_Y", (1, 1.0)).add("*DATABASE_SPCFORC", (1.0,)).add("*DATABASE_GLSTAT", (1.0,))
    done = slideline("d=o", deck=deck, name="drop")
    assert done.returncode == 0, done.stderr
    force = table(tmp_path / "o", "spcforc", "fx", "fy").reshape(-1, 3, 2).sum(axis=1)
    assert force[-1] == pytest.approx([0.0, 1000.0 * GRAVITY], abs=1e-6)
    assert "is controlled by implicit" in (tmp_path / "o" / "drop.glstat").read_text()


def test_the_element_that_rules_the_step_is_named(slideline, tmp_path):
    deck = Deck("steps")
    deck.control(0.1).part(4).elastic(1000.0, 1.0e6, 0.3, 4)
    points, quads = grid(4, 1, 4.0, 1.0)
    points[[2, 7], 0] += 0.4          # element 3 becomes the shortest
    deck.mesh(points, quads, part=4)
    deck.output(glstat=0.05)
    assert slideline("d=o", deck=deck).returncode == 0
    controls = re.findall(r"dt of cycle\s+\d+ is controlled by shell\s+(\d+) of part\s+(\d+)",
                          (tmp_path / "o" / "job.glstat").read_text())
    assert len(controls) == 3 and set(controls) == {("3", "4")}


def squares(viscosity=(0.0, 0.0), speed=0.0):
    """Element 1 is a square of 1, element 2 one of 0.9 apart from it; the first is squeezed at `speed`."""
    deck = Deck("two squares")
    deck.add("*CONTROL_TERMINATION", (1.0e-6,)).add("*CONTROL_TIMESTEP", (0.0, 0.9))
    deck.part().elastic(8000.0, 2.0e11, 0.3)
    wide = deck.mesh(*grid(1, 1), part=1)
    deck.mesh(*grid(1, 1, 0.9, 0.9, (3.0, 0.0)), part=1)
    deck.add("*CONTROL_BULK_VISCOSITY", viscosity)
    if speed:
        deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), -speed, 0.0) for node in wide[1::2]])
    return deck.output(glstat=1.0e-6)


@pytest.mark.parametrize("deck, element", [
    (squares(), "2"),                                          # the shorter one
    (squares(viscosity=(1.5, 0.06), speed=1500.0), "1"),       # squeezed against viscosity
])
def test_the_named_element_is_the_first_of_the_log(slideline, tmp_path, deck, element):
    assert slideline("d=o", deck=deck).returncode == 0
    listed = re.search(r"element +part +stable step\n +(\d+) +(\d+) ", (tmp_path / "o" / "job.log").read_text())
    named = re.search(r"dt of cycle +0 is controlled by shell +(\d+) of part +(\d+)",
                      (tmp_path / "o" / "job.glstat").read_text())
    assert named.groups() == listed.groups() == (element, "1")


@pytest.mark.parametrize("binary, written", [("0", True), ("1", True), ("2", False), ("3", True)])
def test_binary_says_whether_there_is_text(slideline, tmp_path, binary, written):
    assert slideline("d=b", deck=with_all(drop(end_time=0.002), binary), name="drop").returncode == 0
    for name in NAMES:
        assert (tmp_path / "b" / f"drop.{name}").exists() == written, name
        assert (tmp_path / "b" / f"drop.{name}.csv").exists(), name
    assert (tmp_path / "b" / "drop.log").read_text().count("BINARY asks for binout") == (binary in "23")


def test_an_unknown_binary_is_refused(slideline):
    done = slideline("d=b", deck=with_all(drop(), "4"))
    assert done.returncode == 1
    assert len(re.findall(r"field 2 \(BINARY\)", done.stderr)) == 6


def test_without_interval_there_is_no_text(slideline, tmp_path):
    deck = Deck("quiet")
    deck.control(0.01, dt=0.001).part().elastic(1.0e4, 1.0e6, 0.3)
    deck.mesh(*grid(1, 1))
    assert slideline("d=q", deck=deck, name="drop").returncode == 0
    assert not [name for name in NAMES if (tmp_path / "q" / f"drop.{name}").exists()]


def test_texts_of_a_run_that_goes_on(slideline, tmp_path):
    text = with_all(drop()).rsplit("*END", 1)[0] + "*DATABASE_BINARY_D3DUMP\n120,\n*END\n"
    assert slideline("d=whole", deck=text, name="drop").returncode == 0
    assert slideline("r=whole/drop.dump01.h5", "d=rest").returncode == 0
    for name in NAMES:
        whole = (tmp_path / "whole" / f"drop.{name}").read_bytes()
        assert len(whole) > 500 and whole == (tmp_path / "rest" / f"drop.{name}").read_bytes(), name
