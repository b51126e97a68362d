# SPDX-License-Identifier: MIT
"""Pictures of models: what is read of a deck, surfaces as the program walks them, the picture."""
import pathlib
import re
import subprocess

import conftest
import numpy as np
import pytest

from slideline_tools import UserError, scenes
from slideline_tools.draw import picture, resolve
from slideline_tools.draw.model import ModelError
from slideline_tools.histories import read_csv
from slideline_tools.results import read

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "doc/examples"

# A ring of eight quads (part 1) with a block of two quads and a triangle (part 2) above it; numbers
# run against the order of the deck.
RING = [(x, y) for y in range(4) for x in range(4)]
BLOCK = [(0.5, 3.01), (1.5, 3.01), (2.5, 3.01), (0.5, 4.0), (1.5, 4.0), (2.5, 4.0), (3.2, 4.0)]
MESH = {**{100 - k: point for k, point in enumerate(RING)},
        **{200 + k: point for k, point in enumerate(BLOCK)}}


def ring_cells():
    return [(100 - k, 99 - k, 95 - k, 96 - k) for y in range(3) for x in range(3)
            for k in [4 * y + x] if (x, y) != (1, 1)]


BLOCK_CELLS = [(200, 203, 204, 201), (201, 202, 205, 204), (202, 206, 205, 205)]  # first clockwise

MAIN = """*KEYWORD
*TITLE
ring and block
*PARAMETER
R vel          -2.0
*CONTROL_TERMINATION
       1.0
*CONTROL_TIMESTEP
       0.0       0.9
*DATABASE_BINARY_D3PLOT
       1.0
*DATABASE_HISTORY_NODE
       200
*INCLUDE
mesh.inc
*PART
ring
         1         1         1
*PART
block
         2         1         2
*SECTION_SHELL
         1        13

*MAT_ELASTIC
         1    1000.0     1.0E6       0.3
*MAT_RIGID
         2    1000.0     1.0E6       0.3
       1.0       1.0       7.0

*SET_PART_LIST
         1
         1
*SET_PART_LIST
         2
         2
*SET_NODE_LIST_GENERATE_TITLE
foot of the ring
         1
        97       100
*SET_NODE_LIST_TITLE
left side, out of order
         7
        96       100        88        92
*SET_SEGMENT
         5
        88        87
        86        87
*DEFINE_CURVE
         1         0       1.0       3.0       0.0       0.0
                 0.0                 0.0
                 1.0                 5.0
*BOUNDARY_SPC_SET
         1         0         1         1
*BOUNDARY_SPC_NODE
        88         0         1         0
*BOUNDARY_PRESCRIBED_MOTION_RIGID
         2         2         0         1     &vel
*LOAD_SEGMENT_SET
         5         1       2.0
*LOAD_NODE_POINT
        96         1         1      -1.0
*LOAD_BODY_Y
         1       1.0
*INITIAL_VELOCITY_GENERATION
         1         2       4.0       1.0       0.0
       1.5       1.5
*CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE_TITLE
 pads
         1         2
         0.0

*END
"""


def write_deck(folder, swap=False):
    nodes = [f"{number:8d}{x:16.8f}{y:16.8f}{0.0:16.1f}" for number, (x, y) in MESH.items()]
    cells = [(1, cell) for cell in ring_cells()] + [(2, cell) for cell in BLOCK_CELLS]
    elements = [f"{k:8d}{part:8d}" + "".join(f"{node:8d}" for node in cell)
                for k, (part, cell) in enumerate(cells, start=1)]
    (folder / "mesh.inc").write_text("\n".join(["*NODE", *nodes, "*ELEMENT_SHELL", *elements, ""]))
    text = MAIN.replace(" pads\n         1         2", " pads\n         2         1") if swap else MAIN
    (folder / "deck.k").write_text(text)
    return folder / "deck.k"


@pytest.fixture
def model(tmp_path, slideline):
    return resolve(write_deck(tmp_path), slideline)


def chains_of(surface):
    """The nodes of each chain; a closed one repeats its first node at the end."""
    breaks = np.flatnonzero(surface.segments[1:, 0] != surface.segments[:-1, 1]) + 1
    return [np.append(part[:, 0], part[-1, 1]) for part in np.split(surface.segments, breaks) if len(part)]


