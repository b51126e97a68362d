# SPDX-License-Identifier: MIT
"""What is said of decks that run, and small mistakes that other decks do not make."""
import numpy as np
import pytest
from conftest import drop, numbers
from meshes import Deck, grid


def said_by(slideline, tmp_path, *cards, words=()):
    """Status, and screen and log together, of the drop with more cards behind it."""
    text = drop(end_time=0.001).text().rsplit("*END", 1)[0] + "\n".join(cards) + "\n*END\n"
    done = slideline("d=out", *words, deck=text)
    log = tmp_path / "out" / "job.log"
    return done.returncode, done.stderr + (log.read_text() if log.exists() else "")


POINTS = "0.0,0.1\n2.0e4,3.0e4"
PIECEWISE = "*MAT_PIECEWISE_LINEAR_PLASTICITY\n5,1000.0,1.0e6,0.3,2.0e4,1.0e5\n"
CURVE = "*DEFINE_CURVE\n5,\n0.0,2.0e4\n1.0,3.0e4"
FACTOR = "*DEFINE_CURVE\n6,\n0.0,1.0\n100.0,2.0"
TABLE = "*DEFINE_TABLE\n7,\n0.0,\n10.0,\n*DEFINE_CURVE\n8,\n0.0,2.0e4\n1.0,3.0e4\n*DEFINE_CURVE\n9,\n0.0,3.0e4\n1.0,4.0e4"


@pytest.mark.parametrize("cards, words", [
    ("*CONTROL_HOURGLASS\n4,0.0", "means the default 0.1"),
    ("*MAT_RIGID\n5,1000.0,1.0e6,0.3\n0.0,7,7", "CON1 and CON2 have no effect while CMO is 0"),
    ("*CONTROL_UNITS\nmm,ms,stone", '(MASS): "stone" is not a known unit (kg, g, mg'),
    (PIECEWISE + "0.0,0.0,5\n0.0,0.1\n2.0e4,3.0e4\n" + CURVE, "EPS and ES have no effect where LCSS"),
    (PIECEWISE + "40.0,5.0,7\n" + TABLE, "a table (LCSS) gives the rate effect: LCSR, C and P have none"),
    (PIECEWISE + "40.0,5.0,5,6\n" + CURVE + "\n" + FACTOR, "LCSR gives the rate effect: C and P have none"),
    (PIECEWISE + "0.0,0.0,0,0,1.0", "VP has no effect: the material has no rate effect"),
])
def test_cards_without_effect_are_named(slideline, tmp_path, cards, words):
    status, said = said_by(slideline, tmp_path, cards)
    assert status == 0, said
    assert words in said, said
    assert said.count("warning: ") > 0


@pytest.mark.parametrize("name, needed, card", [
    ("ELOUT", "HISTORY_SHELL", "1"), ("NODFOR", "NODAL_FORCE_GROUP", "2"),
    ("SECFORC", "CROSS_SECTION_SET", "5,,,5\n*SET_SHELL_LIST\n5\n1,2,3\n*SET_NODE_LIST\n5\n2,3")])
def test_a_history_of_nothing_is_named(slideline, tmp_path, name, needed, card):
    """A history without the keyword that says of what was nowhere reported, and there was no file."""
    reported = f"*DATABASE_{name}: asks for a history, but the deck has no *DATABASE_{needed}: no file is written"
    cards = [f"*DATABASE_{name}\n1.0e-4"]
    assert reported in said_by(slideline, tmp_path, *cards)[1]
    assert not (tmp_path / "out" / f"job.{name.lower()}.csv").exists()
    status, said = said_by(slideline, tmp_path, *cards, f"*DATABASE_{needed}\n{card}")
    assert status == 0 and "asks for a history" not in said, said
    assert (tmp_path / "out" / f"job.{name.lower()}.csv").exists()


def test_histories_that_the_model_has_nothing_for_are_named(slideline, tmp_path):
    """No rigid body, no wall: no file, a line of the log and no warning."""
    status, said = said_by(slideline, tmp_path, *(f"*DATABASE_{name}\n1.0e-4" for name in ("RBDOUT", "RWFORC", "SPCFORC")))
    assert status == 0 and "\nrequested without content in the model, not written: rwforc, rbdout\n" in said, said
    assert "warning" not in said and (tmp_path / "out/job.spcforc.csv").exists()


