# SPDX-License-Identifier: MIT
"""The scripts that run folders and sweeps and compare them, with blanks in every path."""
import csv
import os
import pathlib
import re
import shlex
import signal
import subprocess
import sys
import time

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BATCH = ROOT / "tools" / "batch"

#: Stands for the program: says what it was reported, and ends as the deck's first line says.
FAKE = """#!/bin/sh
[ "$1" != --version ] || { echo fake 1; exit 0; }
for word in "$@"; do
  case $word in i=*) deck=${word#i=} ;; d=*) folder=${word#d=} ;; jobid=*) job=${word#jobid=} ;; esac
done
printf '%s|' "$@" >>"$folder/reported.txt"
echo >>"$folder/reported.txt"
printf ' Elapsed time        = 1.250 seconds\\n Warnings            = 3\\n' >"$folder/$job.log"
printf ' %-32s %s\\n' 'cycle no.' 17 time 2.5E-01 'time step' 9.0 'energy ratio' 1.01 >"$folder/status.out"
echo "time,fx
0.0,1.0
1.0,$(sed -n 's/^.. *force *//p' "$deck")" >"$folder/$job.rcforc.csv"
exit "$(sed -n '1s/^.. *ends *//p' "$deck")"
"""


@pytest.fixture
def place(tmp_path):
    """A folder with blanks and a quote in its name, with the fake program in it."""
    folder = tmp_path / "some one's folder"
    folder.mkdir()
    program = folder / "the program"
    program.write_text(FAKE)
    program.chmod(0o755)
    return folder


def deck(path, ends=0, force=2.0, more=""):
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"$ ends {ends}\n$ force {force}\n*KEYWORD\n{more}*END\n")


def call(place, script, *words, program=None, **variables):
    environment = {**os.environ, "SLIDELINE": str(program or place / "the program"), **variables}
    return subprocess.run([BATCH / script, *map(str, words)], cwd=place, env=environment, capture_output=True,
                          text=True, timeout=100)


def summary(folder):
    with open(folder / "summary.csv", newline="") as stream:
        return {row["run"]: row for row in csv.DictReader(stream)}


def reported(folder):
    return (folder / "reported.txt").read_text().splitlines()


@pytest.fixture
def decks(place):
    folder = place / "my decks"
    deck(folder / "first one.k", more="*INCLUDE\n$ the mesh\n  mesh part.k\n")
    deck(folder / "mesh part.k", 1)
    deck(folder / "second.key", 2)
    deck(folder / "third.dyn", 139)
    (folder / "notes.txt").write_text("no deck\n")
    return folder


def test_folder_of_decks(place, decks):
    done = call(place, "run_folder.sh", "-j", 2, "my decks", "ctype=5", "p:text=a b")
    assert done.returncode == 1
    rows = summary(decks / "results")
    assert [(name, row["status"], row["meaning"]) for name, row in rows.items()] == [
        ("first one", "0", "normal"), ("second", "2", "error termination"), ("third", "139", "crashed")]
    assert {k: rows["first one"][k] for k in ("time", "cycles", "seconds", "warnings", "energy_ratio")} == {
        "time": "2.5E-01", "cycles": "17", "seconds": "1.250", "warnings": "3", "energy_ratio": "1.01"}
    assert reported(decks / "results" / "first one") == [
        "i=my decks/first one.k|d=my decks/results/first one|jobid=first one|ctype=5|p:text=a b|"]
    assert "error termination" in done.stdout and "2 of the runs" in done.stderr


def test_what_has_ended_well_is_passed_over(place, decks):
    results = place / "results of mine"

    def again(*words):
        call(place, "run_folder.sh", "-o", results, "my decks", *words)
        return [len(reported(results / name)) for name in ("first one", "second")]
    assert again() == [1, 1]
    assert again() == [1, 2]
    deck(decks / "mesh part.k", 1, 3.0)
    assert again() == [2, 3]
    deck(decks / "third.dyn", 0)
    assert again() == [2, 4]
    assert summary(results)["third"]["status"] == "0"
    assert again("endtim=1.0") == [3, 5]
    call(place, "run_folder.sh", "--fresh", "-o", results, "my decks", "endtim=1.0")
    assert len(reported(results / "first one")) == 4


def test_many_runs_share_what_goes_before_them(place):
    """Several lines a call: each still has its own inputs, lock and folder, and one that can not begin costs no other."""
    for number in range(40):
        deck(place / "many" / f"run {number}.k", 2 if number == 7 else 0)
    (place / "many" / "results").mkdir()
    (place / "many" / "results" / "run 3").write_text("in the way\n")
    done = call(place, "run_folder.sh", "-j", 2, "many")
    rows = summary(place / "many" / "results")
    assert done.returncode == 1 and len(rows) == 40
    assert {name for name, row in rows.items() if row["status"] != "0"} == {"run 3", "run 7"}
    deck(place / "many" / "run 20.k", 0, 3.0)
    call(place, "run_folder.sh", "-j", 2, "many")
    assert {number for number in range(40) if number != 3 and len(reported(place / "many" / "results" / f"run {number}")) == 2} == {7, 20}


