# SPDX-License-Identifier: MIT
"""Keyword decks in LS-DYNA fixed format, and structured quadrilateral meshes.

A deck is text: `Deck` puts keywords, cards and comments together and writes above each
card the names of its fields. Numbers are cut to the width of their field, never beyond.
"""
import functools
import textwrap

import numpy as np

WIDTH = 10
LINE_LENGTH = 80


def field(value, width=WIDTH):
    """A number, text or None (blank) right-aligned in `width` columns.

    Reals get as many digits as fit while one blank column stays in front.
    """
    if value is None:
        return " " * width
    if isinstance(value, str):
        text = value
    elif isinstance(value, (int, np.integer)):
        text = str(int(value))
    else:
        text = real(float(value), width - 1)
    if len(text) > width:
        raise ValueError(f"'{text}' does not fit in a field of {width} columns")
    return text.rjust(width)


@functools.lru_cache(1 << 16)  # the lines of a grid have few coordinates
def real(value, width):
    """Text of a real with all its digits, or with the most digits that fit."""
    if value == 0.0:
        return "0.0"
    for digits in range(min(17, width), 0, -1):
        fitting = [text for text in _spellings(value, digits) if len(text) <= width]
        if fitting:
            return fitting[0]
    raise ValueError(f"{value!r} does not fit in {width} columns")


def _spellings(value, digits):
    """Positional and exponential text of at most so many digits, the better one first."""
    plain = np.format_float_positional(value, precision=digits, fractional=False, trim="0")
    power = np.format_float_scientific(value, precision=digits - 1, trim="0", exp_digits=1)
    power = power.replace("e+", "E").replace("e", "E")
    return [plain, power] if len(plain) <= len(power) + 2 else [power, plain]


class Deck:
    """Text of a deck, written from top to bottom."""

    def __init__(self, title, about=()):
        """`about`: paragraphs that explain the deck to its reader, above *KEYWORD."""
        if len(title) > LINE_LENGTH:
            raise ValueError("a title has at most 80 characters")
        self.lines = []
        self.comment(*about)
        self.keyword("KEYWORD")
        self.keyword("TITLE")
        self.lines.append(title)

    def comment(self, *paragraphs):
        """Comment lines; a paragraph longer than a line is wrapped, an empty one is a bare `$`."""
        for paragraph in paragraphs:
            for text in textwrap.wrap(paragraph, LINE_LENGTH - 2) or [""]:
                self.lines.append(f"$ {text}".rstrip())
        return self

    def block(self, *paragraphs):
        """A new block of the deck, set off by a line and explained."""
        self.lines.append("$" + "-" * (LINE_LENGTH - 1))
        return self.comment(*paragraphs)

    def keyword(self, name, heading=None):
        """A keyword line; `heading` is the text line that _TITLE keywords and parts carry."""
        self.lines.append("*" + name)
        if heading is not None:
            self.lines.append(heading)
        return self

    def names(self, names, widths):
        """The comment line that names the fields below it."""
        line = "".join(name.rjust(width) for name, width in zip(names, widths))
        self.lines.append("$#" + line[2:])
        return self

    def card(self, names, *values):
        """One card of ten-column fields, under a line with the field names."""
        names = names.split()
        self.names(names, [WIDTH] * len(names))
        return self.row(values, [WIDTH] * len(names))

    def row(self, values, widths):
        """One card without field names."""
        if len(values) > len(widths):
            raise ValueError(f"{len(values)} values for {len(widths)} fields")
        self.lines.append("".join(field(value, width) for value, width in zip(values, widths)).rstrip())
        return self

    def table(self, names, widths, rows):
        """Cards of one layout under one line of field names."""
        self.names(names.split(), widths)
        for row in rows:
            self.row(row, widths)
        return self

    def parameters(self, *entries):
        """*PARAMETER, one per line; an entry is (name, value, explanation).

        A real with more digits than fit its field is written in comma form.
        """
        self.keyword("PARAMETER")
        self.names(["name", "value"], [WIDTH, WIDTH])
        for name, value, explanation in entries:
            kind = "I" if isinstance(value, (int, np.integer)) else "R"
            self.comment(explanation)
            line = f"{kind} {name}".ljust(WIDTH) + field(value)
            if float(line[WIDTH:]) != value:
                line = f"{kind} {name},{value!r}"
            self.lines.append(line)
        return self

    def curve(self, number, heading, points):
        """*DEFINE_CURVE_TITLE with (abscissa, ordinate) pairs."""
        self.keyword("DEFINE_CURVE_TITLE", heading)
        self.card("lcid sidr sfa sfo offa offo", number, 0, 1.0, 1.0, 0.0, 0.0)
        return self.table("abscissa ordinate", [20, 20], points)

    def constant_step(self, curve, step, end):
        """*CONTROL_TIMESTEP with a constant LCTM curve; `step` may be a `&parameter`."""
        self.keyword("CONTROL_TIMESTEP")
        self.card("dtinit tssfac isdo tslimt dt2ms lctm", 0.0, 0.9, 0, 0.0, 0.0, curve)
        return self.curve(curve, "time step", [(0.0, step), (end, step)])

    def node_set(self, number, heading, nodes):
        """*SET_NODE_LIST_TITLE, eight nodes a line, in the given order."""
        self.keyword("SET_NODE_LIST_TITLE", heading)
        self.card("sid", number)
        nodes = [int(node) for node in nodes]
        rows = [nodes[k:k + 8] for k in range(0, len(nodes), 8)]
        names = " ".join(f"nid{k}" for k in range(1, 9))
        return self.table(names, [WIDTH] * 8, rows)

    def spc_set(self, node_set, fix_x, fix_y):
        """*BOUNDARY_SPC_SET: u_x and/or u_y of a node set are zero."""
        self.keyword("BOUNDARY_SPC_SET")
        return self.card("nsid cid dofx dofy", node_set, 0, int(fix_x), int(fix_y))

    def nodes(self, ids, points):
        """*NODE with (n, 2) coordinates in metres."""
        self.keyword("NODE")
        rows = [(int(i), x, y) for i, (x, y) in zip(ids, points)]
        return self.table("nid x y", [8, 16, 16], rows)

    def quads(self, ids, part, quads):
        """*ELEMENT_SHELL with (n, 4) node numbers, counter-clockwise."""
        self.keyword("ELEMENT_SHELL")
        parts = np.broadcast_to(part, len(ids))
        rows = [(int(i), int(p), *(int(n) for n in quad))
                for i, p, quad in zip(ids, parts, quads)]
        return self.table("eid pid n1 n2 n3 n4", [8] * 6, rows)

    def database(self, **intervals):
        """*DATABASE_<name> cards; an interval in s, a `&parameter`, or 0 for no file."""
        for name, interval in intervals.items():
            self.keyword("DATABASE_" + name.upper())
            self.card("dt", interval)
        return self

    def history_nodes(self, nodes):
        """*DATABASE_HISTORY_NODE, the nodes written to nodout."""
        self.keyword("DATABASE_HISTORY_NODE")
        nodes = [int(node) for node in nodes]
        return self.card(" ".join(f"id{k}" for k in range(1, len(nodes) + 1)), *nodes)

    def text(self):
        """The whole deck, closed by *END."""
        return "\n".join(self.lines + ["*END"]) + "\n"


