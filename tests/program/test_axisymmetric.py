# SPDX-License-Identifier: MIT
"""Axisymmetric decks: what the program settles and says by itself, the same bits at any number of threads and
after a restart."""
import pathlib
import re
import subprocess

import h5py
import numpy as np
import pytest
from conftest import numbers
from meshes import Deck, grid

TAYLOR = pathlib.Path(__file__).resolve().parents[2] / "input/taylor/taylor.k"


def run(exe, folder, *words, status=0):
    done = subprocess.run([exe, *words], cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == status, done.stderr
    return done


def tables(folder, job):
    return {path.name.split(".", 1)[1]: path.read_bytes() for path in sorted(folder.glob(f"{job}.*.csv"))
            if "timing" not in path.name}


def fields(path):
    with h5py.File(path) as stream:
        group = stream["VTKHDF"]
        return {f"{kind}/{name}": group[kind][name][()].tobytes() for kind in ("PointData", "CellData")
                for name in group[kind]}


def bar(points):
    """The Taylor bar for 300 cycles or so, by one or four points, with restart files."""
    text, count = re.subn(r"(?m)^(         1        15       1.0         )1$", rf"\g<1>{points}", TAYLOR.read_text())
    assert count == 1
    text = re.sub("(?m)^R endtim .*$", "R endtim      6.0E-6", text)
    return text.replace("*END", "*DATABASE_BINARY_D3DUMP\n       100\n*END")


@pytest.mark.parametrize("points", [1, 4])
def test_same_bits_with_threads_and_after_a_restart(exe, tmp_path, points):
    (tmp_path / "job.k").write_text(bar(points))
    for n in (1, 2, 3):
        run(exe, tmp_path, "i=job.k", f"d=t{n}", f"ncpu={n}")
    for n in (2, 3):
        assert tables(tmp_path / f"t{n}", "job") == tables(tmp_path / "t1", "job")
        assert fields(tmp_path / f"t{n}/job.vtkhdf") == fields(tmp_path / "t1/job.vtkhdf")
    (tmp_path / "again").mkdir()
    run(exe, tmp_path, "r=t1/job.dump01.h5", "d=again", "ncpu=2")
    whole, rest = (numbers(tmp_path / folder / "job.glstat.csv", "total") for folder in ("t1", "again"))
    assert len(rest) and list(rest) == list(whole)[-len(rest):]
    states = [fields(tmp_path / folder / "job.vtkhdf")["PointData/displacement"] for folder in ("t1", "again")]
    assert states[0].endswith(states[1][-1111 * 24:])


def two_rings():
    """A deformable disc and a rigid ring above it."""
    deck = Deck("disc and rigid ring")
    deck.control(0.05)
    deck.add("*PART", "disc", (1, 1, 1), "ring", (2, 1, 2)).add("*SECTION_SHELL", (1, 15, None, 1), (1.0,))
    deck.elastic(1000.0, 1.0e6, 0.3)
    deck.add("*MAT_RIGID", (2, 1000.0, 1.0e6, 0.3), (0.0,), (0.0,))
    coordinates, quads = grid(4, 2, 1.0, 0.5)
    coordinates[0, 0] = -1.0e-14
    deck.mesh(coordinates, quads)
    deck.mesh(*grid(4, 2, 1.0, 0.5, (0.5, 1.0)), part=2)
    deck.add("*INITIAL_VELOCITY", (0,), (2.0, -3.0))
    return deck.output(plot=0.05, glstat=0.01, matsum=0.01)


def test_what_is_settled_is_reported(exe, tmp_path):
    (tmp_path / "job.k").write_text(two_rings().text())
    done = run(exe, tmp_path, "i=job.k", "d=out")
    log = (tmp_path / "out/job.log").read_text()
    assert "per radian" in log
    assert "nodes at r = 0, which are fixed in r: 3; rigid bodies move along the axis only" in log
    assert "nodes on the axis or of rigid bodies whose initial velocity in r is ignored: 18, " in done.stderr + log
    with h5py.File(tmp_path / "out/job.vtkhdf") as stream:
        moved = stream["VTKHDF/PointData/displacement"][-30:]
        time = stream["VTKHDF/Steps/Values"][-1]
        assert "hoop_strain" in stream["VTKHDF/CellData"]
    on_axis = [0, 5, 10]
    assert np.all(moved[on_axis, 0] == 0.0)
    # The ring flies along the axis.
    assert np.all(moved[15:, 0] == 0.0)
    assert np.allclose(moved[15:, 1], -3.0 * time, rtol=1e-9)


def test_masses_are_per_radian(exe, tmp_path):
    (tmp_path / "job.k").write_text(two_rings().text())
    run(exe, tmp_path, "i=job.k", "d=out")
    mass = numbers(tmp_path / "out/job.matsum.csv", "mass")
    assert np.allclose(mass[:2], [1000.0 * 0.5 * 0.5, 1000.0 * 0.5 * (1.5 ** 2 - 0.5 ** 2) * 0.5], rtol=1e-12)


def test_plane_runs_have_no_hoop_strain(exe, tmp_path):
    (tmp_path / "job.k").write_text(two_rings().text().replace("1,15,,1", "1,13,,1"))
    run(exe, tmp_path, "i=job.k", "d=out")
    with h5py.File(tmp_path / "out/job.vtkhdf") as stream:
        assert "hoop_strain" not in stream["VTKHDF/CellData"]


def hollow(way, points, implicit=False):
    """A ring of bore 0.01 m that flies inward at `way` m/s, or whose bore is led inward by `way` m in a static run."""
    deck = Deck("ring that goes through its axis")
    if implicit:
        deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.1))
    else:
        deck.control(0.03)
    deck.add("*PART", "ring", (1, 1, 1)).add("*SECTION_SHELL", (1, 15, None, points), (1.0,)).elastic(1000.0, 1.0e6, 0.3)
    ids = deck.mesh(*grid(4, 4, 0.3, 0.3, (0.01, 0.0)))
    if implicit:
        deck.curve(1, [(0.0, 0.0), (1.0, 1.0)]).fix(ids[4::5], 1, 1)
        deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", *[(int(node), 1, 2, 1, way) for node in ids[::5]])
    else:
        deck.add("*INITIAL_VELOCITY", (0,), (way, 0.0))
    return deck.output(glstat=1.0e-3 if not implicit else 0.1).text()


