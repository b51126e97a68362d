# SPDX-License-Identifier: MIT
"""Forms of the command line and overrides."""
import re

import numpy as np
import pytest
from conftest import columns, drop, numbers

NORMAL = "N o r m a l    t e r m i n a t i o n"


def test_help_and_version(slideline):
    for option in ("--help", "--version"):
        done = slideline(option)
        assert done.returncode == 0
        assert "slideline" in done.stdout.lower()
    assert "i=" in slideline("--help").stdout and "ncpu=" in slideline("--help").stdout
    assert re.search(r"\d+\.\d+", slideline("--version").stdout)


def test_bare_deck_path_and_defaults(slideline, tmp_path):
    (tmp_path / "first.k").write_text(drop(end_time=0.002).text())
    done = slideline("first.k")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "first.glstat.csv").exists()
    assert (tmp_path / "first.vtkhdf").exists()


def test_bare_path_with_an_equals_sign(slideline, tmp_path):
    """A word with a slash before its = is a path; one without is NAME=VALUE, whatever follows."""
    (tmp_path / "runs/pen=1e9").mkdir(parents=True)
    (tmp_path / "runs/pen=1e9/deck.k").write_text(drop(end_time=0.002).text())
    done = slideline("runs/pen=1e9/deck.k", "d=out/pen=1e9")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out/pen=1e9/deck.glstat.csv").exists()
    done = slideline("runs=/deck.k")
    assert done.returncode == 1 and 'unknown argument "runs=/deck.k"' in done.stderr
    done = slideline("--runs/pen=1e9/deck.k")
    assert done.returncode == 1 and 'unknown argument "--runs/pen=1e9/deck.k"' in done.stderr


@pytest.mark.parametrize("word, meant", [
    ("ctpye=5", "ctype="), ("ctpye.2=5", "ctype="), ("jobib=x", "jobid="), ("quite=1", "quiet="), ("NCPUS=2", "ncpu="),
    ("endtime=1", "endtim="), ("--jobid=x", "jobid="), ("--hlep", "--help"), ("dtt=1e-6", "dt="), ("tming=off", "timing="),
    ("memry=20m", "memory="), ("pne=1", "pen="),
    ("what=1", None), ("case=1", None), ("runs=/deck.k", None), ("foo=2", None), ("k=1", None), ("=1", None), ("-", None)])
def test_misspelt_words_get_the_nearest(slideline, word, meant):
    done = slideline(word, deck=drop())
    assert done.returncode == 1
    assert done.stderr.splitlines()[0] == f'unknown argument "{word}"' + (f"; did you mean {meant}?" if meant else "")


def test_a_second_word_without_a_name_is_a_second_deck(slideline):
    done = slideline("case", deck=drop())
    assert done.returncode == 1 and 'job.k" and "case"\n' in done.stderr, done.stderr


def test_values_of_overrides_are_reported_with_other_mistakes(slideline):
    done = slideline("ctype=abc", "pen=1e5", "p:X=abc", "dt.x=1", "endtim=x", "foo=2", deck=drop())
    assert done.returncode == 1
    assert done.stderr.splitlines() == ['unknown argument "dt.x=1"; did you mean dt=?', 'unknown argument "foo=2"',
                                        '"ctype=abc": the value is not a whole number',
                                        '"endtim=x": the value is not a number above 0 (numbers reach 1e40)',
                                        'try slideline --help']


@pytest.mark.parametrize("word", ["jobid=x\n state   normal", "jobid=x\x1b[31m", "d=out\x7f", "d=out\nx", "p:A=1\r", "memory=\t2m"])
def test_control_characters_are_refused(slideline, tmp_path, word):
    """A line feed in a job's name forged a line of status.out; escapes reached the log and the screen."""
    done = slideline(word, deck=drop())
    assert done.returncode == 1
    shown = "".join(letter if letter.isprintable() else "?" for letter in word)
    assert done.stderr.splitlines()[0] == f'"{shown}" has a control character (line feed, escape or the like) where ? stands: expected none'
    assert sorted(path.name for path in tmp_path.iterdir()) == ["job.k"]


def test_results_folder_with_parents_and_job_name(slideline, tmp_path):
    done = slideline("d=a/b/c", "jobid=other", deck=drop(end_time=0.002))
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "a" / "b" / "c" / "other.glstat.csv").exists()
    assert not list((tmp_path / "a" / "b" / "c").glob("job*"))


def test_memory_is_accepted_and_ignored(slideline, tmp_path):
    done = slideline("d=m", "memory=200m", deck=drop(end_time=0.002))
    assert done.returncode == 0, done.stderr
    done = slideline("d=n", deck=drop(end_time=0.002))
    assert (tmp_path / "m/job.glstat.csv").read_bytes() == (tmp_path / "n/job.glstat.csv").read_bytes()


