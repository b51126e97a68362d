# SPDX-License-Identifier: MIT
"""Names of results that are taken, shared or lost, faults of the disk at every call, and an environment full of traps."""
import json
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from conftest import drop, is_full

KINDS = ("pipe", "link", "dangling link")
#: What is lost, and how; where not in full each name in two ways and each way with two names.
LOST = [(name, how) for k, name in enumerate(("slow.vtkhdf", "slow.glstat.csv", "slow.log"))
        for i, how in enumerate(("removed", "emptied", "renamed")) if is_full() or i != k]


@pytest.fixture(scope="module")
def deck(tmp_path_factory):
    """A deck with all kinds of results, and the folder of an undisturbed run."""
    folder = tmp_path_factory.mktemp("names")
    text = drop().text().rsplit("*END", 1)[0] + "*DATABASE_BINARY_D3DUMP\n50,\n*DATABASE_BINARY_RUNRSF\n20,\n*END\n"
    (folder / "job.k").write_text(text)
    return folder


def run(exe, folder, *words, **more):
    return subprocess.run([exe, *words], cwd=folder, capture_output=True, text=True, timeout=60, check=False, **more)


def snapshot(folder):
    """What a folder holds: name -> (inode, length, time of the last change)."""
    return {path.name: (entry.st_ino, entry.st_size, entry.st_mtime_ns) for path in Path(folder).iterdir()
            for entry in [path.lstat()]}


def inodes(folder):
    """name -> inode; the results file may take its own name between two looks, status.out is replaced."""
    return {name.removesuffix(".part"): facts[0] for name, facts in snapshot(folder).items() if "status" not in name}


@pytest.fixture(scope="module")
def whole(exe, deck):
    assert run(exe, deck, "i=job.k", "d=whole").returncode == 0
    return deck / "whole"


@pytest.mark.parametrize("kind", KINDS)
def test_a_pipe_or_a_link_is_refused_before_anything_is_touched(exe, deck, whole, kind):
    """One rule for all: the names of an undisturbed run are the names that must be looked at; where not in full each with one
    kind, in turn."""
    names = {path.name for path in whole.iterdir()}
    assert {"job.log", "job.vtkhdf", "job.glstat.csv", "job.runrsf.h5", "job.dump01.h5", "status.out",
            "job.effective.k", "job.timing.csv"} <= names
    assert "job.dump06.h5" not in names
    looked = sorted(names | {"job.dump07.h5", "job.dump99.h5"})  # numbers behind a gap
    for name in looked if is_full() else looked[KINDS.index(kind)::len(KINDS)]:
        folder = deck / "taken"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(whole, folder)
        (folder / name).unlink(missing_ok=True)
        target = deck / "target"
        target.write_text("mine\n")
        if kind == "pipe":
            os.mkfifo(folder / name)
        else:
            (folder / name).symlink_to(target if kind == "link" else deck / "nowhere")
        before = snapshot(folder)
        done = run(exe, deck, "i=job.k", "d=taken")
        assert done.returncode == 3, (name, done.stderr)
        assert f"taken/{name}" in done.stderr and ("pipe" in done.stderr or "link" in done.stderr), done.stderr
        assert snapshot(folder) == before, name
        assert target.read_text() == "mine\n" and not (deck / "nowhere").exists()


def test_numbered_restart_files_that_no_deck_asks_for(exe, deck):
    """The first name is looked at all the same; what stands under a later one is not in the way, and stays."""
    (deck / "plain.k").write_text(drop(end_time=0.002).text())
    for number, status in ((1, 3), (50, 0)):
        folder = deck / f"number{number}"
        folder.mkdir()
        link = folder / f"plain.dump{number:02d}.h5"
        link.symlink_to(deck / "nowhere")
        done = run(exe, deck, "i=plain.k", f"d={folder.name}")
        assert done.returncode == status and (status == 0 or link.name in done.stderr), done.stderr
        assert link.is_symlink() and not (deck / "nowhere").exists()


def test_a_hard_link_or_a_folder_that_is_a_link_serves(exe, deck, whole):
    (deck / "real").mkdir()
    (deck / "linked").symlink_to(deck / "real")
    assert run(exe, deck, "i=job.k", "d=linked").returncode == 0
    assert (deck / "real" / "job.glstat.csv").read_bytes() == (whole / "job.glstat.csv").read_bytes()


