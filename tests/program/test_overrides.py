# SPDX-License-Identifier: MIT
"""What the command line gives in place of the deck keeps the rules of the deck, and the deck as run says it."""
import re

import pytest
from conftest import drop
from meshes import Deck, grid
from test_implicit import pulled


@pytest.fixture
def said(slideline, tmp_path):
    """said(deck, *words): the status, and all that `check` says of the deck with these words."""
    def call(deck, *words):
        path = tmp_path / "job.k"
        path.write_text(deck if isinstance(deck, str) else deck.text())
        done = slideline("check", str(path), *words)
        return done.returncode, done.stdout + done.stderr
    return call


def as_run(slideline, tmp_path, deck, *words):
    """The deck as run."""
    done = slideline("d=out", *words, deck=deck)
    assert done.returncode == 0, done.stderr
    return (tmp_path / "out/job.effective.k").read_text()


def with_cards(*cards, deck=None):
    """A deck with more cards before its end."""
    return (deck or drop(end_time=0.001)).text().rsplit("*END", 1)[0] + "\n".join(cards) + "\n*END\n"


TABLE = "*DEFINE_TABLE\n{0},\n0.0,\n10.0,\n*DEFINE_CURVE\n12,\n0.0,2.0e4\n1.0,3.0e4\n*DEFINE_CURVE\n13,\n0.0,3.0e4\n1.0,4.0e4"
PIECEWISE = "*MAT_PIECEWISE_LINEAR_PLASTICITY\n5,1000.0,1.0e6,0.3,2.0e4\n0.0,0.0,{0}"


def free_of_curves():
    """A block that flies, without a curve."""
    deck = Deck("flies").control(1.0e-3).part(1).elastic(1000.0, 1.0e6, 0.3)
    deck.mesh(*grid(2, 1))
    return deck.output(glstat=1.0e-4)


@pytest.mark.parametrize("number", [1, 2147483647])
def test_step_beside_a_table_of_any_number(slideline, said, tmp_path, number):
    """The curve of dt= takes no number that a table has."""
    deck = with_cards(TABLE.format(number), PIECEWISE.format(number), deck=free_of_curves())
    status, text = said(deck, "dt=1.0e-6")
    assert status == 0, text
    effective = as_run(slideline, tmp_path, deck, "dt=1.0e-6")
    (tmp_path / "again.k").write_text(effective)
    assert slideline("i=again.k", "d=again").returncode == 0
    assert (tmp_path / "again/again.effective.k").read_text() == effective
    assert (tmp_path / "again/again.glstat.csv").read_bytes() == (tmp_path / "out/job.glstat.csv").read_bytes()


@pytest.mark.parametrize("number", [1, 90000001, 2147483647])
@pytest.mark.parametrize("cards", [
    "*DATABASE_MATSUM\n0.0,0,{0}", PIECEWISE, "*LOAD_BODY_Y\n{0},1.0", "*LOAD_NODE_POINT\n1,1,{0},1.0",
    "*BOUNDARY_PRESCRIBED_MOTION_NODE\n1,1,2,{0},1.0", "*DAMPING_GLOBAL\n{0},1.0"])
def test_reference_to_no_curve_finds_none_with_a_step_either(said, cards, number):
    deck = with_cards(cards.format(number), deck=free_of_curves())
    for words in ((), ("dt=1.0e-6",)):
        status, text = said(deck, *words)
        assert status == 1 and f'"{number}" matches no curve' in text, text


def test_restart_with_changes_does_not_meet_the_curve_of_the_step(slideline, tmp_path):
    deck = with_cards("*DATABASE_BINARY_D3DUMP\n1000000,", deck=free_of_curves())
    as_run(slideline, tmp_path, deck, "dt=1.0e-6")
    (tmp_path / "changes.k").write_text("*CONTROL_TERMINATION\n0.002,\n*DATABASE_GLSTAT\n0.0,0,1\n")
    done = slideline("r=out/job.dump01.h5", "i=changes.k")
    assert done.returncode == 1 and '"1" matches no curve of this deck' in done.stderr
    (tmp_path / "whole.k").write_text(deck.replace("*CONTROL_TERMINATION\n0.001", "*CONTROL_TERMINATION\n0.0012"))
    done = slideline("r=out/job.dump01.h5", "i=whole.k", "dt=1.0e-6")
    assert done.returncode == 0, done.stderr


