# SPDX-License-Identifier: MIT
"""Small meshes and decks for the verification cases.

Cards are written in comma form, so that numbers keep all their digits.
"""
import numpy as np

STEP_CURVE = 9001


def field(value):
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    return repr(float(value))


def card(values):
    """One comma card; a single field keeps a trailing comma, which marks the form."""
    line = ",".join(field(value) for value in values)
    return line if "," in line else line + ","


class Deck:
    """Text of a keyword deck, put together card by card."""

    def __init__(self, title):
        self.lines = ["*KEYWORD", "*TITLE", title]
        self.n_node = 0
        self.n_element = 0

    def add(self, keyword, *cards):
        """A keyword with its cards: sequences become comma cards, strings stay."""
        self.lines.append(keyword)
        self.lines += [entry if isinstance(entry, str) else card(entry) for entry in cards]
        return self

    def mesh(self, coordinates, quads, part=1):
        """Nodes and quads (0-based connectivity); returns the user ids of the nodes."""
        ids = np.arange(len(coordinates)) + self.n_node + 1
        self.add("*NODE", *[(i, x, y) for i, (x, y) in zip(ids.tolist(), coordinates)])
        first = self.n_element + 1
        self.add("*ELEMENT_SHELL", *[(first + k, part, *(ids[list(quad)].tolist()))
                                     for k, quad in enumerate(quads)])
        self.n_node += len(coordinates)
        self.n_element += len(quads)
        return ids

    def part(self, part=1, material=None, section=None, hourglass=0, points=None):
        """points: NIP of the section (4: full integration)."""
        self.add("*PART", f"part {part}",
                 (part, section or 1, material or part, 0, hourglass))
        if section is None and "*SECTION_SHELL" not in self.lines:
            self.add("*SECTION_SHELL", (1, 13, None, points), (1.0,))
        return self

    def elastic(self, rho, young, poisson, material=1):
        return self.add("*MAT_ELASTIC", (material, rho, young, poisson))

    def plastic(self, rho, young, poisson, yield_stress, tangent=0.0, beta=1.0, material=1):
        return self.add("*MAT_PLASTIC_KINEMATIC",
                        (material, rho, young, poisson, yield_stress, tangent, beta),
                        (0.0, 0.0, 0.0, 0.0))

    def curve(self, number, points):
        return self.add("*DEFINE_CURVE", (number,), *[(a, o) for a, o in points])

    def control(self, end_time, dt=None, scale=0.9):
        """End time and step: a constant step if dt is given."""
        self.add("*CONTROL_TERMINATION", (end_time,))
        if dt is None:
            return self.add("*CONTROL_TIMESTEP", (0.0, scale))
        self.add("*CONTROL_TIMESTEP", (0.0, scale, 0, 0.0, 0.0, STEP_CURVE))
        return self.curve(STEP_CURVE, [(0.0, dt), (1.0e6, dt)])

    def hourglass(self, form, coefficient):
        return self.add("*CONTROL_HOURGLASS", (form, coefficient))

    def output(self, plot=None, glstat=None, matsum=None, rcforc=None, nodout=None, nodes=()):
        if plot is not None:
            self.add("*DATABASE_BINARY_D3PLOT", (plot,))
        for name, interval in (("GLSTAT", glstat), ("MATSUM", matsum), ("RCFORC", rcforc),
                               ("NODOUT", nodout)):
            if interval is not None:
                self.add(f"*DATABASE_{name}", (interval,))
        nodes = list(nodes)
        if nodes:
            self.add("*DATABASE_HISTORY_NODE",
                     *[nodes[k:k + 8] for k in range(0, len(nodes), 8)])
        return self

    def node_set(self, number, nodes):
        nodes = [int(node) for node in nodes]
        return self.add("*SET_NODE_LIST", (number,),
                        *[nodes[k:k + 8] for k in range(0, len(nodes), 8)])

    def fix(self, nodes, x=0, y=0):
        return self.add("*BOUNDARY_SPC_NODE", *[(int(node), 0, x, y) for node in nodes])

    def prescribe(self, node, dof, kind, curve, factor=1.0):
        """kind: 0 velocity, 1 acceleration, 2 displacement; a factor of 0 becomes a fixity,
        since a blank or zero factor reads as 1."""
        if factor == 0.0:
            return self.fix([node], x=int(dof == 1), y=int(dof == 2))
        return self.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", (int(node), dof, kind, curve, factor))

    def hang(self, ids, hanging):
        """Hanging nodes as rows of indices (node, its two parents)."""
        return self.add("*CONSTRAINED_ADAPTIVITY", *[tuple(int(ids[node]) for node in row) for row in hanging])

    def contact(self, slave, master, kind, penalty, unit=0, gauss=2):
        """Our contact card between two node sets given by number."""
        return self.add("*CONTACT_2D_SLIDELINE", (-slave, -master, kind, gauss, penalty),
                        (0.0, 1.0e20, unit))

    def text(self):
        return "\n".join([*self.lines, "*END", ""])