def test_no_result_is_written_through_a_hard_link(exe, deck, whole):
    """After cp -al of a folder the other names keep what they have, whether the run begins anew or goes on."""
    for words in (["i=job.k", "endtim=0.011"], ["r=again/job.dump03.h5"]):
        shutil.rmtree(deck / "again", ignore_errors=True)
        shutil.rmtree(deck / "kept", ignore_errors=True)
        shutil.copytree(whole, deck / "again")
        (deck / "again" / "job.vtkhdf.part").write_text("left by a killed run\n")
        (deck / "again" / "job.dump60.h5.part").write_text("behind a gap\n")
        shutil.copytree(deck / "again", deck / "kept", copy_function=os.link)
        before = {path.name: path.read_bytes() for path in (deck / "kept").iterdir()}
        done = run(exe, deck, *words, "d=again")
        assert done.returncode == 0, done.stderr
        assert {path.name: path.read_bytes() for path in (deck / "kept").iterdir()} == before
        kept, now = before["job.log"], (deck / "again" / "job.log").read_bytes()
        assert now.startswith(kept) == words[0].startswith("r=") and now.count(b"N o r m a l") == 1 + now.startswith(kept)


OWN = ("job.log", "job.effective.k", "job.glstat.csv", "job.glstat", "job.timing.csv", "job.vtkhdf", "status.out",
       "job.status.out.part", "job.runrsf.h5", "job.dump02.h5", "d3kil")
WAYS = ("deck", "included", "linked")


@pytest.mark.parametrize("name, way", [(name, way) for k, name in enumerate(OWN) for i, way in enumerate(WAYS)
                                       if is_full() or k % len(WAYS) == i])
def test_a_file_that_the_run_reads_is_no_name_of_a_result(exe, deck, name, way):
    """By whatever path, where not in full each name by one of them, in turn; refused before anything is written."""
    folder = deck / "own"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    shutil.copy(deck / "job.k", folder / name)
    word = f"i=./own/{name}"
    if way == "included":
        (folder / "job.k").write_text(f"*KEYWORD\n*INCLUDE\n{name}\n*END\n")
        word = "i=own/job.k"
    elif way == "linked":
        (deck / "own.k").unlink(missing_ok=True)
        (deck / "own.k").symlink_to(folder / name)
        word = "i=own.k"
    before = snapshot(folder)
    done = run(exe, deck, word, "d=own", "jobid=job")
    assert done.returncode == 3 and name in done.stderr and "which this run reads" in done.stderr, done.stderr
    assert snapshot(folder) == before
    done = run(exe, deck, word, "d=other", "jobid=job")
    assert done.returncode == 0, "another folder is no matter"


def test_a_restart_file_is_no_name_of_a_result(exe, deck, whole):
    """But for the running one, which is replaced, and the numbers that are past; the deck of changes is looked at too."""
    (deck / "more.k").write_text("*KEYWORD\n*CONTROL_TERMINATION\n0.021\n*END\n")
    for source, name, changes, status in (("job.dump03.h5", "job.dump03.h5", "more.k", 0), ("job.runrsf.h5",) * 2 + ("more.k", 0),
                                          ("job.dump03.h5", "job.dump05.h5", "more.k", 3),
                                          ("job.dump03.h5", "job.timing.csv", "more.k", 3),
                                          ("job.dump03.h5", "job.dump03.h5", "own/job.timing.csv", 3)):
        shutil.rmtree(deck / "own", ignore_errors=True)
        shutil.copytree(whole, deck / "own")
        if name != source:
            shutil.copy(whole / source, deck / "own" / name)
        if changes != "more.k":
            shutil.copy(deck / "more.k", deck / changes)
        before = snapshot(deck / "own")
        done = run(exe, deck, f"r=own/{name}", f"i={changes}", "d=own")
        assert done.returncode == status, (name, changes, done.stderr)
        assert status == 0 or "which this run reads" in done.stderr and snapshot(deck / "own") == before, done.stderr