def test_words_of_ls_dyna(slideline, tmp_path):
    """Those without effect are reported once, in one warning; the results are those of a run without them."""
    deck = drop(end_time=0.002).text().replace("*END", "*DATABASE_BINARY_D3DUMP\n10,\n*END")
    words = ["o=d3hsp", "g=d3plot", "s=intfor", "f=d3thdt", "a=runrsf", "x=7", "x=8", "para=1"]
    done = slideline("d=dyna", "d=nodump", "c=3600", "memory2=20m", "ncpu=-2", *words, deck=deck)
    assert done.returncode == 0, done.stderr
    assert done.stderr == "warning: without effect on the command line: o= g= s= f= a= x= para=\n"
    assert "Warnings            = 1" in done.stdout
    assert slideline("d=own", "ncpu=2", deck=deck).returncode == 0
    names = {folder: {path.name for path in (tmp_path / folder).iterdir()} for folder in ("dyna", "own")}
    assert names["own"] - names["dyna"] == {"job.dump01.h5", "job.dump02.h5"} and not (tmp_path / "nodump").exists()
    for name in ("job.glstat.csv", "job.rcforc.csv", "job.nodout.csv"):
        assert (tmp_path / "dyna" / name).read_bytes() == (tmp_path / "own" / name).read_bytes()
    assert not list(tmp_path.glob("d3*"))


def test_processor_time_has_a_limit(slideline, tmp_path):
    """c=1: a run that would take minutes stops as by a signal, with all its files."""
    done = slideline("d=c", "c=1", "endtim=1000.0", deck=drop(), timeout=100)
    assert done.returncode == 4 and "stopped on request" in done.stdout, done.stderr
    assert len(numbers(tmp_path / "c" / "job.glstat.csv", "time")) > 1


def test_a_pipe_gets_twenty_lines_and_the_end(slideline, tmp_path):
    """However many states are written; quiet=1 leaves the line that says how the run has ended."""
    deck = drop(end_time=0.02).text().replace("*DATABASE_BINARY_D3PLOT\n0.002", "*DATABASE_BINARY_D3PLOT\n0.0002")
    done = slideline("d=l", deck=deck)
    assert done.returncode == 0, done.stderr
    lines = re.findall(r"(?m)^ *\d+ t (\S+) dt", done.stdout)
    assert len(lines) == 20 and float(lines[0]) == 0.0 and float(lines[-1]) == pytest.approx(0.02)
    assert max(np.diff(np.array(lines, float))) < 0.0014, "one for each share of the run"
    done = slideline("d=q", "quiet=1", deck=deck)
    assert (done.returncode, done.stdout, done.stderr) == (0, f" {NORMAL}\n", "")
    log = (tmp_path / "q" / "job.log").read_text()
    assert "Problem time" in log and "contact_search" in log


@pytest.mark.parametrize("word, said", [("nonsense=1", "nonsense"), ("quiet=2", "expected 0 or 1"),
                                        ("c=0", "from 1 to"), ("ncpu=-0", "ncpu"), ("--nonsense", "nonsense"),
                                        ("ctype=two", "two"), ("ctype.7=2", "interface 7"),
                                        ("ncpu=0", "ncpu"), ("ncpu=1025", "1024"), ("ncpu=two", "ncpu"), ("perthread=0", "perthread"), ("timing=often", "phase, interface or off"), ("endtim=", "endtim"),
                                        ("endtim=soon", "soon"), ("p:nowhere=3", "nowhere"),
                                        ("jobid=a/b", "expected a name without /"), ("jobid=", "jobid= is empty")])
def test_wrong_words_are_refused(slideline, word, said):
    done = slideline("d=w", word, deck=drop(end_time=0.002))
    assert done.returncode == 1
    assert said in done.stderr.lower()


@pytest.mark.parametrize("name", ["ctype", "ngauss", "pen", "punit", "pent", "vdc"])
def test_overrides_that_find_no_interface_are_reported(slideline, name):
    """A deck without contact: a sweep over types would otherwise give seven equal runs without a word. One for an
    interface by number is refused."""
    deck = re.sub(r"\*CONTACT_2D[^*]*", "", drop(end_time=0.002).text())
    done = slideline("d=w", f"{name}=1", deck=deck)
    assert done.returncode == 0
    reported = f"changes {name.upper()} of all interfaces, but the deck has none"
    assert reported in done.stdout + done.stderr
    done = slideline("d=n", "endtim=0.001", "tssfac=0.5", "dt=1.0e-4", deck=deck)
    assert done.returncode == 0 and "of all interfaces" not in done.stdout + done.stderr
    done = slideline("d=o", f"{name}.1=1", deck=deck)
    assert done.returncode == 1 and "changes interface 1, which" in done.stderr