def slide(card_1, card_2=None):
    """The drop with an interface of other cards."""
    cards = re.sub(r"\*CONTACT_2D[^*]*", "", drop(end_time=0.001).text()).rsplit("*END", 1)[0]
    return f"{cards}*CONTACT_2D_SLIDELINE\n-2,-3,{card_1}\n" + (f"{card_2}\n" if card_2 else "") + "*END\n"


@pytest.mark.parametrize("deck, words", [
    (slide("2,,,"), ("pen=2.0e5",)),
    (slide("2,,-1.0,"), ("pen=2.0e5",)),
    (slide("7,,,"), ("pen=-1", "punit=4")),
    (slide("2,11,2.0e5,"), ("ngauss=3",)),
    (slide("2,,2.0e5,", ",,3"), ("pen=0.5",)),
    (slide("2,,2.0e5,", ",,7"), ("punit=1",)),
    (slide("2,,2.0e5,", ",,0,-1.0"), ("pent=1.0e5",)),
    (slide("2,,2.0e5,", ",,0,,-5.0"), ("vdc=10",)),
    (slide("2,,2.0e5,-0.3"), ("fs=0",)),
    (slide("2,,2.0e5,0.0,-0.3"), ("fd=0",)),
    (slide("2,,2.0e5,0.0,0.0,-2.0"), ("dc=2",)),
    (slide("2,,2.0e5,", ",,\n-1.0,2.0"), ("vc=1.0e5", "tfac=0.5")),
    (slide("2,,2.0e5,").replace("_SLIDELINE\n-2,-3,2,,2.0e5", "_AUTOMATIC_SURFACE_TO_SURFACE\n-2,-3,-1.0"), ("pen=1.5",)),
    (slide("2,,2.0e5,").replace("0.0,0.9,0,0.0,0.0,9001", "0.0,-0.9"), ("tssfac=0.5",)),
    (slide("2,,2.0e5,").replace("0.0,0.9,0,0.0,0.0,9001", "0.0,0.9,0,0.0,0.0,-1"), ("dt=1.0e-4",)),
    (pulled(1.0, dt=0.5).text().replace("*CONTROL_IMPLICIT_GENERAL\n1,0.5", "*CONTROL_IMPLICIT_GENERAL\n1,"), ("dt=0.5",)),
])
def test_blank_or_bad_field_that_the_command_line_gives(slideline, said, tmp_path, deck, words):
    """The deck alone is refused; with the word it runs, and so does the deck as run, to the same bits."""
    assert said(deck)[0] == 1
    status, text = said(deck, *words)
    assert status == 0, text
    (tmp_path / "again.k").write_text(as_run(slideline, tmp_path, deck, *words))
    done = slideline("i=again.k", "d=again")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "again/again.glstat.csv").read_bytes() == (tmp_path / "out/job.glstat.csv").read_bytes()


@pytest.mark.parametrize("card_1, card_2, word, message", [
    ("2,,2.0e5,", ",,0,0.0,101.0", "vdc=101.0", '"{0}101.0" {1}is not a damping in per cent of critical (0 to 100)'),
    ("2,,2.0e5,", ",,\n0.0,1.5", "tfac=1.5", '"{0}1.5" {1}is not a ratio of the tangential to the normal penalty (above 0, at most 1)'),
    ("2,,-1.0,", None, "pen=-1.0", '"{0}-1.0" {1}is not a penalty (more than 0)'),
    ("9,,2.0e5,", None, "ctype=9", '"{0}9" {1}is not a contact type (0 the program chooses, 1 classical NTS, 2 NTS-AR'),
    ("2,11,2.0e5,", None, "ngauss=11", '"{0}11" {1}is not a number of Gauss points (1 to 10)'),
    ("2,,2.0e5,", ",,5", "punit=5", '"{0}5" {1}is not a unit of the penalty (0 force per length at each contact node, 1 stress'),
])
def test_one_rule_for_card_and_command_line(said, card_1, card_2, word, message):
    status, text = said(slide(card_1, card_2))
    assert status == 1 and message.format("", "") in text, text
    status, text = said(slide("2,,2.0e5,"), word)
    assert status == 1 and message.format(word.split("=")[0] + "=", "on the command line ") in text, text
    assert text.count("on the command line") == 1