def grid(n_x, n_y, width=1.0, height=1.0, origin=(0.0, 0.0)):
    """Structured block: coordinates ((n_x+1)(n_y+1), 2), row by row from the bottom, and quads."""
    x = origin[0] + width * np.arange(n_x + 1) / n_x
    y = origin[1] + height * np.arange(n_y + 1) / n_y
    coordinates = np.array([(a, b) for b in y for a in x])
    return coordinates, grid_quads(n_x, n_y)


def grid_quads(n_x, n_y):
    row = n_x + 1
    return [(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i)
            for j in range(n_y) for i in range(n_x)]


def divide(coordinates, quads, marked):
    """The marked quads in four; nodes in the middle of edges of others hang: (node, its two parents)."""
    points, result, middles = [*np.asarray(coordinates)], [], {}

    def middle(a, b):
        if (key := (min(a, b), max(a, b))) not in middles:
            middles[key] = len(points)
            points.append(0.5 * (points[a] + points[b]))
        return middles[key]

    for k, quad in enumerate(quads):
        if k not in marked:
            continue
        centre = len(points)
        points.append(np.mean([points[node] for node in quad], axis=0))
        sides = [middle(a, b) for a, b in zip(quad, np.roll(quad, -1))]
        result += [(quad[i], sides[i], centre, sides[i - 1]) for i in range(4)]
    kept = [tuple(quad) for k, quad in enumerate(quads) if k not in marked]
    edges = {(min(a, b), max(a, b)) for quad in kept for a, b in zip(quad, np.roll(quad, -1))}
    return np.array(points), kept + result, [(node, *key) for key, node in middles.items() if key in edges]


def distorted_patch():
    """Unit square of 2 x 2 quads with every side node and the middle node moved; node 4 is inside."""
    coordinates = np.array([(0.0, 0.0), (0.45, 0.0), (1.0, 0.0),
                            (0.0, 0.6), (0.57, 0.44), (1.0, 0.52),
                            (0.0, 1.0), (0.4, 1.0), (1.0, 1.0)])
    return coordinates, grid_quads(2, 2)


def polygon(rng, radius):
    """Corners of a convex polygon about the origin, counter-clockwise."""
    n = int(rng.integers(3, 9))
    angles = np.sort(2.0 * np.pi * (np.arange(n) + 0.6 * rng.random(n)) / n)
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def polygon_quads(corners, n):
    """Each corner with the halves of its sides and the centre is a quad of n x n elements."""
    centre, points, quads, known = corners.mean(axis=0), [], [], {}

    def place(point):
        key = tuple(np.round(point, 12))
        if key not in known:
            known[key] = len(points)
            points.append(point)
        return known[key]

    for k, corner in enumerate(corners):
        before, after = 0.5 * (corners[k - 1] + corner), 0.5 * (corner + corners[(k + 1) % len(corners)])
        block = np.empty((n + 1, n + 1), dtype=int)
        for i in range(n + 1):
            for j in range(n + 1):
                a, b = i / n, j / n
                block[i, j] = place((1 - a) * (1 - b) * centre + a * (1 - b) * before + a * b * corner
                                    + (1 - a) * b * after)
        quads += [(block[i, j], block[i + 1, j], block[i + 1, j + 1], block[i, j + 1])
                  for i in range(n) for j in range(n)]
    return np.array(points), quads


def rotate(coordinates, angle, centre=(0.0, 0.0)):
    """Turn coordinates counter-clockwise."""
    c, s = np.cos(angle), np.sin(angle)
    return (coordinates - centre) @ np.array([[c, s], [-s, c]]) + centre


def quad_areas(coordinates, quads):
    """Areas from the diagonals."""
    corner = np.asarray(coordinates)[np.asarray(quads)]
    p, q = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    return 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])


def lumped_mass(coordinates, quads, rho):
    """A quarter of each element's mass at each of its nodes."""
    mass = np.zeros(len(coordinates))
    share = rho * quad_areas(coordinates, quads) / 4.0
    for corner in range(4):
        np.add.at(mass, np.asarray(quads)[:, corner], share)
    return mass


def angular_momentum(mass, position, velocity):
    """About the origin, for (state, node, component) arrays or one state of them."""
    return np.sum(mass * (position[..., 0] * velocity[..., 1]
                          - position[..., 1] * velocity[..., 0]), axis=-1)


def moduli(young, poisson):
    """Bulk modulus, shear modulus and the modulus of uniaxial strain."""
    bulk = young / (3.0 * (1.0 - 2.0 * poisson))
    shear = young / (2.0 * (1.0 + poisson))
    return bulk, shear, bulk + 4.0 * shear / 3.0


def trapezoid(values, times):
    """Integral of a history by the trapezoidal rule."""
    return float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(times)))