class Grid:
    """A structured mesh of quads: columns along x, rows along y, numbered column by column.

    `node[i, j]` and `element[i, j]` are numbers as in the deck; `points[i, j]` = (x, y) in m.
    """

    def __init__(self, x, y, first_node=1, first_element=1):
        """`x`, `y`: increasing coordinates of the grid lines in m."""
        x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        if np.any(np.diff(x) <= 0.0) or np.any(np.diff(y) <= 0.0):
            raise ValueError("grid lines must have increasing coordinates")
        n_x, n_y = len(x), len(y)
        self.points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
        self.node = first_node + np.arange(n_x * n_y).reshape(n_x, n_y)
        self.element = first_element + np.arange((n_x - 1) * (n_y - 1)).reshape(n_x - 1, n_y - 1)

    @property
    def quads(self):
        """Node numbers of the elements, (column, row, 4), counter-clockwise."""
        n = self.node
        return np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1)

    @property
    def left(self):
        """Nodes of the left edge, top to bottom (body on the left hand)."""
        return self.node[0, ::-1]

    @property
    def right(self):
        """Nodes of the right edge, bottom to top (body on the left hand)."""
        return self.node[-1, :]

    @property
    def lower(self):
        """Nodes of the lower edge, left to right (body on the left hand)."""
        return self.node[:, 0]

    @property
    def upper(self):
        """Nodes of the upper edge, right to left (body on the left hand)."""
        return self.node[::-1, -1]

    def write(self, deck, part):
        """Nodes and elements into a deck; `part` is one number or one per element."""
        deck.nodes(self.node.ravel(), self.points.reshape(-1, 2))
        deck.quads(self.element.ravel(), np.ravel(part), self.quads.reshape(-1, 4))


def spaced(*stretches):
    """Grid lines of joined stretches (start, end, cells), evenly divided each, in m."""
    lines = [np.array([stretches[0][0]])]
    for start, end, cells in stretches:
        lines.append(start + (end - start) * np.arange(1, cells + 1) / cells)
    return np.concatenate(lines)