def numbers(model, nodes):
    return model.node_ids[nodes].tolist()


def test_mesh_and_parts(model):
    assert model.title == "ring and block"
    assert {number: model.points[model.indices([number])[0]].tolist() for number in MESH} == {
        number: pytest.approx(list(point)) for number, point in MESH.items()}
    corner = model.points[model.cells]
    first, second = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    assert np.all(first[:, 0] * second[:, 1] > first[:, 1] * second[:, 0])
    assert {part.id: (part.title, part.n_element, part.law) for part in model.parts.values()} == {
        1: ("ring", 8, "elastic"), 2: ("block", 3, "rigid")}
    assert model.parts[2].is_rigid and model.parts[2].held == ("x", "turn")


def test_sets_and_conditions(model):
    assert sorted(numbers(model, model.node_sets[1].nodes)) == [97, 98, 99, 100]
    assert model.node_sets[1].title == "foot of the ring"
    held = {int(number): flags.tolist() for number, flags in zip(model.node_ids, model.fixed)
            if flags.any()}
    assert held == {**{number: [True, True] for number in (97, 98, 99, 100)}, 88: [True, False]}
    assert numbers(model, model.history_nodes) == [200]
    assert model.not_drawn == []
    assert len(model.warnings) >= 1 and "numbered clockwise" in model.warnings[0]


def test_loads_and_motions(model):
    arrows = {one.kind: one for one in model.arrows}
    assert set(arrows) == {"motion", "load", "pressure", "body", "velocity"}
    # The curve peaks at 3*5 = 15; the upper edges of the ring are pushed down.
    np.testing.assert_allclose(arrows["pressure"].places, [[0.5, 3.0], [1.5, 3.0]])
    np.testing.assert_allclose(arrows["pressure"].vectors, [[0.0, -30.0]] * 2)
    assert "peak 30" in arrows["pressure"].label
    np.testing.assert_allclose(arrows["load"].vectors, [[-15.0, 0.0]])
    np.testing.assert_allclose(arrows["load"].places, [[0.0, 1.0]])
    np.testing.assert_allclose(arrows["body"].vectors, [[0.0, -15.0]])
    np.testing.assert_allclose(arrows["motion"].vectors, [[0.0, -30.0]])
    assert "part 2" in arrows["motion"].label and "velocity" in arrows["motion"].label


def test_initial_velocity(model):
    """Translation and spin 4 about (1.5, 1.5) for the ring alone; nodes that are held stand still."""
    np.testing.assert_allclose(model.velocity[model.indices([85])[0]], [1.0 - 4.0 * 1.5, 4.0 * 1.5])
    np.testing.assert_allclose(model.velocity[model.indices([100])[0]], 0.0)
    np.testing.assert_allclose(model.velocity[model.cells[model.cell_parts == 2]], 0.0)


def test_velocity_of_a_rigid_body(tmp_path, slideline):
    """Translation and spin about the centre of mass, before what its nodes get; held directions stay at rest."""
    text = (EXAMPLES / "initial_velocity_rigid_body.k").read_text()

    def read_model(deck):
        (tmp_path / "deck.k").write_text(deck)
        return resolve(tmp_path / "deck.k", slideline)

    model = read_model(text.replace("*END\n", "*INITIAL_VELOCITY_NODE\n         4       9.0       9.0\n*END\n"))
    np.testing.assert_allclose(model.velocity[model.indices([4])[0]], [1.0 - 10.0 * 0.5, 10.0 * 0.5])
    np.testing.assert_allclose(model.velocity.mean(axis=0), [1.0, 0.0], atol=1e-12)
    rigid = "         1    1000.0    2.1E11       0.3\n"
    held = read_model(text.replace(rigid, rigid + "       1.0       1.0       7.0\n"))
    np.testing.assert_allclose(held.velocity, 0.0)


def test_surfaces_of_part_sets(model):
    """Two chains for the ring, body on the left: normals point away from it."""
    interface = model.interfaces[0]
    assert interface.label.startswith('interface 1 "pads"')
    assert sorted(len(chain) - 1 for chain in chains_of(interface.slave)) == [4, 12]
    assert [len(chain) - 1 for chain in chains_of(interface.master)] == [7]
    middle = model.points[interface.slave.segments].mean(axis=1)
    outward = interface.slave.normals(model.points)
    inside = np.all(np.abs(middle - 1.5) < 0.6, axis=1)
    toward = np.sum(outward * (middle - 1.5), axis=1)
    assert inside.sum() == 4 and np.all(toward[inside] < 0.0) and np.all(toward[~inside] > 0.0)


