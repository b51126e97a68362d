# SPDX-License-Identifier: MIT
"""A mesh file becomes a deck that runs; what is no plane mesh is refused with all reasons."""
import re
import subprocess

import numpy as np
import pytest

from slideline_tools import UserError, cli, from_mesh

meshio = pytest.importorskip("meshio")

#: two blocks, the upper one on the lower: gmsh's numbers of groups, quads and a pair of triangles
POINTS = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0],
                   [0.5, 1, 0], [1.5, 1, 0], [0.5, 2, 0], [1.5, 2, 0], [9, 9, 0]], dtype=float)
LOWER, UPPER, TOP, BOTTOM, BASE, CORNER = 1, 2, 11, 12, 13, 21


def made_mesh(**changes):
    """Quads (one of them clockwise) below, two triangles above, three edges and a point of groups."""
    cells = [("quad", np.array([[0, 1, 4, 3], [1, 4, 5, 2]])), ("triangle", np.array([[6, 7, 9], [6, 9, 8]])),
             ("line", np.array([[3, 4], [4, 5], [6, 7], [0, 1], [1, 2]])), ("vertex", np.array([[0]]))]
    groups = [np.array([LOWER, LOWER]), np.array([UPPER, UPPER]), np.array([TOP, TOP, BOTTOM, BASE, BASE]),
              np.array([CORNER])]
    names = {"lower": [LOWER, 2], "upper": [UPPER, 2], "lower_top": [TOP, 1], "upper_bottom": [BOTTOM, 1],
             "base": [BASE, 1], "corner": [CORNER, 0]}
    return meshio.Mesh(changes.get("points", POINTS), changes.get("cells", cells),
                       cell_data={"gmsh:physical": groups, "gmsh:geometrical": groups},
                       field_data={name: np.array(value) for name, value in names.items()})


def written(tmp_path, **changes):
    path = tmp_path / "model.msh"
    made_mesh(**changes).write(path, file_format="gmsh22", binary=False)
    return path


def test_groups_become_parts_and_sets(tmp_path, capsys):
    path = written(tmp_path)
    assert cli.main(["from-mesh", str(path)]) == 0
    text = path.with_suffix(".k").read_text()
    shown = capsys.readouterr().out
    assert "part 1: lower, 2 elements" in shown and "part 2: upper, 2 elements" in shown
    assert "set 1: lower_top, 2 edges" in shown and shown.startswith("wrote ") and "set 4: corner, 1 node\n" in shown
    assert "1 point of no triangle or quad left out" in shown
    assert "1 face walked clockwise and turned" in shown
    assert text.count("*SET_SEGMENT_TITLE") == 3 and text.count("*SET_NODE_LIST_TITLE") == 4
    assert cli.main(["from-mesh", str(path)]) == 2, "a deck that is there is not written over unasked"


def test_no_cell_is_lost_without_a_word(tmp_path):
    mesh = meshio.Mesh(POINTS, [("quad", np.array([[0, 1, 4, 3]])), ("triangle10", np.array([list(range(10))]))])
    with pytest.raises(UserError, match="1 cells of kind triangle10"):
        from_mesh.check("a mesh", mesh)


def test_names_of_groups_are_no_comments_and_no_keywords():
    assert [from_mesh.heading(name) for name in ("$skin", "*NODE", "body")] == ["_$skin", "_*NODE", "body"]


def test_faces_are_walked_with_the_face_on_the_left(tmp_path):
    mesh = from_mesh.read(written(tmp_path))
    for faces in mesh.parts.values():
        for face in faces:
            x, y = mesh.points[face].T
            assert np.sum(x*np.roll(y, -1) - np.roll(x, -1)*y) > 0.0


def test_the_skeleton_runs_with_its_contact(tmp_path, slideline):
    """Both boxes fall on their base: the edges of the file are surfaces of contact and supports."""
    path = written(tmp_path)
    assert cli.main(["from-mesh", str(path), "-o", str(tmp_path / "deck.k")]) == 0
    text = (tmp_path / "deck.k").read_text()
    block = re.search(r"^\$ (\*CONTACT_2D_SLIDELINE)\n\$ .*?\n(?:\$ (?![\d*]).*\n)*\$ (\d.*)\n\$ (\d.*)\n", text, re.M)
    assert block, "the skeleton shows how to write the contact"
    contact = "\n".join(block.groups())
    extra = ("*BOUNDARY_SPC_SET\n3,0,1,1\n*LOAD_BODY_Y\n1,1e3\n*DEFINE_CURVE\n1\n0,1\n1,1\n"
             "*DATABASE_RCFORC\n1e-5\n")
    text = text.replace("*END", f"{contact}\n{extra}*END").replace("       1.0\n*DATABASE_BINARY", "      2E-3\n*DATABASE_BINARY")
    (tmp_path / "deck.k").write_text(text)
    done = subprocess.run([slideline, f"i={tmp_path / 'deck.k'}", f"d={tmp_path / 'out'}", "jobid=job"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = np.genfromtxt(tmp_path / "out/job.rcforc.csv", delimiter=",", names=True, dtype=None, encoding="ascii")
    force = rows["fy"][rows["side"] == "slave"]
    assert np.abs(force).max() > 0.0


def test_what_is_no_plane_mesh_is_refused_with_all_reasons(tmp_path):
    bent = POINTS.copy()
    bent[5, 2] = 0.5
    with pytest.raises(UserError, match="z runs from 0 to 0.5"):
        from_mesh.read(written(tmp_path, points=bent))
    curved = meshio.Mesh(POINTS, [("triangle6", np.array([[0, 1, 4, 3, 5, 6]]))])
    curved.write(tmp_path / "curved.vtk")
    with pytest.raises(UserError, match="triangle6.*no triangles and no quads"):
        from_mesh.read(tmp_path / "curved.vtk")
    with pytest.raises(UserError, match="no such file"):
        from_mesh.read(tmp_path / "nothing.msh")
    (tmp_path / "broken.msh").write_text("what")
    with pytest.raises(UserError, match="cannot read it"):
        from_mesh.read(tmp_path / "broken.msh")
