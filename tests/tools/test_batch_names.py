# SPDX-License-Identifier: MIT
"""Batches lose no run: names that are the same in part, and names that tables and shells stumble over."""
import csv
import os
import shutil
import signal
import subprocess
import time

import pytest

from test_batch_runs import BATCH, FAKE, call, deck, place, summary, reported  # noqa: F401


def statuses(folder):
    return {name: row["status"] for name, row in summary(folder).items()}


def test_decks_of_one_stem_have_folders_of_their_own(place):
    """a.k, a.key, a.dyn at the same time; each ends in its own way."""
    for number, name in enumerate(("a.k", "a.key", "a.dyn", "A.K", "b.k", "b_k.key", "B.KEY", "list.txt.k")):
        deck(place / "decks" / name, number, force=number)
    assert call(place, "run_folder.sh", "-j", 4, "decks").returncode == 1
    results = place / "decks" / "results"
    found = {row["run"]: row["status"] for row in csv.DictReader(open(results / "summary.csv", newline=""))}
    assert sorted(found.values()) == [str(k) for k in range(8)]
    assert found == {"A_K": "3", "a_dyn": "2", "a_k-2": "0", "a_key": "1", "B_KEY": "6", "b_k-2": "4", "b_k": "5",
                     "list.txt_k": "7"}
    assert all(len(reported(results / name)) == 1 for name in found)
    assert len({name.lower() for name in found}) == 8


def test_a_deck_alone_keeps_its_name(place):
    deck(place / "decks" / "a.k")
    deck(place / "decks" / "ab.key")
    call(place, "run_folder.sh", "decks")
    assert list(summary(place / "decks" / "results")) == ["a", "ab"]


def test_odd_names_survive(place):
    names = ["a,b", 'quoted "x"', "-j", "--fresh", "$HOME `ls`", "it's", "back\\slash", "a=b", "*", "{}", "name.with.dots",
             " blank", "{ä}", "%s"]
    for name in names:
        deck(place / "decks" / f"{name}.k", 2)
    (place / "decks" / "name.with.dots").mkdir()  # a folder of the same name as a deck
    assert call(place, "run_folder.sh", "decks", "-o", "x").returncode == 1
    assert statuses(place / "decks" / "results") == dict.fromkeys(names, "2")
    raw = (place / "decks" / "results" / "summary.csv").read_text()
    assert '\n"a,b",2,' in raw and '\n"quoted ""x""",2,' in raw and "\nit's,2," in raw


@pytest.mark.parametrize("name", ["one\ntwo", "one\ttwo", "one\rtwo", "one\x1btwo"])
def test_names_that_no_line_holds_are_refused_before_anything_runs(place, name):
    deck(place / "decks" / "a.k")
    deck(place / "decks" / f"{name}.k")
    done = call(place, "run_folder.sh", "decks")
    assert done.returncode == 2 and "one?two.k" in done.stderr and "control character" in done.stderr
    assert not list((place / "decks").rglob("reported.txt"))
    assert call(place, "sweep.sh", "-o", "out", f"decks/{name}.k", "ctype=1").returncode == 2
    assert call(place, "sweep.sh", "-o", "out", "decks/a.k", f"p:x={name}").returncode == 2
    assert not list(place.rglob("reported.txt"))


def test_blanks_at_the_end_of_a_name(place):
    """The program leaves them out of the names of its files."""
    deck(place / "decks" / "a.k", 1)
    deck(place / "decks" / "a .k", 2)
    call(place, "run_folder.sh", "decks")
    assert sorted(statuses(place / "decks" / "results").values()) == ["1", "2"]
    assert not any(name.endswith(" ") for name in summary(place / "decks" / "results"))


def test_links_and_capitals_are_decks_and_hidden_files_are_not(place):
    deck(place / "elsewhere" / "x.k")
    deck(place / "decks" / "B.K")
    deck(place / "decks" / "._b.k", 1)
    (place / "decks" / "link.k").symlink_to(place / "elsewhere" / "x.k")
    call(place, "run_folder.sh", "decks")
    assert list(summary(place / "decks" / "results")) == ["B", "link"]


