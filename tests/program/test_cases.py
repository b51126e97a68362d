# SPDX-License-Identifier: MIT
"""*CASE: several runs of one deck."""
import json
import re

import pytest
from conftest import drop

HEAD = """*CASE
       101 slow
dt=5e-5 memory=20m
         1         3
*CASE
102 fast

         2         3
*CASE
         7

         4
"""
BLOCKS = {1: "*INITIAL_VELOCITY\n1,\n0.3,-1.0", 2: "*INCLUDE\nfast.inc", 3: "*TITLE\nof two cases",
          4: "*PARAMETER\nR low,-4.0\n*INITIAL_VELOCITY\n1,\n0.3,&low"}
VELOCITY = "*INITIAL_VELOCITY\n1,\n0.3,-2.0\n"


def block(number):
    """Between marks, or by the option behind the name."""
    if number == 1:
        return BLOCKS[1].replace("VELOCITY\n", "VELOCITY CID=1\n") + "\n"
    return f"*CASE_BEGIN_{number}\n{BLOCKS[number]}\n*CASE_END_{number}\n"


def cases_deck(end_time=0.002):
    """The drop with its velocity by case: blocks where the plain deck has it, cases behind them."""
    text = drop(end_time=end_time).text()
    text = re.sub(r"\*INITIAL_VELOCITY\n.*\n.*\n", "".join(map(block, BLOCKS)), text)
    assert text.count("*CASE_BEGIN") == 3 and text.count("CID=1\n") == 1
    return text.replace("*END", HEAD + "*END")


def plain_deck(numbers):
    """The same with the keywords of some blocks alone."""
    text = re.sub(r"\*CASE\n.*(?=\*END)", "", cases_deck(), flags=re.S)
    for number in BLOCKS:
        text = text.replace(block(number), BLOCKS[number] + "\n" if number in numbers else "")
    assert "CASE" not in text
    return text


@pytest.fixture
def fast(tmp_path):
    (tmp_path / "fast.inc").write_text("*INITIAL_VELOCITY\n1,\n0.3,-3.0\n")


@pytest.fixture
def check(slideline, tmp_path, fast):
    """check(deck, *words): the answer of `slideline check` to a deck job.k."""
    def call(deck, *words):
        (tmp_path / "job.k").write_text(deck)
        return slideline("check", "job.k", *words)
    return call


def tables(folder, job):
    return {path.name[len(job):]: path.read_bytes() for path in folder.glob(f"{job}.*.csv") if "timing" not in path.name}


def test_all_cases_have_the_bits_of_decks_of_their_own(slideline, tmp_path, fast):
    done = slideline("d=all", "case", deck=cases_deck())
    assert done.returncode == 0, done.stderr
    assert re.findall(r"^case .*", done.stdout, re.M) == ["case 101 (slow)", "case 102 (fast)", "case 7 (case7)"]
    assert done.stdout.count("N o r m a l") == 3
    different = set()
    for job, numbers, words in (("slow", (1, 3), ["dt=5e-5"]), ("fast", (2, 3), []), ("case7", (4,), [])):
        own = slideline("d=own", f"jobid={job}", *words, deck=plain_deck(numbers))
        assert own.returncode == 0, own.stderr
        assert len(tables(tmp_path / "all", job)) > 3
        assert tables(tmp_path / "all", job) == tables(tmp_path / "own", job)
        effective = (tmp_path / "all" / f"{job}.effective.k").read_text()
        assert "CASE" not in effective and effective == (tmp_path / "own" / f"{job}.effective.k").read_text()
        different.add((tmp_path / "all" / f"{job}.nodout.csv").read_bytes())
    assert len(different) == 3
    assert "of two cases" in (tmp_path / "all/slow.effective.k").read_text()
    again = slideline("i=all/fast.effective.k", "d=again", "jobid=fast")
    assert again.returncode == 0 and tables(tmp_path / "again", "fast") == tables(tmp_path / "all", "fast")


def test_some_cases_and_their_names(slideline, tmp_path, fast):
    done = slideline("d=out", "case=7,101", "quiet=1", deck=cases_deck())
    assert done.returncode == 0, done.stderr
    assert re.findall(r"^case .*", done.stdout, re.M) == ["case 7 (case7)", "case 101 (slow)"]
    assert not list((tmp_path / "out").glob("fast.*"))
    # A file of another case need not be there; one of this case has to be.
    (tmp_path / "fast.inc").unlink()
    assert slideline("d=named", "case=7", "jobid=own", deck=cases_deck()).returncode == 0
    assert {path.name.split(".")[0] for path in (tmp_path / "named").iterdir()} == {"own"}
    done = slideline("case=102", deck=cases_deck())
    assert done.returncode == 1 and 'the file "fast.inc" was not found' in done.stderr


