# SPDX-License-Identifier: MIT
"""The sources speak the field's language: words of pictures are not used in identifiers, nor in comments of these folders."""
import functools
import pathlib
import re

import pytest

from fortran_source import ROOT, without_strings

#: no part of an identifier anywhere in src/
NO_NAMES = ("account aside asleep awake caught feet former freight hair hear heed hinders judge judges know lend loan lose "
            "massive namesakes parcel rider riders rub rubbed spot spots tell told twin twins waking").split()
#: not in comments of src/
NO_COMMENTS = re.compile(r"\b(asleep|awake|caught|feet|foretold|freight|hair|heed|judged|lends?|let go|loans?|mistakes?|namesakes?|"
                         r"nobody|parcel|riders?|rub(s|bed)?|settled?|spots?|tells?|told|twins?|whoever)\b|"
                         r"^>\s*(The same\b|Its components)", re.I)
#: no words of tests/ and tools/, where they are no longer part of texts that are compared
NO_WORDS = re.compile(r"(?<![a-z])(told|namesakes?|heed|nobody|twins?|lend|loan)(?![a-z])", re.I)

FILES = sorted((ROOT / "src").rglob("*.f90"))


@functools.cache
def lines():
    """Place, code and comment of each line of src/."""
    found = []
    for path in FILES:
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            code, _, comment = without_strings(line).partition("!")
            found.append((f"{path.relative_to(ROOT)}:{number}", code.lower(), comment))
    return found


@pytest.mark.parametrize("word", NO_NAMES)
def test_identifiers_are_terms_of_the_field(word):
    part = re.compile(rf"\b(?:\w+_)?{word}(?:_\w+)?\b")
    wrong = [f"{place}: {found[0]}" for place, code, _ in lines() if word in code for found in [part.search(code)] if found]
    assert not wrong


def test_comments_are_in_terms_of_the_field():
    wrong = [f"{place}: {found[0]}" for place, _, comment in lines() for found in [NO_COMMENTS.search(comment)] if found]
    assert not wrong


def test_tests_and_tools_are_in_terms_of_the_field():
    files = [path for folder in ("tests", "tools") for kind in ("*.py", "*.pf", "*.md", "*.toml")
             for path in sorted((ROOT / folder).rglob(kind)) if path != pathlib.Path(__file__)]
    wrong = [f"{path.relative_to(ROOT)}:{number}: {found[0]}" for path in files
             for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
             for found in [NO_WORDS.search(line)] if found]
    assert not wrong