@pytest.mark.parametrize("scene", [{"way": -8.0, "points": 1}, {"way": -0.011, "points": 4, "implicit": True}])
def test_nodes_beyond_the_axis_are_reported_once(exe, tmp_path, scene):
    (tmp_path / "job.k").write_text(hollow(**scene))
    done = run(exe, tmp_path, "i=job.k", "d=out")
    assert done.stderr.count("has crossed the axis") == 1
    (tmp_path / "job.k").write_text(hollow(**(scene | {"way": 0.1 * scene["way"]})))
    assert "crossed the axis" not in run(exe, tmp_path, "i=job.k", "d=out").stderr


def test_radial_loads_on_the_axis_are_reported(exe, tmp_path):
    def disc(form):
        deck = Deck("loads on the axis").control(1.0e-3)
        deck.add("*PART", "disc", (1, 1, 1)).add("*SECTION_SHELL", (1, form), (1.0,)).elastic(1000.0, 1.0e6, 0.3)
        deck.node_set(1, deck.mesh(*grid(3, 3))).curve(1, [(0.0, 1.0)])
        deck.add("*LOAD_NODE_SET", (1, 1, 1, 5.0), (1, 2, 1, 5.0)).add("*LOAD_NODE_POINT", (1, 1, 1), (2, 1, 1))
        return deck.text()

    for form, reported in ((15, True), (13, False)):
        (tmp_path / "job.k").write_text(disc(form))
        said = run(exe, tmp_path, "check", "job.k").stderr
        assert ("*LOAD_NODE_SET: loads in r without effect, on nodes on the axis (x = 0), which are fixed in r: 5, " in said) == reported, said


