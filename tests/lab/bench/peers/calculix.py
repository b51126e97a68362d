# SPDX-License-Identifier: MIT
"""Contact patch and block-to-block for CalculiX: the meshes, springs and steps of slideline's own scenes.

Plane strain quads (CPE4), pressure linear in the overclosure with the slope that slideline has: the penalty of a contact
node over the length of a slave segment.
"""
import re
import subprocess

import numpy as np

CONTACTS = ("NODE TO SURFACE", "SURFACE TO SURFACE", "MORTAR")
YOUNG, RHO, PENALTY = 1.0e6, 1000.0, 1.0e6
STATIC = """*STEP, NLGEOM
*STATIC, DIRECT
1.0,1.0
*DSLOAD
TOP,P,1.0
"""
PUSH = """*STEP, NLGEOM
*STATIC, DIRECT
1.0,1.0
*BOUNDARY
PUSHED,2,2,-{push}
"""
ENDING = """*EL PRINT, ELSET=EALL, FREQUENCY=100000
S
*END STEP
"""


def mesh_lines(lower, upper):
    """Nodes, elements, sets and surfaces of two blocks."""
    lines = ["*NODE, NSET=NALL"]
    for grid in (lower, upper):
        lines += [f"{node},{x!r},{y!r},0.0" for node, (x, y)
                  in zip(grid.node.ravel().tolist(), grid.points.reshape(-1, 2).tolist())]
    for name, grid in (("LOWER", lower), ("UPPER", upper)):
        lines.append(f"*ELEMENT, TYPE=CPE4, ELSET={name}")
        lines += [",".join(map(str, (element, *quad))) for element, quad
                  in zip(grid.element.ravel().tolist(), grid.quads.reshape(-1, 4).tolist())]
    for name, elements, face in (("SLAVE", upper.element[:, 0], "S1"),
                                 ("MASTER", lower.element[:, -1], "S3"),
                                 ("TOP", upper.element[:, -1], "S3")):
        lines.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
        lines += [f"{element},{face}" for element in elements.tolist()]
    for name, nodes in (("BASE", lower.lower), ("PUSHED", upper.upper)):
        lines.append(f"*NSET, NSET={name}")
        lines += [f"{node}," for node in nodes.tolist()]
    return lines


def deck(contact, lower, upper, pinned, step):
    """Text of a deck; `pinned`: nodes held in x; `step`: STATIC or DYNAMIC."""
    side = np.diff(upper.points[:, 0, 0])[0]
    lines = mesh_lines(lower, upper) + [
        "*ELSET, ELSET=EALL", "LOWER,UPPER", "*MATERIAL, NAME=SOFT", "*ELASTIC", f"{YOUNG},0.0",
        "*DENSITY", f"{RHO}", "*SOLID SECTION, ELSET=EALL, MATERIAL=SOFT", "1.0",
        "*SURFACE INTERACTION, NAME=SPRINGS",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{PENALTY / side:.9g},0.0",
        f"*CONTACT PAIR, INTERACTION=SPRINGS, TYPE={contact}", "SLAVE,MASTER",
        "*BOUNDARY", "BASE,2,2"] + [f"{node},1,1" for node in pinned]
    return "\n".join(lines) + "\n" + step + ENDING


def stresses(path):
    """{element: mean s_yy over its points} of the last printed state; empty where there is none."""
    blocks = re.split(r"stresses \(elem[^\n]*\n", path.read_text(encoding="ascii"))
    if len(blocks) < 2:
        return {}
    points = {}
    for line in blocks[-1].splitlines():
        words = line.split()
        if len(words) == 8:
            points.setdefault(int(words[0]), []).append(float(words[3]))
    return {element: float(np.mean(values)) for element, values in points.items()}


def run(folder, name, text):
    """Run a deck; (stresses, its message where it failed)."""
    (folder / f"{name}.inp").write_text(text, encoding="ascii")
    for old in folder.glob(f"{name}.dat"):
        old.unlink()
    done = subprocess.run(["ccx", name], cwd=folder, capture_output=True, text=True, check=False)
    output = folder / f"{name}.dat"
    found = stresses(output) if output.exists() else {}
    trouble = [line.strip() for line in done.stdout.splitlines() if "*ERROR" in line]
    return found, "" if found else (trouble or [f"status {done.returncode}"])[0]
