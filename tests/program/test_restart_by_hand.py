# SPDX-License-Identifier: MIT
"""Restart files that come from elsewhere, faults of the disk at every call that writes one, and results of another run."""
import os
import re
import shutil
import subprocess
import sys
import zlib
from pathlib import Path

import h5py
import kill_runs
import numpy as np
import pytest
from conftest import is_full

sys.path.append(str(Path(__file__).resolve().parents[1] / "lab/fuzz"))
import fuzz_restarts  # noqa: E402
from slideline_tools.contact_types import ALL_TYPES  # noqa: E402


@pytest.fixture(scope="module")
def checked(exe):
    """Whether the program is a checked build."""
    return "-fsanitize" in subprocess.run([exe, "--version"], capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module")
def job(exe, tmp_path_factory):
    """A run of type 5 with restart files."""
    return kill_runs.Job(exe, "block_5", tmp_path_factory.mktemp("hand"))


@pytest.fixture(scope="module")
def implicit_job(exe, tmp_path_factory):
    """An implicit run with restart files."""
    return kill_runs.Job(exe, "block_implicit", tmp_path_factory.mktemp("hand"))


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("scene", [f"block_{kind}" for kind in (ALL_TYPES if is_full() else (3, 5, 7))] +
                         ["rigid_die", "everything", "block_implicit"])
def test_files_made_by_hand(exe, checked, tmp_path, scene):
    """A share of all mutants: refused with the reason, or a run as any; the fuzzer takes more of them."""
    count, statuses, broken = fuzz_restarts.run(exe, scene, 0.0012 if checked else 0.0015, 11, tmp_path, checked)
    assert not broken, broken
    assert count > 4 and statuses.get(1, 0) > 2, statuses


#: dataset -> (new content, word of the message)
LIES = {
    "state/relaxation/n": (lambda old: old * 0 + 5, "the deck does not ask for"),
    "state/contacts/1/slave_status/segment": (lambda old: old * 0 + 10**6, "no segment has"),
    "state/contacts/1/slave_status/active_points": (lambda old: old * 0 + 2**30, "no contact point has"),
    "state/contacts/1/slave_status/n_active": (lambda old: old + 1, "active points"),
    "state/contacts/1/master_status/n": (lambda old: old + 2, "than there are"),
    "state/estimates/1/penetration": (lambda old: old - 1.0, "below zero"),
    "state/contacts/1/points/n": (lambda old: old * 0 + (2**31 - 1), "list"),
    "state/contacts/1/points/traction": (lambda old: np.zeros(3), "no friction"),
    "state/contacts/1/points/slave_nodes": (lambda old: old * 0 - 1, "no node"),
    "state/contacts/1/points/master_nodes": (lambda old: old * 0 + 99999, "no node"),
    "state/contacts/1/nodes": (lambda old: old[::-1].copy(), "numbers that differ from those of the deck"),
    "state/contacts/1/n_slave": (lambda old: old - 1, ", expected "),
    "state/contacts/n": (lambda old: old + 1, ", expected "),
    "state/elements/hourglass_start": (lambda old: old * 0 + 10**8, "numbers that differ from those of the deck"),
    "state/motion": (lambda old: old * np.nan, "finite"),
    "state/mass": (lambda old: old[:-1], "in all"),
    "state/time": (lambda old: np.float64(old[0]), "in all"),
    "driver/steps/first_dt": (lambda old: old * 0, "not positive"),
    "driver/steps/constant": (lambda old: old * 0 + 1.0e-300, "too small for the end time"),
    "run/n_dump": (lambda old: old * 0 - 1, "no run reaches"),
    "state/contacts/1/monitor/node": (lambda old: old * 0 + 99999, "no node"),
    "state/contacts/1/monitor/changes/2/node": (lambda old: old * 0 - 1, "no node"),
    "driver/steps/start_cycle": (lambda old: old * 0 - 1, "below zero"),
    "driver/steps/start_cycle, later": (lambda old: old * 0 + 10**8, "after the present one"),
    "driver/damping": (lambda old: old[:-1], "in all"),
    "outputs/plot/next": (lambda old: old * 0 - 1.0e300, "below zero"),
    "outputs/plot/count": (lambda old: old * 0 - 7, "no run can reach"),
    "outputs/histories/1": (lambda old: old[:, :-1].copy(), "expected"),
}


@pytest.mark.parametrize("name", LIES)
def test_a_lie_is_named(exe, job, tmp_path, name):
    """Message with file, dataset and what is wrong with it; nothing is written."""
    change, word = LIES[name]
    refuse_lie(exe, job, tmp_path, name.partition(",")[0], change, word)


def refuse_lie(exe, job, tmp_path, name, change, word):
    """Go on from a file of which one dataset is changed, among the results of the run that wrote it: refused by the name of the
    dataset, and each file there stays as it was."""
    path = tmp_path / "lie.h5"
    shutil.copy(sorted(job.whole.glob("job.dump*.h5"))[1], path)
    with h5py.File(path, "r+") as stream:
        fuzz_restarts.replace(stream, name, change(stream[name][()]))
    fuzz_restarts.mend(path)
    out = tmp_path / "out"
    shutil.copytree(job.whole, out)
    before = {file.name: file.read_bytes() for file in out.iterdir()}
    assert len(before["job.glstat.csv"].splitlines()) > 2
    done = subprocess.run([exe, f"r={path}", "d=out"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1, (done.returncode, done.stderr)
    assert "lie.h5" in done.stderr and name in done.stderr and word in done.stderr, done.stderr
    after = {file.name: file.read_bytes() for file in out.iterdir()}
    assert before.keys() == after.keys() and not [file for file in before if before[file] != after[file]]


@pytest.mark.parametrize("name", ["driver/control/dt", "driver/trial/internal", "outputs/glstat/next"])
def test_a_lie_of_an_implicit_run_is_named(exe, implicit_job, tmp_path, name):
    refuse_lie(exe, implicit_job, tmp_path, name, *{
        "driver/control/dt": (lambda old: old * 0, "not positive"),
        "driver/trial/internal": (lambda old: old * np.nan, "finite"),
        "outputs/glstat/next": (lambda old: old * 0 - 1.0, "below zero")}[name])


def test_a_job_name_does_not_lead_elsewhere(exe, job, tmp_path):
    path = tmp_path / "lie.h5"
    shutil.copy(sorted(job.whole.glob("job.dump*.h5"))[1], path)
    with h5py.File(path, "r+") as stream:
        fuzz_restarts.replace(stream, "run/job", np.bytes_(b"../escaped"))
    fuzz_restarts.mend(path)
    done = subprocess.run([exe, f"r={path}", "d=out"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and "run/job" in done.stderr, done.stderr
    assert not list(tmp_path.glob("escaped*"))


@pytest.mark.parametrize("place", [0, -1])
def test_states_of_another_run_are_not_taken(exe, job, tmp_path, place):
    """As many states of as many nodes, at another time: the results file is of another run."""
    folder = tmp_path / "again"
    shutil.copytree(job.whole, folder)
    dump = sorted(folder.glob("job.dump*.h5"))[1]
    with h5py.File(dump) as stream:
        count = len(stream["outputs/state_times"])
    with h5py.File(folder / "job.vtkhdf", "r+") as stream:
        stream["VTKHDF/Steps/Values"][(count - 1) if place else 0] += 1.0e-7
    before = (folder / "job.vtkhdf").read_bytes()
    done = subprocess.run([exe, f"r={dump}"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and "does not contain the states before the restart" in done.stderr, done.stderr
    assert (folder / "job.vtkhdf").read_bytes() == before


def outside(stream, way):
    """Put what lies in another file, or elsewhere in this one, in the place of a field."""
    values = stream["VTKHDF/CellData/mises"]
    shape, name = values.shape, "VTKHDF/CellData/mises"
    if way == "group":
        name = "VTKHDF/CellData"
    elif way == "offsets":
        name = "VTKHDF/Steps/Values"
    del stream[name]
    if way == "virtual":
        layout = h5py.VirtualLayout(shape, "<f8")
        layout[:] = h5py.VirtualSource("elsewhere.h5", name, shape)
        stream.create_virtual_dataset(name, layout)
    elif way == "storage":
        stream.create_dataset(name, shape, "<f8", external=[("elsewhere.bin", 0, h5py.h5f.UNLIMITED)])
    elif way == "soft":
        stream[name] = h5py.SoftLink("/VTKHDF/CellData/pressure")
    else:
        stream[name] = h5py.ExternalLink("elsewhere.h5", name)


@pytest.mark.parametrize("way", ["link", "group", "offsets", "soft", "virtual", "storage"])
def test_a_results_file_does_not_lead_elsewhere(exe, job, tmp_path, way):
    """Fields that a run would take over from other files: refused before anything is written, as in restart files."""
    folder = tmp_path / "again"
    shutil.copytree(job.whole, folder)
    shutil.copy(folder / "job.vtkhdf", folder / "elsewhere.h5")
    (folder / "elsewhere.bin").write_bytes(bytes(10 ** 6))
    with h5py.File(folder / "job.vtkhdf", "r+") as stream:
        outside(stream, way)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    dump = sorted(folder.glob("job.dump*.h5"))[1]
    done = subprocess.run([exe, f"r={dump}"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and "is not stored in it" in done.stderr, done.stderr
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


#: stands between program and C library: the call number FAULT_AT of a kind for restart files fails
FAULTS = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
static long count = 0;
static int fails(const char *kind, int file, const char *name) {
  char link[64], path[4096] = "";
  const char *wanted = getenv("FAULT_KIND");
  if (!wanted || strcmp(wanted, kind)) return 0;
  if (name) strncpy(path, name, sizeof path - 1);
  else { snprintf(link, sizeof link, "/proc/self/fd/%d", file); if (readlink(link, path, sizeof path - 1) < 0) return 0; }
  if (!strstr(path, "runrsf.h5")) return 0;
  count++;
  if (count < atol(getenv("FAULT_AT"))) return 0;
  if (getenv("FAULT_ONCE") && count > atol(getenv("FAULT_AT"))) return 0;
  FILE *reported = fopen(getenv("FAULT_REPORTED"), "w");
  if (reported) fclose(reported);
  errno = atoi(getenv("FAULT_ERRNO"));
  return 1;
}
#define NEXT(type, name, ...) ((type (*)(__VA_ARGS__))dlsym(RTLD_NEXT, name))
ssize_t write(int f, const void *d, size_t n) {
  return fails("write", f, 0) ? -1 : NEXT(ssize_t, "write", int, const void *, size_t)(f, d, n); }
ssize_t pwrite(int f, const void *d, size_t n, off_t at) {
  return fails("write", f, 0) ? -1 : NEXT(ssize_t, "pwrite", int, const void *, size_t, off_t)(f, d, n, at); }
ssize_t pwrite64(int f, const void *d, size_t n, off_t at) { return pwrite(f, d, n, at); }
int ftruncate(int f, off_t n) { return fails("truncate", f, 0) ? -1 : NEXT(int, "ftruncate", int, off_t)(f, n); }
int ftruncate64(int f, off_t n) { return ftruncate(f, n); }
int fsync(int f) { return fails("fsync", f, 0) ? -1 : NEXT(int, "fsync", int)(f); }
int close(int f) {
  int bad = fails("close", f, 0), kept = errno, status = NEXT(int, "close", int)(f);
  if (bad) errno = kept;
  return bad ? -1 : status; }
int rename(const char *a, const char *b) { return fails("rename", -1, b) ? -1 : NEXT(int, "rename", const char *, const char *)(a, b); }
"""
CALLS = {"write": 60, "fsync": 3, "close": 8, "rename": 3}


def is_whole(path):
    """Whether a restart file has length and checksum of its head."""
    data = path.read_bytes()
    head = dict(line.split(" ", 1) for line in data[:512].decode("ascii").splitlines()[1:3])
    body = data[512:]
    return int(head["length"]) == len(body) and head["checksum"].strip() == f"{zlib.crc32(body):08X}"


@pytest.mark.parametrize("kind", CALLS)
def test_a_fault_at_any_call_leaves_a_whole_file(exe, job, checked, kind):
    """The n-th call of a kind for the running restart file fails, once or from then on: status 3, and the file of the name is
    whole, as the one before or the new one."""
    if checked:
        pytest.skip("sanitisers stand there themselves")
    compiler = shutil.which("cc") or shutil.which("gcc")
    if not compiler:
        pytest.skip("no C compiler")
    library = job.folder / "faults.so"
    if not library.exists():
        (job.folder / "faults.c").write_text(FAULTS)
        subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-w", "faults.c", "-o", "faults.so", "-ldl"], cwd=job.folder, check=True)
    tried = 0
    for once in (True, False):
        for number in sorted({1, 2, 3, *range(4, CALLS[kind] + 1, max(1, CALLS[kind] // 8))}):
            folder = job.folder / "faulty"
            shutil.rmtree(folder, ignore_errors=True)
            reported = job.folder / "reported"
            reported.unlink(missing_ok=True)
            variables = {"LD_PRELOAD": str(library), "FAULT_KIND": kind, "FAULT_AT": str(number), "FAULT_REPORTED": str(reported),
                         "FAULT_ERRNO": str(5 if number % 2 else 28), **({"FAULT_ONCE": "1"} if once else {})}
            done = subprocess.run([exe, "i=job.k", "d=faulty"], cwd=job.folder, capture_output=True, text=True, timeout=60,
                                  check=False, env={**os.environ, **variables})
            if not reported.exists():
                assert done.returncode == 0, done.stderr
                continue
            tried += 1
            where = (kind, number, once, done.returncode, done.stderr[-500:])
            # Of five calls that close the second and the fourth follow reading: a file that can not be closed then is no loss.
            assert done.returncode == 3 and "runrsf.h5" in done.stderr or kind == "close" and once and number % 5 in (2, 4), where
            path = folder / "job.runrsf.h5"
            log = (folder / "job.log").read_text()
            assert is_whole(path) if path.exists() else "restart file faulty/job.runrsf.h5" not in log, where
            assert not list(folder.glob("*.h5.part")), where
            assert not re.search(r"Backtrace|HDF5-DIAG", done.stderr), where
    assert tried > 0, kind