def test_only_what_is_included_here_is_left_out(place):
    deck(place / "other" / "mesh.k")
    deck(place / "decks" / "a.k", more="*INCLUDE_PATH\n../other\n*INCLUDE\nmesh.k\nfirst.k\nsec +\nond.k\n")
    for name in ("mesh.k", "first.k", "second.k", "third.k"):
        deck(place / "decks" / name, 1)
    deck(place / "decks" / "b.k", more=f"*INCLUDE\n{place}/decks/third.k\n$ end\n*END\n*INCLUDE\nmesh.k\n")
    done = call(place, "run_folder.sh", "decks")
    assert statuses(place / "decks" / "results") == {"a": "0", "b": "0", "mesh": "1"}
    assert [line for line in done.stdout.splitlines() if "includes it" in line] == [
        f"== decks/{name}.k: no run of its own, another deck includes it" for name in ("first", "second", "third")]
    # A change of any of them is a change of the run.
    for name, runs in (("first", 2), ("second", 3), ("mesh", 3)):
        deck(place / "decks" / f"{name}.k", 1, force=9.0)
        call(place, "run_folder.sh", "decks")
        assert len(reported(place / "decks" / "results" / "a")) == runs
    deck(place / "other" / "mesh.k", force=3.0)
    call(place, "run_folder.sh", "decks")
    assert len(reported(place / "decks" / "results" / "a")) == 4


def test_a_run_that_can_not_begin_leaves_the_others(place):
    for name in "abc":
        deck(place / "decks" / f"{name}.k")
    (place / "decks" / "results").mkdir()
    (place / "decks" / "results" / "b").write_text("in the way\n")
    done = call(place, "run_folder.sh", "decks")
    assert done.returncode == 1
    assert statuses(place / "decks" / "results") == {"a": "0", "b": "-", "c": "0"}


def test_the_reason_stands_in_the_table(place):
    program = place / "the program"
    program.write_text(FAKE.replace("exit ", "echo ' 0 t 0.0'; echo 'warning: of \"no\" matter' >&2\n"
                                    "echo 'a.k:3: *NODE card 1 (NID): \"x\", no number' >&2; echo second >&2\nexit "))
    deck(place / "decks" / "a.k", 1)
    deck(place / "decks" / "b.k")
    done = call(place, "run_folder.sh", "decks")
    assert [row["reason"] for row in summary(place / "decks" / "results").values()] == [
        'a.k:3: *NODE card 1 (NID): "x", no number', ""]
    assert 'a.k:3: *NODE card 1 (NID): "x", no number\n' in done.stdout


def test_refusals_of_the_program_stand_in_the_table(place, slideline):
    text = (BATCH.parents[1] / "tests" / "rejected" / "examples" / "hourglass_negative.k").read_text()
    (place / "decks").mkdir()
    (place / "decks" / "a.k").write_text(text)
    call(place, "run_folder.sh", "decks", program=slideline)
    (place / "decks" / "b.k").write_text(text.replace("      -0.1", "       0.1"))
    call(place, "sweep.sh", "-o", "swept", "decks/b.k", "ctype=8,9", program=slideline)
    reason = 'decks/a.k:54: *HOURGLASS card 1 field 3 (QM): "-0.1" is not an hourglass coefficient (0 to 10; 0.05 to 0.15 are usual)'
    assert [row["reason"] for row in summary(place / "decks" / "results").values()] == [reason]
    first, second = (row["reason"] for row in summary(place / "swept").values())
    assert '"ctype=8" on the command line is not a contact type' in first
    assert '"ctype=9" on the command line is not a contact type' in second


def test_values_that_make_one_name(place):
    deck(place / "a.k")
    done = call(place, "sweep.sh", "-j", 4, "-o", "out", "a.k", "p:f=x/y,x y,x:y,1e3,1E3")
    assert done.returncode == 0, done.stderr
    rows = summary(place / "out")
    assert len(rows) == len({name.lower() for name in rows}) == 5
    assert sorted(reported(place / "out" / name)[0].split("|")[-2] for name in rows) == [
        f"p:f={value}" for value in ("1E3", "1e3", "x y", "x/y", "x:y")]


@pytest.mark.parametrize("words", [["ctype=1,1"], ["ctype=1,,2"], ["ctype=1,"], ["ctype=1", "CTYPE=2"],
                                   ["p:long=" + "1" * 240]])
