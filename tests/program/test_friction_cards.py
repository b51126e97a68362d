# SPDX-License-Identifier: MIT
"""Cards that give friction: which one counts, and what is warned of."""
import re

import pytest
from conftest import drop

INTERFACE = re.compile(r"^interface (\d+).*\(type|^  friction: coefficient ([^ ;,]+)", re.M)


def deck(cards, control=None):
    """The drop with other contact cards; `control` is card 3 of *CONTROL_CONTACT."""
    text = re.sub(r"\*CONTACT_2D[^*]*", "", drop(end_time=0.001).text()).rsplit("*END", 1)[0]
    return text + cards + (f"*CONTROL_CONTACT\n\n\n{control}\n" if control else "") + "*END\n"


def ours(friction="", card_3=""):
    return f"*CONTACT_2D_SLIDELINE\n-2,-3,2,,2.0e5,{friction}\n" + (f",,\n{card_3}\n" if card_3 else "")


def stock(friction="", card_3="", name="AUTOMATIC_NODE_TO_SURFACE"):
    return f"*CONTACT_2D_{name}\n-2,-3,1.0,0,{friction}\n" + (f",,\n{card_3}\n" if card_3 else "")


@pytest.fixture
def asked(slideline, tmp_path):
    """(interface, coefficient at rest) of all friction that the log tells of, and all that is said."""
    def check(text, *words):
        (tmp_path / "deck.k").write_text(text)
        done = slideline("check", "i=deck.k", *words)
        found, interface = [], 0
        if done.returncode:
            return found, done.stdout + done.stderr
        assert slideline("i=deck.k", *words).returncode == 0
        for number, coefficient in INTERFACE.findall((tmp_path / "deck.log").read_text()):
            interface = int(number or interface)
            if coefficient:
                found.append((interface, float(coefficient)))
        return found, done.stdout + done.stderr
    return check


STOCK = ["AUTOMATIC_NODE_TO_SURFACE", "AUTOMATIC_ONE_WAY_SURFACE_TO_SURFACE", "AUTOMATIC_SURFACE_TO_SURFACE",
         "AUTOMATIC_SURFACE_TO_SURFACE_MORTAR"]


@pytest.mark.parametrize("name", STOCK)
def test_stock_cards_ask_for_friction(asked, name):
    assert asked(deck(stock("0.3", name=name)))[0] == [(1, 0.3)]
    assert asked(deck(stock("", "1.0e5", name=name)))[0] == []


@pytest.mark.parametrize("cards, control, words, expected", [
    (ours(), None, (), []),
    (ours("0.3"), None, (), [(1, 0.3)]),
    (ours("0.0,0.3"), None, (), [(1, 0.0)]),
    (ours("0.3"), None, ("fs=0",), []),
    (ours("0.3,0.2,1.0"), None, ("fs=0",), [(1, 0.0)]),
    (ours("0.3,0.2,1.0"), None, ("fs=0", "fd=0"), []),
    (ours() + stock(), None, ("fs.2=0.3",), [(2, 0.3)]),
    (stock("0.3,0.0,2.0"), None, ("fs=0",), []),
    (ours() + stock(), "0.4,", (), [(2, 0.4)]),
    (stock() + stock("", "1.0e5"), "0.4,", (), [(1, 0.4)]),
    (stock("0.1") + stock(), "0.0,0.2", (), [(1, 0.1), (2, 0.0)]),
    (stock(), "0.4,", ("fs=0",), []),
    ("*CONTACT_2D_PENALTY_FRICTION\n2,3\n,\n0.3,\n", "0.4,", (), [(1, 0.3)]),
    ("*CONTACT_2D_PENALTY_FRICTION\n2,3\n,\n0.3,0.3,0.3\n", None, ("fs=0",), []),
    ("*CONTACT_2D_PENALTY_FRICTION\n2,3\n,\n,0.3,0.3\n", None, (), [(1, 0.3)]),
])
def test_friction_that_counts(asked, cards, control, words, expected):
    found, said = asked(deck(cards, control), *words)
    assert found == expected, said


@pytest.mark.parametrize("cards, control, words, warning", [
    (ours("0.2,0.3,1.0"), None, (), '(FD) of interface 1, "3.000000E-01", is above the static one (FS), "2.000000E-01"'),
    (ours("0.2,0.3,1.0"), None, ("fs=0.4",), None),
    (ours("0.3,0.2,1.0"), None, ("fs=0.1",), "is above the static one (FS)"),
    (ours("0.3,0.2"), None, (), "without a decay (DC) the friction of interface 1 is static (FS) at any speed: the dynamic coefficient (FD) has no effect"),
    (stock("0.3"), None, (), None),
    (ours("", "1.0e5"), None, (), "the limit of the friction stress (VC) of interface 1 has no effect without"),
    (ours(), "0.4,", (), '(SFRIC): "0.4" has no effect here: it is the friction of *CONTACT_2D_AUTOMATIC_ cards'),
    (stock("0.1"), "0.4,", (), '(SFRIC): "0.4" has no effect here'),
    (stock(), "0.4,", (), None),
])
def test_friction_that_is_likely_not_meant(asked, cards, control, words, warning):
    said = asked(deck(cards, control), *words)[1]
    assert said.count("warning: ") == bool(warning), said
    assert not warning or warning in said, said


def test_a_zero_in_tfac_is_the_default(slideline, tmp_path):
    """As on a zero-filled card of LS-DYNA: the friction of a blank TFAC, bit for bit."""
    found = []
    for card_3 in ("", "0.0,0.0,0,0.0"):
        assert slideline(deck=deck(ours("0.3", card_3))).returncode == 0
        log = (tmp_path / "job.log").read_text()
        found.append((log.count("tangential penalty 1.000000E+00 of the normal one"), (tmp_path / "job.rcforc.csv").read_bytes()))
    assert found[0][0] == 1 and found[0] == found[1]


@pytest.mark.parametrize("word", ["fs=-0.1", "fd=-0.1", "dc=-1", "vc=-1", "fs=x", "tfac=0"])
def test_no_friction_on_the_command_line(asked, word):
    said = asked(deck(ours()), word)[1]
    assert f'"{word}" on the command line: the value is not a number ' in said
    assert ("of 0 or more" in said) == (not word.startswith("tfac"))
