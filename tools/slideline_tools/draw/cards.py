# SPDX-License-Identifier: MIT
"""Keyword cards of an effective deck: fields by column or comma."""
from __future__ import annotations

import dataclasses
import re

BARE_EXPONENT = re.compile(r"^([-+]?[0-9.]+)([-+][0-9]+)$")  # 8.9-3 is 8.9e-3


@dataclasses.dataclass
class Row:
    """The fields of one line, blank where the line is shorter."""

    fields: list[str]

    def text(self, place: int) -> str:
        """A field, from 0 on."""
        return self.fields[place] if place < len(self.fields) else ""

    def real(self, place: int) -> float:
        """A real number, 0 for a blank."""
        return real_number(self.text(place))

    def integer(self, place: int) -> int:
        """A whole number, 0 for a blank."""
        return whole_number(self.text(place))

    def integers(self) -> list[int]:
        """All fields as whole numbers."""
        return [whole_number(field) for field in self.fields]


@dataclasses.dataclass
class Card:
    """One keyword without its star and its _TITLE or _ID, its title and its data lines."""

    name: str
    title: str
    lines: list[str]
    least: int = 0   # least width of a field (20 in the LONG form)

    def row(self, line: int, widths: tuple[int, ...] = (10,) * 8) -> Row:
        """The fields of a line; none beyond the end."""
        if line >= len(self.lines):
            return Row([])
        text = self.lines[line]
        if "," in text:
            return Row([field.strip() for field in text.split(",")])
        fields, start = [], 0
        for width in (max(width, self.least) for width in widths):
            if start >= len(text):
                break
            fields.append(text[start:start + width].strip())
            start += width
        return Row(fields)


def read_cards(text: str) -> list[Card]:
    """All keywords of a deck in their order."""
    cards, deck_least, titled = [], 0, False
    for line in text.splitlines():
        if line.startswith("*"):
            words = line[1:].split() or [""]
            name, options = words[0].upper(), [word.upper() for word in words[1:]]
            if name == "KEYWORD":
                deck_least = least_width(options)
            least = {"+": 20, "%": 10, "-": 0}.get(name[-1:], deck_least)
            name = name.rstrip("+-%")
            titled = name.endswith(("_TITLE", "_ID"))
            cards.append(Card(name.removesuffix("_TITLE").removesuffix("_ID"), "", [], least))
        elif cards and not line.startswith("$"):
            if titled:
                cards[-1].title, titled = line.strip(), False
            else:
                cards[-1].lines.append(line.rstrip())
    return cards


def least_width(options: list[str]) -> int:
    """Least width of all fields that the options of *KEYWORD ask for."""
    if any(option in ("LONG=Y", "LONG=K") for option in options):
        return 20
    return 10 if "I10=Y" in options else 0


def real_number(text: str) -> float:
    """A real number as decks write it; 0 for a blank."""
    text = text.strip().lower().replace("d", "e")
    return float(BARE_EXPONENT.sub(r"\1e\2", text)) if text else 0.0


def whole_number(text: str) -> int:
    """A whole number as decks write it; 0 for a blank."""
    text = text.strip()
    try:
        return int(text) if text else 0
    except ValueError:
        return int(real_number(text))
