# SPDX-License-Identifier: MIT
"""The result files: names, headers, number format, states, histories in HDF5, VTK."""
import re
import zlib

import h5py
import numpy as np
import pytest
from conftest import columns, drop, numbers
from meshes import Deck, grid

HEADERS = {
    "glstat": "time,cycle,dt,kinetic,internal,hourglass,viscous,damping,contact,external_work,"
              "total,energy_ratio,leapfrog,friction",
    "rcforc": "time,interface,side,fx,fy,n_active",
    "nodout": "time,node,x,y,ux,uy,vx,vy,ax,ay",
    "contact": "time,interface,node,s,x,y,gap,pressure,fx,fy,length,traction,slip,state,row_stress,offset",
    "matsum": "time,part,kinetic,internal,hourglass,momentum_x,momentum_y,mass",
    "timing": "phase,seconds,calls,share",
}
INTEGERS = {"cycle", "interface", "n_active", "node", "part", "calls", "state"}
REAL = re.compile(r"-?\d+(\.\d+)?(E[+-]\d{2,3})?")
PHASES = {"elements", "contact_search", "contact_pairing", "contact_force", "nodes", "output", "input",
          "solver", "total"}
#: columns of /dyna
FURTHER = {"glstat": {"velocity_x", "velocity_y", "element", "element_part"}, "nodout": {"cycle"}}
HISTORIES = ("glstat", "rcforc", "nodout", "contact", "matsum")


def state(root, group, name, k, size):
    """Rows of one field at state k, found through its offsets."""
    first = int(np.ravel(root[f"Steps/{group}Offsets/{name}"])[k])
    return root[group][name][first:first + size]


@pytest.mark.parametrize("table", HEADERS)
def test_header(finished, table):
    with open(finished[0] / f"drop.{table}.csv", newline="") as stream:
        assert stream.readline() == HEADERS[table] + "\n"


def test_other_files(finished):
    folder, _ = finished
    for suffix in ("vtkhdf", "log", "effective.k"):
        assert (folder / f"drop.{suffix}").stat().st_size > 0
    names = {path.name for path in folder.iterdir()}
    assert names == ({f"drop.{t}.csv" for t in HEADERS} | {"drop.vtkhdf", "drop.log", "drop.effective.k", "status.out"}
                     | {f"drop.{t}" for t in ("glstat", "rcforc", "nodout", "matsum")})


def digits(text):
    """The significant digits of a number."""
    return re.sub(r"[eE].*|[-.]", "", text).strip("0")


@pytest.mark.parametrize("table", HISTORIES)
def test_number_format(finished, table):
    path = finished[0] / f"drop.{table}.csv"
    raw = path.read_bytes()
    assert not set(raw) & set(b' "\r\t')
    assert raw.endswith(b"\n") and b"\n\n" not in raw
    for name, values in columns(path).items():
        assert values
        for text in values:
            if name == "side":
                assert text in ("slave", "master")
            elif name in INTEGERS:
                assert re.fullmatch(r"\d+", text), (name, text)
            else:
                assert REAL.fullmatch(text), (name, text)
                assert digits(text) == digits(repr(float(text))), (name, text)  # Python's are the shortest


def test_one_row_per_time_and_entity(finished):
    folder, _ = finished
    keys = {"glstat": ("time",), "rcforc": ("time", "interface", "side"), "nodout": ("time", "node"),
            "contact": ("time", "interface", "node"), "matsum": ("time", "part")}
    for table, names in keys.items():
        table_columns = columns(folder / f"drop.{table}.csv")
        rows = list(zip(*(table_columns[name] for name in names)))
        assert len(rows) == len(set(rows)), table
        times = np.array([float(text) for text in table_columns["time"]])
        assert np.all(np.diff(times) >= 0.0), table


def test_intervals_first_and_last(finished):
    folder, _ = finished
    for table in HISTORIES:
        time = np.unique(numbers(folder / f"drop.{table}.csv", "time"))
        interval = 2.0e-3 if table == "contact" else 1.0e-3
        assert time == pytest.approx(np.arange(len(time)) * interval, abs=1e-9), table
        assert time[0] == 0.0 and time[-1] == pytest.approx(0.02, rel=1e-12)
    with h5py.File(folder / "drop.vtkhdf") as stream:
        states = stream["VTKHDF/Steps/Values"][:]
        assert states == pytest.approx(np.arange(11) * 2.0e-3, abs=1e-9)
        assert np.all(stream["VTKHDF/PointData/displacement"][:24] == 0.0)


