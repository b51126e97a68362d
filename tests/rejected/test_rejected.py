# SPDX-License-Identifier: MIT
"""Every refused deck ends with status 1, says each refusal with its line and its words and no other, and leaves no results."""
import os
import re
import subprocess
from pathlib import Path

import pytest

from refused_decks import HERE, Refused, refused_decks

#: what a checked build says of itself; some sanitisers end with status 1 too
CRASH = re.compile(r"Sanitizer|runtime error|received signal|Backtrace for this error", re.IGNORECASE)
TIME_LIMIT = 60
DECKS = refused_decks()


def wrong(deck: Refused, status: int, said: str, left: list[str]) -> list[str]:
    """What is wrong with the way the program refused a deck."""
    found = [] if status == 1 else [f"exit status {status}, expected 1"]
    messages = [line for line in said.splitlines()
                if not line.startswith(("  |", "warning:")) and "refused, " not in line]
    for line, words in sorted(deck.expected(), key=lambda refusal: -len(refusal[1])):
        start = f"{deck.name}.k:{line}: " if line else ""
        message = next((text for text in messages if text.startswith(start) and words in text), None)
        if message is not None:
            messages.remove(message)
        elif line or words not in said:
            found.append(f"not said: {start}{words}")
    found += [f"said too: {text}" for text in messages]
    if CRASH.search(said):
        found.append("the program crashed")
    return found + [f"left behind: {name}" for name in left]


@pytest.fixture(scope="module", name="work")
def work_folder(tmp_path_factory):
    """One folder for all decks: pytest takes longer to make one for each than the program to refuse a deck."""
    return tmp_path_factory.mktemp("refused")


@pytest.mark.parametrize("deck", DECKS, ids=lambda deck: f"{deck.family}-{deck.name}")
def test_refused(deck, work):
    assert deck.expected()
    folder = deck.folder
    if folder == HERE:  # made from a table
        folder = work
        (folder / f"{deck.name}.k").write_text(deck.text, encoding="latin-1")
    out = work / deck.name
    run = subprocess.run([os.path.abspath(os.environ["SLIDELINE"]), f"i={deck.name}.k", f"d={out}"], cwd=folder,
                         capture_output=True, timeout=TIME_LIMIT, stdin=subprocess.DEVNULL, check=False)
    said = run.stderr.decode("utf-8", errors="replace")
    assert wrong(deck, run.returncode, said, [path.name for path in out.rglob("*.vtkhdf")]) == [], said


@pytest.mark.parametrize("base", sorted(HERE.glob("*.k")), ids=lambda path: path.stem)
def test_the_deck_that_is_edited_is_accepted(base):
    run = subprocess.run([os.environ["SLIDELINE"], "check", base], capture_output=True, text=True, check=False)
    assert run.returncode == 0 and " 0 warnings" in run.stdout and base.with_suffix(".txt").is_file()


def test_names_and_titles():
    assert len({deck.name for deck in DECKS}) == len(DECKS) > 270
    assert sum(deck.family == "examples" for deck in DECKS) == 21


DECK = Refused("bad", "mesh", "$^ refused, 1 error\n*NODE\n$ a comment\n$^ no such part\n", Path())


@pytest.mark.parametrize("status, said, left, why", [
    (1, "bad.k:2: *NODE: no such part: 7\n  | *NODE\nbad.k: refused, 1 error", [], []),
    (0, "bad.k:2: no such part\nrefused, 1 error", [], ["exit status 0, expected 1"]),
    (1, "bad.k:2: no such set\nrefused, 1 error", [],
     ["not said: bad.k:2: no such part", "said too: bad.k:2: no such set"]),
    (1, "bad.k:3: no such part\nrefused, 1 error", [],
     ["not said: bad.k:2: no such part", "said too: bad.k:3: no such part"]),
    (1, "bad.k:2: no such part\nrefused, 2 errors", [], ["not said: refused, 1 error"]),
    (1, "bad.k:2: no such part\nbad.k:2: no such part\nrefused, 1 error", [], ["said too: bad.k:2: no such part"]),
    (1, "bad.k:2: no such part\nrefused, 1 error\n  | AddressSanitizer: heap", [], ["the program crashed"]),
    (1, "bad.k:2: no such part\nrefused, 1 error", ["x.vtkhdf"], ["left behind: x.vtkhdf"])])
def test_anything_else_fails(status, said, left, why):
    assert wrong(DECK, status, said, left) == why


def test_line_of_a_refusal():
    """Comments are no line of a deck, and what comes before its first keyword is none either."""
    assert DECK.expected() == [(0, "refused, 1 error"), (1 + 1, "no such part")]
