# SPDX-License-Identifier: MIT
"""A deck on its mesh divided: each quad in n x n, each triangle in n^2, nodes of curved edges on their arcs, and all that
refers to nodes, elements and segments carried along.

The deck is the effective deck of a run. Conditions of nodes pass to a new node where all nodes of its edge, or of its
element, have them; nodal loads become those of the same line load; the step, where the deck gives one, and the compliance
of a penalty per length go down as the size of the elements.
"""
import itertools

import numpy as np

from slideline_tools import UserError
from slideline_tools.effective_deck import Block, read_blocks

#: largest turn between two segments of a curve (METHODS, arcs of contact surfaces)
SMOOTH = np.radians(16.0)
#: the same where two such turns that follow each other are alike to so much of them: facets of a circle
FACETS, ALIKE = np.radians(25.0), 0.1
#: ratio of curvatures below which an end is straight, and of turns below which a line meets the arc there
FLAT, TANGENT = 0.1, 0.75
#: keywords that a finer mesh leaves as they are, by their beginnings
UNCHANGED = ("KEYWORD", "TITLE", "END", "COMMENT", "CONTROL_", "DEFINE_", "DATABASE_", "PART", "SECTION_", "MAT_", "EOS_", "HOURGLASS",
             "DAMPING_", "INITIAL_VELOCITY", "SET_PART", "SET_2D_SEGMENT", "LOAD_BODY", "LOAD_SEGMENT_SET", "LOAD_RIGID_BODY",
             "BOUNDARY_PRESCRIBED_MOTION_SET", "BOUNDARY_PRESCRIBED_MOTION_RIGID", "BOUNDARY_SPC_", "CONTACT_2D_", "RIGIDWALL_PLANAR", "INTERFACE_SPRINGBACK",
             "TERMINATION_", "CONSTRAINED_NODE_SET", "ELEMENT_MASS")
#: keywords among these that a finer mesh would change
REFUSED = ("ELEMENT_MASS_NODE_SET", "DEFINE_COORDINATE_NODES")
#: contacts whose positive surfaces are node sets
OF_NODE_SETS = ("CONTACT_2D_PENALTY", "CONTACT_2D_SLIDING", "CONTACT_2D_TIED_SLIDING")


def whole(text: str) -> int:
    """A whole number of a field, 0 for a blank."""
    return int(float(text)) if text else 0


def real(text: str) -> float:
    """A number of a field, 0 for a blank."""
    return float(text.upper().replace("D", "E")) if text else 0.0


