# SPDX-License-Identifier: MIT
"""Write a CalculiX deck of the symmetric plate (half model) and turn its results into a CSV.

  make_deck.py deck NX NY svk|neohooke|elastoplastic DT OUT.inp [--type C3D20R] [--alpha -0.05] [--end 0.6]
  make_deck.py csv JOB.dat OUT.csv [--step 1e-3]

The plate is a layer of 3D elements one element thick with u_z = 0 on every node, which is plane
strain. 20-node and 8-node bricks and 8-node plane-strain quads (CPE8, CPE8R) are known.
"""
import argparse

import numpy as np

LENGTH, HEIGHT = 8.0, 1.0
LOAD = 80.0e3
ELASTIC_FROM = 7.0
BRICK20 = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2),
           (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
           (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
QUAD8 = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0)]
CORNERS = {"C3D20": BRICK20, "C3D20R": BRICK20, "C3D8I": BRICK20[:8], "C3D8": BRICK20[:8],
           "C3D8R": BRICK20[:8], "CPE8": QUAD8, "CPE8R": QUAD8, "CPE4": QUAD8[:4]}


def top_weights(kind):
    """Consistent weights of a uniform load on the top face: offset on the face -> share."""
    if kind.startswith("C3D20"):
        return {(i, k): (-1 / 12 if i != 1 and k != 1 else 1 / 3)
                for i in range(3) for k in range(3) if (i, k) != (1, 1)}
    if kind.startswith("C3D8"):
        return {(i, k): 0.25 for i in (0, 2) for k in (0, 2)}
    if kind.startswith("CPE8"):
        return {(0, 0): 1 / 6, (1, 0): 2 / 3, (2, 0): 1 / 6}
    return {(0, 0): 0.5, (2, 0): 0.5}


def write_lines(out, ids, per_line=12):
    ids = list(ids)
    for start in range(0, len(ids), per_line):
        out.write(", ".join(str(i) for i in ids[start:start + per_line]) + ",\n")


def write_deck(args):
    nx, ny, kind = args.nx, args.ny, args.type
    solid = kind.startswith("C3D")
    thick = HEIGHT / ny if solid else 1.0
    ids, elements = {}, []
    for i in range(nx):
        for j in range(ny):
            elements.append([ids.setdefault((2 * i + a, 2 * j + b, c), len(ids) + 1)
                             for a, b, c in CORNERS[kind]])
    force = {}
    for i in range(nx):
        for (a, c), weight in top_weights(kind).items():
            node = ids[(2 * i + a, 2 * ny, c)]
            force[node] = force.get(node, 0.0) + weight * LOAD * thick * LENGTH / nx
    plastic_columns = round(nx * ELASTIC_FROM / LENGTH)
    with open(args.out, "w", encoding="ascii") as out:
        out.write(f"** Symmetric plate, {nx} x {ny} {kind}, {args.law}, time step {args.dt:g} s\n*NODE, NSET=ALL\n")
        for (i, j, k), node in ids.items():
            out.write(f"{node}, {i*LENGTH/(2*nx):.9g}, {j*HEIGHT/(2*ny):.9g}, {k*thick/2:.9g}\n")
        for name, first, last in (("BODY", 0, plastic_columns * ny), ("TIP", plastic_columns * ny, nx * ny)):
            out.write(f"*ELEMENT, TYPE={kind}, ELSET={name}\n")
            for number in range(first, last):
                line = [number + 1] + elements[number]
                if len(line) > 16:
                    out.write(", ".join(map(str, line[:16])) + ",\n" + ", ".join(map(str, line[16:])) + "\n")
                else:
                    out.write(", ".join(map(str, line)) + "\n")
        for name, test in (("SYMMETRY", lambda i, j: i == 0), ("PIN", lambda i, j: i == 2 * nx and j == ny),
                           ("MID", lambda i, j: i == 0 and j == ny)):
            out.write(f"*NSET, NSET={name}\n")
            write_lines(out, [n for (i, j, k), n in ids.items() if test(i, j)])
        for name in ("BODY", "TIP"):
            out.write(f"*MATERIAL, NAME={name}\n*ELASTIC\n1.e9, 0.3\n*DENSITY\n1000.\n")
            if args.law == "neohooke":
                out.write("*PLASTIC\n1.e15, 0.\n")
            elif args.law == "elastoplastic":
                out.write("*PLASTIC\n1.e7, 0.\n" if name == "BODY" else "*PLASTIC\n1.e15, 0.\n")
            out.write(f"*SOLID SECTION, ELSET={name}, MATERIAL={name}\n")
            out.write("1.\n" if not solid else "")
        out.write("*AMPLITUDE, NAME=ON\n0., 1., 10., 1.\n")
        out.write("*BOUNDARY\nSYMMETRY, 1, 1\nPIN, 1, 2\n" + ("ALL, 3, 3\n" if solid else ""))
        out.write(f"*STEP, NLGEOM, INC=100000\n*DYNAMIC, DIRECT, ALPHA={args.alpha:g}\n{args.dt:.6g}, {args.end:.6g}\n")
        out.write("*CLOAD, AMPLITUDE=ON\n")
        for node, value in force.items():
            out.write(f"{node}, 2, {value:.12g}\n")
        out.write("*NODE PRINT, NSET=MID\nU\n*END STEP\n")


def read_history(name):
    """Time and u_y averaged over the printed nodes from a CalculiX .dat file."""
    times, values, current = [], [], []
    with open(name, encoding="ascii") as lines:
        for line in lines:
            if "displacements" in line:
                if current:
                    values.append(np.mean(current))
                times.append(float(line.split()[-1]))
                current = []
            elif line.strip():
                current.append(float(line.split()[2]))
    values.append(np.mean(current))
    return np.array([0.0] + times), np.array([0.0] + values)


def write_csv(args):
    time, value = read_history(args.dat)
    grid = np.arange(round(time[-1] / args.step) + 1) * args.step
    with open(args.out, "w", encoding="ascii") as out:
        out.write("time,uy\n")
        for t, u in zip(grid, np.interp(grid, time, value)):
            out.write(f"{t:.4f},{u:.6e}\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    deck = commands.add_parser("deck")
    deck.add_argument("nx", type=int)
    deck.add_argument("ny", type=int)
    deck.add_argument("law", choices=["svk", "neohooke", "elastoplastic"])
    deck.add_argument("dt", type=float)
    deck.add_argument("out")
    deck.add_argument("--type", choices=sorted(CORNERS), default="C3D20R")
    deck.add_argument("--alpha", type=float, default=-0.05)
    deck.add_argument("--end", type=float, default=0.6)
    deck.set_defaults(run=write_deck)
    table = commands.add_parser("csv")
    table.add_argument("dat")
    table.add_argument("out")
    table.add_argument("--step", type=float, default=1.0e-3)
    table.set_defaults(run=write_csv)
    args = parser.parse_args()
    args.run(args)


if __name__ == "__main__":
    main()