def test_units_of_contact_are_per_radian(exe, tmp_path):
    def rubbing(form):
        deck = Deck("rings that overlap and rub").control(0.01)
        for part in (1, 2):
            deck.add("*PART", f"part {part}", (part, 1, part)).elastic(1000.0, 1.0e6, 0.3, part)
        deck.add("*SECTION_SHELL", (1, form), (1.0,))
        lower = deck.mesh(*grid(4, 2, 1.0, 0.5, (0.5, 0.0)))
        upper = deck.mesh(*grid(4, 2, 1.0, 0.5, (0.5, 0.499)), part=2)
        deck.node_set(1, upper[:5]).node_set(2, lower[10:][::-1]).node_set(3, upper)
        deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, 5, 2, 1.0, 0.3), (0.0, 1.0e20, 2))
        return deck.add("*INITIAL_VELOCITY", (3,), (1.0, 0.0)).output(glstat=1.0e-3).text()

    reported = "*CONTROL_UNITS\n        mm       sec  mtrc_ton\n"
    named = re.compile(r"\d (?:k?[NJ]|m?m|m?s)(?:[/ ]|$)", re.M)
    for form, units, right in (
            (15, "", (r"dissipated \S+ per radian\n", r"contact force there \S+ per radian; the run", "times the radius, per radian")),
            (15, reported, (r"dissipated \S+ N mm per radian\n", r"node \d+: \S+ mm, contact force there \S+ N per radian; the run")),
            (13, "", (r"dissipated \S+\n", r"node \d+: \S+, contact force there \S+; the run")),
            (13, reported, (r"dissipated \S+ N mm/mm\n", r"contact force there \S+ N/mm; the run", r"mean length \S+ mm\n",
                        r" N/mm per slave node = \S+ N/mm\^2; "))):
        (tmp_path / "job.k").write_text(rubbing(form).replace("*END", units + "*END"))
        run(exe, tmp_path, "i=job.k", "d=out")
        log = (tmp_path / "out/job.log").read_text()
        assert all(re.search(text, log) for text in right), log
        assert ("radian" in log) == (form == 15) and bool(named.search(log.split("first time step")[0])) == bool(units), log


def struck(scale):
    """A plastic bar strikes a plate with friction, two implicit steps of a third of an element each; lengths and times in units
    that are `scale` times smaller than m and s."""
    per_volume = scale ** -3
    deck = Deck("struck").add("*CONTROL_TERMINATION", (2e-6 * scale,))
    deck.add("*CONTROL_IMPLICIT_GENERAL", (1, 1e-6 * scale)).add("*CONTROL_IMPLICIT_DYNAMICS", (1,))
    deck.add("*SECTION_SHELL", (1, 15, None, 4), (1.0,)).part(1, section=1).part(2, section=1)
    deck.plastic(8930.0 * per_volume, 117e9 * per_volume, 0.35, 400e6 * per_volume, 100e6 * per_volume)
    deck.elastic(7850.0 * per_volume, 210e9 * per_volume, 0.3, 2)
    bar = deck.mesh(*grid(5, 20, 3.2e-3 * scale, 12.8e-3 * scale, (0.0, 1e-5 * scale)), part=1)
    plate = deck.mesh(*grid(9, 5, 6e-3 * scale, 3e-3 * scale, (0.0, -3e-3 * scale)), part=2)
    deck.fix(plate[:10], y=1).node_set(1, bar).add("*INITIAL_VELOCITY", (1,), (0.0, -227.0))
    deck.node_set(2, bar[:6]).node_set(3, plate[-10:][::-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-2, -3, 5, 3, 1.0, 0.1), (0.0, 1e20, 2))
    return deck.output(plot=2e-6 * scale).text()


