# SPDX-License-Identifier: MIT
"""The sweeps of `tools/study.sh`, with a small program in place of slideline."""
import dataclasses
import io
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import pandas as pd
import pytest

from slideline_tools import UserError
from slideline_tools.studies import __main__ as command
from slideline_tools.studies.framework import pages, runner, table
from slideline_tools.studies.framework.job import Job, Options, Study, interleave, part_of
from slideline_tools.studies.framework.progress import Progress, span

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"

# Appends its name to a log, waits as long as the deck says and writes a result.
PROGRAM = """#!{python}
import os, pathlib, sys, time
words = dict(word.split("=", 1) for word in sys.argv[1:])
log = open({log!r}, "a")
print("begin", words["jobid"], os.getpid(), time.time(), file=log, flush=True)
deck = dict(line.split() for line in open(words["i"]))
time.sleep(float(deck["wait"]))
if "fail" in words:
    print("warning: odd", file=sys.stderr)
    print("deck.k: line 3: a mistake", file=sys.stderr)
    sys.exit(int(words["fail"]))
pathlib.Path(words["d"], "result.txt").write_text(deck["value"])
print("end", words["jobid"], os.getpid(), time.time(), file=log, flush=True)
"""


def deck(value, wait=0.0):
    return f"value {value}\nwait {wait}\n"


def measure(job, folder):
    try:
        return {"value": int((folder / "result.txt").read_text()), "third": 1.0 / 3.0}
    except ValueError as problem:
        raise UserError(str(problem)) from problem


class Bench:
    """A study folder, the program and its log."""

    def __init__(self, folder):
        self.folder, self.log = folder / "sweep", folder / "log.txt"
        self.program = folder / "program"
        self.program.write_text(PROGRAM.format(python=sys.executable, log=str(self.log)))
        self.program.chmod(0o755)

    def sweep(self):
        return runner.Sweep(self.folder, self.program, command.file_digest(self.program))

    def run(self, jobs, parallel=1, retry=False):
        """Run them; returns the jobids that the program has seen begin, in order."""
        self.log.write_text("")
        self.sweep().run(jobs, parallel, Progress(), retry)
        return [line.split()[1] for line in self.log.read_text().splitlines()
                if line.startswith("begin")]

    def rows(self, jobs):
        """The rows of the table, without their empty cells."""
        found = table.table_of(Study("tiny", None, measure, None), jobs, self.sweep()).to_dict("records")
        return [{name: value for name, value in row.items() if value == value} for row in found]


@pytest.fixture
def bench(tmp_path):
    return Bench(tmp_path)


def three(**named):
    return [Job(name, deck(number), name, labels={"number": number}, **named)
            for number, name in enumerate("abc")]


def test_finished_runs_are_not_run_again(bench):
    assert bench.run(three()) == ["a", "b", "c"]
    assert bench.run(three()) == []
    assert [row["value"] for row in bench.rows(three())] == [0, 1, 2]


def test_what_has_changed_is_run_anew(bench):
    bench.run(three())
    jobs = three()
    jobs[0] = Job("a", deck(7), "a", labels={"number": 0})
    assert bench.run(jobs) == ["a"]
    assert bench.rows(jobs)[0]["value"] == 7
    jobs[1] = Job("b", deck(1), "b", ("p:x=1",))
    assert bench.run(jobs) == ["b"]
    jobs[2] = Job("c", deck(2), "c", environment={"OMP_NUM_THREADS": "1"})
    assert bench.run(jobs) == ["c"]
    with open(bench.program, "a") as stream:
        stream.write("# another version\n")
    assert bench.rows(jobs)[0] == {"run": "a", "repeat": 1, "number": 0, "state": "missing"}
    assert bench.run(jobs) == ["a", "b", "c"]


