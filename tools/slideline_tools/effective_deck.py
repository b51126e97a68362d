# SPDX-License-Identifier: MIT
"""The effective deck of a run: its keywords with their cards, and titles and laws by number."""
import dataclasses
import itertools


@dataclasses.dataclass
class Block:
    """One keyword (without the star, upper case), its data lines, and the line of the keyword as it stands."""

    keyword: str
    lines: list[str]
    width: int = 10
    head: str = ""

    @property
    def is_titled(self) -> bool:
        """Whether a title line stands before the first card."""
        return self.keyword.endswith(("_TITLE", "_ID"))

    def fields(self, line: int, *widths: int) -> list[str]:
        """The fields of one line, comma or columns (of `widths` where they are not all alike); none beyond the end of
        the block."""
        if line >= len(self.lines):
            return []
        text = self.lines[line].rstrip()
        if "," in text:
            return [field.strip() for field in text.split(",")]
        if widths and self.width == 10:
            least = 10 if self.head.rstrip().endswith("%") else 0
            starts = [0, *itertools.accumulate(max(width, least) for width in widths)]
            return [text[a:b].strip() for a, b in itertools.pairwise(starts) if a < len(text)]
        return [text[k:k + self.width].strip() for k in range(0, len(text), self.width)]

    def cards(self, first: int = 0, *widths: int) -> list[list[str]]:
        """The fields of all lines from `first` on, as of `fields`; none of blank ones."""
        return [fields for line in range(first, len(self.lines)) if (fields := self.fields(line, *widths))]

    def number(self, line: int) -> int:
        """The whole number in the first field of a line; 0 where there is none."""
        first = (self.fields(line) or [""])[0].removesuffix(".0")
        return int(first) if first.isdigit() else 0


def read_blocks(text: str, *prefixes: str) -> list[Block]:
    """The blocks of a deck in their order; with `prefixes` those whose keywords begin so."""
    blocks, wide = [], False
    for line in text.splitlines():
        if line.startswith("*"):
            name, mark = ([*line[1:].split(), "", ""])[:2]
            name = name.upper() + (mark if mark in ("+", "-", "%") else "")
            if name == "KEYWORD":
                wide = "LONG=Y" in line.upper() or "LONG=K" in line.upper()
            long = (wide or name.endswith("+")) and not name.endswith("-")
            blocks.append(Block(name.rstrip("+-%"), [], 20 if long else 10, line))
        elif not line.startswith("$") and blocks:
            blocks[-1].lines.append(line)
    return [one for one in blocks if one.keyword.startswith(prefixes)] if prefixes else blocks


def material_keyword(deck: str, number: int) -> str:
    """The keyword of a material, or 'its *MAT' when it is not found."""
    for block in read_blocks(deck, "MAT_"):
        if block.number(int(block.is_titled)) == number:
            return "*" + block.keyword.removesuffix("_TITLE")
    return "its *MAT"


def part_titles(deck: str) -> dict[int, str]:
    """part id -> heading of the *PART keywords of a deck."""
    return {number: block.lines[line - 1].strip()
            for block in read_blocks(deck, "PART") if block.keyword == "PART"
            for line in range(1, len(block.lines), 2) if (number := block.number(line))}


def interface_titles(deck: str) -> dict[int, str]:
    """interface id -> title on the first card of *CONTACT_..._TITLE of a deck."""
    titles = {}
    for block in read_blocks(deck, "CONTACT_"):
        if block.keyword.endswith("_TITLE") and block.number(0):
            line = block.lines[0]
            titles[block.number(0)] = (line.split(",", 1)[1] if "," in line[:20]
                                       else line[block.width:]).strip()
    return titles
