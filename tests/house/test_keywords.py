# SPDX-License-Identifier: MIT
"""doc/keywords.md says of every keyword and field what the reader's table says."""
import re
import sys

import pytest

from fortran_source import ROOT, read_source

sys.path.insert(0, str(ROOT / "tools/docs"))

from keyword_pages import WORD, made_page, read_keywords, read_schema, table_lines  # noqa: E402

PAGE = (ROOT / "doc/keywords.md").read_text(encoding="utf-8")
READER, KEYWORDS = read_schema(), read_keywords(PAGE)
#: a clause that is a range or a default
SAID = re.compile(r"(^|[,;] )((above|below|at (most|least)) -?\d\S*|\d\S* or (above|below)|\d\S* to \d\S*|between -?\d\S* and \d\S*"
                  r"|not negative|(negative|others) refused)(?=;|$)")
DEFAULT = re.compile(r"(^|[,;] )0 (is|and blank) -?[\d.e]+(?=;|$)")


def test_page_has_the_keywords_of_the_reader():
    assert set(READER) == {keyword.name for keyword in KEYWORDS}


def test_page_has_the_fields_of_the_reader():
    """Made by tools/docs/keyword_pages.py: run it where this fails."""
    assert made_page(PAGE) == PAGE


@pytest.mark.parametrize("keyword", KEYWORDS, ids=lambda keyword: keyword.name)
def test_honoured_fields_have_a_meaning_and_say_nothing_twice(keyword):
    """Of a row of fields alike, as EPS1 to EPS8, the first has it. Ranges and defaults are the reader's."""
    reported = set()
    for _, name, _, _, default, limits, treatment, meaning in keyword.fields:
        stem = re.sub(r"\d", "", name)
        if meaning:
            reported.add(stem)
        if treatment == "honoured":
            assert stem in reported, name
            assert not (limits and SAID.search(meaning)), (name, limits, meaning)
            assert not (default and DEFAULT.search(meaning)), (name, default, meaning)


def test_ranges_are_written_as_the_reader_reads_them():
    for line in (line for name in ("control", "mesh", "conditions", "contact", "database") for line in table_lines(f"table_{name}")):
        for word in line.split() if line.startswith(" ") else ():
            limits = WORD.fullmatch(word)[6]
            assert not limits or re.fullmatch(r"(\|-?\d+)+|[<>]=?-?[\d.e+-]+(<=?-?[\d.e+-]+)?", limits), word
            assert not limits or len(limits) <= 32 and WORD.fullmatch(word)[3] == "", word


def test_page_names_what_is_ignored_and_refused():
    ignored, refused = PAGE.split("## Known, without effect")[1].split("## Known, refused")
    for line in table_lines("table_others"):
        keywords, reason = line.split(maxsplit=1)
        for keyword in keywords.split(","):
            assert f"`*{keyword}`" in (ignored if reason.strip() == "ignored" else refused)


#: a field asked for by name, as in `real_of(card, 'FS')`, `find_field(cursor, 1, 'NID')`, `location_t(line, 1, 'LCID')`
ASKED = re.compile(r"\b(?:integer_of|real_of|reals_of|is_blank|is_bad|has_field|location_of|location_t|report_field|refuse_negative|"
                   r"refuse_outside|require_id|check_\w+|hourglass_\w+|note_explicit|find_field|find_keyword_field)"
                   r"\((?:deck, )?\w+(?:%\w+)*(?:\([^()]*\))?(?:, (?:cursor|card|cards\(\d\)|\d))*, '(\w+)'(?:, '(\w+)')?")


def test_fields_asked_for_are_in_the_table():
    fields = {row[1] for rows in READER.values() for row in rows}
    asked = [(source.name, line, name) for source in map(read_source, sorted((ROOT / "src/deck").rglob("*.f90")))
             for line, statement in source.statements for match in ASKED.finditer(statement)
             for name in match.groups() if name and re.fullmatch(r"[A-Z]\w*", name)]
    assert len(asked) > 150
    assert not [place for place in asked if place[2] not in fields]
