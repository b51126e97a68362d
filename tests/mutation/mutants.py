# SPDX-License-Identifier: MIT
"""Makes mutants of Fortran sources: copies with one operator, index, number or statement broken.

Only executable statements of procedures are touched: no declaration, no `use`, no string and no
comment, so that a mutant has the interface of its original and its module file stays valid.
"""
from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

HEADER = re.compile(r"^(?:(?:pure|impure|elemental|recursive)\s+)*(?:subroutine|function)\s+\w+", re.I)
HEADER_END = re.compile(r"^end\s+(?:subroutine|function)\b", re.I)
SKIPPED = re.compile(r"^(?:use|implicit|import|contains|private|public|end|else|interface|module|"
                     r"select|case|continue|type)\b(?!\s*[=(%]|\s+if\b)", re.I)
NUMBER = re.compile(r"(?<![\w.])(\d+\.\d*(?:[eEdD][+-]?\d+)?|\d+)(_\w+)?(?![\w.])")
WORDS = {"min": "max", "max": "min", "minval": "maxval", "maxval": "minval", "any": "all",
         "all": "any", "floor": "ceiling", "ceiling": "floor", "abs": ""}
RELATIONS = {"==": ["/="], "/=": ["=="], "<": ["<=", ">"], ">": [">=", "<"], "<=": ["<", ">="],
             ">=": [">", "<="]}
REALS = {"0.0": "1.0", "0.5": "1.0", "1.0": "2.0", "2.0": "1.0"}


@dataclass(frozen=True)
class Statement:
    """One statement: its code on one line (strings blanked) and where each character comes from."""
    text: str
    places: tuple[int, ...]


@dataclass(frozen=True)
class Mutant:
    """One broken statement of one file."""
    file: str
    line: int
    rule: str
    before: str
    after: str
    start: int  # of what is replaced, in the text of the file
    end: int
    replacement: str

    @property
    def key(self) -> str:
        """What tells this mutant from all others of the same sources."""
        return f"{self.file}:{self.start}:{self.end}:{self.replacement}"

    def apply(self, text: str) -> str:
        """The text of the broken file."""
        return text[:self.start] + self.replacement + text[self.end:]


def code_of(text: str) -> Iterator[tuple[int, str]]:
    """(place, character) of all code; strings are blanked, comments and continuation marks left out."""
    place = 0
    for line in text.splitlines(keepends=True):
        quote, last = "", -1
        kept: list[tuple[int, str]] = []
        for k, char in enumerate(line):
            if quote:
                kept.append((place + k, char if char == quote else "\0"))
                quote = "" if char == quote else quote
            elif char == "!":
                break
            else:
                quote = char if char in "'\"" else ""
                kept.append((place + k, char))
        for k, (_, char) in enumerate(kept):
            if char not in " \n":
                last = k
        if last >= 0 and kept[last][1] == "&":
            yield from kept[:last]
        elif last >= 0:
            yield from kept[:last + 1]
            yield place + len(line), "\n"
        place += len(line)


def read_statements(text: str) -> list[Statement]:
    """The statements of a file."""
    statements, chars, places = [], [], []
    for place, char in code_of(text):
        if char in "\n;":
            if "".join(chars).strip():
                statements.append(squeeze(chars, places))
            chars, places = [], []
        else:
            chars.append(char)
            places.append(place)
    return statements


def squeeze(chars: list[str], places: list[int]) -> Statement:
    """A statement with runs of blanks made one, without blanks at its ends."""
    kept = [k for k, char in enumerate(chars)
            if char != " " or (k + 1 < len(chars) and chars[k + 1] != " " and k > 0)]
    while kept and chars[kept[0]] == " ":
        kept.pop(0)
    return Statement("".join(chars[k] for k in kept), tuple(places[k] for k in kept))


def closing(text: str, opening: int) -> int:
    """Index of the parenthesis that closes the one at `opening`."""
    depth = 0
    for k in range(opening, len(text)):
        depth += (text[k] in "([") - (text[k] in ")]")
        if depth == 0:
            return k
    return len(text) - 1


def opening_before(text: str, k: int) -> int:
    """Index of the innermost parenthesis or bracket that is open at `k`, or -1."""
    depth = 0
    for j in range(k - 1, -1, -1):
        depth += (text[j] in ")]") - (text[j] in "([")
        if depth < 0:
            return j
    return -1


def is_declaration(text: str) -> bool:
    """Whether there is a `::` outside parentheses."""
    depth = 0
    for k, char in enumerate(text):
        depth += (char in "([") - (char in ")]")
        if depth == 0 and text.startswith("::", k):
            return True
    return False


def declared_integers(text: str) -> set[str]:
    """Names that an integer declaration declares."""
    if not re.match(r"integer\b", text, re.I):
        return set()
    names = re.sub(r"\([^()]*\)", "", text.split("::", 1)[1])
    return {re.split(r"\s*=", name)[0].strip().lower() for name in names.split(",")}