def test_sweeps_with_values_twice_or_without_are_refused(place, words):
    deck(place / "a.k")
    done = call(place, "sweep.sh", "-o", "out", "a.k", *words)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1 and "sweep.sh" in done.stderr
    assert not list(place.rglob("reported.txt"))


@pytest.mark.parametrize("script, words", [("sweep.sh", ["ctype=1"]), ("run_folder.sh", [])])
def test_one_folder_for_two_batches_is_refused(place, script, words):
    for folder in ("one", "two"):
        deck(place / folder / "a.k", force=1.0 + len(folder))
    of = [f"{folder}/a.k" if words else folder for folder in ("one", "two")]
    assert call(place, script, "-o", "out", of[0], *words).returncode == 0
    done = call(place, script, "-o", "out", of[1], *words)
    assert done.returncode == 2 and "holds the runs of" in done.stderr
    assert call(place, script, "-o", "out", of[0], *words).returncode == 0  # goes on
    os.rename(place / "one", place / "moved")
    assert call(place, script, "-o", "out", of[0].replace("one", "moved"), *words).returncode == 0
    assert len(list(csv.DictReader(open(place / "out" / "summary.csv", newline="")))) == 1


@pytest.mark.parametrize("words", [["-j", "0"], ["-j", "two"], ["-j"], ["--part", "3/3"], ["--part", "1"],
                                   ["--part", "a/b"], ["--part", "-1/2"], ["--none"]])
def test_wrong_numbers_are_refused(place, words):
    deck(place / "decks" / "a.k")
    done = call(place, "run_folder.sh", *words, "decks")
    assert done.returncode == 2 and done.stderr and not list(place.rglob("reported.txt"))


@pytest.mark.skipif(not shutil.which("flock"), reason="no flock")
def test_two_batches_at_once_run_nothing_twice(place):
    program = place / "the program"
    program.write_text(FAKE.replace("printf '%s|' \"$@\"", "sleep 0.3\nprintf '%s|' \"$@\""))
    for name in "abcd":
        deck(place / "decks" / f"{name}.k")
    calls = [subprocess.Popen([BATCH / "run_folder.sh", "-j", "2", "decks"], cwd=place, stdout=subprocess.DEVNULL,
                              env={**os.environ, "SLIDELINE": str(program)}) for _ in range(3)]
    for running in calls:
        running.wait(timeout=60)
    assert all(len(reported(place / "decks" / "results" / name)) == 1 for name in "abcd")


def test_a_batch_that_is_cut_short_goes_on(place):
    program = place / "the program"
    program.write_text(FAKE.replace("printf '%s|' \"$@\"", "sleep 0.2\nprintf '%s|' \"$@\""))
    names = [f"{k:02d}, \"x\"" for k in range(8)]
    for name in names:
        deck(place / "decks" / f"{name}.k")
    running = subprocess.Popen([BATCH / "run_folder.sh", "decks"], cwd=place, start_new_session=True,
                               stdout=subprocess.DEVNULL, env={**os.environ, "SLIDELINE": str(program)})
    results = place / "decks" / "results"
    end = time.monotonic() + 20.0
    while len(list(results.glob("*/run.status"))) < 3 and time.monotonic() < end:
        time.sleep(0.02)
    os.killpg(running.pid, signal.SIGKILL)
    running.wait()
    done = call(place, "run_folder.sh", "-j", 2, "decks")
    assert done.returncode == 0, done.stdout + done.stderr
    assert list(statuses(results)) == names and done.stdout.count("has run already") >= 3


def test_hundreds_of_decks(place):
    """A table of many runs is made at once, without a process for each of its cells."""
    for k in range(600):
        deck(place / "decks" / f"{k}.k")
    begun = time.monotonic()
    done = call(place, "run_folder.sh", "--collect", "decks")
    assert done.returncode == 1 and len(summary(place / "decks" / "results")) == 600
    assert time.monotonic() - begun < 20.0


