# SPDX-License-Identifier: MIT
"""Lines of Markdown prose that a terminal and a diff can show.

`python tests/house/prose.py FILE...` wraps them in place.
"""
from __future__ import annotations

import pathlib
import re
import sys

LONGEST = 160  # columns of a line of prose; longer ones are broken
WIDTH = 120  # where they are broken
CELL = 119  # characters of a cell of a table

CODE = "    "
FENCE = re.compile(r"\s*(```|~~~|\$\$)")
ITEM = re.compile(r"(\s*)([-*+]|\d+[.)])\s+")
NO_PROSE = re.compile(r"\s*(\||#|<|!\[|\[[^\]]+\]:\s)|(---|===)")
# What a break would change or make hard to find: code, formulas, images and links.
WHOLE = re.compile(r"`[^`]*`|\$[^$]+\$|!?\[[^\]]*\]\([^)]*\)|\S")
# At the beginning of a line these mean something else.
MARK = re.compile(r"([-+*>#|=<]|\d+[.)]$|:\s|```|\$\$)")


def words(text: str) -> list[str]:
    """The pieces of a line between which it may be broken."""
    pieces, word, end = [], "", 0
    for found in WHOLE.finditer(text):
        if found.start() > end and word:
            pieces.append(word)
            word = ""
        word += found[0]
        end = found.end()
    return pieces + [word] if word else pieces


def filled(paragraph: list[str]) -> list[str]:
    """The lines of a paragraph or of an item of a list in lines of at most WIDTH columns, where its pieces allow it."""
    line = " ".join([paragraph[0].rstrip(), *(one.strip() for one in paragraph[1:])])
    item = ITEM.match(line)
    indent = line[: len(line) - len(line.lstrip())]
    first, rest = (item[0], " " * len(item[0])) if item else (indent, indent)
    lines, now = [], first
    for word in words(line[len(first):]):
        blank = "" if now in (first, rest) else " "
        if blank and len(now) + 1 + len(word) > WIDTH and not MARK.match(word):
            lines.append(now)
            now, blank = rest, ""
        now += blank + word
    hard = "  " if paragraph[-1].endswith("  ") else ""
    return [*lines, now + hard]


def prose(text: str):
    """(number, line, whether it is prose) of each line of a page."""
    fence, is_code, before = "", False, ""
    for number, line in enumerate(text.split("\n"), 1):
        mark = FENCE.match(line)
        # A block that stands four columns in is code, whose lines stay as they are.
        is_code = line.startswith(CODE) and (is_code or not before.strip()) or is_code and not line.strip()
        before = line
        if fence:
            fence = "" if mark and mark[1] == fence else fence
        elif mark and not (mark[1] == "$$" and line.count("$$") > 1):
            fence = mark[1]
        else:
            yield number, line, not (is_code or NO_PROSE.match(line) or mark)
            continue
        yield number, line, False


def paragraphs(text: str):
    """The lines of a page, those of a paragraph or of an item of a list together, and whether they are prose."""
    lines: list[str] = []
    for _, line, is_prose in prose(text):
        goes_on = is_prose and line.strip() and not ITEM.match(line) and not (lines and lines[-1].endswith("  "))
        if lines and not goes_on:
            yield lines, True
            lines = []
        if is_prose and line.strip():
            lines.append(line)
        else:
            yield [line], False
    if lines:
        yield lines, True


def wrapped(text: str) -> str:
    """A page whose prose keeps to LONGEST columns: paragraphs with a longer line are filled anew."""
    lines: list[str] = []
    for paragraph, is_prose in paragraphs(text):
        lines += filled(paragraph) if is_prose and max(map(len, paragraph)) > LONGEST else paragraph
    return "\n".join(lines)


def too_wide(text: str) -> list[str]:
    """What of a page is wider than it may be, with the number of its line."""
    trouble = []
    for number, line, is_prose in prose(text):
        if is_prose and len(line) > LONGEST:
            trouble.append(f"line {number}: prose of {len(line)} columns")
        elif line.lstrip().startswith("|"):
            widest = max(len(cell.strip()) for cell in re.split(r"(?<!\\)\|", line))
            if widest > CELL:
                trouble.append(f"line {number}: a cell of {widest} characters")
    return trouble


if __name__ == "__main__":
    for name in sys.argv[1:]:
        path = pathlib.Path(name)
        path.write_text(wrapped(path.read_text(encoding="utf-8")), encoding="utf-8")