def in_index(text: str, start: int, end: int) -> bool:
    """Whether text[start:end] is a whole subscript, argument or bound of a subscript range."""
    before, after = text[:start].rstrip(), text[end:].lstrip()
    if not before or before[-1] not in "(,:" or not after or after[0] not in "),:":
        return False
    k = opening_before(text, start)
    return k > 0 and text[k] == "(" and (text[k - 1].isalnum() or text[k - 1] == "_")


def operators(text: str) -> Iterator[tuple[str, int, int, str]]:
    """Broken operators as (rule, start, end, replacement)."""
    inside = {k for number in NUMBER.finditer(text) for k in range(*number.span())}
    for found in re.finditer(r"[-+]", text):
        if found.start() not in inside:
            yield "sign", *found.span(), "-" if found.group() == "+" else "+"
    for found in re.finditer(r"(?<![*(,])\*(?![*),])|(?<![/(])/(?![/=)])", text):
        yield "factor", *found.span(), "/" if found.group() == "*" else "*"
    for found in re.finditer(r"==|/=|<=|>=|<|(?<!=)>", text):
        for other in RELATIONS[found.group()]:
            yield "relation", *found.span(), other
    for found in re.finditer(r"\.(and|or|true|false)\.|\.not\. ?", text, re.I):
        other = {"and": ".or.", "or": ".and.", "true": ".false.", "false": ".true."}
        yield "logic", *found.span(), other.get((found.group(1) or "").lower(), "")


def numbers(text: str) -> Iterator[tuple[str, int, int, str]]:
    """Broken numbers; a literal subscript is moved to its neighbour."""
    for found in NUMBER.finditer(text):
        if re.search(r"\b(?:tiny|huge|epsilon)\($", text[:found.start()]):
            continue  # asks for the kind only
        literal, start, end = found.group(1), found.start(1), found.end(1)
        if "." in literal:
            plain = f"{2.0*float(literal.lower().replace('d', 'e'))!r}"
            yield "number", start, end, REALS.get(literal, plain)
        elif in_index(text, start, found.end()):
            yield "index", start, end, str(2 if literal == "1" else int(literal) - 1 if int(literal) else 1)
        else:
            yield "number", start, end, str(int(literal) + 1)


def names(text: str, integers: set[str]) -> Iterator[tuple[str, int, int, str]]:
    """Broken subscripts by name, and functions exchanged for their opposite."""
    for found in re.finditer(r"(?<![\w%.])[a-zA-Z]\w*", text):
        word, (start, end) = found.group(), found.span()
        if word.lower() in integers and in_index(text, start, end):
            yield "index", start, end, f"{word} + 1"
            yield "index", start, end, f"{word} - 1"
        elif word.lower() in WORDS and text.startswith("(", end):
            yield "function", start, end, WORDS[word.lower()]


def statements_and_conditions(text: str) -> Iterator[tuple[str, int, int, str]]:
    """Statements left out, conditions turned round, `exit` and `cycle` exchanged."""
    body, end = 0, len(text)
    found = re.match(r"(?:else )?if \(|do while \(", text, re.I)
    if found:
        shut = closing(text, found.end() - 1)
        yield "condition", found.end(), shut, f".not. ({text[found.end():shut]})"
        body = shut + 1 + (text[shut + 1:shut + 2] == " ")
    action = text[body:]
    if action.lower() in ("exit", "cycle"):
        yield "loop", body, end, "cycle" if action.lower() == "exit" else "exit"
    elif action.lower() == "return" or re.match(r"call\b", action, re.I) or is_assignment(action):
        yield "left out", body, end, "continue"


def is_assignment(text: str) -> bool:
    """Whether a statement gives a variable a value."""
    return bool(re.match(r"[a-zA-Z]\w*(?:%\w+|\([^()]*(?:\([^()]*(?:\([^()]*\)[^()]*)*\)[^()]*)*\))*\s*=(?![=>])",
                         text)) and not re.match(r"do\b", text, re.I)


def make_mutants(file: str, text: str) -> list[Mutant]:
    """All mutants of one file, in the order of their places."""
    mutants: list[Mutant] = []
    integers: set[str] = set()
    depth = 0
    for statement in read_statements(text):
        code = statement.text
        if HEADER.match(code):
            depth += 1
        elif HEADER_END.match(code):
            depth -= 1
        elif is_declaration(code):
            integers |= declared_integers(code)
        elif depth > 0 and not SKIPPED.match(code):
            for rule, start, end, replacement in [
                    *operators(code), *numbers(code), *names(code, integers),
                    *statements_and_conditions(code)]:
                if "\0" not in code[start:end]:
                    mutants.append(mutant_of(file, text, statement, (rule, start, end, replacement)))
    return sorted(mutants, key=lambda mutant: (mutant.start, mutant.end, mutant.replacement))


def mutant_of(file: str, text: str, statement: Statement, edit: tuple[str, int, int, str]) -> Mutant:
    """The mutant of one edit of a statement."""
    rule, start, end, replacement = edit
    first, last = statement.places[start], statement.places[end - 1] + 1
    whole = "".join(text[place] for place in statement.places)
    return Mutant(file, text.count("\n", 0, first) + 1, rule, whole,
                  whole[:start] + replacement + whole[end:], first, last, replacement)