def test_comparison_of_names_that_are_alike(place):
    tool = place / "tools"
    tool.write_text("#!/bin/sh\necho \"compared $2\"\nexit 1\n")
    tool.chmod(0o755)
    for folder in ("new", "kept"):
        for name in ("a/b.csv", "a_b.csv", "a,b/c d.csv"):
            (place / folder / name).parent.mkdir(parents=True, exist_ok=True)
            (place / folder / name).write_text("time\n0.0\n")
    done = call(place, "compare_folder.sh", "new", "kept", TOOLS=str(tool))
    assert done.returncode == 1 and "3 failed" in done.stdout
    said = sorted(path.read_text().strip() for path in (place / "new" / "compared").rglob("*.csv.txt"))
    assert said == ["compared new/a,b/c d.csv", "compared new/a/b.csv", "compared new/a_b.csv"]
    (place / "kept" / "x\ny.csv").write_text("time\n")
    done = call(place, "compare_folder.sh", "new", "kept", TOOLS=str(tool))
    assert done.returncode == 2 and "control character" in done.stderr


@pytest.mark.parametrize("script, words", [("run_folder.sh", ["E=200"]), ("run_folder.sh", ["-o", "mu=0.3", "E=200"]),
                                           ("sweep.sh", ["-o", "mu=0.3", "E=200/a.k", "ctype=1,2"])])
def test_a_folder_with_a_name_like_an_assignment(place, script, words):
    """awk takes NAME=VALUE for an assignment, and reads its standard input instead."""
    deck(place / "E=200" / "a.k")
    deck(place / "E=200" / "b.k", more="*INCLUDE\n-\n")
    done = call(place, script, *words)
    assert done.returncode == 0, done.stderr
    results = place / (words[1] if len(words) > 1 else "E=200/results")
    assert list(statuses(results).values()) == ["0", "0"]


@pytest.mark.parametrize("included", ["pipe", "/dev/zero"])
def test_a_deck_that_includes_no_file_holds_no_batch(place, included):
    os.mkfifo(place / "pipe")
    deck(place / "decks" / "it's a.k", more="*INCLUDE\nit's b.k\n")
    deck(place / "decks" / "it's b.k", 1)
    deck(place / "decks" / "z.k", 1, more=f"*INCLUDE\n{included}\n")
    done = call(place, "run_folder.sh", "decks")
    assert statuses(place / "decks" / "results") == {"it's a": "0", "z": "1"}, done.stderr


@pytest.mark.parametrize("signal_is", ["-", "''"], ids=["killed", "refused"])
def test_a_table_that_can_not_be_written_leaves_the_old_one(place, signal_is):
    """The largest file size stands for a full disk; the table on the screen is whole."""
    deck(place / "decks" / "a.k")
    assert call(place, "run_folder.sh", "decks").returncode == 0
    results = place / "decks" / "results"
    before = (results / "summary.csv").read_bytes()
    done = subprocess.run(["sh", "-c", f"trap {signal_is} XFSZ; ulimit -f 0; exec \"$@\"", "sh", BATCH / "run_list.sh",
                           "--collect", results / "list.txt", results], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and "normal" in done.stdout and "summary.csv: can not be written" in done.stderr, done.stderr
    assert (results / "summary.csv").read_bytes() == before and not (results / "summary.csv.new").exists()


def test_a_search_path_for_folders_is_no_matter(place):
    """With CDPATH the shell prints where `cd` has gone."""
    deck(place / "decks" / "a.k")
    done = subprocess.run(["tools/batch/run_folder.sh", place / "decks"], cwd=BATCH.parents[1], capture_output=True, text=True,
                          env={**os.environ, "SLIDELINE": str(place / "the program"), "CDPATH": f"{place}:."}, timeout=60)
    assert done.returncode == 0 and statuses(place / "decks" / "results") == {"a": "0"}, done.stderr


@pytest.mark.parametrize("name", ["!", "(", "-type", "kept=1"])
def test_comparison_of_folders_with_names_that_find_knows(place, name):
    for folder in ("new", name):
        (place / folder).mkdir()
        (place / folder / "a.csv").write_text("time\n0.0\n")
    assert "1 agreed" in call(place, "compare_folder.sh", "new", name, TOOLS="true").stdout
    assert "1 agreed" in call(place, "compare_folder.sh", name, "new", TOOLS="true").stdout