class Mesh:
    """Nodes and elements of a deck, and the new ones.

    `points`    node id -> (x, y)
    `elements`  (id, part, its three or four nodes counter-clockwise or not, as in the deck)
    `weights`   new node -> [(old node, weight)] of the linear interpolation
    """

    def __init__(self, blocks: list[Block]) -> None:
        self.points: dict[int, np.ndarray] = {}
        self.elements: list[tuple[int, int, list[int]]] = []
        for block in blocks:
            for card in block.cards(0, 8, 16, 16, 16) if block.keyword == "NODE" else ():
                number, x, y = (card + ["", ""])[:3]
                self.points[int(number)] = np.array([real(x), real(y)])
            for card in block.cards(0, *[8] * 10) if block.keyword == "ELEMENT_SHELL" else ():
                eid, pid, *nodes = map(whole, (card + [""] * 4)[:6])
                self.elements.append((eid, pid, list(dict.fromkeys(node for node in nodes if node))))
        if not self.elements:
            raise UserError("no *ELEMENT_SHELL to divide")
        if odd := next((one for one in self.elements if len(one[2]) not in (3, 4)), None):
            raise UserError(f"element {odd[0]} has {len(odd[2])} nodes; only quads and triangles are divided")
        #: edge -> elements (places in `elements`) on it
        self.sides: dict[frozenset, list[int]] = {}
        for place, (_, _, nodes) in enumerate(self.elements):
            for pair in itertools.pairwise([*nodes, nodes[0]]):
                self.sides.setdefault(frozenset(pair), []).append(place)
        self.outside = {node for edge, on in self.sides.items() if len(on) == 1 for node in edge}
        self.weights: dict[int, list[tuple[int, float]]] = {}
        self.between: dict[frozenset, tuple[int, list[int]]] = {}   # edge -> its first node, new nodes from there
        self.inside: list[list[int]] = []                           # new nodes of each element
        self.children: list[list[tuple[int, list[int]]]] = []       # (id, nodes) of each element

    def divide(self, count: int) -> None:
        """Divide all elements; a child in the middle keeps the id."""
        number = itertools.count(max(self.points) + 1)
        bulge = self.bulges()
        for edge in self.sides:
            a, b = sorted(edge)
            new = []
            for k in range(1, count):
                share = k / count
                new.append(self.add(next(number), {a: 1.0 - share, b: share}))
                self.points[new[-1]] = self.points[new[-1]] + bulge(a, b, share)
            self.between[edge] = a, new
        fresh = itertools.count(max(one[0] for one in self.elements) + 1)
        for eid, _, nodes in self.elements:
            grid, cells = (self.quad if len(nodes) == 4 else self.triangle)(nodes, count, number)
            self.inside.append([node for node in grid if node in self.weights and len(self.weights[node]) > 2])
            middle = len(cells) // 2 if count % 2 else (count // 2 - 1) * (count + 1) if len(nodes) == 4 else 0
            self.children.append([(eid if k == middle else next(fresh), cell) for k, cell in enumerate(cells)])

    def add(self, number: int, weights: dict[int, float]) -> int:
        """A new node by its weights."""
        self.weights[number] = [pair for pair in weights.items() if pair[1]]
        self.points[number] = sum(weight * self.points[node] for node, weight in self.weights[number])
        return number

    def new_between(self, edge: frozenset) -> list[int]:
        """The new nodes of an edge."""
        return self.between[edge][1]

    def along(self, a: int, b: int) -> list[int]:
        """The nodes from a to b of an edge, both ends too."""
        first, new = self.between[frozenset((a, b))]
        return [a, *(new if a == first else new[::-1]), b]

    def quad(self, nodes, n, number):
        """Nodes and cells of a quad: the inner nodes by its four edges (Coons)."""
        a, b, c, d = nodes
        low, right, high, left = self.along(a, b), self.along(b, c), self.along(d, c), self.along(a, d)
        grid = np.zeros((n + 1, n + 1), dtype=int)
        grid[:, 0], grid[:, n], grid[0], grid[n] = low, high, left, right
        for i, j in itertools.product(range(1, n), range(1, n)):
            u, v = i / n, j / n
            grid[i, j] = self.add(next(number), {a: (1 - u) * (1 - v), b: u * (1 - v), c: u * v, d: (1 - u) * v})
            edges = ((1 - v) * self.points[low[i]] + v * self.points[high[i]] + (1 - u) * self.points[left[j]]
                     + u * self.points[right[j]])
            self.points[grid[i, j]] = edges - self.points[grid[i, j]]
        cells = [[int(grid[k]) for k in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
                 for i, j in itertools.product(range(n), range(n))]
        return grid.ravel().tolist(), cells

    def triangle(self, nodes, n, number):
        """Nodes and cells of a triangle."""
        a, b, c = nodes
        grid = {(i, 0): node for i, node in enumerate(self.along(a, b))}
        grid |= {(0, j): node for j, node in enumerate(self.along(a, c))}
        grid |= {(n - j, j): node for j, node in enumerate(self.along(b, c))}
        for i, j in itertools.product(range(1, n), range(1, n)):
            if i + j < n:
                grid[i, j] = self.add(next(number), {a: (n - i - j) / n, b: i / n, c: j / n})
        upright = [[grid[i, j], grid[i + 1, j], grid[i, j + 1]] for i in range(n) for j in range(n - i)]
        turned = [[grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1]] for i in range(n - 1) for j in range(n - 1 - i)]
        return list(grid.values()), upright + turned

    # ---- curved edges ------------------------------------------------------------------------

    def bulges(self):
        """A function of an edge and a share of it: how far the arc of an exterior edge stands off its chord there, (x, y)."""
        after, before = {}, {}
        for edge, on in self.sides.items():
            if len(on) == 1:
                nodes = self.elements[on[0]][2]
                x = np.array([self.points[node] for node in nodes])
                area = np.sum(x[:, 0] * np.roll(x[:, 1], -1) - np.roll(x[:, 0], -1) * x[:, 1])
                a, b = next(pair for pair in itertools.pairwise([*nodes, nodes[0]]) if frozenset(pair) == edge)
                a, b = (a, b) if area > 0.0 else (b, a)
                # Two boundaries that meet in a node have no arc there.
                after[a], before[b] = (None if a in after else b), (None if b in before else a)
        turns, curvatures = {}, {}
        for node, following in after.items():
            if (previous := before.get(node)) is None or following is None:
                continue
            p, q = self.points[node] - self.points[previous], self.points[following] - self.points[node]
            cross, lengths = p[0] * q[1] - p[1] * q[0], np.linalg.norm(p) * np.linalg.norm(q)
            turns[node] = np.arctan2(cross, p @ q)
            curvatures[node] = 2.0 * cross / (lengths * np.linalg.norm(p + q)) if abs(turns[node]) < np.pi - 1e-6 else 0.0

        def is_smooth(node):
            turn = turns.get(node, np.pi)
            return abs(turn) <= SMOOTH or abs(turn) <= FACETS and any(abs(turns.get(other, np.pi) - turn) < ALIKE * abs(turn)
                                                                     for other in (before[node], after[node]))

        def curvature(a, b):
            ends = [curvatures[node] for node in (a, b) if is_smooth(node)]
            if not ends or min(ends) * max(ends) < 0.0 or min(map(abs, ends)) < FLAT * max(map(abs, ends)):
                return 0.0
            if all(node in turns for node in (before.get(a), after.get(b))):  # a line between two arcs
                beyond = (turns[before[a]], turns[after[b]])
                if all(abs(turns[node]) < TANGENT * abs(turn) <= TANGENT * SMOOTH for node, turn in zip((a, b), beyond)):
                    return 0.0
            weak = min(map(abs, ends)) < TANGENT * max(map(abs, ends))    # a line meets the arc at one end
            return max(ends, key=abs) if weak else float(np.mean(ends))

        def bulge(a, b, share):
            if len(self.sides[frozenset((a, b))]) > 1:
                return 0.0
            if after.get(a) != b:
                a, b, share = b, a, 1.0 - share
            if after.get(a) != b or not (kappa := curvature(a, b)):
                return 0.0
            chord = self.points[b] - self.points[a]
            bent = kappa * np.linalg.norm(chord)
            height = kappa * share * (1.0 - share) / (np.sqrt(1.0 - (bent * (share - 0.5)) ** 2) + np.sqrt(1.0 - 0.25 * bent ** 2))
            return height * np.linalg.norm(chord) * np.array([chord[1], -chord[0]])
        return bulge

    # ---- what nodes have ---------------------------------------------------------------------

    def new_in(self, nodes) -> list[int]:
        """The new nodes that belong to a set of old ones: on edges and in elements all of whose nodes are in it, but not
        through a body from one of its sides to another."""
        held, found = set(nodes), []
        full = [held.issuperset(one[2]) for one in self.elements]
        for edge, on in self.sides.items():
            if held >= edge and (len(on) == 1 or any(full[k] for k in on) or not edge <= self.outside):
                found += self.new_between(edge)
        return found + [node for k, new in enumerate(self.inside) if full[k] for node in new]

    def walked(self, nodes: list[int], ordered: bool) -> list[int]:
        """A set of nodes with the new ones: between neighbours in the list, then, unless the order counts, all others."""
        found = list(nodes[:1])
        for a, b in itertools.pairwise(nodes):
            found += (self.along(a, b) if frozenset((a, b)) in self.between else [a, b])[1:]
        there = set(found)
        return found if ordered else found + [node for node in self.new_in(nodes) if node not in there]

    def line_loads(self, loads: dict[int, float], axisymmetric: bool) -> dict[int, float]:
        """Nodal loads of the line load that those of old nodes stand for; loads of single nodes as they are."""
        lines = [tuple(edge) for edge, on in self.sides.items() if len(on) == 1 and loads.keys() >= edge]

        def tributary(pairs):
            sums: dict[int, float] = {}
            for a, b in pairs:
                x = self.points[a][0], self.points[b][0]
                length = np.linalg.norm(self.points[b] - self.points[a])
                for node, near, far in ((a, *x), (b, *x[::-1])):
                    sums[node] = sums.get(node, 0.0) + length * ((2.0 * near + far) / 6.0 if axisymmetric else 0.5)
            return sums
        coarse = tributary(lines)
        density = {node: loads[node] / size for node, size in coarse.items() if size > 0.0}
        fine = tributary(pair for a, b in lines for pair in itertools.pairwise(self.along(a, b)))
        spread = {node: size * sum(weight * density.get(old, 0.0) for old, weight in self.weights.get(node, [(node, 1.0)]))
                  for node, size in fine.items()}
        return {**{node: load for node, load in loads.items() if node not in density}, **spread}


