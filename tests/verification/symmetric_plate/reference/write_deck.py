# SPDX-License-Identifier: MIT
"""Write a CalculiX deck of the symmetric plate (half model) and turn its results into a CSV.

  write_deck.py deck NX NY elastic|elastoplastic OUT.inp
  write_deck.py csv JOB.dat OUT.csv

The plate is a layer of bricks of 20 nodes (C3D20R), u_z = 0 on every node, which is plane strain. A law that never yields makes
CalculiX take its finite-strain law in `elastic` too. The CSV has every tenth step of 1 ms, and three about the first peak.
"""
import sys

import numpy as np

LENGTH, HEIGHT, LOAD, ELASTIC_FROM = 8.0, 1.0, 80.0e3, 7.0
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2),
           (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
           (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
#: consistent weights of a uniform load on the top face: offset on the face -> share
TOP = {(i, k): (-1 / 12 if i != 1 and k != 1 else 1 / 3) for i in range(3) for k in range(3) if (i, k) != (1, 1)}


def lines(numbers, per_line):
    """Numbers in lines; a comma at the end of a line continues it."""
    rows = [numbers[start:start + per_line] for start in range(0, len(numbers), per_line)]
    return ",\n".join(",".join(map(str, row)) for row in rows) + "\n"


def mesh(nx, ny, thick):
    """Node numbers by half-cell index (i, j, k); text with nodes, elements (sets BODY and TIP) and node sets."""
    ids, elements = {}, []
    for i, j in np.ndindex(nx, ny):
        elements.append([ids.setdefault((2 * i + a, 2 * j + b, c), len(ids) + 1) for a, b, c in CORNERS])
    text = "*NODE,NSET=ALL\n"
    for (i, j, k), node in ids.items():
        text += f"{node},{i*LENGTH/(2*nx):.9g},{j*HEIGHT/(2*ny):.9g},{k*thick/2:.9g}\n"
    plastic = round(nx * ELASTIC_FROM / LENGTH) * ny
    for group, first, last in (("BODY", 0, plastic), ("TIP", plastic, nx * ny)):
        text += f"*ELEMENT,TYPE=C3D20R,ELSET={group}\n"
        text += "".join(lines([number + 1] + elements[number], 15) for number in range(first, last))
    for group, test in (("SYMMETRY", lambda i, j: i == 0), ("PIN", lambda i, j: i == 2 * nx and j == ny),
                        ("MID", lambda i, j: i == 0 and j == ny)):
        text += f"*NSET,NSET={group}\n" + lines([n for (i, j, k), n in ids.items() if test(i, j)], 12)
    return ids, text


def deck(nx, ny, law):
    thick = HEIGHT / ny
    ids, text = mesh(nx, ny, thick)
    for group in ("BODY", "TIP"):
        limit = "1.e7" if law == "elastoplastic" and group == "BODY" else "1.e15"
        text += f"*MATERIAL,NAME={group}\n*ELASTIC\n1.e9,0.3\n*DENSITY\n1000.\n*PLASTIC\n{limit},0.\n"
        text += f"*SOLID SECTION,ELSET={group},MATERIAL={group}\n"
    force = {}
    for i in range(nx):
        for (a, c), weight in TOP.items():
            node = ids[(2 * i + a, 2 * ny, c)]
            force[node] = force.get(node, 0.0) + weight * LOAD * thick * LENGTH / nx
    text += "*AMPLITUDE,NAME=ON\n0.,1.,10.,1.\n*BOUNDARY\nSYMMETRY,1,1\nPIN,1,2\nALL,3,3\n"
    text += "*STEP,NLGEOM,INC=100000\n*DYNAMIC,DIRECT,ALPHA=-0.05\n0.001,0.6\n*CLOAD,AMPLITUDE=ON\n"
    text += "".join(f"{node},2,{value:.12g}\n" for node, value in force.items())
    return text + "*NODE PRINT,NSET=MID\nU\n*END STEP\n"


def history(dat):
    """Table of time and u_y, the mean of the printed nodes, from the text of a CalculiX .dat file."""
    rows = [(0.0, 0.0)]
    for block in dat.split("displacements")[1:]:
        head, *printed = [line for line in block.splitlines() if line.strip()]
        rows.append((float(head.split()[-1]), np.mean([float(line.split()[2]) for line in printed if line.split()[0].isdigit()])))
    peak = max(range(len(rows)), key=lambda k: rows[k][1])
    return "time,uy\n" + "".join(f"{t:.4f},{u:.6e}\n" for k, (t, u) in enumerate(rows) if k % 10 == 0 or abs(k - peak) < 2)


if __name__ == "__main__":
    command, *words, out = sys.argv[1:]
    with open(out, "w", encoding="ascii") as stream:
        if command == "deck":
            stream.write(deck(int(words[0]), int(words[1]), words[2]))
        else:
            with open(words[0], encoding="ascii") as dat:
                stream.write(history(dat.read()))