def test_a_failed_run_is_a_result(bench):
    jobs = three()
    jobs[1] = Job("b", deck(1), "b", ("fail=2",))
    assert bench.run(jobs) == ["a", "b", "c"]
    row = bench.rows(jobs)[1]
    assert (row["state"], row["status"]) == ("failed", 2)
    assert row["message"] == "deck.k: line 3: a mistake"
    assert (bench.folder / "runs" / "b" / "b.k").read_text() == deck(1)
    assert bench.run(jobs) == []
    assert bench.run(jobs, retry=True) == ["b"]


def test_a_run_over_its_limit_is_stopped_and_has_failed(bench):
    jobs = [Job("slow", deck(1, wait=30.0), "slow", limit=0.2), *three()]
    start = time.monotonic()
    assert bench.run(jobs) == ["slow", "a", "b", "c"]
    assert time.monotonic() - start < 20.0
    row = bench.rows(jobs)[0]
    assert row["state"] == "failed" and row["message"] == "stopped after 0.2 s"


def test_a_run_stopped_from_outside_is_no_result(bench, capsys):
    jobs = [Job("x", deck(1), "x", ("fail=4",)), *three()]
    assert bench.run(jobs) == ["x", "a", "b", "c"]
    assert "x was killed" in capsys.readouterr().out
    assert bench.rows(jobs)[0]["state"] == "missing"
    assert bench.run(jobs) == ["x"]


def test_what_can_not_be_measured_has_failed(bench):
    jobs = [Job("a", deck("nothing"), "a")]
    bench.run(jobs)
    row = bench.rows(jobs)[0]
    assert row["state"] == "failed" and "invalid literal" in row["message"]


def most_at_once(log):
    """Largest number of processes between their begin and their end."""
    events = sorted((float(line.split()[3]), line.startswith("begin")) for line in
                    log.read_text().splitlines())
    running = most = 0
    for _, begun in events:
        running += 1 if begun else -1
        most = max(most, running)
    return most


def waiting_jobs(alone):
    return [Job(f"w{number}", deck(number, wait=0.4), f"w{number}", alone=alone)
            for number in range(4)]


@pytest.mark.parametrize("parallel, alone, most", [(1, False, 1), (2, False, 2), (2, True, 1)])
def test_runs_side_by_side(bench, parallel, alone, most):
    assert sorted(bench.run(waiting_jobs(alone), parallel)) == ["w0", "w1", "w2", "w3"]
    assert most_at_once(bench.log) == most


def test_rounds_are_interleaved():
    jobs = [Job("a", ""), Job("b", "", turns=2)]
    names = [job.folder_name for job in interleave(jobs, 2)]
    assert names == ["a", "b", "b.2", "a.2", "b.3", "b.4"]
    with pytest.raises(ValueError):
        interleave([Job("a", ""), Job("a", "")], 1)


def test_more_repeats_keep_those_there_are(bench):
    assert bench.run(interleave(three(), 1)) == ["a", "b", "c"]
    assert bench.run(interleave(three(), 2)) == ["a", "b", "c"]
    assert sorted(path.name for path in (bench.folder / "runs").iterdir()) == [
        "a", "a.2", "b", "b.2", "c", "c.2"]


def test_parts_cover_all_and_keep_groups_together():
    jobs = interleave([Job(f"{scene}{k}", "", group=scene) for scene in "xyz" for k in (1, 2)], 2)
    parts = [part_of(jobs, index, 2) for index in (0, 1)]
    assert {job.group for job in parts[0]} == {"x", "z"} and {job.group for job in parts[1]} == {"y"}
    assert sorted(job.folder_name for part in parts for job in part) == sorted(
        job.folder_name for job in jobs)


def test_a_table_keeps_all_digits(bench, tiny):
    assert tiny() == 0
    assert pd.read_csv(bench.folder / "tiny.csv")["third"].tolist() == [1.0 / 3.0] * 4


