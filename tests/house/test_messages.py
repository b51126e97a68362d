# SPDX-License-Identifier: MIT
"""tools/docs/messages.py finds the messages of the program: those of every refused deck, and all procedures that report one."""
import re
import sys

from fortran_source import ROOT, read_source

sys.path[:0] = [str(ROOT / "tools/docs"), str(ROOT / "tests/rejected")]

from messages import KIND_OF, KINDS, PARTS, read_messages, tables, template  # noqa: E402
from refused_decks import refused_decks  # noqa: E402

MESSAGES = read_messages()
#: keyword, card, field and its text, ahead of a message
PLACE = re.compile(r"^(\*\w+ ?)?:? ?(card \d+ )?(field \d+ \(\w+\):? ?)?(\".*?\"|blank)?(: )?")


def test_a_template_has_the_text_of_an_expression():
    assert template("'node '//to_text(id)//' is '//trim(merge('in ', 'out', yes))") == "node … is {in|out}"
    assert template("'Young''s modulus'") == "Young's modulus"


def windows(text, n):
    """The runs of n words of the parts of a text."""
    for part in re.split('[…{|}"]', text):
        words = re.findall(r"[A-Za-z*][\w*:-]*", part)
        yield from (tuple(words[k:k + n]) for k in range(len(words) - n + 1))


def test_every_refusal_of_the_test_decks_is_found():
    """Three words that follow each other do so in a message, or two of a short one."""
    found = {window for message in MESSAGES for n in (2, 3) for window in windows(message.text, n)}
    texts = {PLACE.sub("", words) for deck in refused_decks() for _, words in deck.expected()}
    lost = [text for text in texts if len(text.split()) > 1 and "refused, " not in text
            and not any(window in found for window in windows(text, 2 if len(text.split()) < 6 else 3))]
    assert len(texts) > 300 and lost == []


def test_procedures_that_take_messages_are_there():
    sources = [read_source(path) for path in (ROOT / "src").rglob("*.f90")]
    there = {procedure.name for source in sources for procedure in source.procedures}
    bound = {name for source in sources for _, text in source.statements for name in re.findall(r"procedure.*:: (\w+)", text)}
    interfaces = {name for source in sources for _, text in source.statements for name in re.findall(r"^interface (\w+)", text)}
    assert {name.split("%")[-1] for name in KIND_OF} - there - bound - interfaces == set()


def test_every_kind_has_its_table():
    page = tables()
    assert all(f"## {kind}\n" in page for kind in (*KINDS, PARTS))
    assert {message.kind for message in MESSAGES} == {*KINDS, PARTS}