@pytest.fixture
def slow(exe, deck):
    """A run that goes on until it is ended."""
    (deck / "slow.k").write_text(drop(end_time=1.0e4).text().replace("*DATABASE_BINARY_D3PLOT\n0.002",
                                                                       "*DATABASE_BINARY_D3PLOT\n2.0"))
    shutil.rmtree(deck / "slow", ignore_errors=True)
    process = subprocess.Popen([exe, "i=slow.k", "d=slow"], cwd=deck, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True)
    for _ in range(1500):
        if all((deck / "slow" / name).exists() for name in ("status.out", "slow.vtkhdf")):
            break
        time.sleep(0.02)
    yield process
    process.kill()
    process.communicate()


def test_two_runs_of_one_name_exclude_each_other(exe, deck, slow):
    before = inodes(deck / "slow")
    done = run(exe, deck, "i=slow.k", "d=slow")
    assert done.returncode == 3 and "another run" in done.stderr and "jobid=" in done.stderr, done.stderr
    after = inodes(deck / "slow")
    assert before == after and (deck / "slow" / "slow.log").stat().st_size > 0
    other = subprocess.run([exe, "i=job.k", "d=slow", "jobid=other"], cwd=deck, capture_output=True, timeout=60, check=False)
    assert other.returncode == 0, "another name beside it is no matter"
    slow.kill()
    slow.wait()
    assert run(exe, deck, "i=job.k", "d=slow", "jobid=slow").returncode == 0, "a killed run blocks none"


@pytest.mark.parametrize("name, how", LOST)
def test_results_that_are_lost_during_a_run_are_noticed(deck, slow, name, how):
    path = deck / "slow" / name
    for _ in range(200):
        if path.exists() and path.stat().st_size > 0:
            break
        time.sleep(0.02)
    if how == "removed":
        path.unlink()
    elif how == "emptied":
        os.truncate(path, 0)
    else:
        path.rename(deck / "slow" / "elsewhere")
    (deck / "slow" / "d3kil").write_text("sw4\n")  # a plot state, so that something is written
    try:
        slow.wait(1.2)
    except subprocess.TimeoutExpired:
        slow.send_signal(signal.SIGTERM)
    said, complaint = slow.communicate(timeout=20)
    assert slow.returncode == 3, (slow.returncode, complaint)
    assert f"slow/{name}" in complaint and ("removed or renamed" in complaint or "changed" in complaint), complaint
    assert "N o r m a l" not in said or name == "slow.log"


TRAPS = {"GFORTRAN_OPTIONAL_PLUS": "y", "GFORTRAN_DEFAULT_RECL": "20", "GFORTRAN_LIST_SEPARATOR": ";",
         "GFORTRAN_CONVERT_UNIT": "big_endian", "GFORTRAN_UNBUFFERED_ALL": "y", "GFORTRAN_UNBUFFERED_PRECONNECTED": "y",
         "GFORTRAN_STDOUT_UNIT": "17", "GFORTRAN_STDERR_UNIT": "18", "GFORTRAN_STDIN_UNIT": "19",
         "GFORTRAN_FORMATTED_BUFFER_SIZE": "2", "GFORTRAN_UNFORMATTED_BUFFER_SIZE": "2", "GFORTRAN_SHOW_LOCUS": "n"}


def test_variables_of_the_runtime_change_nothing(exe, deck, whole):
    """Same names, same bytes, same lines on the screen but for times of day and durations."""
    plain = run(exe, deck, "i=job.k", "d=whole2")
    done = run(exe, deck, "i=job.k", "d=trapped", env={**os.environ, **TRAPS})
    assert (done.returncode, done.stderr) == (0, plain.stderr)
    names = sorted(path.name for path in whole.iterdir())
    assert sorted(path.name for path in (deck / "trapped").iterdir()) == names
    assert not list(deck.glob("fort.*"))
    for name in names:
        if name.endswith(".csv") and "timing" not in name or name.endswith("effective.k"):
            assert (deck / "trapped" / name).read_bytes() == (whole / name).read_bytes(), name

    def shape(text):
        return re.sub(r"[\d.E+-]+", "0", re.sub(r"[+]\d", "PLUS", text.replace("E+", "E")).replace("trapped", "whole2")
                      ).replace(" ", "")

    assert shape(done.stdout) == shape(plain.stdout)
    log = (deck / "trapped" / "job.log").read_text()
    assert shape(log) == shape((deck / "whole2" / "job.log").read_text())
    timing = (deck / "trapped" / "job.timing.csv").read_text()
    assert "+" not in timing and timing.count("\n") == (whole / "job.timing.csv").read_text().count("\n")