def test_time_to_go():
    shown = Progress()
    shown.known(Job("a", ""), {"seconds": 10.0, "status": 0})
    shown.known(Job("b", ""), {"seconds": 30.0, "status": 0})
    shown.start([Job("b", "", repeat=2), Job("c", "", alone=True), Job("d", "", cost=3.0)], 2)
    assert shown.to_go() == 20.0 / 2 + 20.0 + 3 * 20.0 / 2
    assert [span(x) for x in (10.0, 300.0, 7200.0)] == [
        "about 10 s", "about 5 min", "about 2.0 h"]


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_one_renewed_line_on_a_terminal_and_plain_lines_elsewhere(bench, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    jobs = [Job("a", deck(1), "a"), Job("b", deck(2), "b", ("fail=2",)), Job("c", deck(3), "c")]
    terminal, pipe = Terminal(), io.StringIO()
    bench.sweep().run(jobs, 1, Progress(terminal))
    shown = terminal.getvalue()
    assert shown.count("\n") == 2  # the failure and the end stay
    assert all(len(line) <= 59 for line in shown.replace("\n", "\r").split("\r"))
    assert "\rb failed: deck.k: line 3: a mistake" in shown and "\r1 of 3 runs, about" in shown
    bench.sweep().run([*jobs, Job("d", deck(4), "d")], 1, Progress(pipe))
    assert pipe.getvalue().splitlines()[0] == "3 of 4 runs have finished before"
    assert pipe.getvalue().splitlines()[1].startswith("4 of 4 runs, 1 failed; d took ")


# ---- the command -------------------------------------------------------------------------------

STUDY_FILE = """
import test_study
from slideline_tools.studies.framework.job import Job, Study


def jobs(options):
    return [Job(f"t{t}_{n}", test_study.deck(10 * t + n, wait=WAIT), "run",
                labels={"type": t, "number": n}) for t in options.types for n in range(options.levels[0])]


def chart(rows, folder):
    (folder / "chart.svg").write_text(str(len(rows)))


WAIT = 0.0
STUDY = Study("tiny", jobs, test_study.measure, chart, levels=(2,), types=(1, 2), quick_levels=(1,))
"""


@pytest.fixture
def tiny(bench, tmp_path, monkeypatch):
    """The command line with a study `tiny` of four runs and the bench's program and folder."""
    (tmp_path / "tiny_study.py").write_text(STUDY_FILE)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "tiny_study", raising=False)
    monkeypatch.setattr(pages, "load", lambda name: __import__("tiny_study").STUDY)
    monkeypatch.setitem(pages.STUDIES, "tiny", "tiny")

    def run(*arguments):
        return command.main(["tiny", "--program", str(bench.program), "--folder",
                             str(bench.folder), *arguments])
    return run


def test_command_writes_table_and_chart(tiny, bench):
    assert tiny() == 0
    rows = pd.read_csv(bench.folder / "tiny.csv")
    assert rows["value"].tolist() == [10, 11, 20, 21] and set(rows["state"]) == {"finished"}
    assert (bench.folder / "chart.svg").read_text() == "4"
    assert json.loads((bench.folder / "runs/t1_0/job.json").read_text())["status"] == 0


def test_command_options(tiny, bench, capsys):
    assert tiny("--types", "2", "--quick") == 0
    assert pd.read_csv(bench.folder / "tiny.csv")["value"].tolist() == [20]
    assert tiny("--only", "t1*", "--list") == 0
    assert capsys.readouterr().out.splitlines()[-2:] == ["to run    t1_0", "to run    t1_1"]
    assert tiny("--part", "0/2") == 0 and tiny("--part", "1/2", "-j", "2") == 0
    assert tiny("--collect", "--repeats", "2") == 0
    assert "8 runs, 4 missing" in capsys.readouterr().out


@pytest.mark.parametrize("arguments", [("--part", "2/2"), ("--part", "x"), ("-j", "0"),
                                       ("--repeats", "0"), ("--only", "nothing"), ("--types", "7i"),
                                       ("--quick", "--publish")])
def test_command_refuses(tiny, capsys, arguments):
    assert tiny(*arguments) == 2
    assert capsys.readouterr().err.startswith("study: ")


