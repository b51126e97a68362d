# SPDX-License-Identifier: MIT
"""The effective deck of a run: keywords, their cards, and the sets that make up surfaces."""
from __future__ import annotations

import dataclasses


@dataclasses.dataclass
class Block:
    """One keyword (without the star, upper case) and its data lines."""

    keyword: str
    lines: list[str]
    width: int = 10

    def fields(self, line: int) -> list[str]:
        """The fields of one line, comma or columns; none beyond the end of the block."""
        if line >= len(self.lines):
            return []
        text = self.lines[line]
        if "," in text:
            return [field.strip() for field in text.split(",")]
        return [text[k:k + self.width].strip() for k in range(0, len(text.rstrip()), self.width)]


def read_blocks(text: str) -> list[Block]:
    """All blocks of a deck in their order."""
    blocks, wide = [], False
    for line in text.splitlines():
        if line.startswith("*"):
            name = line[1:].split()[0].upper() if len(line) > 1 and line[1:].split() else ""
            if name == "KEYWORD":
                wide = "LONG=Y" in line.upper() or "LONG=K" in line.upper()
            long = (wide or name.endswith("+")) and not name.endswith("-")
            blocks.append(Block(name.rstrip("+-%"), [], 20 if long else 10))
        elif not line.startswith("$") and blocks:
            blocks[-1].lines.append(line)
    return blocks


def whole_number(text: str) -> int:
    """A whole number as a deck may write it; 0 for a blank."""
    return int(float(text)) if text else 0


def contact_blocks(blocks: list[Block]) -> list[Block]:
    """The interfaces, in the order of the deck, without their title lines."""
    found = []
    for block in blocks:
        if block.keyword.startswith("CONTACT_2D"):
            titled = block.keyword.endswith(("_TITLE", "_ID"))
            found.append(Block(block.keyword, block.lines[1:] if titled else block.lines,
                               block.width))
    return found


def sets(blocks: list[Block], kind: str) -> dict[int, list[int]]:
    """Members of every *SET_NODE... or *SET_PART... in list form, by set number."""
    found = {}
    for block in blocks:
        if not block.keyword.startswith(f"SET_{kind}"):
            continue
        if "GENERATE" in block.keyword or "COLUMN" in block.keyword:
            continue
        start = 1 if block.keyword.endswith("_TITLE") else 0
        number = block.fields(start)
        if not number or not number[0]:
            continue
        members = [whole_number(field) for k in range(start + 1, len(block.lines))
                   for field in block.fields(k)]
        found[whole_number(number[0])] = [member for member in members if member]
    return found


def material_keyword(blocks: list[Block], number: int) -> str:
    """The keyword of a material, or 'its *MAT' when it is not found."""
    for block in blocks:
        if block.keyword.startswith("MAT_"):
            fields = block.fields(1 if block.keyword.endswith("_TITLE") else 0)
            if fields and fields[0] and whole_number(fields[0]) == number:
                return "*" + block.keyword.removesuffix("_TITLE")
    return "its *MAT"