@pytest.mark.parametrize("scale, word, reported", [("1.2", None, "TSSFAC is above 1: "), ("0.9", "tssfac=1.2", '"tssfac=1.2" on the command line is above 1: '),
                                               ("1.2", "tssfac=0.9", None), ("1.0", "tssfac=1.0", None)])
def test_scale_of_the_step_above_one_is_warned_of(said, scale, word, reported):
    deck = slide("2,,2.0e5,").replace("0.0,0.9,0,0.0,0.0,9001", f"0.0,{scale}")
    status, text = said(deck, *([word] if word else []))
    assert status == 0, text
    assert ("is above 1: the run may become unstable" in text) == bool(reported)
    assert not reported or text.count(reported) == 1


def test_first_step_that_the_curve_overrules_is_warned_of(said):
    plain = slide("2,,2.0e5,")
    deck = plain.replace("0.0,0.9,0,0.0,0.0,9001", "1.0e-5,0.9,0,0.0,0.0,9001")
    assert "DTINIT has no effect with the curve LCTM" in said(deck)[1]
    assert "DTINIT" not in said(plain)[1]
    deck = plain.replace("0.0,0.9,0,0.0,0.0,9001", "1.0e-5,0.9")
    assert "DTINIT" not in said(deck)[1]
    assert 'DTINIT has no effect with "dt=1.0e-4" on the command line' in said(deck, "dt=1.0e-4")[1]


def test_curve_number_below_0_stays_a_mistake_of_an_implicit_deck(said):
    """There dt= replaces DT0 alone: LCTM would stand in the deck as run."""
    deck = with_cards("*CONTROL_TIMESTEP\n0.0,0.9,0,0.0,0.0,-1", deck=pulled(1.0, dt=0.5))
    status, text = said(deck, "dt=0.5")
    assert status == 1 and "LCTM" in text and "is not a curve number" in text, text


@pytest.mark.parametrize("gamma, beta, reported", [("0.6", "", "GAMMA 6.000000E-01 and BETA 2.500000E-01"), ("0.6", "0.3", "3.025000E-01"),
                                               ("0.6", "0.3025", None), ("0.5", "0.25", None), ("", "0.3", None), ("", "", None)])
def test_newmark_that_is_not_stable_at_every_step_is_warned_of(said, gamma, beta, reported):
    """Unconditional stability needs BETA >= (GAMMA + 1/2)^2/4; statics has no such limit."""
    for mass, expected in ((1, reported), (0, None)):
        deck = with_cards(f"*CONTROL_IMPLICIT_DYNAMICS\n{mass},{gamma},{beta}", deck=pulled(1.0, dt=0.5))
        status, text = said(deck)
        assert status == 0, text
        assert ("Newmark's method with" in text) == bool(expected), text
        assert not expected or expected in text


@pytest.mark.parametrize("options, mark, width", [("", "", 10), ("", " +", 20), (" LONG=Y", "", 20), (" LONG=Y", " -", 10), (" I10=Y", "", 10),
                                                  (" LONG=Y", "", 10), (" MEMORY=1000000 " + 80 * "X" + " LONG=Y", "", 20)])
def test_numbers_of_titles_in_every_layout(slideline, tmp_path, options, mark, width):
    """Interface and wall have their number in 10 columns, or 20 in the long layout; and so has the deck as run."""
    deck = slide("2,,2.0e5,").replace("*KEYWORD", "*KEYWORD" + options).replace(
        "*CONTACT_2D_SLIDELINE\n", f"*CONTACT_2D_SLIDELINE_TITLE{mark}\n{21:{width}d}a die, new\n")
    deck = deck.rsplit("*END", 1)[0] + "\n".join(
        [f"*RIGIDWALL_PLANAR_ID{mark}", f"{7:{width}d}a wall", "0,", "0.0,-3.0,0.0,0.0,-2.0,0.0", "*DATABASE_RWFORC", "1.0e-4,", "*END", ""])
    for words in ((), ("pen.21=1.0e5", "dt=5.0e-5")):
        effective = as_run(slideline, tmp_path, deck, *words)
        (tmp_path / "again.k").write_text(effective)
        assert slideline("i=again.k", "d=again").returncode == 0
        assert (tmp_path / "again/again.effective.k").read_text() == effective
        for folder, job in (("out", "job"), ("again", "again")):
            assert 'interface 21 "a die, new": NTS-AR' in (tmp_path / folder / f"{job}.log").read_text()
            assert (tmp_path / folder / f"{job}.rwforc.csv").read_text().splitlines()[1].split(",")[1] == "7"