def test_all_goes_on_behind_a_study_that_fails(monkeypatch, capsys):
    done = []

    def perform(wanted):
        done.append((wanted.name, wanted.publish))
        if len(done) == 1:
            raise UserError("no runs")

    monkeypatch.setattr(command, "perform", perform)
    assert command.main(["all", "--publish"]) == command.UNUSABLE
    assert done == [(name, True) for name in pages.STUDIES] and "study: no runs" in capsys.readouterr().err


def test_pictures_of_the_page_are_those_that_the_chart_has_drawn(tiny, bench, monkeypatch, capsys):
    def chart(_, folder):
        (folder / "a.png").write_text("picture")

    made = dataclasses.replace(pages.load("tiny"), chart=chart, page=lambda _: "# Tiny\n\n![a](../pictures/a.png)\n")
    monkeypatch.setattr(pages, "load", lambda name: made)
    monkeypatch.setitem(pages.PAGES, "tiny", pages.Page("paper", ()))
    assert tiny() == 0
    assert (bench.folder / "doc/pictures/a.png").read_text() == "picture"
    assert pages.ORIGIN.search((bench.folder / "doc/studies/tiny.md").read_text())["source"] == "unknown"
    assert tiny("--publish") == 2
    assert "committed, not from unknown" in capsys.readouterr().err


def test_one_command_at_a_time(tiny, bench, capsys):
    with command.held(bench.folder, shared=False):
        assert tiny() == 2
    assert "under way" in capsys.readouterr().err
    with command.held(bench.folder, shared=True):
        assert tiny() == 2 and tiny("--part", "0/1") == 0


DRIVER = """
import sys
sys.path[:0] = {paths!r}
import tiny_study
tiny_study.WAIT = 0.6
from slideline_tools.studies import __main__ as command
from slideline_tools.studies.framework import pages
pages.load = lambda name: tiny_study.STUDY
pages.STUDIES["tiny"] = "tiny"
sys.exit(command.main(["tiny", "--program", {program!r}, "--folder", {folder!r}, "-j", "1"]))
"""


def begun(log):
    return [line.split() for line in log.read_text().splitlines() if line.startswith("begin")]


def start_and_wait_for_second_run(bench, tmp_path):
    """A study in a process of its own, in the middle of its second run."""
    (tmp_path / "tiny_study.py").write_text(STUDY_FILE)
    bench.log.write_text("")
    text = DRIVER.format(paths=[str(tmp_path), str(pathlib.Path(__file__).parent), str(TOOLS)],
                         program=str(bench.program), folder=str(bench.folder))
    process = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 20.0
    while len(begun(bench.log)) < 2 and time.monotonic() < deadline:
        time.sleep(0.01)
    return process, text


@pytest.mark.parametrize("how, status", [(signal.SIGKILL, -signal.SIGKILL), (signal.SIGTERM, 4),
                                         (signal.SIGINT, 4)])
def test_goes_on_after_a_kill(bench, tmp_path, how, status):
    process, text = start_and_wait_for_second_run(bench, tmp_path)
    process.send_signal(how)
    process.communicate(timeout=20)
    assert process.returncode == status
    second = begun(bench.log)[1]
    for _ in range(200):  # the run dies with its sweep
        if not os.path.exists(f"/proc/{second[2]}"):
            break
        time.sleep(0.02)
    assert "end " + second[1] + " " + second[2] not in bench.log.read_text()
    finished = [path.parent.name for path in bench.folder.glob("runs/*/job.json")]
    assert finished == ["t1_0"]
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60,
                          check=False)
    assert done.returncode == 0, done.stderr
    assert "1 of 4 runs have finished before" in done.stdout
    assert len(begun(bench.log)) == 2 + 3
    assert pd.read_csv(bench.folder / "tiny.csv")["value"].tolist() == [10, 11, 20, 21]


def test_every_study_has_unique_runs():
    for name in pages.STUDIES:
        study = pages.load(name)
        assert study.name == name
        quick = study.jobs(Options(tuple(study.quick_levels), tuple(study.types), True, 1))
        assert interleave(quick, 1)
