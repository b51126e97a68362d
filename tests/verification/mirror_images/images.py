# SPDX-License-Identifier: MIT
"""Images of a deck in comma form: mirrored at x = 0, and with a search for all spots in every cycle (FREQ 1)."""


def mirrored(keyword, row, fields):
    """The fields of a row below a keyword, mirrored."""
    negated = []
    if keyword == "*NODE":
        negated = [1]
    elif keyword == "*INITIAL_VELOCITY_GENERATION":
        negated = [2, 3] if row % 2 else [0]     # spin and vx; x of the axis
    elif keyword == "*ELEMENT_SHELL":
        nodes = fields[2:]
        return fields[:2] + ([nodes[0], nodes[2], nodes[1], nodes[1]] if nodes[2] == nodes[3] else nodes[::-1])
    return [repr(-float(field)) if k in negated and field else field for k, field in enumerate(fields)]


def image(text, is_mirrored=False, is_searched=False):
    lines, keyword, row = [], "", 0
    for line in text.splitlines():
        if line[:1] in ("*", "$", ""):
            if line[:1] == "*":
                keyword, row = line.split()[0], 0
            lines.append(line)
            continue
        row += 1
        fields = line.split(",")
        if is_mirrored:
            fields = mirrored(keyword, row, fields)
        if is_searched and keyword == "*CONTACT_2D_SLIDELINE" and row == 2:
            fields = [*fields, *[""] * (8 - len(fields))]
            fields[6] = "1"
        lines.append(",".join(fields))
    changed = "\n".join([*lines, ""])
    if (is_mirrored or is_searched) and changed == text:
        raise ValueError("this image of the deck is the deck itself: no card was found that makes it another one")
    return changed