def test_last_state_when_the_interval_does_not_fit(slideline, tmp_path):
    deck = drop(end_time=0.0047)
    assert slideline("d=l", deck=deck).returncode == 0
    for table in HISTORIES:
        assert numbers(tmp_path / "l" / f"job.{table}.csv", "time")[-1] == pytest.approx(0.0047)
    with h5py.File(tmp_path / "l" / "job.vtkhdf") as stream:
        assert stream["VTKHDF/Steps/Values"][-1] == pytest.approx(0.0047)


def test_what_was_not_asked_for_is_not_written(slideline, tmp_path):
    deck = Deck("quiet")
    deck.control(0.01, dt=0.001).part().elastic(1.0e4, 1.0e6, 0.3)
    deck.mesh(*grid(1, 1))
    assert slideline("d=q", deck=deck).returncode == 0
    names = {path.name for path in (tmp_path / "q").iterdir()}
    assert {"job.glstat.csv", "job.log"} <= names
    for table in ("rcforc", "nodout", "contact", "matsum"):
        assert f"job.{table}.csv" not in names


def test_initial_overlap_force_at_time_zero(slideline, tmp_path):
    deck = drop(end_time=0.001)
    text = deck.text()
    upper = Deck("moved")
    upper.mesh(*grid(3, 2, 0.6, 0.4, (0.2, -0.001)), part=1)
    moved = "\n".join(upper.lines[3:16])
    start = text.index("*NODE")
    text = text[:start] + moved + "\n" + text[text.index("*ELEMENT_SHELL"):]
    done = slideline("d=o", deck=text)
    assert done.returncode == 0, done.stderr
    force = columns(tmp_path / "o" / "job.rcforc.csv")
    assert float(force["time"][0]) == 0.0
    first = [float(v) for v, t, s in zip(force["fy"], force["time"], force["side"])
             if float(t) == 0.0 and s == "slave"]
    # type 2, eps 2e5 per node, competence lengths 0.1 0.2 0.2 0.1 over 0.2: three full nodes
    assert first == [pytest.approx(3 * 2.0e5 * 0.001, rel=1e-9)]
    assert "penetrat" in (tmp_path / "o" / "job.log").read_text().lower()


def test_timing_table(finished):
    table = columns(finished[0] / "drop.timing.csv")
    assert set(table["phase"]) == PHASES
    seconds = dict(zip(table["phase"], map(float, table["seconds"])))
    parts = sum(value for phase, value in seconds.items() if phase != "total")
    assert parts == pytest.approx(seconds["total"], rel=1e-6)
    assert all(value >= 0.0 for value in seconds.values())


CONTACT_PHASES = ("contact_search", "contact_pairing", "contact_force")


def timing_table(path):
    """{phase: (whole nanoseconds, calls)} in the order of the file."""
    table = columns(path)
    assert len(set(table["phase"])) == len(table["phase"])
    assert all(len(text.split(".")[1]) == 9 for text in table["seconds"])
    return {phase: (int(text.replace(".", "")), int(calls)) for phase, text, calls
            in zip(table["phase"], table["seconds"], table["calls"])}


def check_interfaces(rows, ids):
    """Rows by interface add up to their phase, and the rows without a dot to the total."""
    split = {phase: [rows[f"{phase}.{k}"] for k in ids] for phase in CONTACT_PHASES}
    for phase, parts in split.items():
        assert (sum(t for t, _ in parts), sum(n for _, n in parts)) == rows[phase]
    assert set(rows) == PHASES | {f"{p}.{k}" for p in CONTACT_PHASES for k in ids}
    assert sum(t for phase, (t, _) in rows.items() if "." not in phase and phase != "total") \
        == rows["total"][0]
    return split


def test_timing_by_interface(slideline, tmp_path):
    """Rows are named by the ids of the interfaces, as those of rcforc are."""
    deck = drop(kind=2).contact(3, 2, 7, 2.0e5)
    for number in (12, 7):
        place = deck.lines.index("*CONTACT_2D_SLIDELINE")
        deck.lines[place:place + 1] = ["*CONTACT_2D_SLIDELINE_TITLE", f"{number:10}"]
    done = slideline("d=x", "timing=interface", deck=deck)
    assert done.returncode == 0, done.stderr
    assert set(numbers(tmp_path / "x" / "job.rcforc.csv", "interface")) == {7, 12}
    split = check_interfaces(timing_table(tmp_path / "x" / "job.timing.csv"), (12, 7))
    cycles = numbers(tmp_path / "x" / "job.glstat.csv", "cycle")[-1] + 1
    assert [n for _, n in split["contact_search"]] == [cycles, cycles]
    assert [n for _, n in split["contact_pairing"]] == [cycles, cycles]
    assert all(t > 0 for t, _ in split["contact_search"] + split["contact_force"])


