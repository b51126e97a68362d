# SPDX-License-Identifier: MIT
"""Input that no one should give: files without end, include loops, numbers at the edges. Each has a defined end.
A short run of the fuzzer (tests/lab/fuzz) stands last."""
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import drop, is_full, numbers

FUZZER = Path(__file__).resolve().parents[1] / "lab/fuzz" / "fuzz_decks.py"


def check(exe, folder, deck="job.k", seconds=20):
    """(status, what was said) of the check of a deck; a hang fails."""
    done = subprocess.run([exe, "check", deck], cwd=folder, capture_output=True, text=True, timeout=seconds,
                          stdin=subprocess.DEVNULL, errors="replace", check=False)
    assert done.returncode in range(5) and "Backtrace" not in done.stderr, done.stderr
    return done.returncode, done.stderr


def changed(pattern, replacement, text=None):
    """The drop deck with one change, which must be one."""
    text, count = re.subn(pattern, replacement, text or drop().text(), count=1, flags=re.MULTILINE)
    assert count == 1, pattern
    return text


@pytest.mark.parametrize("name", ["pipe", "/dev/zero", "/dev/null", "/dev/urandom", ".", "/proc/self/mem", "empty.k"])
@pytest.mark.parametrize("place", ["deck", "include", "restart"])
def test_what_is_no_file_is_refused(exe, tmp_path, name, place):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "empty.k").write_text("")
    (tmp_path / "job.k").write_text(f"*KEYWORD\n*INCLUDE\n{name}\n*END\n")
    words = {"deck": ["check", name], "include": ["check", "job.k"], "restart": [f"r={name}"]}[place]
    done = subprocess.run([exe, *words], cwd=tmp_path, capture_output=True, text=True, timeout=20, check=False)
    assert done.returncode == 1, done.stderr
    assert name in done.stderr


