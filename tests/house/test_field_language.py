# SPDX-License-Identifier: MIT
"""The sources speak the field's language: words of pictures are not used in identifiers, nor in comments of these folders."""
import re

import pytest

from fortran_source import ROOT, without_strings

#: no part of an identifier anywhere in src/
NO_NAMES = ("account aside asleep awake caught feet former freight hair hear heed hinders judge judges know lend loan lose "
            "massive namesakes parcel rider riders rub rubbed spot spots tell told twin twins waking").split()
#: not in comments of these folders and files of src/
NO_COMMENTS = re.compile(r"\b(mistakes?|told|tells?|judged|nobody|whoever|hair|namesakes?|heed)\b|^>\s*(The same\b|Its components)",
                         re.I)
FOLDERS = ("base", "deck", "loads", "model", "arguments.f90", "check.f90", "main.f90", "model_tables.f90")

FILES = sorted((ROOT / "src").rglob("*.f90"))


def split(line):
    """Code and comment of a line."""
    code, _, comment = without_strings(line).partition("!")
    return code.lower(), comment


@pytest.mark.parametrize("word", NO_NAMES)
def test_identifiers_are_terms_of_the_field(word):
    part = re.compile(rf"\b(?:\w+_)?{word}(?:_\w+)?\b")
    wrong = [f"{path.relative_to(ROOT)}:{number}: {found[0]}" for path in FILES
             for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
             for found in [part.search(split(line)[0])] if found]
    assert not wrong


def test_comments_are_in_terms_of_the_field():
    wrong = [f"{path.relative_to(ROOT)}:{number}: {found[0]}" for path in FILES
             if path.relative_to(ROOT / "src").parts[0] in FOLDERS
             for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
             for found in [NO_COMMENTS.search(split(line)[1])] if found]
    assert not wrong