# ---- the deck --------------------------------------------------------------------------------

def node_sets(model) -> dict[int, list[int]]:
    """The nodes of the node sets of a `draw.model.Model`, in their order, as the program has them."""
    return {one.id: model.node_ids[one.nodes].tolist() for one in model.node_sets.values()}


def divided(text: str, sets: dict[int, list[int]], count: int) -> str:
    """The effective deck `text` on its mesh divided by `count`; `sets`: the nodes of its node sets as the program has
    them. UserError where something in it cannot be carried along."""
    blocks = read_blocks(text)
    check_known(blocks)
    mesh = Mesh(blocks)
    mesh.divide(count)
    return deck_of(blocks, Division(blocks, mesh, sets, count))


def check_known(blocks: list[Block], *others: str) -> None:
    """UserError where a keyword, but for these others, cannot be carried along."""
    for block in blocks:
        known = block.keyword.startswith(UNCHANGED) or block.keyword in (*HANDLED, *others) or block.keyword.startswith("SET_NODE")
        if not known or block.keyword.startswith(REFUSED):
            raise UserError(f"a mesh with *{block.keyword} cannot be divided")


class Division:
    """The blocks of a deck for a divided mesh."""

    def __init__(self, blocks, mesh: Mesh, sets: dict[int, list[int]], count: int) -> None:
        self.mesh, self.sets, self.count, self.blocks = mesh, sets, count, blocks
        self.axisymmetric = any("15" in block.fields(int(block.is_titled))[1:2] for block in blocks
                                if block.keyword.startswith("SECTION_SHELL"))
        self.ordered = {abs(number) for block in blocks if block.keyword.startswith("CONTACT_")
                        for number in map(whole, block.fields(int(block.is_titled))[:2])
                        if number < 0 or block.keyword.startswith(OF_NODE_SETS)}
        self.whole_sets = {sid: mesh.walked(nodes, sid in self.ordered) for sid, nodes in sets.items()}
        self.written = False
        self.loads: dict[tuple, dict[int, float]] = {}

    def block(self, block: Block) -> list[str]:
        """The lines of a block."""
        name = block.keyword
        if name.startswith("SET_NODE"):
            sid = block.number(int(block.is_titled))
            if sid not in self.sets:
                raise UserError(f"*{name} {sid} cannot be divided: the program has no such set")
            title = block.lines[:1] if block.is_titled else []
            nodes = self.whole_sets[sid]
            return [f"*SET_NODE_LIST{'_TITLE' * len(title)}", *title, f"{sid},", *rows_of(nodes)]
        handler = HANDLED.get(name)
        if name.startswith("CONTACT_2D_SLIDELINE"):
            handler = Division.penalty
        return handler(self, block) if handler else [block.head, *block.lines]

    def node(self, block):
        """Old nodes as they are, the new ones with the last digits."""
        new = [] if self.written else [f"{node},{float(x)!r},{float(y)!r}" for node in self.mesh.weights
                                       for x, y in (self.mesh.points[node],)]
        self.written = True
        return [block.head, *block.lines, *new]

    def elements(self, block):
        """The children of all elements, with the first block."""
        if block is not next(one for one in self.blocks if one.keyword == "ELEMENT_SHELL"):
            return []
        return [block.head, *(f"{eid},{pid},{','.join(map(str, (*cell, cell[-1])[:4]))}" for (_, pid, _), children in zip(
            self.mesh.elements, self.mesh.children) for eid, cell in children)]

    def segments(self, block):
        """Edges of a segment set, of *SET_SEGMENT or lines SEG of _GENERAL."""
        head, general = int(block.is_titled) + 1, "GENERAL" in block.keyword
        lines = []
        for card in block.cards(head):
            pieces = self.pieces(*map(whole, card[general:general + 2])) if not general or card[0] == "SEG" else None
            lines += [",".join(card)] if pieces is None else [("SEG," if general else "") + f"{a},{b}" for a, b in pieces]
        return [block.head, *block.lines[:head], *lines]

    def pieces(self, a, b):
        """The pieces of an edge."""
        if frozenset((a, b)) not in self.mesh.sides:
            raise UserError(f"no element has the edge {a}, {b}")
        return itertools.pairwise(self.mesh.along(a, b))

    def pressures(self, block):
        """*LOAD_SEGMENT on all pieces."""
        return [block.head, *(",".join([*card[:3], str(a), str(b)]) for card in block.cards() for a, b in self.pieces(*map(whole, card[3:5])))]

    def gather_loads(self, block):
        """Nodal loads, which `further` writes."""
        for number, *fields in (card + [""] * 4 for card in block.cards()):
            on = self.sets[whole(number)] if block.keyword == "LOAD_NODE_SET" else [whole(number)]
            loads = self.loads.setdefault((fields[0], fields[1], *fields[3:7]), {})
            for node in on:
                loads[node] = loads.get(node, 0.0) + (real(fields[2]) or 1.0)
        return []

    def prescribed(self, block):
        """*BOUNDARY_..._NODE: a row for each new node whose neighbours have the same."""
        alike: dict[tuple, list[int]] = {}
        for number, *fields in block.cards():
            alike.setdefault(tuple(fields), []).append(whole(number))
        return [block.head, *block.lines, *(",".join([str(node), *fields]) for fields, nodes in alike.items()
                                            for node in self.mesh.new_in(nodes))]

    def nodal_velocities(self, block):
        """*INITIAL_VELOCITY_NODE, interpolated."""
        given = {whole(card[0]): [real(text) for text in (card + [""] * 2)[1:3]] for card in block.cards()}
        return [block.head, *block.lines, *(f"{node},{vx!r},{vy!r}" for node in self.mesh.new_in(given) for vx, vy in [
            [float(sum(weight * given[old][k] for old, weight in self.mesh.weights[node])) for k in (0, 1)]])]

    def shells(self, block):
        """Sets of elements with all children."""
        head = int(block.is_titled) + 1
        numbers = [whole(text) for card in block.cards(head) for text in card if text]
        if "GENERATE" in block.keyword:
            spans = list(zip(numbers[::2], numbers[1::2]))
            numbers = [one[0] for one in self.mesh.elements if any(a <= one[0] <= b for a, b in spans)]
        wanted = set(numbers)
        children = [eid for (old, _, _), some in zip(self.mesh.elements, self.mesh.children) if old in wanted for eid, _ in some]
        return [block.head.replace("_GENERATE", ""), *block.lines[:head], *rows_of(children)]

    def penalty(self, block):
        """A penalty per length (PUNIT 1) grows as the elements shrink, as those of the other units do by themselves."""
        first = int(block.is_titled)
        card, second = block.fields(first), block.fields(first + 1)
        lines = list(block.lines)
        if len(second) > 2 and whole(second[2]) == 1:
            lines[first] = self.scaled(card, 4)
            lines[first + 1] = self.scaled(second, 3)
        return [block.head, *lines]

    def scaled(self, fields, place, factor=None):
        """A card with one of its numbers times `factor` (the count)."""
        if len(fields) > place and real(fields[place]) != 0.0:
            fields[place] = repr(real(fields[place]) * (factor or self.count))
        return ",".join(fields) if len(fields) > 1 else f"{fields[0]},"

    def step(self, block):
        """*CONTROL_TIMESTEP: steps that the deck gives, as curve too, divided."""
        fields = block.fields(0)
        for place in (0, 4):
            self.scaled(fields, place, 1.0 / self.count)
        if len(fields) > 5 and whole(fields[5]):
            fields[5] = str(self.divided_curve(whole(fields[5])))
        return [block.head, ",".join(fields).rstrip(",") + ",", *block.lines[1:]]

    def divided_curve(self, number):
        """A copy of a curve with its ordinates over the count; its number."""
        curves = [block for block in self.blocks if block.keyword.startswith(("DEFINE_CURVE", "DEFINE_TABLE"))]
        fresh = max(block.number(int(block.is_titled)) for block in curves) + 1
        block = next((one for one in curves if one.number(int(one.is_titled)) == number
                      and one.keyword in ("DEFINE_CURVE", "DEFINE_CURVE_TITLE")), None)
        if block is None:
            raise UserError(f"the step by curve {number} cannot be divided: only *DEFINE_CURVE")
        first = int(block.is_titled)
        fields = (block.fields(first) + [""] * 4)[:6]
        fields[0], fields[3] = str(fresh), repr((real(fields[3]) or 1.0) / self.count)
        self.curve = [block.head, *block.lines[:first], ",".join(fields), *block.lines[first + 1:]]
        return fresh

    def implicit_step(self, block):
        """*CONTROL_IMPLICIT_GENERAL: its step divided in dynamics; load steps of statics are the deck's."""
        dynamic = any(whole((one.fields(0) or [""])[0]) == 1 for one in self.blocks if one.keyword == "CONTROL_IMPLICIT_DYNAMICS")
        if not dynamic:
            return [block.head, *block.lines]
        return [block.head, self.scaled(block.fields(0), 1, 1.0 / self.count), *block.lines[1:]]

    def further(self) -> list[str]:
        """What stands behind all blocks: loads, supports between nodes of different cards, the curve of the step."""
        lines = getattr(self, "curve", [])
        if self.loads:
            lines = [*lines, "*LOAD_NODE_POINT"]
            for (direction, curve, *more), loads in self.loads.items():
                lines += [",".join([str(node), direction, curve, repr(float(load)), *more])
                          for node, load in self.mesh.line_loads(loads, self.axisymmetric).items() if load]
        held: dict[tuple, set[int]] = {}
        there: dict[tuple, set[int]] = {}
        for block in self.blocks:
            if block.keyword not in ("BOUNDARY_SPC_NODE", "BOUNDARY_SPC_SET"):
                continue
            for card in block.cards():
                number, system, *free = map(whole, (card + [""] * 4)[:4])
                of_set = block.keyword.endswith("SET")
                for k in (0, 1):
                    if free[k]:
                        held.setdefault((system, k), set()).update(self.sets[number] if of_set else [number])
                        there.setdefault((system, k), set()).update(self.whole_sets[number] if of_set else [number])
        rows = [f"{node},{system},{int(k == 0)},{int(k == 1)}" for (system, k), nodes in held.items()
                for node in self.mesh.new_in(nodes) if node not in there[system, k]]
        return [*lines, *(["*BOUNDARY_SPC_NODE", *rows] if rows else [])]