def test_a_switch_that_is_a_pipe_is_no_switch(exe, tmp_path):
    """Nothing waits for a writer of d3kil."""
    (tmp_path / "job.k").write_text(drop(end_time=1.0e4).text())
    process = subprocess.Popen([exe, "i=job.k", "d=out", "dt=1.0e-4"], cwd=tmp_path, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    try:
        wait_for((tmp_path / "out" / "job.vtkhdf").exists)
        os.mkfifo(tmp_path / "out" / "d3kil")
        rows = len(numbers(tmp_path / "out" / "job.glstat.csv", "time"))
        time.sleep(1.5)
        wait_for(lambda: len(numbers(tmp_path / "out" / "job.glstat.csv", "time")) > rows)
    finally:
        process.kill()
        process.wait()


def wait_for(condition, seconds=60.0):
    """Wait until something is so."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.02)


def test_loops_of_includes(exe, tmp_path):
    (tmp_path / "job.k").write_text("*KEYWORD\n*INCLUDE\na.k\n*END\n")
    (tmp_path / "a.k").write_text("*INCLUDE\nb.k\n")
    (tmp_path / "b.k").write_text("*INCLUDE\na.k\n*INCLUDE\n./a.k\n*INCLUDE\njob.k\n")
    status, said = check(exe, tmp_path)
    assert status == 1 and "includes itself" in said and len(said) < 20000


def test_many_includes_end(exe, tmp_path):
    """Each file includes the next twice: 2^30 readings are not made."""
    for k in range(30):
        (tmp_path / f"{k}.k").write_text(f"*INCLUDE\n{k + 1}.k\n*INCLUDE\n{k + 1}.k\n")
    (tmp_path / "30.k").write_text("*TITLE\nx\n")
    (tmp_path / "job.k").write_text("*KEYWORD\n*INCLUDE\n0.k\n*END\n")
    status, said = check(exe, tmp_path)
    assert status == 1 and "included files" in said


def test_includes_outside_the_folder_of_the_deck(exe, tmp_path):
    """Any file that can be read may be included, by any path; the effective deck holds its text."""
    (tmp_path / "decks").mkdir()
    (tmp_path / "damping.k").write_text("*DAMPING_GLOBAL\n0,0.5\n")
    for name in ("../damping.k", str(tmp_path / "damping.k"), "../decks/../damping.k"):
        (tmp_path / "decks" / "job.k").write_text(drop().text().rsplit("*END", 1)[0] + f"*INCLUDE\n{name}\n*END\n")
        done = subprocess.run([exe, "i=decks/job.k", "d=out", "endtim=0.001"], cwd=tmp_path, capture_output=True,
                              text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert "*DAMPING_GLOBAL" in (tmp_path / "out" / "job.effective.k").read_text()


@pytest.mark.parametrize("value", ["1e308", "-1e308", "1e309", "NaN", "inf", "-inf", "1e101", "1.1e40"])
@pytest.mark.parametrize("card", [r"^\*CONTROL_TERMINATION\n", r"^\*NODE\n *\d+", r"^\*INITIAL_VELOCITY\n.*\n",
                                  r"^\*MAT_ELASTIC.*\n +\d+,|^\*MAT_ELASTIC.*\n *\d+"])
def test_numbers_that_are_too_large_are_refused(exe, tmp_path, value, card):
    text = drop().text()
    found = re.search(card, text, re.MULTILINE)
    assert found, card
    at = found.end()
    end = text.index("\n", at)
    rest = text[at:end]
    lead = "," if rest.startswith(",") or "NODE" in card else ""
    fields = [word for word in re.split(r"[,\s]+", rest) if word]
    fields[0] = value
    (tmp_path / "job.k").write_text(text[:at] + lead + ",".join(fields) + text[end:])
    status, said = check(exe, tmp_path)
    assert status == 1 and value in said, said


@pytest.mark.parametrize("number", ["2147483648", "4294967297", "9223372036854775808", "-2147483649", "1" * 40])
def test_ids_beyond_what_is_kept_are_refused(exe, tmp_path, number):
    """A number that wraps around could be that of another node."""
    text = drop().text().rsplit("*END", 1)[0] + f"*BOUNDARY_SPC_NODE\n{number},0,1,1\n*END\n"
    (tmp_path / "job.k").write_text(text)
    status, said = check(exe, tmp_path)
    assert status == 1 and "too large" in said


def test_the_largest_ids_are_taken(exe, tmp_path):
    text = drop().text().rsplit("*END", 1)[0] + "*NODE\n2147483647,5.0,5.0\n*END\n"
    (tmp_path / "job.k").write_text(text)
    status, said = check(exe, tmp_path)
    assert status == 0 or "2147483647" in said, said


def test_negative_mass_is_refused(exe, tmp_path):
    (tmp_path / "job.k").write_text(changed(r"^(\*MAT_ELASTIC.*\n *\d+,?) *1000.0?", r"\1-1000.0"))
    status, said = check(exe, tmp_path)
    assert status == 1 and "(RO)" in said and "-1000.0" in said, said


@pytest.mark.parametrize("corner", ["same place", "turned round", "on a line"])
def test_zero_and_negative_areas_are_refused(exe, tmp_path, corner):
    """The first element of the drop: nodes 1, 2, 6, 5."""
    x, y = {"same place": ("0.2", "0.002"), "turned round": ("-9.0", "-9.0"), "on a line": ("0.2", "0.002")}[corner]
    text = drop().text()
    if corner == "on a line":
        text = changed(r"^5,.*$", "5,0.3,0.002", text)
        text = changed(r"^6,.*$", "6,0.35,0.002", text)
    else:
        text = changed(r"^6,.*$", f"6,{x},{y}", text)
    (tmp_path / "job.k").write_text(text)
    status, said = check(exe, tmp_path)
    assert status == 1 and "element" in said.lower(), said


@pytest.mark.parametrize("moment", [0.0, 0.005, 0.02, 0.05, 0.1, 0.2, 0.4])
def test_stop_while_files_are_read_or_written(exe, tmp_path, moment):
    """SIGTERM at any phase: a stop with status 4, or the end that had come; before the program listens, none."""
    text = drop(end_time=1.0e4).text()
    lines = [f"*NODE\n{100000 + k},{k}.0,100.0" for k in range(60000)]  # some tenths of a second to read
    (tmp_path / "job.k").write_text(text.rsplit("*END", 1)[0] + "\n".join(lines) + "\n*END\n")
    process = subprocess.Popen([exe, "i=job.k", "d=out"], cwd=tmp_path, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    time.sleep(moment)
    # The last one is for a program that listens, however long a loaded machine lets it begin.
    while moment == 0.4 and not (tmp_path / "out").exists() and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGTERM)
    _, said = process.communicate(timeout=60)
    unheard = moment < 0.4 and not (tmp_path / "out").exists()
    assert process.returncode in ((4, -signal.SIGTERM) if unheard else (4,)), said
    if process.returncode == 4:
        assert "stopped on request" in said
        assert (tmp_path / "out" / "job.vtkhdf").exists()
        assert not list((tmp_path / "out").glob("*.part"))


def test_short_fuzz(exe, tmp_path):
    """The same decks each time, however fast the machine, twice as many in full; SLIDELINE_FUZZ gives a time instead, and with
    it other decks."""
    asked = os.environ.get("SLIDELINE_FUZZ")
    seconds = float(asked or 120)
    seed, decks = (int(time.time()), 10**9) if asked else (1, 400 if is_full() else 200)
    done = subprocess.run([sys.executable, str(FUZZER), "--program", exe, "--seconds", str(seconds), "--seed", str(seed),
                           "--decks", str(decks), "--limit", "20", "--keep", str(tmp_path / "failures")], capture_output=True, text=True,
                          timeout=seconds + 200, check=False)
    print(done.stdout)
    assert done.returncode == 0, done.stdout
    assert int(re.search(r"(\d+) decks", done.stdout)[1]) > 5
