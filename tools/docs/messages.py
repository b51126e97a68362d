# SPDX-License-Identifier: MIT
"""Every error, warning and log line of the program, read from the statements of src/.

    messages.py WORD...    prints the messages that have all of the words, with kind and source line

tools/docs/site_source.py puts the tables below doc/messages.md.
"""
import dataclasses
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/house"))

from fortran_source import read_source  # noqa: E402

from keyword_pages import table_lines  # noqa: E402

#: kind of message -> the procedures that take its text
KINDS = {
    "Errors in the deck or on the command line": (
        "line_error field_error report_field report_name report_number reject_field refuse refuse_side refuse_static "
        "refuse_duplicates refuse_rigid set_error note find_body"),
    "Errors that stop a run": "raise archive%fail visitor%fail archive%expect visitor%expect source%expect check_status",
    "Warnings": "warn line_warning warn_of_field warn_of_nodes warn_of_explicit add_warning",
    "Notes in the log": "write_log show_note put_line",
}
DECK = next(iter(KINDS))
PARTS = "Parts of longer messages"
KIND_OF = {name: kind for kind, names in KINDS.items() for name in names.split()}
#: files whose texts are tables or names of columns
OTHERS = {"deck_schema_tables.f90", "deck_schema_others.f90", "dyna_layouts.f90", "history_tables.f90"}
#: arguments ahead of the message: deck, line and the key of a warning
KEYED = {"line_warning": 3, "warn_of_nodes": 3}
CALL = re.compile(r"(?:if \(.*?\) |else )?call (\w+(?:%\w+)*)\((.*)\)$")
ASSIGNED = re.compile(r"(?:if \(.*\) )?(?:\w+(?:%\w+)*(?:\([^()]*\))?|character\(.*?\), parameter.*? :: \w+(?:\(.*?\))?) = (.*)$")
LITERAL = re.compile(r"'((?:[^']|'')*)'")
#: a field of a card, as the procedures that report an error of one take it
FIELD = re.compile(r"^(?:place_of\(\w+(?:\(\d\))?, |place_t\(.*, )?'([A-Z][A-Z0-9_]*)'\)?$")
WORDS = re.compile(r"[A-Za-z]{2,},? \(?[A-Za-z]{2,}")


@dataclasses.dataclass
class Message:
    """One message: its text with … for numbers and names, its kind, file and line."""

    text: str
    kind: str
    file: str
    line: int


def split(text, mark):
    """The parts of an expression between marks outside of brackets and strings."""
    parts, depth, quoted, start = [], 0, False, 0
    for at, char in enumerate(text):
        quoted ^= char == "'"
        depth += 0 if quoted else (char in "([") - (char in ")]")
        if not quoted and not depth and text.startswith(mark, at):
            parts.append(text[start:at])
            start = at + len(mark)
    return [part.strip() for part in [*parts, text[start:]]]


def template(expression):
    """The text of an expression: strings as they are, `{a|b}` for a choice of two, … for anything else."""
    out = ""
    for term in split(expression, "//"):
        choice = re.match(r"(?:trim\()?merge\(\s*('.*')", term)
        if LITERAL.fullmatch(term):
            out += term[1:-1].replace("''", "'")
        elif choice:
            out += "{" + "|".join(text.strip() for text in LITERAL.findall(choice[1])[:2]) + "}"
        elif not out.endswith("…"):
            out += "…"
    return out


def read_statements(source, file):
    """The messages of one file, with the first line of the procedure that makes each."""
    for line, statement in source.statements:
        called, assigned = CALL.match(statement), ASSIGNED.match(statement)
        if called:
            arguments = split(called[2], ",")[KEYED.get(called[1], 0):]
            field = next((f"({found[1]}): … " for part in arguments if (found := FIELD.search(part))), "")
            text = field + " ".join(template(part) for part in arguments if WORDS.search(" ".join(LITERAL.findall(part))))
        else:
            text = template(assigned[1]) if assigned else ""
        kind = KIND_OF.get(called[1] if called else "", "")
        around = max((one.first for one in source.procedures if one.first <= line <= one.last), default=0)
        if kind or WORDS.search(text):
            yield Message(text.strip(), kind, file, line), around


def read_fields():
    """The messages of the tables of the schema: what a field must be, why one is refused, and why a keyword is."""
    file = "deck/schema/deck_schema.f90"
    for table, form in (("expectations", "is not {}"), ("refusals", "{}")):
        for row in table_lines(table, (ROOT / "src" / file).read_text(encoding="utf-8")):
            fields, _, text = row.partition(" ")
            text = f"has no effect here{text.strip()}" if text.startswith(" :") or text.startswith(":") else form.format(text)
            yield Message(f"({fields}): … {text}", DECK, file, 0)
    for row in table_lines("table_others"):
        keywords, _, text = row.partition(" ")
        if text.strip() != "ignored":
            yield Message(f"*{keywords}: {text} not available in slideline", DECK, "deck/schema/deck_schema_others.f90", 0)


def read_messages():
    """All messages; a text that is kept in a variable is of the kind of the one procedure called with it."""
    found = list(read_fields())
    for path in sorted((ROOT / "src").rglob("*.f90")):
        if path.name in OTHERS:
            continue
        made = list(read_statements(read_source(path), path.relative_to(ROOT / "src").as_posix()))
        for message, around in made:
            kinds = {other.kind for other, place in made if place == around and other.kind}
            message.kind = message.kind or (kinds.pop() if len(kinds) == 1 else PARTS)
        found += [message for message, _ in made if WORDS.search(message.text)]
    return found


def tables():
    """A table for each kind, as Markdown."""
    lines, messages = [], read_messages()
    for kind in (*KINDS, PARTS):
        lines += [f"## {kind}", "", "| message | source |", "|---|---|"]
        for one in sorted((one for one in messages if one.kind == kind), key=lambda one: (one.file, one.line)):
            text = re.sub(r"([|*<_])", r"\\\1", one.text)
            lines.append(f"| {text} | `{one.file}`{f', {one.line}' if one.line else ''} |")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    for one in read_messages():
        if all(word.lower() in one.text.lower() for word in sys.argv[1:]):
            print(f"{one.text}\n    {one.kind}; src/{one.file}{f':{one.line}' if one.line else ''}")