@pytest.mark.parametrize("law, stays", [
    ("*MAT_MOONEY-RIVLIN_RUBBER\n2,1000.0,0.49,3.0e5,1.0e5", True), ("*MAT_BLATZ-KO_RUBBER\n2,1000.0,7.0e5", True),
    ("*MAT_CRUSHABLE_FOAM\n2,1000.0,1.0e6,0.0,9,1.0e4\n*DEFINE_CURVE\n9,\n0.0,1.0e5\n0.9,1.0e6", True),
    ("*MAT_ELASTIC\n2,1000.0,1.0e6,0.3", False), ("*MAT_RIGID\n2,1000.0,1.0e6,0.3", False)])
def test_what_erode_passes_over_is_named(slideline, tmp_path, law, stays):
    """Rubber and foam stay in the mesh: the deck is reported so, whatever else may leave."""
    deck = Deck("two squares").add("*CONTROL_TERMINATION", (1.0e-4,)).add("*CONTROL_TIMESTEP", (0.0, 0.9, 0, 0.0, 0.0, 0, 1))
    deck.add("*SECTION_SHELL", (1, 13), (1.0,)).elastic(1000.0, 1.0e6, 0.3)
    for part in (1, 2):
        deck.add("*PART", f"square {part}", (part, 1, part)).mesh(*grid(1, 1, origin=(2.0 * part, 0.0)), part=part)
    deck.add(law)
    done = slideline("d=out", deck=deck)
    assert done.returncode == 0, done.stderr
    said = (tmp_path / "out" / "job.log").read_text()
    assert ("ERODE does not erode part 2, which is rubber or foam" in said) == stays, said


@pytest.mark.parametrize("cards, words, line", [
    ("*PARAMETER_EXPRESSION\n,2*3", "a parameter needs a name", ()),
    ("*PARAMETER\nR stiff,2.0", 'p:STIFF on the command line: "hard" is not a number', ("p:stiff=hard",)),
    ("", "is not a share of the largest stable penalty", ("punit=3", "pen=2.0")),
])
def test_small_mistakes(slideline, tmp_path, cards, words, line):
    status, said = said_by(slideline, tmp_path, cards, words=line)
    assert status == 1 and words in said, said


def test_a_deck_of_many_parameters_with_a_byte_order_mark(slideline, tmp_path):
    """Twenty parameters, more than a list starts with; one given as +2.0 is taken as -2.0 by a minus before its name."""
    text = drop(end_time=0.001).text()
    names = "\n".join(f"R name{k:02d},+{k}.5" for k in range(20))
    parametric = text.replace("*CONTROL_TERMINATION", f"*PARAMETER\n{names}\nR   down,+2.0\n*CONTROL_TERMINATION", 1)
    assert "0.3,-2.0" in parametric
    parametric = parametric.replace("0.3,-2.0", "0.3,-&down")
    (tmp_path / "marked.k").write_bytes(b"\xef\xbb\xbf" + parametric.encode())
    assert slideline("i=marked.k", "d=marked").returncode == 0
    assert slideline("d=plain", deck=text).returncode == 0
    assert (tmp_path / "marked/marked.glstat.csv").read_bytes() == (tmp_path / "plain/job.glstat.csv").read_bytes()


def test_all_nodes_at_one_height(slideline, tmp_path):
    """A plane at z = 0.5 is as good as one at 0, and is said to be ignored."""
    deck = Deck("raised").control(1.0e-3, dt=1.0e-4).part(1).elastic(1000.0, 1.0e6, 0.3)
    deck.mesh(*grid(2, 1))
    text = deck.output(glstat=1.0e-4).text()
    raised = "\n".join(line + ",0.5" if line.count(",") == 2 and at in range(start, stop) else line
                       for (start, stop) in [node_lines(text)] for at, line in enumerate(text.splitlines()))
    done = slideline("d=out", deck=raised)
    assert done.returncode == 0, done.stderr
    assert "z is the same for all nodes and is ignored" in done.stderr + (tmp_path / "out/job.log").read_text()


def node_lines(text):
    """First line and line behind the last one of the nodes."""
    lines = text.splitlines()
    start = lines.index("*NODE") + 1
    stop = next(at for at in range(start, len(lines)) if lines[at].startswith("*"))
    return start, stop


def test_round_off_of_a_mesher_is_no_height(slideline, tmp_path):
    """z of one node is off by 1e-9 of the mesh."""
    lines = drop(end_time=0.001).text().splitlines()
    first = lines.index("*NODE") + 2
    lines[first] = ",".join(lines[first].split(",")[:3]) + ",1.0e-9"
    done = slideline("d=out", deck="\n".join(lines) + "\n")
    assert done.returncode == 0, done.stderr


