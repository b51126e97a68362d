# SPDX-License-Identifier: MIT
"""Decks that the program refuses, with the lines and the words of every refusal.

Whole decks are in `examples`. Of the others a family has a deck that the program accepts, FAMILY.k, and a table of edits
of it, FAMILY.txt, with rows like

    # hourglass_negative: A negative coefficient.
    *HOURGLASS
             1         1      -0.1
    $^ field 3 (QM): "-0.1" is negative

The k-th block of a keyword takes the place of the k-th such block of the accepted deck, or comes at the end where that
has none. `+*KEYWORD` comes at the end whatever the deck has, `-*KEYWORD` removes all blocks of the keyword. A row that
begins with `##` is a whole deck. In all decks `$^ WORDS` belongs to the line above, comments left out: one message must
give this line and these words. Above the first keyword it is for what has no line in the deck: a message of the whole
deck, of a file that it includes (`parts/long.inc:1: ...`), or the last line, `refused, 2 errors`.
"""
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).resolve().parent
MARK = "$^ "


class Refused(NamedTuple):
    """A deck that is refused."""
    name: str
    family: str
    text: str
    folder: Path  # what it includes lies there

    def expected(self) -> list[tuple[int, str]]:
        """Line (0: none) and words of each refusal."""
        found, line = [], 0
        has_keyword = False
        for number, text in enumerate(self.text.splitlines(), 1):
            if text.startswith(MARK):
                found.append((line, text[len(MARK):].strip()))
            elif not text.startswith("$"):
                has_keyword = has_keyword or text.startswith("*")
                line = number if has_keyword else 0
        return found


def blocks_of(lines: list[str]) -> list[list[str]]:
    """The lines in blocks of a keyword and its cards; what comes before the first one is a block too."""
    found = [[]]
    for line in lines:
        if line.lstrip("+-").startswith("*"):
            found.append([])
        found[-1].append(line)
    return found


def edited(base: list[str], edit: list[str]) -> list[str]:
    """The accepted deck after the edit of a row."""
    blocks, last, used = blocks_of(base), [], {}
    head, *changes = blocks_of(edit)
    for block in changes:
        keyword = block[0].lstrip("+-")
        places = [k for k, old in enumerate(blocks) if old[:1] == [keyword]]
        if block[0].startswith("-"):
            blocks = [old for old in blocks if old[:1] != [keyword]]
        elif not block[0].startswith("+") and used.get(keyword, 0) < len(places):
            blocks[places[used.get(keyword, 0)]] = block
            used[keyword] = used.get(keyword, 0) + 1
        else:
            last.append([keyword, *block[1:]])
    return [line for block in [head, *blocks[:-1], *last, blocks[-1]] for line in block]


def rows(table: Path) -> list[tuple[str, bool, list[str]]]:
    """Name of each row of a table, whether it is a whole deck, and its lines below the title."""
    found = []
    for line in table.read_text(encoding="latin-1").splitlines():
        if line.startswith("#"):
            if found and found[-1][2][-1:] == [""]:
                found[-1][2].pop()  # sets the rows apart
            found.append((line.lstrip("#").split(":")[0].strip(), line.startswith("##"), []))
        elif found:
            found[-1][2].append(line)
    return found


def refused_decks() -> list[Refused]:
    """All decks of the folder that are refused."""
    found = [Refused(path.stem, "examples", path.read_text(encoding="latin-1"), path.parent)
             for path in sorted((HERE / "examples").glob("*.k"))]
    for table in sorted(HERE.glob("*.txt")):
        base = table.with_suffix(".k").read_text(encoding="latin-1").splitlines()
        for name, whole, lines in rows(table):
            text = "\n".join(lines if whole else edited(base, lines)) + "\n"
            found.append(Refused(name, table.stem, text, HERE))
    return found