def test_keyword_of_any_length_is_named_whole(said):
    name = "NO_SUCH_" + 112 * "X"
    status, text = said(with_cards("*" + name))
    assert status == 1 and f"*{name}: is not a keyword" in text
    status, text = said(with_cards("*CONTROL_ENERGY" + 700 * " "))
    assert status == 0, text


def test_keyword_line_that_is_too_long_is_refused(said):
    """A name of a megabyte does not take the memory and the time of a thousand copies; nor is an option dropped."""
    for line in ("*N" + 1000000 * "O", "*KEYWORD" + 600 * " " + "LONG=Y"):
        status, text = said(with_cards(line))
        assert status == 1 and "the line is longer than 512 columns" in text and len(text) < 5000


def test_folder_of_any_length_is_searched(said, tmp_path):
    """A folder of *INCLUDE_PATH of 1500 characters, in lines of 400."""
    folder = tmp_path
    for k in range(6):
        folder = folder / (f"{k}" * 250)
    folder.mkdir(parents=True)
    text = drop(end_time=0.001).text()
    contact = re.search(r"\*CONTACT_2D[^*]*", text)[0]
    (folder / "contact.k").write_text(contact)
    path = str(folder)
    lines = " +\n".join(path[k:k + 400] for k in range(0, len(path), 400))
    status, found = said(text.replace(contact, f"*INCLUDE_PATH\n{lines}\n*INCLUDE\ncontact.k\n"))
    assert status == 0, found


SLIDELINE = "*CONTACT_2D_SLIDELINE\n-2,-3,2,,2.0e5,"
IMPLICIT = SLIDELINE + "\n*CONTROL_IMPLICIT_GENERAL\n1,1.0e-4"
TIE = SLIDELINE + "\n\n,,1"


@pytest.mark.parametrize("cards, words, reported", [
    (IMPLICIT, "tssfac=0.8", "{0} has no effect with the implicit method"),
    (IMPLICIT, "punit=3 pen=0.5", "{0} asks for a share of the largest stable penalty"),
    (SLIDELINE, "tssfac=1.2", "{0} is above 1: the run may become unstable"),
    (SLIDELINE, "dt=5e-5", "DTINIT has no effect with {0}"),
    (SLIDELINE, "punit=4 ctype=7 vdc=5", "{0} asks for implicit springs, which in this version have no damping"),
    (SLIDELINE, "punit=3 pen=2", '{1} is not a share of the largest stable penalty (PUNIT 3: above 0, at most 1)'),
    (SLIDELINE, "punit=3", "card 1 field 5 (PEN): \"2.0e5\" is not a share of the largest stable penalty (PUNIT 3: above 0, at most 1)\n"
                              "  | -2,-3,2,,2.0e5,\n  |          ^^^^^\n  | with {0}"),
    (TIE, "vdc=20", "interface 1 is tied: ties have no contact damping; {0} has no effect on it"),
    (TIE, "punit=3 pen=0.5", "interface 1 is tied: its penalty cannot be a share of the largest stable penalty; {0} has no effect on it"),
    (TIE, "fs=0.1", "interface 1 is tied: {0} has no effect on it"),
    ("", "pen=1e5", "{0} changes PEN of all interfaces, but the deck has none")])
def test_messages_of_words_say_where_they_stand(said, cards, words, reported):
    deck = re.sub(r"\*CONTACT_2D[^*]*", "", drop(end_time=0.001).text()).rsplit("*END", 1)[0] + cards
    deck = deck.replace("0.0,0.9,0,0.0,0.0,9001", "1.0e-5,0.9")
    _, text = said(deck + "\n*END\n", *words.split())
    assert text.count(reported.format(*(f'"{word}" on the command line' for word in words.split()))) == 1, text