def deck_of(blocks: list[Block], deck: Division) -> str:
    """The text of the deck."""
    lines = []
    for block in blocks:
        if block.keyword == "END":
            break
        lines += deck.block(block)
    return "\n".join([*lines, *deck.further(), "*END"]) + "\n"


def rows_of(numbers) -> list[str]:
    """Numbers, eight a line."""
    return [",".join(map(str, numbers[k:k + 8])) + "," for k in range(0, len(numbers), 8)]


#: keyword -> what writes its block
HANDLED = {"NODE": Division.node, "ELEMENT_SHELL": Division.elements, "LOAD_SEGMENT": Division.pressures,
           **dict.fromkeys(("SET_SEGMENT", "SET_SEGMENT_TITLE", "SET_SEGMENT_GENERAL", "SET_SEGMENT_GENERAL_TITLE"), Division.segments),
           **dict.fromkeys(("LOAD_NODE_POINT", "LOAD_NODE_SET"), Division.gather_loads),
           "BOUNDARY_PRESCRIBED_MOTION_NODE": Division.prescribed,
           "INITIAL_VELOCITY_NODE": Division.nodal_velocities,
           **dict.fromkeys((f"SET_SHELL_LIST{generate}{title}" for generate in ("", "_GENERATE") for title in ("", "_TITLE")), Division.shells),
           "CONTROL_TIMESTEP": Division.step, "CONTROL_IMPLICIT_GENERAL": Division.implicit_step}
