# SPDX-License-Identifier: MIT
"""The example decks of doc/examples, as their heads describe them.

The comment lines before `*KEYWORD` are the head: first a title, then paragraphs, then

    $ Keywords: *MAT_ELASTIC *PART            the keyword pages that show this deck
    $ Run: ctype=5                            more words of the command line, if any
    $ Warnings: 1                             how many the deck is to get (none without this line)
    $ Status: 1                               exit status (0 without this line)
    $ Expect: last nodout:uy@node=3 = -9.81*0.1**2/2 within 1e-6
    $ Expect: log a text of the log
    $ Expect: file NAME                       a file of the results

A quantity is `first`, `last`, `max`, `min`, `rows` (number of rows) of a column of a history table,
or `last cell:mises@element_id=1` of a cell field; `within` is relative, absolute where 0 is expected.
"""
import dataclasses
import math
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "doc/examples"
FUNCTIONS = {name: getattr(math, name)
             for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "pi")} | {"abs": abs}
QUANTITY = re.compile(r"(first|last|max|min|rows) (\w+):(\w+)(?:@([\w=,.]+))? = (.+) within (\S+)$")


@dataclasses.dataclass(frozen=True)
class Expectation:
    """One line `$ Expect:` that is a number."""

    text: str        #: as it stands in the deck
    pick: str        #: first, last, max, min or rows
    table: str       #: history table, or `cell`
    column: str
    where: dict      #: column -> value as text
    formula: str
    tolerance: float

    @property
    def value(self):
        """The number that the formula gives."""
        return float(eval(self.formula, {"__builtins__": {}}, FUNCTIONS))  # noqa: S307


@dataclasses.dataclass(frozen=True)
class Example:
    """One example deck."""

    path: pathlib.Path
    title: str
    paragraphs: list   #: texts
    keywords: list     #: without asterisks
    words: list        #: of the command line
    warnings: int
    status: int
    expectations: list
    log_texts: list
    files: list

    @property
    def name(self):
        return self.path.stem

    @property
    def command(self):
        """The command that runs it, from the top of the tree."""
        return " ".join(["build/release/slideline", f"i=doc/examples/{self.path.name}",
                         f"d=results/examples/{self.name}", *self.words])


def read_expectation(text):
    found = QUANTITY.match(text)
    if not found:
        raise ValueError(f"this is no expectation: {text}")
    pick, table, column, where, formula, tolerance = found.groups()
    pairs = dict(pair.split("=") for pair in where.split(",")) if where else {}
    return Expectation(text, pick, table, column, pairs, formula, float(tolerance))


def read_example(path):
    """The example of a deck; raises ValueError where its head is not as it should be."""
    head = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("$"):
            break
        head.append(line[1:].strip())
    marked = [re.match(r"(Keywords|Run|Warnings|Status|Expect): (.*)", line) for line in head]
    entries = [(found.group(1), found.group(2).strip()) for found in marked if found]
    prose = "\n".join("" if found else line for line, found in zip(head, marked))
    paragraphs = [" ".join(part.split()) for part in re.split(r"\n\s*\n", prose) if part.strip()]

    def texts(name):
        return [text for entry, text in entries if entry == name]

    expect = texts("Expect")
    try:
        return Example(
            path, paragraphs[0], paragraphs[1:],
            [word.lstrip("*") for text in texts("Keywords") for word in text.split()],
            [word for text in texts("Run") for word in text.split()],
            int((texts("Warnings") or ["0"])[0]), int((texts("Status") or ["0"])[0]),
            [read_expectation(text) for text in expect if not text.startswith(("log ", "file "))],
            [text[4:] for text in expect if text.startswith("log ")],
            [text[5:] for text in expect if text.startswith("file ")])
    except (IndexError, ValueError) as problem:
        raise ValueError(f"{path.name}: {problem}") from problem


def read_examples():
    """All examples, by name."""
    return [read_example(path) for path in sorted(FOLDER.glob("*.k"))]


def included_files(example):
    """The files that a deck includes, all of doc/examples."""
    text = example.path.read_text(encoding="utf-8")
    names = re.findall(r"^\*INCLUDE\s*\n(?:\$.*\n)*(.+)$", text, flags=re.M)
    paths = [FOLDER / name.strip() for name in names]
    return [path if path.exists() else FOLDER / "parts" / path.name for path in paths]