@pytest.mark.parametrize("words, told", [
    ([], "the deck has cases: say case=ID for one of 101 (slow), 102 (fast), 7 (case7), or case for all"),
    (["case=3"], "case=3: expected one of 101 (slow), 102 (fast), 7 (case7)"),
    (["case=7,7"], 'case="7,7": 7 is given twice'),
    (["case="], 'case="": expected a number from 1'),
    (["case=all"], 'case="all": expected a number from 1'),
    (["case", "case=7"], "case (all cases) and case= (some) do not go together"),
    (["case", "jobid=x"], "jobid= on the command line would be the name of 3 cases"),
])
def test_words_that_are_refused(slideline, fast, words, told):
    done = slideline("d=out", *words, deck=cases_deck())
    assert done.returncode == 1 and told in done.stderr


def test_a_deck_without_cases(slideline):
    done = slideline("d=out", "case=1", deck=drop(end_time=0.002))
    assert done.returncode == 1 and "case= is asked for and the deck has no *CASE" in done.stderr
    done = slideline("d=out", "case", deck=drop(end_time=0.002))
    assert done.returncode == 0 and done.stderr == "warning: without effect on the command line: case\n"


def test_commands_of_a_case(slideline, fast):
    """What may not stand there has file, line, card and field; the command line wins over the rest."""
    deck = cases_deck().replace("dt=5e-5 memory=20m", "dt=5e-5 i=x.k ncycle=5 ncpu=0")
    done = slideline("case=101", deck=deck)
    assert done.returncode == 1
    assert re.search(r'job\.k:\d+: \*CASE card 2 field 1 \(COMMANDS\): ', done.stderr)
    for told in ('"i=x.k" may not stand there', '"ncycle=5" may not stand there', 'ncpu="0": expected a number'):
        assert told in done.stderr
    done = slideline("case=101", deck=cases_deck().replace("dt=5e-5", "td=5e-5 ncup=2 ctpye=3"))
    assert re.findall(r"an override; did you mean (\w+)=", done.stderr) == ["dt", "ncpu", "ctype"], done.stderr
    done = slideline("case=101", "dt=4e-5", deck=cases_deck())
    assert done.returncode == 0 and re.search(r"Problem cycle +?= 50\b", done.stdout), done.stdout


def test_no_case_runs_where_one_is_refused(slideline, tmp_path, fast):
    """Mistakes that cases share are told once."""
    deck = cases_deck().replace("R low,-4.0", "R lower,-4.0").replace("*CASE\n       101", "*BOUNDARY_NONE\n*CASE\n       101")
    done = slideline("d=out", "case", deck=deck)
    assert done.returncode == 1
    assert "case 101 (slow), case 102 (fast):\n" in done.stderr and "\ncase 7 (case7):\n" in done.stderr
    assert "is not defined by any *PARAMETER" in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("number, words", [("102", ["case=101"]), ("  0", ["case=101"]), ("  0", ["case"]), ("102", [])])
def test_words_of_every_case_are_told_at_once(slideline, fast, number, words):
    """Of one that is not run too, or has no number; a value that no deck takes has its line as well."""
    deck = cases_deck().replace("102 fast\n\n", f"{number} fast\nncpu=0 pen=-x vdc=1 i=x.k\n")
    deck = deck.replace("*PART\n", "*BOUNDARY_NONE\n*PART\n", 1)
    done = slideline("d=out", *words, deck=deck)
    told = re.findall(r'^\S*job\.k:\d+: (\*\w+ .*)', done.stderr, re.M)
    place = '*CASE card 2 field 1 (COMMANDS): "ncpu=0 pen=-x vdc=1 i=x.k" '
    assert done.returncode == 1
    assert [text for text in told if "COMMANDS" in text] == [place + text for text in (
        'ncpu="0": expected a number from 1 to 1024', '"pen=-x": the value is not a number other than 0 (numbers reach 1e40)',
        '"i=x.k" may not stand there: expected ncpu=, perthread= or an override')], done.stderr
    assert len([text for text in told if "CASEID" in text]) == (number == "  0")
    assert "*BOUNDARY_NONE: " in done.stderr