def test_another_build_runs_anew(place, decks):
    """A build from edited sources may say the same of itself."""
    program = place / "the program"
    for more, times in (("", 1), ("", 1), ("# edited\n", 2)):
        program.write_text(program.read_text() + more)
        call(place, "run_folder.sh", "my decks")
        assert len(reported(decks / "results" / "first one")) == times


def signalled(place, program, there, *words):
    """A folder run whose process group gets SIGUSR1 once `there()`; its exit status."""
    running = subprocess.Popen([BATCH / "run_folder.sh", "my decks", *words], cwd=place, start_new_session=True,
                               env={**os.environ, "SLIDELINE": str(program)}, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    try:
        end = time.monotonic() + 20.0
        while not there():
            assert time.monotonic() < end, "waited too long"
            time.sleep(0.02)
        os.killpg(running.pid, signal.SIGUSR1)
        return running.wait(timeout=60)
    finally:
        if running.poll() is None:
            os.killpg(running.pid, signal.SIGKILL)
            running.wait()


def test_signal_for_the_runs_leaves_the_scripts_alone(place):
    """Schedulers signal every process of a job (scancel --full): the runs go on and the table is made."""
    deck(place / "my decks" / "one.k")
    program, results = place / "the program", place / "my decks" / "results"
    program.write_text(FAKE.replace("exit \"$(sed", "sleep 0.5\nexit \"$(sed"))
    assert signalled(place, program, (results / "one" / "one.rcforc.csv").exists) == 0
    assert summary(results)["one"]["meaning"] == "normal"


def test_signal_reaches_the_program(place, slideline):
    """What the scripts ignore the program takes: a restart file, and the run goes on to its end."""
    (place / "my decks").mkdir()
    text = (ROOT / "input/collision/collision.k").read_text()
    (place / "my decks" / "one.k").write_text(text)
    folder = place / "my decks" / "results" / "one"

    def runs():
        found = folder / "status.out"
        return found.exists() and re.search(r"cycle no\. +[1-9]", found.read_text())
    assert signalled(place, slideline, runs, "endtim=1.0e-2") == 0
    assert (folder / "one.dump01.h5").exists()
    assert summary(folder.parent)["one"]["meaning"] == "normal"


def test_example_of_the_sweep(place, slideline):
    """The call in the head of the script is taken by the program (each run cut short)."""
    example = re.search(r"^#   tools/batch/sweep.sh (.*)$", (BATCH / "sweep.sh").read_text(), re.M)[1]
    words = [str(ROOT / word) if word.startswith("input/") else word for word in shlex.split(example)]
    done = call(place, "sweep.sh", *words, "endtim=1.0e-6", program=slideline)
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(summary(place / "results" / "sweep")) == 6


def test_sweep_runs_every_combination(place):
    deck(place / "one deck.k")
    done = call(place, "sweep.sh", "-j", 3, "-o", "swept here", "one deck.k", "ctype=1,5", "p:speed=-1.5,2e3,/x y")
    assert done.returncode == 0, done.stderr
    rows = summary(place / "swept here")
    assert list(rows) == [f"ctype_{c}_speed_{s}" for c in (1, 5) for s in ("-1.5", "2e3", "_x_y")]
    assert reported(place / "swept here" / "ctype_5_speed__x_y")[0].endswith("|ctype=5|p:speed=/x y|")


def test_arrays_share_the_work(place, decks):
    for task in range(2):
        done = call(place, "slurm.sh", "run_folder.sh", "my decks", SLURM_SUBMIT_DIR=str(ROOT),
                    SLURM_ARRAY_TASK_ID=str(task), SLURM_ARRAY_TASK_COUNT="2")
        assert done.returncode == 0, done.stderr
        there = {path.parent.name for path in (decks / "results").glob("*/reported.txt")}
        assert there == ({"first one", "third"} if task == 0 else {"first one", "second", "third"})
    done = call(place, "slurm.sh", "run_folder.sh", "--collect", "my decks", SLURM_SUBMIT_DIR=str(ROOT))
    assert done.returncode == 1 and len(summary(decks / "results")) == 3
    assert all(len(reported(path.parent)) == 1 for path in (decks / "results").glob("*/reported.txt"))


def test_job_of_many_processes(place):
    """The launcher gets the program with its words and the threads of a task; without a program nothing is launched."""
    (place / "launch").write_text("""#!/bin/sh
printf '%s|' "$@" >launched.txt
""")
    (place / "launch").chmod(0o755)
    (place / "tools").symlink_to(ROOT / "tools")
    words = {"LAUNCH": "./launch -n 8", "SLURM_SUBMIT_DIR": ".", "SLURM_CPUS_PER_TASK": "2"}
    assert call(place, "slurm.sh", "ranks", "i=one deck.k", "d=out", **words).returncode == 0
    assert (place / "launched.txt").read_text() == f"-n|8|{place / 'the program'}|i=one deck.k|d=out|ncpu=2|"
    (place / "launched.txt").unlink()
    done = call(place, "slurm.sh", "ranks", "i=one deck.k", program="none", **words)
    assert done.returncode == 2 and "no such program" in done.stderr and not (place / "launched.txt").exists()


@pytest.mark.parametrize("script, words", [
    ("slurm.sh", []), ("slurm.sh", ["compare_folder.sh"]), ("run_folder.sh", []), ("run_folder.sh", ["none"]), ("run_folder.sh", ["empty"]),
    ("run_list.sh", ["none", "out"]), ("sweep.sh", ["-o", "out", "none.k", "a=1"]),
    ("sweep.sh", ["-o", "out", "one.k", "a"]), ("sweep.sh", ["one.k", "a=1"]), ("compare_folder.sh", ["none"]),
    ("compare_folder.sh", ["none", "empty"])])
def test_wrong_calls(place, script, words):
    (place / "empty").mkdir()
    deck(place / "one.k")
    done = call(place, script, *words)
    assert done.returncode == 2
    assert done.stderr


def test_a_list_makes_its_folder(place):
    deck(place / "one.k")
    (place / "list.txt").write_text("a\tone.k\n")
    done = call(place, "run_list.sh", "list.txt", "new/out")
    assert done.returncode == 0, done.stderr
    assert (place / "new/out/summary.csv").is_file() and (place / "new/out/a/run.status").read_text() == "0\n"


def test_missing_program_is_said(place, decks):
    done = call(place, "run_folder.sh", "my decks", program=place / "gone")
    assert done.returncode == 2 and "no such program" in done.stderr


@pytest.fixture
def tools(place):
    """A command slideline-tools without an installation."""
    path = place / "the tools"
    path.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}/tools" exec "{sys.executable}" -c \''
                    'import sys; from slideline_tools.cli import main; sys.exit(main())\' "$@"\n')
    path.chmod(0o755)
    return str(path)