def test_a_first_signal_does_not_kill(exe, deck):
    """SIGUSR1 and SIGUSR2 from the first instruction of the program on; before that the shell can have them ignored."""
    (deck / "usr.k").write_text(drop(end_time=0.2).text())
    for delay in (0.0, 0.005, 0.02):
        process = subprocess.Popen(["sh", "-c", 'trap "" USR1 USR2; exec "$0" i=usr.k d=usr', exe], cwd=deck,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(0.05)  # of the shell
        deadline = time.monotonic() + delay + 0.05
        while time.monotonic() < deadline and process.poll() is None:
            process.send_signal(signal.SIGUSR1)
            process.send_signal(signal.SIGUSR2)
            time.sleep(0.0005)
        _, complaint = process.communicate(timeout=60)
        assert process.returncode == 0, complaint


def test_requests_while_a_deck_is_read_are_heeded(exe, deck):
    """A deck that takes a while: SIGUSR1 before its run begins makes a restart file at the first chance."""
    pipe_deck = drop(end_time=0.02).text()
    lines = "\n".join(f"{1000 + i},{i * 1.0},99.0" for i in range(100000))
    (deck / "long.k").write_text(pipe_deck.replace("*NODE\n", f"*NODE\n{lines}\n", 1))
    process = subprocess.Popen([exe, "i=long.k", "d=long"], cwd=deck, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(2000):  # until the program itself runs
        about = Path(f"/proc/{process.pid}")
        if about.joinpath("exe").resolve() == Path(exe) and \
                int(re.search(r"SigCgt:\s+([0-9a-f]+)", about.joinpath("status").read_text())[1], 16) & (1 << 9):
            break
        time.sleep(0.001)
    process.send_signal(signal.SIGUSR1)
    _, complaint = process.communicate(timeout=120)
    assert process.returncode == 0, complaint
    assert (deck / "long" / "long.dump01.h5").exists()


@pytest.mark.parametrize("word", ["job.k", "wrong.k"])
def test_json_that_cannot_be_written_is_an_error_of_files(exe, deck, word):
    (deck / "wrong.k").write_text("*KEYWORD\n*NODEX\n*END\n")
    with open("/dev/full", "w", encoding="ascii") as full:
        done = subprocess.run([exe, "check", word, "--json"], cwd=deck, stdout=full, stderr=subprocess.PIPE, text=True,
                              timeout=60, check=False)
    assert done.returncode == 3 and "standard output" in done.stderr, done.stderr


BYTES = {b"Pr\xfcfung": "Pr\xfcfung", "Prüfung".encode(): "Prüfung", b"\xc0\xaf": "\xc0\xaf", b"\xed\xa0\x80": "\xed\xa0\x80",
         b"\xf4\x90\x80\x80": "\xf4\x90\x80\x80", b"\xe2\x82": "\xe2\x82", "€𝄞".encode(): "€𝄞", b"\x01\x7f\"\\": "\x01\x7f\"\\",
         b"\xff\xfe": "\xff\xfe"}


@pytest.mark.parametrize("found", BYTES)
def test_json_is_utf8_whatever_the_names(exe, deck, found):
    """Bytes that are no UTF-8 are read as Latin-1."""
    # Control characters are refused in arguments.
    name = b"bytes " + bytes(byte for byte in found if byte >= 32 and byte != 127) + b".k"
    with open(os.path.join(os.fsencode(deck), name), "wb") as stream:
        stream.write(b"*KEYWORD\n*CONTROL_TERMINATION\n" + found + b"\n*NODEX" + found + b"\n*END\n")
    done = subprocess.run([os.fsencode(exe), b"check", name, b"--json"], cwd=deck, capture_output=True, timeout=60, check=False)
    answer = json.loads(done.stdout.decode("utf-8", errors="strict"))
    assert done.returncode == 1
    assert answer["deck"] == f"bytes {BYTES[found].translate({1: None, 127: None})}.k"