def test_words_that_need_the_model_are_told_beside_wrong_ones(slideline, fast):
    """Good words of COMMANDS change the deck that is judged, and what is wrong with them says where they stand."""
    deck = cases_deck().replace("dt=5e-5 memory=20m", "ncpu=0 ctype=77 ctype.9=5 tfac=2 p:lwo=1")
    deck = deck.replace("*PART\n", "*BOUNDARY_NONE\n*PART\n", 1)
    done = slideline("case=101", "pen=1e9", "punit=8", deck=deck)
    assert done.returncode == 1
    for told in ('(COMMANDS): "ncpu=0 ctype=77 ctype.9=5 tfac=2 p:lwo=1" ncpu="0": expected', "p:LWO in COMMANDS of *CASE: the deck has no", '*BOUNDARY_NONE: ',
                 '"ctype=77" in COMMANDS of *CASE is not a contact type', '"tfac=2" in COMMANDS of *CASE ',
                 '"ctype.9=5" in COMMANDS of *CASE changes interface 9, which the deck does not have',
                 '"punit=8" on the command line is not a unit of the penalty', "refused, 7 errors"):
        assert done.stderr.count(told) == 1, done.stderr


SLIDELINE = "*CONTACT_2D_SLIDELINE\n-2,-3,2,,2.0e5,"
IMPLICIT = SLIDELINE + "\n*CONTROL_IMPLICIT_GENERAL\n1,1.0e-4"
TIE = SLIDELINE + "\n\n,,1"


@pytest.mark.parametrize("cards, words, told", [
    (IMPLICIT, "tssfac=0.8", "{0} has no effect with the implicit method"),
    (IMPLICIT, "punit=3 pen=0.5", "{0} asks for a share of the largest stable penalty"),
    (SLIDELINE, "tssfac=1.2", "{0} is above 1: the run may become unstable"),
    (SLIDELINE, "dt=5e-5", "DTINIT has no effect beside {0}"),
    (SLIDELINE, "punit=4 ctype=7 vdc=5", "{0} asks for implicit springs, which in this version have no damping"),
    (SLIDELINE, "punit=3 pen=2", 'with {1} and {0} the penalty "2.000000E+00" is not a share'),
    (SLIDELINE, "punit=3", 'with {0} the penalty "2.000000E+05" is not a share'),
    (TIE, "vdc=20", "interface 1 is tied: ties have no contact damping; {0} has no effect on it"),
    (TIE, "punit=3 pen=0.5", "interface 1 is tied: its penalty can not be a share of the largest stable one; {0} has no effect on it"),
    (TIE, "fs=0.1", "interface 1 is tied: {0} has no effect on it"),
    ("", "pen=1e5", "{0} changes PEN of all interfaces, but the deck has none")])
def test_messages_of_words_say_where_they_stand(slideline, tmp_path, cards, words, told):
    """On the command line or in COMMANDS, and the word itself."""
    deck = re.sub(r"\*CONTACT_2D[^*]*", "", drop(end_time=0.001).text()).rsplit("*END", 1)[0] + cards
    deck = deck.replace("0.0,0.9,0,0.0,0.0,9001", "1.0e-5,0.9")
    (tmp_path / "job.k").write_text(deck + "\n*END\n")
    (tmp_path / "case.k").write_text(f"{deck}\n*CASE\n1\n{words}\n\n*END\n")
    for words_of_run, place in (("job.k " + words, "on the command line"), ("case.k case", "in COMMANDS of *CASE")):
        done = slideline("check", *words_of_run.split())
        said = done.stdout + done.stderr
        assert said.count(told.format(*(f'"{word}" {place}' for word in words.split()))) == 1, said
        assert ("the command line" in said) == (place == "on the command line"), said


