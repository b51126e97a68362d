# SPDX-License-Identifier: MIT
"""Write a CalculiX deck of the symmetric plate (half model) and turn its results into a CSV.

  write_deck.py deck NX NY svk|neohooke|elastoplastic DT OUT.inp
                [--type C3D20R] [--alpha -0.05] [--end 0.6]
  write_deck.py csv JOB.dat OUT.csv [--step 1e-3]

`deck` writes OUT.inp and, beside it, the mesh mesh_NXxNY.inp that OUT.inp includes.
The plate is a layer of 3D elements one element thick with u_z = 0 on every node, which is plane
strain. 20-node and 8-node bricks and 8-node plane-strain quads (CPE8, CPE8R) are known.
"""
import argparse
import pathlib

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


def write_lines(out, numbers, per_line):
    """A list of numbers in lines; a comma at the end of a line continues it."""
    for start in range(0, len(numbers), per_line):
        last = start + per_line >= len(numbers)
        out.write(",".join(map(str, numbers[start:start + per_line])) + ("\n" if last else ",\n"))


def grid_mesh(nx, ny, kind):
    """Node numbers by half-cell index (i, j, k), and the node numbers of each element."""
    ids, elements = {}, []
    for i in range(nx):
        for j in range(ny):
            elements.append([ids.setdefault((2 * i + a, 2 * j + b, c), len(ids) + 1)
                             for a, b, c in CORNERS[kind]])
    return ids, elements


def write_mesh(args, ids, elements, thick, name):
    """Nodes, elements (sets BODY and TIP) and node sets."""
    nx, ny = args.nx, args.ny
    plastic = round(nx * ELASTIC_FROM / LENGTH) * ny
    with open(name, "w", encoding="ascii") as out:
        out.write(f"** Symmetric plate, {nx} x {ny} {args.type}\n*NODE,NSET=ALL\n")
        for (i, j, k), node in ids.items():
            out.write(f"{node},{i*LENGTH/(2*nx):.9g},{j*HEIGHT/(2*ny):.9g},{k*thick/2:.9g}\n")
        for group, first, last in (("BODY", 0, plastic), ("TIP", plastic, nx * ny)):
            out.write(f"*ELEMENT,TYPE={args.type},ELSET={group}\n")
            for number in range(first, last):
                write_lines(out, [number + 1] + elements[number], 15)
        for group, test in (("SYMMETRY", lambda i, j: i == 0),
                            ("PIN", lambda i, j: i == 2 * nx and j == ny),
                            ("MID", lambda i, j: i == 0 and j == ny)):
            out.write(f"*NSET,NSET={group}\n")
            write_lines(out, [n for (i, j, k), n in ids.items() if test(i, j)], 12)


def write_material(out, args, group, solid):
    out.write(f"*MATERIAL,NAME={group}\n*ELASTIC\n1.e9,0.3\n*DENSITY\n1000.\n")
    if args.law == "elastoplastic" and group == "BODY":
        out.write("*PLASTIC\n1.e7,0.\n")
    elif args.law != "svk":
        out.write("*PLASTIC\n1.e15,0.\n")      # finite-strain law that never yields
    out.write(f"*SOLID SECTION,ELSET={group},MATERIAL={group}\n")
    out.write("" if solid else "1.\n")


def write_deck(args):
    nx, ny, kind = args.nx, args.ny, args.type
    solid = kind.startswith("C3D")
    thick = HEIGHT / ny if solid else 1.0
    ids, elements = grid_mesh(nx, ny, kind)
    mesh = pathlib.Path(args.out).with_name(f"mesh_{nx}x{ny}.inp")
    write_mesh(args, ids, elements, thick, mesh)
    force = {}
    for i in range(nx):
        for (a, c), weight in top_weights(kind).items():
            node = ids[(2 * i + a, 2 * ny, c)]
            force[node] = force.get(node, 0.0) + weight * LOAD * thick * LENGTH / nx
    with open(args.out, "w", encoding="ascii") as out:
        out.write(f"** Symmetric plate, {args.law}, time step {args.dt:g} s\n")
        out.write(f"*INCLUDE,INPUT={mesh.name}\n")
        for group in ("BODY", "TIP"):
            write_material(out, args, group, solid)
        out.write("*AMPLITUDE,NAME=ON\n0.,1.,10.,1.\n")
        out.write("*BOUNDARY\nSYMMETRY,1,1\nPIN,1,2\n" + ("ALL,3,3\n" if solid else ""))
        out.write(f"*STEP,NLGEOM,INC=100000\n*DYNAMIC,DIRECT,ALPHA={args.alpha:g}\n")
        out.write(f"{args.dt:.6g},{args.end:.6g}\n")
        out.write("*CLOAD,AMPLITUDE=ON\n")
        for node, value in force.items():
            out.write(f"{node},2,{value:.12g}\n")
        out.write("*NODE PRINT,NSET=MID\nU\n*END STEP\n")


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
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
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
