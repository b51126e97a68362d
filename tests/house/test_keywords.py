# SPDX-License-Identifier: MIT
"""doc/keywords.md says of every keyword and field what the reader's table says."""
import re
import sys

import pytest

from fortran_source import ROOT, read_source

sys.path.insert(0, str(ROOT / "tools/docs"))

from keyword_pages import read_keywords  # noqa: E402

SOURCE = "".join((ROOT / "src/deck/schema" / name).read_text(encoding="utf-8")
                 for name in ("deck_schema_tables.f90", "deck_schema_others.f90"))
KINDS = {"i": "integer", "f": "real", "a": "text"}
TREATMENTS = {"": "honoured", "s": "no effect", "w": "warning", "r": "refused"}


def table_lines(name):
    """The lines of one table of the reader."""
    body = re.search(rf":: {name}\(\*\) = \[character\(\d+\) :: &\n(.*?)\]\n", SOURCE, re.S).group(1)
    return re.findall(r"'([^']*)'", re.sub(r"' &\n\s*//'", "", body))


def keywords_of_the_reader():
    """keyword -> rows (card, field, columns, kind, default, treatment)."""
    found, rows = {}, None
    names = re.findall(r":: (table_\w+)\(\*\)", SOURCE)
    for line in (line for name in names if name != "table_others" for line in table_lines(name)):
        if not line.startswith(" "):
            rows = found.setdefault(line.split()[0], [])
            card = 0
            continue
        card, column = card + 1, 1
        for word in line.split():
            name, kind, treatment, width, default = re.fullmatch(
                r"([^:]+):([ifax])([swr]?)(\d*)(?:[=~]([^<>|]+))?(?:[<>|]\S+)?", word).groups()
            width = int(width or 10)
            if name != "-":
                rows.append((str(card), name, f"{column}-{column + width - 1}", KINDS[kind],
                             default or "", TREATMENTS[treatment]))
            column += width
    return found


def keywords_of_the_page():
    """The same, as doc/keywords.md has it."""
    text = (ROOT / "doc/keywords.md").read_text(encoding="utf-8")
    return {keyword.name: [tuple(row[:6]) for row in keyword.fields] for keyword in read_keywords(text)}


READER, PAGE = keywords_of_the_reader(), keywords_of_the_page()


def test_page_has_the_keywords_of_the_reader():
    assert set(READER) == set(PAGE)


@pytest.mark.parametrize("keyword", sorted(READER))
def test_page_has_the_fields_of(keyword):
    assert PAGE[keyword] == READER[keyword]


def test_page_names_what_is_ignored_and_refused():
    text = (ROOT / "doc/keywords.md").read_text(encoding="utf-8")
    ignored, refused = text.split("## Known, without effect")[1].split("## Known, refused")
    for line in table_lines("table_others"):
        keyword, reason = line.split(maxsplit=1)
        assert f"`*{keyword}`" in (ignored if reason.strip() == "ignored" else refused)


#: a field asked for by name, as in `real_of(card, 'FS')`, `find_field(cursor, 1, 'NID')`, `place_t(line, 1, 'LCID')`
ASKED = re.compile(r"\b(?:integer_of|real_of|reals_of|is_blank|is_bad|has_field|place_of|place_t|report_field|refuse_negative|"
                   r"refuse_outside|require_id|check_\w+|hourglass_\w+|note_explicit|find_field|find_keyword_field)"
                   r"\((?:deck, )?\w+(?:%\w+)*(?:\([^()]*\))?(?:, (?:cursor|card|cards\(\d\)|\d))*, '(\w+)'(?:, '(\w+)')?")


def test_fields_asked_for_are_in_the_table():
    fields = {name for rows in READER.values() for _, name, *_ in rows}
    asked = [(source.name, line, name) for source in map(read_source, sorted((ROOT / "src/deck").rglob("*.f90")))
             for line, statement in source.statements for match in ASKED.finditer(statement)
             for name in match.groups() if name and re.fullmatch(r"[A-Z]\w*", name)]
    assert len(asked) > 150
    assert not [place for place in asked if place[2] not in fields]
