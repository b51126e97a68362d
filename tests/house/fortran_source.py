# SPDX-License-Identifier: MIT
"""Reads Fortran sources as far as the house rules need: statements, modules, uses, procedures."""
import re
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PREFIX = (r"(?:(?:pure|impure|elemental|recursive|module|integer|real|logical|complex|character|"
          r"type|class|double\s+precision)\b(?:\s*\([^()]*(?:\([^()]*\)[^()]*)*\))?\s*)*")
PROCEDURE = re.compile(r"^" + PREFIX + r"\b(subroutine|function)\s+(\w+)\s*(?:\(([^)]*)\))?", re.I)
PROCEDURE_END = re.compile(r"^end\s*(subroutine|function)\b", re.I)
INTERFACE = re.compile(r"^(abstract\s+)?interface\b", re.I)
INTERFACE_END = re.compile(r"^end\s*interface\b", re.I)
USE = re.compile(r"^use\b\s*(?:,\s*((?:non_)?intrinsic)\s*)?(?:::)?\s*(\w+)(.*)$", re.I)
MODULE = re.compile(r"^module\s+(?!procedure\b|subroutine\b|function\b|pure\b)(\w+)$", re.I)


@dataclass
class Procedure:
    """One subroutine or function."""
    name: str
    first: int
    last: int = 0
    arguments: int = 0

    @property
    def lines(self):
        return self.last - self.first + 1


@dataclass
class Use:
    """One use statement."""
    module: str
    line: int
    only: bool
    intrinsic: bool


@dataclass
class Source:
    """One file: its raw lines, its statements as (first line, text), and what was found in them."""
    path: Path
    lines: list
    statements: list
    modules: list = field(default_factory=list)
    uses: list = field(default_factory=list)
    procedures: list = field(default_factory=list)

    @property
    def name(self):
        return str(self.path.relative_to(ROOT)) if self.path.is_relative_to(ROOT) else self.path.name


def without_comment(line):
    """The line up to a `!` that is not in a string."""
    quote = ""
    for i, char in enumerate(line):
        if quote:
            quote = "" if char == quote else quote
        elif char in "'\"":
            quote = char
        elif char == "!":
            return line[:i]
    return line


def without_strings(statement):
    """The statement with the text of its strings left out."""
    return re.sub(r"'[^']*'|\"[^\"]*\"", "''", statement)


def read_statements(lines):
    """Join continued lines; leave comments out."""
    statements, text, first = [], "", 0
    for number, raw in enumerate(lines, 1):
        line = without_comment(raw).strip()
        if not line:
            continue
        if not text:
            first = number
        text += line.lstrip("&") if text else line
        if text.endswith("&"):
            text = text[:-1]
            continue
        statements.append((first, text.strip()))
        text = ""
    return statements


def read_source(path):
    """Read one file."""
    lines = path.read_text(encoding="utf-8").splitlines()
    source = Source(path, lines, read_statements(lines))
    open_procedures, in_interface = [], False
    for number, statement in source.statements:
        if INTERFACE.match(statement):
            in_interface = True
        elif INTERFACE_END.match(statement):
            in_interface = False
        elif MODULE.match(statement):
            source.modules.append(MODULE.match(statement).group(1).lower())
        elif USE.match(statement):
            kind, module, rest = USE.match(statement).groups()
            source.uses.append(Use(module.lower(), number, bool(re.match(r"\s*,\s*only\s*:", rest, re.I)),
                                   kind is not None and kind.lower() == "intrinsic"))
        elif PROCEDURE_END.match(statement) and not in_interface:
            procedure = open_procedures.pop()
            procedure.last = last_line(source, number)
            source.procedures.append(procedure)
        elif PROCEDURE.match(statement) and not in_interface:
            _, name, arguments = PROCEDURE.match(statement).groups()
            count = len([word for word in (arguments or "").split(",") if word.strip()])
            open_procedures.append(Procedure(name, number, arguments=count))
    assert not open_procedures, f"{path}: no end found for {open_procedures}"
    return source


def last_line(source, number):
    """The last line of the statement that starts on line `number`."""
    while source.lines[number - 1].rstrip().endswith("&"):
        number += 1
    return number