@pytest.mark.parametrize("name", ["d=", "memory=", "p:x=", "", "i="])
def test_a_word_that_is_too_long_is_refused(slideline, tmp_path, name):
    """None is cut: 4096 characters are taken, one more is not."""
    word = name + "x" * (4097 - len(name))
    done = slideline(word, deck=drop(end_time=0.002))
    assert done.returncode == 1
    assert word[:50] in done.stderr and "has 4097 characters; the limit is 4096" in done.stderr
    assert not (tmp_path / "job.log").exists()
    if name == "memory=":
        assert slideline(word[:-1], deck=drop(end_time=0.002)).returncode == 0


def test_no_argument_says_how(slideline):
    done = slideline()
    assert done.returncode == 1
    assert "i=" in done.stderr + done.stdout


def test_missing_deck(slideline):
    done = slideline("i=absent.k")
    assert done.returncode in (1, 3)
    assert "absent.k" in done.stderr


def test_end_time_and_step(slideline, tmp_path):
    done = slideline("d=e", "endtim=0.004", "dt=2.0e-4", deck=drop())
    assert done.returncode == 0, done.stderr
    glstat = tmp_path / "e" / "job.glstat.csv"
    assert numbers(glstat, "time")[-1] == pytest.approx(0.004, rel=1e-12)
    assert numbers(glstat, "cycle")[-1] == 20
    assert np.all(numbers(glstat, "dt") == 2.0e-4)


def test_end_that_no_cycle_reaches(slideline, tmp_path):
    """1e10 cycles to the end, more than are counted: ENDCYC ends the run and not the first cycle."""
    deck = drop().text().replace("*CONTROL_TERMINATION\n0.02,", "*CONTROL_TERMINATION\n0.02,23")
    done = slideline("d=e", "endtim=1.0e6", "dt=1.0e-4", deck=deck)
    assert done.returncode == 0, done.stderr
    assert numbers(tmp_path / "e" / "job.glstat.csv", "cycle")[-1] == 23


def test_end_far_before_the_first_step(slideline, tmp_path):
    """One cycle, and an end: intervals of outputs are cut to the run."""
    done = slideline("d=e", "endtim=1.0e-39", "tssfac=0.5", deck=drop(), timeout=20)
    assert done.returncode == 0, done.stderr
    assert len(numbers(tmp_path / "e" / "job.glstat.csv", "cycle")) == 2


def test_step_factor(slideline, tmp_path):
    deck = drop(end_time=0.003)
    text = deck.text().replace("0.0,0.9,0,0.0,0.0,9001", "0.0,0.9,0,0.0,0.0,0")
    for factor in ("0.8", "0.4"):
        assert slideline(f"d=s{factor}", f"tssfac={factor}", deck=text).returncode == 0
    big, small = (numbers(tmp_path / f"s{f}" / "job.glstat.csv", "dt")[0] for f in ("0.8", "0.4"))
    assert big / small == pytest.approx(2.0, rel=1e-12)


@pytest.mark.parametrize("word", ["ctype=1", "ctype.1=1"])
def test_contact_type(slideline, tmp_path, word):
    assert slideline("d=a", word, deck=drop(kind=2)).returncode == 0
    assert slideline("d=b", deck=drop(kind=1)).returncode == 0
    assert slideline("d=c", deck=drop(kind=2)).returncode == 0
    over, plain, two = ((tmp_path / d / "job.rcforc.csv").read_bytes() for d in "abc")
    assert over == plain
    assert over != two


def test_penalty(slideline, tmp_path):
    assert slideline("d=a", "pen=1.0e5", deck=drop()).returncode == 0
    assert slideline("d=b", deck=drop(penalty=1.0e5)).returncode == 0
    assert slideline("d=c", deck=drop()).returncode == 0
    over, plain, other = ((tmp_path / d / "job.rcforc.csv").read_bytes() for d in "abc")
    assert over == plain
    assert over != other


def test_a_parameter_given_twice_is_refused(slideline):
    done = slideline("p:V0=-1.0", "p:v0=-2.0", deck=drop(parametric=True))
    assert done.returncode == 1 and '"p:v0=-2.0" on the command line: the parameter is given twice' in done.stderr
    assert "no such parameter" not in done.stderr


def test_parameter(slideline, tmp_path):
    assert slideline("d=a", "p:tend=0.004", "p:V0=-1.0", deck=drop(parametric=True)).returncode == 0
    assert numbers(tmp_path / "a" / "job.glstat.csv", "time")[-1] == pytest.approx(0.004, rel=1e-12)
    nodout = columns(tmp_path / "a" / "job.nodout.csv")
    assert float(nodout["vy"][0]) == -1.0


def test_progress_in_a_pipe(finished):
    _, done = finished
    assert NORMAL in done.stdout
    assert re.search(r"(?m)^ *\d+ t \S+ dt \S+", done.stdout)
    assert "\r" not in done.stdout
    assert "\x1b" not in done.stdout
    assert "Problem time" in done.stdout and "Problem cycle" in done.stdout
    assert "Elapsed time" in done.stdout and "nanosecond" in done.stdout.lower()
    assert "contact_search" in done.stdout