def test_more_mistakes_than_are_reported(slideline, tmp_path):
    """1100 sets that are not there: the first in words, all of them in its count and in the sum."""
    text = drop().text().rsplit("*END", 1)[0]
    text += "".join(f"*BOUNDARY_SPC_SET\n{1000 + k},0,1,1\n" for k in range(1100)) + "*END\n"
    done = slideline("d=out", deck=text)
    assert done.returncode == 1
    assert "refused, 1100 errors" in done.stderr
    assert done.stderr.count("BOUNDARY_SPC_SET card") == 1
    first = len(drop().text().rsplit("*END", 1)[0].splitlines()) + 2
    places = ", ".join(f"{tmp_path / 'job.k'}:{first + 2 * k}" for k in range(3))
    assert f"\n  | 1100 times: {places} and so on\n" in done.stderr


def test_names_of_the_alternative_spelling(slideline, tmp_path):
    """SET_PART is SET_PART_LIST and DATABASE_D3PLOT is DATABASE_BINARY_D3PLOT."""
    text = drop(end_time=0.002).text()
    assert "*DATABASE_BINARY_D3PLOT" in text
    other = text.replace("*DATABASE_BINARY_D3PLOT", "*DATABASE_D3PLOT").rsplit("*END", 1)[0]
    assert slideline("d=other", deck=other + "*SET_PART\n4,\n1,2\n*END\n").returncode == 0
    assert slideline("d=plain", deck=text).returncode == 0
    assert np.array_equal(numbers(tmp_path / "other/job.glstat.csv", "time"),
                          numbers(tmp_path / "plain/job.glstat.csv", "time"))
    assert (tmp_path / "other/job.vtkhdf").exists()


def factors(factor):
    """A block, moved and loaded in all ways that have a factor SF on a curve, and a rigid square."""
    deck = Deck("factors").control(2.0e-2, dt=1.0e-4).part(1).part(2)
    deck.elastic(1000.0, 1.0e6, 0.3).add("*MAT_RIGID", (2, 1000.0, 1.0e6, 0.3))
    nodes = deck.mesh(*grid(4, 2, 2.0, 1.0)).tolist()
    deck.mesh(*grid(1, 1, origin=(5.0, 0.0)), part=2)
    deck.node_set(1, nodes[:5]).node_set(2, nodes[7:9]).curve(1, [(0.0, 0.0), (1.0, 1.0)]).curve(2, [(0.0, 40.0), (1.0, 60.0)])
    deck.add("*SET_SEGMENT", (1,), (nodes[12], nodes[11])).add("*BOUNDARY_PRESCRIBED_MOTION_NODE", f"{nodes[10]},1,0,1,{factor}")
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", f"1,2,2,1,{factor}").add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", f"2,1,0,1,{factor}")
    deck.add("*LOAD_RIGID_BODY", f"2,2,2,{factor}").add("*LOAD_NODE_POINT", f"{nodes[6]},1,2,{factor}")
    deck.add("*LOAD_NODE_SET", f"2,1,2,{factor}").add("*LOAD_SEGMENT", f"2,{factor},0.0,{nodes[14]},{nodes[13]}")
    deck.add("*LOAD_SEGMENT_SET", f"1,2,{factor}").add("*LOAD_BODY_X", f"2,{factor}").add("*LOAD_BODY_Y", f"2,{factor}")
    deck.add("*DAMPING_PART_MASS", f"1,2,{factor}").add("*DATABASE_BINARY_RUNRSF", (100,)).add("*DATABASE_BNDOUT", (1.0e-3,))
    deck.add("*DATABASE_RBDOUT", (1.0e-3,))
    return deck.output(glstat=1.0e-3, nodout=1.0e-3, nodes=nodes)


def tables(folder):
    return [(folder / f"job.{name}.csv").read_bytes() for name in ("glstat", "nodout", "bndout", "rbdout")]


def test_a_factor_of_zero_is_one(slideline, tmp_path):
    """SF 0.0 and blank of motions and loads is 1, also in the deck as run and in a restart; one line of the log names them."""
    for name, factor in (("zero", "0.0"), ("blank", ""), ("one", "1.0"), ("two", "2.0")):
        done = slideline(f"d={name}", deck=factors(factor))
        assert done.returncode == 0 and "warning" not in done.stderr, done.stderr
    expected = tables(tmp_path / "one")
    assert tables(tmp_path / "zero") == expected and tables(tmp_path / "blank") == expected
    assert all(other != one for other, one in zip(tables(tmp_path / "two"), expected))
    said = [line for line in (tmp_path / "zero/job.log").read_text().splitlines() if line.startswith("a 0 in these fields")]
    assert len(said) == 1 and said[0].count("SF = 1 of *") == 11 and "SF = 1 of *LOAD_BODY_Y (" in said[0], said
    assert "a 0 in these fields" not in (tmp_path / "one/job.log").read_text() + (tmp_path / "blank/job.log").read_text()
    assert slideline("i=zero/job.effective.k", "jobid=job", "d=again").returncode == 0
    assert tables(tmp_path / "again") == expected
    assert slideline("d=half", "endtim=0.01", deck=factors("0.0")).returncode == 0
    assert slideline("r=half/job.runrsf.h5", "endtim=0.02", "d=half").returncode == 0
    assert numbers(tmp_path / "half/job.nodout.csv", "uy").tolist() == numbers(tmp_path / "one/job.nodout.csv", "uy").tolist()