def test_a_name_for_several_cases_is_told_with_the_rest(slideline, check, fast):
    """Once where no case has more than the others; the cases are told by their own names."""
    for words, n in (("case", 3), ("case=7,101", 2)):
        done = slideline("d=out", words, "jobid=x", deck=cases_deck())
        assert done.returncode == 1 and done.stderr.count(f"jobid= on the command line would be the name of {n} cases") == 1
    assert done.stderr.splitlines()[0] == "case 7 (case7), case 101 (slow):"
    deck = cases_deck().replace("*PART\n", "*BOUNDARY_NONE\n*PART\n", 1)
    done = slideline("d=out", "case", "jobid=x", deck=deck)
    assert done.returncode == 1 and done.stderr.count("jobid= on the command line") == done.stderr.count("*BOUNDARY_NONE: ") == 1
    for odd in (deck, deck.replace("       101 slow", "         0 slow")):  # also of those without a number
        odd = odd.replace("102 fast", "  0 fast").replace("         7\n\n", "         x\n\n")
        assert "the name of 3 cases" in slideline("d=out", "case", "jobid=x", deck=odd).stderr
    cases = json.loads(check(deck, "case", "jobid=x", "--json").stdout)["cases"]
    assert [[finding.get("keyword") for finding in case["findings"]] for case in cases] == [["*BOUNDARY_NONE", None]] * 3


def test_a_failing_case_is_not_hidden(slideline, tmp_path, fast):
    """The next case runs after an error termination; the status is that of the one that failed."""
    deck = cases_deck().replace(BLOCKS[3], "*CONTROL_TERMINATION\n0.006,,,1.0e-9")
    deck = deck.replace("         1         3\n", "         1\n")
    text = re.sub(r"\*CONTROL_TERMINATION\n.*\n", "", deck, count=1)
    text = text.replace("*CASE_END_4\n", "*CONTROL_TERMINATION\n0.002,\n*CASE_END_4\n")
    done = slideline("d=out", "case=102,7", deck=text)
    assert done.returncode == 2, done.stderr
    assert "of 2 cases have not ended normally: case 102 (fast) (status 2)" in done.stderr
    assert "N o r m a l" in done.stdout and done.stdout.rstrip().endswith("E r r o r    t e r m i n a t i o n")
    assert (tmp_path / "out/case7.vtkhdf").exists()


def test_trouble_with_files_ends_all(slideline, tmp_path, fast):
    (tmp_path / "out/fast.vtkhdf").mkdir(parents=True)
    done = slideline("d=out", "case", deck=cases_deck())
    assert done.returncode == 3
    assert "case 102 (fast) (status 3), case 7 (case7) not run" in done.stderr
    assert (tmp_path / "out/slow.vtkhdf").exists() and not (tmp_path / "out/case7.vtkhdf").exists()


def test_restart_of_a_case(slideline, tmp_path, fast):
    """Without a word of cases; a whole deck beside the file needs the case."""
    dump = "*DATABASE_BINARY_D3DUMP\n10,\n*END"
    assert slideline("d=whole", "case=102", deck=cases_deck().replace("*END", dump)).returncode == 0
    assert slideline("r=whole/fast.dump01.h5", "d=on").returncode == 0
    assert slideline("r=whole/fast.dump01.h5", "i=job.k", "case=102", "d=deck").returncode == 0
    for folder in ("on", "deck"):
        assert (tmp_path / folder / "fast.dump02.h5").exists()
        for name in ("nodout", "glstat"):
            rows = (tmp_path / folder / f"fast.{name}.csv").read_text().splitlines()
            assert len(rows) > 1 and (tmp_path / f"whole/fast.{name}.csv").read_text().splitlines()[-1] == rows[-1]
    for words, told in ((["case=102"], "expected case=ID beside the deck (i=), or none"),
                        (["i=job.k"], "the deck has cases"), (["i=job.k", "case=7"], "it belongs to another deck"),
                        (["i=job.k", "case"], "a run that goes on is of one case")):
        done = slideline("r=whole/fast.dump01.h5", *words)
        assert done.returncode == 1 and told in done.stderr


def test_numbers_that_are_none_are_all_that_is_told(check):
    """No case is left: that none has been asked for would be wrong."""
    text = cases_deck()
    for number, other in (("       101 slow", "         x slow"), ("102 fast", " -3 fast"), ("         7\n\n", "         0\n\n")):
        assert text.count(number) == 1
        text = text.replace(number, other)
    for words in (["case"], ["case=1"], []):
        findings = json.loads(check(text, "--json", *words).stdout)["findings"]
        assert [finding.get("name") for finding in findings if finding["severity"] == "error"] == ["CASEID"] * 3