def test_timing_by_interface_of_an_implicit_run(slideline, tmp_path):
    deck = Deck("pressed")
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.5))
    deck.part(points=4).elastic(1000.0, 1.0e6, 0.3)
    lower, upper = deck.mesh(*grid(2, 2)), deck.mesh(*grid(3, 2, 1.0, 1.0, (0.0, 1.0)))
    deck.fix(lower[:3], x=1, y=1).fix(upper[::4], x=1)
    deck.node_set(1, upper[:4]).node_set(2, lower[-3:][::-1])
    deck.contact(1, 2, 7, 1.0e6).contact(1, 2, 2, 1.0e6)
    deck.curve(1, [(0.0, -100.0), (1.0, -100.0)])
    for node in upper[-4:]:
        deck.add("*LOAD_NODE_POINT", (int(node), 2, 1, 1.0))
    done = slideline("d=x", "timing=interface", deck=deck)
    assert done.returncode == 0, done.stderr
    split = check_interfaces(timing_table(tmp_path / "x" / "job.timing.csv"), (1, 2))
    first, second = split["contact_force"]
    assert first[0] > 0 and second[0] > 0 and first[1] == second[1] > 2


def test_timing_off_leaves_the_total(slideline, tmp_path):
    for word in ("phase", "off"):
        assert slideline(f"d={word}", f"timing={word}", deck=drop()).returncode == 0
    rows = timing_table(tmp_path / "off" / "job.timing.csv")
    assert list(rows) == ["total"] and rows["total"][0] > 0
    assert set(timing_table(tmp_path / "phase" / "job.timing.csv")) == PHASES
    assert (tmp_path / "off" / "job.glstat.csv").read_bytes() \
        == (tmp_path / "phase" / "job.glstat.csv").read_bytes()
    log = (tmp_path / "phase" / "job.log").read_text()
    laps, each, share = re.search(r"Clock += (\d+) readings of (\d+\.\d) nanoseconds, (\d+\.\d\d) % of the time", log).groups()
    calls = timing_table(tmp_path / "phase" / "job.timing.csv")
    assert int(laps) == sum(n for phase, (_, n) in calls.items() if phase != "total")
    assert 1.0 < float(each) < 1.0e4 and 0.0 <= float(share) < 100.0


@pytest.mark.parametrize("table", HISTORIES)
def test_histories_in_hdf5(finished, table):
    folder, _ = finished
    text = columns(folder / f"drop.{table}.csv")
    with h5py.File(folder / "drop.vtkhdf") as stream:
        group = stream[f"history/{table}"]
        assert set(group) == set(text)
        assert set(stream.get(f"dyna/{table}", ())) == FURTHER.get(table, set())
        for name, values in text.items():
            stored = group[name][:]
            if name == "side":
                wanted = np.array([{"slave": 1, "master": 2}[value] for value in values])
            else:
                wanted = np.array([float(value) for value in values])
            assert np.array_equal(stored, wanted), (table, name)


def test_run_group(finished):
    folder, _ = finished
    with h5py.File(folder / "drop.vtkhdf") as stream:
        for name in ("deck", "title", "version", "build", "options"):
            assert name in stream["run"].attrs
        deck = stream["run/effective_deck"][()]
        title = stream["run"].attrs["title"]

    def plain(value):
        value = np.asarray(value).ravel()[0] if not isinstance(value, (bytes, str)) else value
        return value.decode() if isinstance(value, bytes) else str(value)

    assert plain(title).strip() == "drop"
    assert plain(deck).strip() == (folder / "drop.effective.k").read_text().strip()


def test_arrays(finished):
    folder, _ = finished
    with h5py.File(folder / "drop.vtkhdf") as stream:
        root = stream["VTKHDF"]
        assert root.attrs["Version"].tolist() == [2, 0]
        assert root.attrs["Type"] == b"UnstructuredGrid"
        points = {"displacement": 3, "velocity": 3, "contact_force": 3, "contact_pressure": None,
                  "gap": None, "node_id": None}
        cells = {"stress": 6, "plastic_strain": None, "pressure": None, "mises": None,
                 "part_id": None, "element_id": None}
        for group, wanted in (("PointData", points), ("CellData", cells)):
            assert set(wanted) <= set(root[group])
            for name, size in wanted.items():
                array = root[group][name]
                assert array.shape[1:] in ([(size,)] if size else [(), (1,)]), name
                assert array.dtype.kind == ("i" if name.endswith("_id") else "f")
                assert array.dtype.itemsize == 8 or name.endswith("_id")
        n_node, n_cell = int(root["NumberOfPoints"][0]), int(root["NumberOfCells"][0])
        assert (n_node, n_cell) == (30, 16)
        steps = len(root["Steps/Values"])
        for k in range(steps):
            assert np.all(state(root, "PointData", "node_id", k, n_node) == np.arange(1, 31))
            assert np.all(state(root, "CellData", "element_id", k, n_cell) == np.arange(1, 17))
            assert np.all(state(root, "CellData", "part_id", k, n_cell) == [1] * 6 + [2] * 10)
        stress = np.array(root["CellData/stress"])
        assert np.array(root["CellData/pressure"]).ravel() == pytest.approx(
            -stress[:, :3].mean(axis=1), rel=1e-12, abs=1e-6)
        xx, yy, zz, xy, yz, xz = stress.T
        assert not yz.any() and not xz.any()
        mises = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy ** 2)
        assert np.array(root["CellData/mises"]).ravel() == pytest.approx(mises, rel=1e-9, abs=1e-6)