@pytest.mark.parametrize("name", ["set_2d_segment", "set_node_general", "contact_2d_force_transducer",
                                  "contact_2d_sliding_voids"])
def test_surfaces_by_other_sets_are_those_of_the_program(tmp_path, slideline, name):
    """Both surfaces against the slave rows of contact.csv; there is no interface for what only measures."""
    def run(path, job):
        done = subprocess.run([slideline, f"i={path}", f"d={tmp_path}", f"jobid={job}", "endtim=1e-9"],
                              capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return (tmp_path / f"{job}.effective.k").read_text()

    deck = run(EXAMPLES / f"{name}.k", "first").replace("*DATABASE_GLSTAT", "*DATABASE_BINARY_D3PLOT\n       1.0\n*DATABASE_GLSTAT")
    deck = deck.replace("*CONTACT_2D", "*SET_SEGMENT\n        77\n        21        42\n*CONTACT_2D", 1)
    for k, text in enumerate((deck, deck.replace("         1         2\n*", "        77         2\n*"))):
        (tmp_path / f"deck{k}.k").write_text(text)
        run(tmp_path / f"deck{k}.k", f"job{k}")
        model = resolve(tmp_path / f"deck{k}.k", slideline)
        assert len(model.interfaces) == 1
        rows = read_csv(tmp_path / f"job{k}.contact.csv").where(time=0.0)
        walked, drawn = rows["node"].astype(int).tolist(), numbers(model, model.interfaces[0].slave.nodes)
        assert from_lowest(walked) == from_lowest(drawn)


@pytest.mark.parametrize("swap", [False, True])
def test_surfaces_are_those_of_the_program(tmp_path, slideline, model, swap):
    """The slave rows of contact.csv, walked by the program, against both computed surfaces."""
    deck = write_deck(tmp_path, swap)
    done = subprocess.run([slideline, f"i={deck}", f"d={tmp_path / 'run'}", "endtim=1e-9"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = read_csv(tmp_path / "run" / "deck.contact.csv").where(time=0.0)
    starts = np.flatnonzero(rows["s"] == 0.0)
    walked = [chain.tolist() for chain in np.split(rows["node"], starts[1:])]
    surface = model.interfaces[0].master if swap else model.interfaces[0].slave
    computed = [numbers(model, chain[:-1]) for chain in chains_of(surface)]
    assert sorted(map(from_lowest, walked)) == sorted(map(from_lowest, computed))


def from_lowest(chain):
    """A closed chain from its lowest number on."""
    start = chain.index(min(chain))
    return chain[start:] + chain[:start]


def test_a_list_of_nodes_is_walked_counter_clockwise(tmp_path, slideline):
    """Whatever its order: the left side of the ring and the ring round the hole."""
    inner = "".join(f"{node:10d}" for node in (94, 90, 91, 95, 94))
    lists = f"*SET_NODE_LIST\n         8\n{inner}\n*SET_NODE_LIST\n         9\n       200       201       202\n"
    contact = "*CONTACT_2D_SLIDELINE\n{:10d}        -9         5         2     1.0E6\n"
    for number, walked, closed in ((-7, [88, 92, 96, 100], False), (-8, [90, 94, 95, 91], True)):
        deck = write_deck(tmp_path)
        text = deck.read_text()
        start = text.index("*CONTACT_2D")
        deck.write_text(text[:start] + lists + contact.format(number) + "*END\n")
        chains = [numbers(model, chain) for model in [resolve(deck, slideline)] for chain in chains_of(model.interfaces[0].slave)]
        assert len(chains) == 1 and (chains[0][0] == chains[0][-1]) == closed
        found = chains[0][:-1] if closed else chains[0]
        assert (from_lowest(found) if closed else found) == walked


def test_model_of_a_scene_is_that_of_the_results(tmp_path, slideline):
    (tmp_path / "die.k").write_text(scenes.sliding(rigid_die=True))
    model = resolve(tmp_path / "die.k", slideline)
    subprocess.run([slideline, f"i={tmp_path / 'die.k'}", f"d={tmp_path}", "endtim=1e-9"],
                   capture_output=True, check=True)
    results = read(tmp_path / "die.vtkhdf")
    np.testing.assert_array_equal(model.node_ids, results.point_field("node_id")[0])
    np.testing.assert_allclose(model.points, results.points[0][:, :2], atol=1e-15)
    np.testing.assert_array_equal(np.sort(model.cells), np.sort(results.cells))
    log = (tmp_path / "die.log").read_text()
    for side, surface in (("slave", model.interfaces[0].slave),
                          ("master", model.interfaces[0].master)):
        count = re.search(rf"{side}: (\d+) nodes, (\d+) segments", log)
        assert [len(surface.nodes), len(surface.segments)] == [int(word) for word in count.groups()]
    centre = re.search(r"^rigid part 2: .*centre of mass (\S+), (\S+)", log, re.M)
    np.testing.assert_allclose(model.centre(2), [float(word) for word in centre.groups()], rtol=1e-3)


def test_overrides_reach_the_program(tmp_path, slideline):
    assert resolve(write_deck(tmp_path), slideline, ["p:vel=7"]).arrows[0].vectors[0][1] == 105.0


def test_refused_deck(tmp_path, slideline, tool):
    (tmp_path / "bad.k").write_text("*KEYWORD\n*NONSENSE\n*END\n")
    finished = tool("draw", tmp_path / "bad.k", "--program", slideline, "-o", tmp_path / "x.png")
    assert finished.returncode == 2 and "*NONSENSE" in finished.stderr
    assert not (tmp_path / "x.png").exists()


def test_program_that_is_not_there(tmp_path):
    with pytest.raises(UserError, match="--program"):
        resolve(write_deck(tmp_path), tmp_path / "none")


def test_program_that_tells_no_model(tmp_path):
    with pytest.raises(ModelError, match="tells no model"):
        resolve(write_deck(tmp_path), "true")


# ---- the picture --------------------------------------------------------------------------------

def labels(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_legend_names_everything(model):
    found = "\n".join(labels(picture.model_figure(model)))
    for words in ('part 1 "ring": 8 elements', "held: x, turn", 'set 1 "foot of the ring": 4 nodes',
                  "slave, 16 segments", "master, 7 segments",
                  "held in x: 1", "held in x and y: 4", "initial velocity, largest", "pressure",
                  "body load in y", "load on node 96", "velocity of part 2", "history of nodes: 1"):
        assert words in found


def test_show_and_zoom(model):
    figure = picture.model_figure(model, ["surfaces"], (0.0, 2.0, 2.0, 4.0))
    found = labels(figure)
    assert not any("set 1" in words or "held in" in words or "initial" in words for words in found
                   if words.startswith(("node", "held", "initial")))
    axes = figure.axes[0]
    assert axes.get_xlim() == (0.0, 2.0) and axes.get_ylim() == (2.0, 4.0)


def test_command(tmp_path, slideline, tool, monkeypatch):
    monkeypatch.setenv("SLIDELINE", slideline)
    deck = conftest.ROOT / "input" / "collision" / "collision.k"
    finished = tool("draw", deck, "p:ctype=5", "-o", tmp_path / "new" / "x.png", "--show", "mesh,surfaces")
    assert finished.returncode == 0, finished.stderr
    assert "310 nodes, 240 elements, 2 parts, 1 interface)" in finished.stdout
    assert is_png(tmp_path / "new" / "x.png")
    assert tool("draw", deck, "--show", "everything").returncode == 2


def test_command_on_a_results_folder(tmp_path, slideline, tool):
    subprocess.run([slideline, f"i={write_deck(tmp_path)}", f"d={tmp_path / 'run'}", "endtim=1e-9"],
                   capture_output=True, check=True)
    finished = tool("draw", tmp_path / "run", "--program", slideline, "-o", tmp_path / "y.png")
    assert finished.returncode == 0, finished.stderr
    assert is_png(tmp_path / "y.png")


def is_png(path: pathlib.Path):
    return path.read_bytes().startswith(b"\x89PNG") and path.stat().st_size > 10000