def test_check(check):
    done = check(cases_deck(), "case")
    assert done.returncode == 0 and len(re.findall(r"^job\.k, case \d+ \(\w+\): accepted", done.stdout, re.M)) == 3
    whole = json.loads(check(cases_deck(), "--json", "case").stdout)
    assert whole["accepted"] and [case["job"] for case in whole["cases"]] == ["slow", "fast", "case7"]
    assert [max(case["model"]["velocity_y"], key=abs) for case in whole["cases"]] == [-1.0, -3.0, -4.0]
    one = json.loads(check(cases_deck(), "--json", "case=102").stdout)
    assert one == whole["cases"][1] and one["case"] == 102
    bad = cases_deck().replace("R low", "R lower")
    done = check(bad, "--json", "case")
    told = json.loads(done.stdout)
    assert done.returncode == 1 and not told["accepted"]
    assert [case["accepted"] for case in told["cases"]] == [True, True, False]
    done = check(bad.replace("       101 slow", "         0 slow"), "--json", "case")
    told = json.loads(done.stdout)
    assert done.returncode == 1 and not told["accepted"]
    assert [[finding["name"] for finding in case["findings"]] for case in told["cases"]] == [["CASEID"], ["VY", "CASEID"]]
    none = check(cases_deck(), "--json")
    assert none.returncode == 1 and "say case=ID" in json.loads(none.stdout)["findings"][0]["message"]


def test_blocks_inside_each_other_and_unnamed_ones(check):
    """A keyword in several blocks belongs to each; a block that no case names is a warning."""
    deck = cases_deck().replace(block(2), "*CASE_BEGIN_9\n" + block(2) + "*CASE_END_9\n")
    deck = deck.replace("*END", "*CASE\n         8\n\n         9\n*TITLE CID=5\nof none\n*END")
    one, two = (json.loads(check(deck, "--json", f"case={case}").stdout) for case in (102, 8))
    assert one["accepted"] and two["accepted"]
    assert one["model"]["velocity_y"] == two["model"]["velocity_y"] and min(one["model"]["velocity_y"]) == -3.0
    assert [(finding["severity"], finding["keyword"]) for finding in one["findings"]] == [("warning", "*TITLE")]
    assert "no *CASE names subcase 5" in one["findings"][0]["message"]


def test_layout_of_a_block_that_is_not_read(check):
    """*KEYWORD LONG=Y in a block of another case changes nothing."""
    deck = cases_deck().replace(block(1), f"*CASE_BEGIN_1\n*KEYWORD LONG=Y\n{BLOCKS[1]}\n*CASE_END_1\n")
    assert check(deck, "case=7").returncode == 0
    assert check(deck, "case=101").returncode == 1


def told_at(text):
    """Keyword of each error in the order in which they are told, without the end."""
    return re.findall(r"^\S*job\.k:\d+: (\*\w+)", text, re.M)


def test_mistakes_of_cases_come_with_those_of_the_deck(check, slideline):
    """In the order of the file, whichever case is asked for, and nothing that is no mistake."""
    deck = cases_deck().replace("*PART\n", "*BOUNDARY_NONE\n*PART\n", 1).replace("102 fast", "102 no/name")
    deck = deck.replace("*END", "*MAT_NONE\n*END")
    for words in (["case=101"], ["case=3"], []):
        done = slideline("d=out", *words, deck=deck)
        assert done.returncode == 1 and told_at(done.stderr) == ["*BOUNDARY_NONE", "*CASE", "*MAT_NONE"], done.stderr
    lines = done.stderr.splitlines()
    assert "say case=ID for one of 101 (slow), 102 (no/name), 7 (case7)" in lines[-2] and lines[-1].endswith("job.k: refused, 4 errors")
    words = deck.replace("102 no/name", "102 fast").replace("dt=5e-5 memory=20m", "ncpu=0")
    assert told_at(slideline("d=out", "case=101", deck=words).stderr) == ["*BOUNDARY_NONE", "*CASE", "*MAT_NONE"]
    done = check(deck, "case")
    assert done.stderr.count("is no stem") == 1 and "case 101 (slow), case 102 (no/name), case 7 (case7):" in done.stderr
    # Where the marks are wrong it is not known what belongs to the case: what is missing is not told.
    marks = deck.replace("102 no/name", "102 fast").replace("*CASE_END_4\n", "")
    done = slideline("d=out", "case=101", deck=marks)
    assert told_at(done.stderr)[:2] == ["*BOUNDARY_NONE", "*CASE_BEGIN_4"] and "is not defined" not in done.stderr