def test_flow_does_not_depend_on_units(exe, tmp_path):
    """Points on the yield surface at the start of a step were elastic or plastic by round-off: 2 % between m and mm."""
    found = []
    for scale in (1.0, 1e3):
        (tmp_path / "job.k").write_text(struck(scale))
        run(exe, tmp_path, "i=job.k", f"d=out{scale:g}")
        with h5py.File(tmp_path / f"out{scale:g}/job.vtkhdf") as stream:
            found.append(stream["VTKHDF/PointData/displacement"][()] / scale)
    assert np.abs(found[1] - found[0]).max() < 1e-11 * np.abs(found[0]).max()


def test_nodes_next_to_the_axis_are_reported(exe, tmp_path):
    for shift, held, reported in ((1.0e-9, False, True), (1.0e-9, True, False), (1.0e-3, False, False), (1.0e-12, False, False)):
        deck = Deck("disc beside its axis").control(1.0e-3)
        deck.add("*PART", "disc", (1, 1, 1)).add("*SECTION_SHELL", (1, 15), (1.0,)).elastic(1000.0, 1.0e6, 0.3)
        ids = deck.mesh(*grid(3, 3, origin=(shift, 0.0)))
        if held:
            deck.fix(ids[::4], x=1)
        (tmp_path / "job.k").write_text(deck.text())
        said = run(exe, tmp_path, "check", "job.k").stderr
        assert ("nodes that lie next to the axis but not on it and form a bore: 4, " in said) == reported, said
        # What is next to the axis does not hang on how long the bodies are.
        deck.mesh(*grid(1, 1, origin=(1.0, 1.0e5)))
        (tmp_path / "job.k").write_text(deck.text())
        said = run(exe, tmp_path, "check", "job.k").stderr
        assert ("nodes that lie next to the axis but not on it and form a bore: 4, " in said) == reported, said


def cone_on_disc(kind, sides):
    """A cone with its tip on the axis, too steep for its flank to face the disc that it falls upon: contact begins at the tip."""
    deck = Deck("cone on a disc").control(0.04, scale=0.6).hourglass(4, 0.05)
    deck.add("*SECTION_SHELL", (1, 15), (1.0,))
    for part, young in ((1, 5.0e7), (2, 1.0e7)):
        deck.part(part, section=1).elastic(1000.0, young, 0.3, part)
        deck.add("*SET_PART_LIST", (part,), (part,))
    points, quads = grid(18, 18, 0.3, 1.0)
    cone = deck.mesh(np.column_stack([points[:, 0], 3.0 * points[:, 0] + 0.4 * points[:, 1] + 0.002]), quads, part=1)
    disc = deck.mesh(*grid(30, 15, 1.0, 0.5, (0.0, -0.5)), part=2)
    deck.node_set(1, cone[:19]).node_set(2, disc[-31:][::-1]).fix(disc[:31], y=1)
    deck.add("*CONTACT_2D_SLIDELINE", (*sides, kind, 3, 0.5), (0.0, 1.0e20, 3))
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), 0.0, -2.0) for node in cone])
    return deck.output(glstat=0.01, matsum=0.04, rcforc=4.0e-4).text()


@pytest.mark.parametrize("kind", range(1, 8))
def test_edges_on_the_axis_are_no_surface(exe, tmp_path, kind):
    """Whole outlines go along the axis; contact is that of the faces alone, with a penalty (PUNIT 3) up to 4 % apart."""
    forces = []
    for sides in ((-1, -2), (1, 2)):
        (tmp_path / "job.k").write_text(cone_on_disc(kind, sides))
        run(exe, tmp_path, "i=job.k", "d=out")
        forces.append(np.max(np.abs(numbers(tmp_path / "out/job.rcforc.csv", "fy"))))
    assert forces[0] > 900.0 and np.isclose(*forces, rtol=0.02 if kind in (2, 3, 4, 6) else 0.04), forces