def test_nodout_agrees_with_the_states(finished):
    folder, _ = finished
    table = {k: np.array(v, dtype=float) for k, v in columns(folder / "drop.nodout.csv").items()}
    with h5py.File(folder / "drop.vtkhdf") as stream:
        times = stream["VTKHDF/Steps/Values"][:]
        moved = stream["VTKHDF/PointData/displacement"][:].reshape(len(times), -1, 3)
        speed = stream["VTKHDF/PointData/velocity"][:].reshape(len(times), -1, 3)
        place = stream["VTKHDF/Points"][:].reshape(len(times), -1, 3)
    for k, time in enumerate(times):
        for node in (1, 13, 20):
            row = (table["time"] == time) & (table["node"] == node)
            assert row.sum() == 1
            for name, value in (("ux", moved[k, node - 1, 0]), ("uy", moved[k, node - 1, 1]),
                                ("vx", speed[k, node - 1, 0]), ("vy", speed[k, node - 1, 1]),
                                ("x", place[k, node - 1, 0]), ("y", place[k, node - 1, 1])):
                assert table[name][row][0] == value, name


def test_vtk_reads_every_step(finished):
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    folder, _ = finished
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(folder / "drop.vtkhdf"))
    reader.UpdateInformation()
    key = vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    times = reader.GetOutputInformation(0).Get(key)
    with h5py.File(folder / "drop.vtkhdf") as stream:
        root = stream["VTKHDF"]
        assert np.array_equal(times, root["Steps/Values"][:])
        for k, time in enumerate(times):
            reader.UpdateTimeStep(time)
            grid_ = reader.GetOutput()
            n_node, n_cell = grid_.GetNumberOfPoints(), grid_.GetNumberOfCells()
            assert (n_node, n_cell) == (30, 16)
            assert grid_.GetCellType(0) == vtk.VTK_QUAD
            assert np.array_equal(vtk_to_numpy(grid_.GetPoints().GetData()),
                                  root["Points"][k * n_node:(k + 1) * n_node])
            for data, group, size in ((grid_.GetPointData(), "PointData", n_node),
                                      (grid_.GetCellData(), "CellData", n_cell)):
                for name in root[group]:
                    stored = state(root, group, name, k, size)
                    read = vtk_to_numpy(data.GetArray(name))
                    assert np.array_equal(read.ravel(), np.asarray(stored).ravel()), (k, name)


def test_triangle_is_a_triangle(slideline, tmp_path):
    deck = Deck("a quad and a triangle")
    deck.control(0.002, dt=0.001).part().elastic(1.0e4, 1.0e6, 0.3)
    deck.mesh([(0, 0), (1, 0), (1, 1), (0, 1), (2, 0.5)], [(0, 1, 2, 3), (1, 4, 2, 2)])
    deck.output(plot=0.001)
    done = slideline("d=t", deck=deck)
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "t" / "job.vtkhdf") as stream:
        assert stream["VTKHDF/Types"][:].tolist() == [9, 5]
        assert stream["VTKHDF/Offsets"][:].tolist() == [0, 4, 7]
        assert stream["VTKHDF/Connectivity"][:].tolist() == [0, 1, 2, 3, 1, 4, 2]


def test_a_result_says_what_made_it(slideline, tmp_path):
    """Source, processor and the checksum that another program finds for the deck as run."""
    slideline("d=r", deck=drop(end_time=0.002))
    with h5py.File(tmp_path / "r/job.vtkhdf") as stream:
        run = dict(stream["run"].attrs)
    expected = f"{zlib.crc32((tmp_path / 'r/job.effective.k').read_bytes()):08X}"
    assert text_of(run["effective_deck_crc32"]) == expected
    version = slideline("--version").stdout
    assert f"source {text_of(run['source'])})" in version and len(text_of(run["source"])) >= 7
    build, flags = re.search(r"build (.*)\nflags (.*)\n", version).groups()
    assert text_of(run["build"]) == f"{build}, {flags}" and "-O" in flags
    assert text_of(run["machine"])


def text_of(value):
    value = np.asarray(value).ravel()[0]
    return value.decode() if isinstance(value, bytes) else str(value)