@pytest.mark.parametrize("cards, field", [
    ("*CONTROL_DYNAMIC_RELAXATION\n0,0.0,0.0", "NRCYCK = 250"), ("*CONTROL_IMPLICIT_AUTO\n1,0,0", "ITEWIN = 5"),
    ("*DEFINE_CURVE\n7,0,0.0,0.0\n0.0,1.0\n1.0,2.0", "SFO = 1"),
    ("*MAT_JOHNSON_COOK\n7,1.0,1.0,2.6,0.3\n1.0,1.0,1.0,0,1.0,2.0,1.0,1.0\n1.0,-1.0,0.0,0,1.0\n0,0,0,0.0", "EFMIN = 1.000000E-06")])
def test_a_zero_of_other_fields_is_their_default(slideline, tmp_path, cards, field):
    status, said = said_by(slideline, tmp_path, cards)
    assert status == 0 and f"{field} of *" in said, said


def test_a_zero_that_is_kept_is_named(slideline, tmp_path):
    """Bulk viscosity of a written 0 is none; LS-DYNA would take 1.5 and 0.06."""
    status, said = said_by(slideline, tmp_path, "*CONTROL_BULK_VISCOSITY\n0.0,0.0")
    assert status == 0 and "a 0 in these fields means 0, where LS-DYNA takes the default: Q1 = 1.500000E+00 of *CONTROL_BULK_VISCOSITY (" in said, said
    assert not np.any(numbers(tmp_path / "out/job.glstat.csv", "viscous"))


def test_damping_of_foam_is_left_out(slideline, tmp_path):
    """DAMP of two foams: one warning that says what is left out, and the bits of a deck without it."""
    def foams(damp):
        deck = Deck("foams").control(2.0e-3, dt=1.0e-4).part(1).part(2).curve(9, [(0.0, 1.0e3), (0.8, 1.0e5)])
        for part in (1, 2):
            nodes = deck.mesh(*grid(2, 2, origin=(2.0 * part, 0.0)), part=part).tolist()
            deck.add("*MAT_CRUSHABLE_FOAM", f"{part},100.0,1.0e6,0.0,9,1.0e3,{damp}").fix(nodes[:3], y=1)
            deck.add("*INITIAL_VELOCITY_NODE", *[(node, 0.0, -5.0) for node in nodes[6:]])
        return deck.output(glstat=1.0e-4)
    done = slideline("d=damped", deck=foams("0.1"))
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("warning: ") == 1 and '(DAMP): "0.1" has no effect here: the rate effect of the foam (viscous damping) is not included' in done.stderr
    assert slideline("d=plain", deck=foams("")).stderr == ""
    assert (tmp_path / "damped/job.glstat.csv").read_bytes() == (tmp_path / "plain/job.glstat.csv").read_bytes()


@pytest.mark.parametrize("zeros", ["       0.0       0.0       0.0       0.0       0.0       0.0", "0,0,0,0,0,0", "0.000E+00,0.0"])
def test_a_second_card_of_zeros_of_part_damping_is_read_over(slideline, tmp_path, zeros):
    for name, rows in (("with", f"1,7,1.0,0\n{zeros}\n2,7\n{zeros}"), ("without", "1,7,1.0,0\n2,7")):
        text = drop(end_time=0.001).text().rsplit("*END", 1)[0]
        text += f"*DEFINE_CURVE\n7,\n0.0,50.0\n1.0,50.0\n*DAMPING_PART_MASS\n{rows}\n*END\n"
        done = slideline(f"d={name}", deck=text)
        assert done.returncode == 0 and done.stderr == "", done.stderr
    assert (tmp_path / "with/job.glstat.csv").read_bytes() == (tmp_path / "without/job.glstat.csv").read_bytes()
    assert numbers(tmp_path / "with/job.glstat.csv", "damping")[-1] > 0.0