def test_folders_are_compared(place, tools):
    decks = place / "my decks"
    for name in ("a", "b b"):
        deck(decks / f"{name}.k")
    assert call(place, "run_folder.sh", "-o", "kept", "my decks").returncode == 0
    assert call(place, "run_folder.sh", "-o", "new", "my decks").returncode == 0
    done = call(place, "compare_folder.sh", "new", "kept", TOOLS=tools)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.splitlines()[-1] == "2 agreed, 0 failed, 0 missing or not comparable"
    deck(decks / "b b.k", force=2.1)
    call(place, "run_folder.sh", "-o", "new", "my decks")
    done = call(place, "compare_folder.sh", "new", "kept", TOOLS=tools)
    assert done.returncode == 1
    assert [line.split()[0] for line in done.stdout.splitlines()[1:3]] == ["agreed", "failed"]
    assert "b b/b b.rcforc.csv  (failed: fx)" in done.stdout
    assert call(place, "compare_folder.sh", "--rtol", 0.2, "new", "kept", TOOLS=tools).returncode == 0
    (place / "new" / "a" / "a.rcforc.csv").unlink()
    done = call(place, "compare_folder.sh", "new", "kept", TOOLS=tools)
    assert done.returncode == 2 and "1 failed, 1 missing" in done.stdout


def test_with_the_program(place, slideline):
    """Two of the stock decks and a sweep of one, by the program itself."""
    stock = ROOT / "tests" / "program" / "stock"
    (place / "stock").mkdir()
    for name in ("includes", "includes_mesh", "unsupported"):
        (place / "stock" / f"stock {name}.k").write_text(
            (stock / f"stock_{name}.k").read_text().replace("stock_includes_mesh.k", "stock includes_mesh.k"))
    assert call(place, "run_folder.sh", "stock", program=slideline).returncode == 1
    rows = summary(place / "stock" / "results")
    assert {name: row["status"] for name, row in rows.items()} == {"stock includes": "0",
                                                                   "stock unsupported": "1"}
    assert float(rows["stock includes"]["time"]) == pytest.approx(4.0e-5, rel=2e-2)
    done = call(place, "sweep.sh", "-o", "swept", "stock/stock includes.k", "ctype=1,7", program=slideline)
    assert done.returncode == 0, done.stdout + done.stderr
    forces = [(place / "swept" / name / f"{name}.rcforc.csv").read_text() for name in ("ctype_1", "ctype_7")]
    assert forces[0] != forces[1]
