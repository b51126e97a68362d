# SPDX-License-Identifier: MIT
"""Disks that are full, folders that cannot be written, names that are taken: status 3, and nothing corrupted."""
import os
import re
import resource
import shutil
import signal
import subprocess
from contextlib import contextmanager

import h5py
import kill_runs
import pytest
from conftest import drop

KINDS = ("vtkhdf", "glstat.csv", "rcforc.csv", "contact.csv", "log", "effective.k", "timing.csv")


@pytest.fixture(scope="module")
def job(exe, tmp_path_factory):
    """Two blocks with restart files, and their undisturbed run: states enough to fill several chunks."""
    return kill_runs.Job(exe, "block_2", tmp_path_factory.mktemp("disk"))


def run(job, *words, limit=None, default_signal=False, folder=None):
    """Run with a largest file size; (status, standard output, standard error)."""
    def restrict():
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL if default_signal else signal.SIG_IGN)

    done = subprocess.run([job.exe, "i=job.k", *words], cwd=folder or job.folder, capture_output=True, text=True,
                          timeout=60, check=False, preexec_fn=restrict)
    assert "HDF5-DIAG" not in done.stderr + done.stdout and "Backtrace" not in done.stderr, done.stderr
    assert done.returncode in range(5), done.stderr
    return done.returncode, done.stdout, done.stderr


def check_left(job, folder, said):
    """What a failed run has left is the start of what the undisturbed run has."""
    count = kill_runs.check_results(job, folder, said)
    kill_runs.check_restarts(folder, said)
    for path in folder.glob("*.csv"):
        if "timing" not in path.name:
            data = path.read_bytes()
            assert job.csv[path.name].startswith(data), path.name
    assert not list(folder.glob("*.h5.part"))
    return count


@pytest.mark.parametrize("default_signal", [False, True])
def test_largest_file_size_at_every_kind_of_file(job, default_signal):
    """The limit falls within one file after the other; SIGXFSZ must not end the process either."""
    largest = max(path.stat().st_size for path in job.whole.iterdir())
    named, counts = set(), []
    sizes = {path.name.removeprefix("job."): path.stat().st_size for path in job.whole.iterdir()}
    limits = sorted({max(1, int(sizes[kind] * share)) for kind in KINDS for share in (0.3, 0.95)}
                    | {largest * k // 10 for k in range(1, 10)})
    for limit in limits[::5] if default_signal else limits:
        shutil.rmtree(job.folder / "full", ignore_errors=True)
        status, said, complaint = run(job, "d=full", limit=limit, default_signal=default_signal)
        assert status == 3, f"limit {limit}: status {status}\n{complaint}"
        assert "full/job." in complaint, complaint
        assert "N o r m a l" not in said
        named.add(complaint.split("full/job.")[1].split(":")[0].split()[0])
        counts.append(check_left(job, job.folder / "full", said))
    assert "vtkhdf" in named and len(set(counts)) > 2, (named, counts)
    assert default_signal or {"effective.k", "log"} <= named, named
    job.run("d=full")
    kill_runs.check_end(job, job.folder / "full")


def test_a_restart_file_that_does_not_fit(job):
    """Results are small enough and the dumps are not: the dump before stays, and the run says which failed."""
    folder = job.folder / "dumps"
    folder.mkdir()
    lines = (job.folder / "job.k").read_text().splitlines()
    at = lines.index("*DATABASE_BINARY_D3PLOT")
    (folder / "job.k").write_text("\n".join(lines[:at] + lines[at + 2:]) + "\n")  # no plot states
    assert run(job, "d=x", folder=folder)[0] == 0
    sizes = sorted(path.stat().st_size for path in (folder / "x").glob("*.h5"))
    status, said, complaint = run(job, "d=x", folder=folder, limit=sizes[-1] - 1)
    assert status == 3 and ".h5" in complaint, complaint
    left = kill_runs.check_restarts(folder / "x", said)
    assert 0 < len(left) < len(sizes) and not list((folder / "x").glob("*.part"))


def test_tables_and_log_that_do_not_fit(job):
    """Without plot states and dumps the last rows fall to the tables and the log."""
    folder = job.folder / "tables"
    folder.mkdir()
    lines = drop().text().splitlines()
    at = lines.index("*DATABASE_BINARY_D3PLOT")
    (folder / "job.k").write_text("\n".join(lines[:at] + lines[at + 2:]) + "\n")
    assert run(job, "d=x", folder=folder)[0] == 0
    sizes = {path.name: path.stat().st_size for path in (folder / "x").iterdir()}
    named = set()
    for name in sizes:
        status, _, complaint = run(job, "d=x", folder=folder, limit=sizes[name] - 1)
        if "timing" not in name and "log" not in name:
            assert status == 3, (name, complaint)
        named |= {other for other in sizes if other in complaint}
    assert len(named) > 2 and any("csv" in name for name in named), named


def test_tables_that_do_not_fit_end_the_run_soon(job):
    """Without plot states nothing else asks the tables: the run ends when one fails, not at its end."""
    folder = job.folder / "soon"
    folder.mkdir()
    lines = drop(end_time=20.0).text().replace("*DATABASE_GLSTAT\n0.001,", "*DATABASE_GLSTAT\n1.0e-5,").splitlines()
    at = lines.index("*DATABASE_BINARY_D3PLOT")
    (folder / "job.k").write_text("\n".join(lines[:at] + lines[at + 2:]) + "\n")
    status, said, complaint = run(job, "d=x", folder=folder, limit=150000)
    assert status == 3 and "job.glstat" in complaint, complaint
    cycle = int(re.search(r"Problem cycle += (\d+)", said)[1])
    assert cycle < 2000, said
    assert "E r r o r" in said and complaint.strip() in said


def test_a_restart_whose_states_do_not_fit_tells_it(job):
    """The copy of the states before the restart fails: the file that has them stays as it is."""
    folder = job.folder / "copied"
    shutil.copytree(job.whole, folder)
    before = (folder / "job.vtkhdf").read_bytes()
    dump = sorted(folder.glob("job.dump*.h5"))[-1]
    status, said, complaint = run(job, f"r={dump}", limit=len(before) // 2)
    assert status == 3 and "job.vtkhdf" in complaint, complaint
    assert (folder / "job.vtkhdf").read_bytes() == before
    log = (folder / "job.log").read_text()
    log = log[log.rindex("command line:"):]
    for text in (said, log):
        assert text.count("E r r o r") == 1 and "N o r m a l" not in text and complaint.strip() in text
    assert "total" in (folder / "job.timing.csv").read_text()


@pytest.mark.parametrize("name", [f"job.{kind}" for kind in KINDS] + ["job.vtkhdf.part", "job.runrsf.h5", "job.dump01.h5"])
def test_a_folder_of_the_name_of_a_file(job, name):
    folder = job.folder / f"taken_{name}"
    (folder / name).mkdir(parents=True)
    status, _, complaint = run(job, f"d={folder.name}")
    assert status == 3, complaint
    assert name in complaint, complaint
    assert (folder / name).is_dir(), "an empty folder of the user was removed"


def test_a_file_within_the_path_of_the_folder(job):
    (job.folder / "plain").write_text("a file\n")
    status, _, complaint = run(job, "d=plain/below/results")
    assert status == 3 and "plain" in complaint and "in the way" in complaint
    assert (job.folder / "plain").read_text() == "a file\n"


def test_a_screen_that_takes_nothing(job):
    """A full disk behind `>`, and closed streams: the results are those of any run."""
    for redirect in (">/dev/full", ">&- 2>&-", ">&- 2>&- <&-"):
        shutil.rmtree(job.folder / "mute", ignore_errors=True)
        done = subprocess.run(["sh", "-c", f'"$0" i=job.k d=mute {redirect}', job.exe], cwd=job.folder,
                              timeout=60, check=False)
        assert done.returncode == 0, redirect
        kill_runs.check_end(job, job.folder / "mute")


def run_unread(job, *words, both=False):
    """Run with a standard output (and error) whose reader has gone; (status, standard error)."""
    reader, writer = os.pipe()
    os.close(reader)
    try:
        done = subprocess.run([job.exe, *words], cwd=job.folder, stdout=writer, text=True, timeout=60,
                              stderr=writer if both else subprocess.PIPE, check=False)
    finally:
        os.close(writer)
    return done.returncode, done.stderr


@pytest.mark.parametrize("both", [False, True])
def test_a_reader_that_has_gone(job, both):
    """As in `| head -1`: the run goes on, and each end has its own status."""
    shutil.rmtree(job.folder / "unread", ignore_errors=True)
    assert run_unread(job, "i=job.k", "d=unread", both=both) == (0, None if both else "")
    kill_runs.check_end(job, job.folder / "unread")
    (job.folder / "wrong.k").write_text("*KEYWORD\n*NODEX\n*END\n")
    for words, status in ((["--help"], 0), (["--version"], 0), (["check", "job.k"], 0), (["check", "wrong.k"], 1),
                          (["check", "job.k", "--json"], 3), (["wrong.k"], 1)):
        found, said = run_unread(job, *words, both=both)
        assert found == status, (words, said)
        assert both or ("NODEX" in said) == (status == 1), (words, said)


@contextmanager
def mounted(path, options):
    """A small file system in memory, where this machine allows mounts."""
    path.mkdir(exist_ok=True)
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", str(path)], capture_output=True,
                          text=True, check=False) if shutil.which("mount") and os.geteuid() == 0 else None
    if done is None or done.returncode != 0:
        pytest.skip("no right to mount a file system here: " + (done.stderr.strip() if done else "not root"))
    try:
        yield path
    finally:
        subprocess.run(["umount", str(path)], check=False)


@pytest.mark.parametrize("share", [0.01, 0.1, 0.3, 0.5, 0.7, 0.85])
def test_full_file_system(job, tmp_path, share):
    size = sum(path.stat().st_size for path in job.whole.iterdir())
    with mounted(tmp_path / "small", f"size={int(share * size)}") as folder:
        status, said, complaint = run(job, f"d={folder}")
        assert status == 3 and str(folder) in complaint, complaint
        check_left(job, folder, said)


def test_folder_that_cannot_be_written(job, tmp_path):
    with mounted(tmp_path / "fixed", "ro") as folder:
        for place in (folder, folder / "below"):
            status, _, complaint = run(job, f"d={place}")
            assert status == 3 and "Read-only" in complaint, complaint


def test_user_without_the_right(job, tmp_path):
    if os.geteuid() == 0:
        pytest.skip("root may write everywhere; the read-only file system stands for this")
    (tmp_path / "closed").mkdir(mode=0o500)
    status, _, complaint = run(job, f"d={tmp_path}/closed")
    assert status == 3 and "Permission denied" in complaint


#: stands between program and C library: a user who may write so many bytes, and a server that tells of it late
QUOTA = """
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>
static long left = -1;
static int refused(int file, size_t count) {
  struct stat about;
  if (fstat(file, &about) || !S_ISREG(about.st_mode)) return 0;
  if (left < 0) left = atol(getenv("QUOTA_BYTES"));
  if ((long)count <= left) { left -= count; return 0; }
  errno = EDQUOT;
  return 1;
}
ssize_t write(int file, const void *data, size_t count) {
  ssize_t (*next)(int, const void *, size_t) = dlsym(RTLD_NEXT, "write");
  return refused(file, count) ? -1 : next(file, data, count);
}
ssize_t pwrite(int file, const void *data, size_t count, off_t at) {
  ssize_t (*next)(int, const void *, size_t, off_t) = dlsym(RTLD_NEXT, "pwrite");
  return refused(file, count) ? -1 : next(file, data, count, at);
}
ssize_t pwrite64(int file, const void *data, size_t count, off_t at) { return pwrite(file, data, count, at); }
int fsync(int file) {
  int (*next)(int) = dlsym(RTLD_NEXT, "fsync");
  if (!getenv("QUOTA_LATE")) return next(file);
  errno = EDQUOT;
  return -1;
}
"""


@pytest.fixture(scope="module")
def quota(tmp_path_factory):
    """A library that gives the program a quota."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if not compiler:
        pytest.skip("no C compiler")
    folder = tmp_path_factory.mktemp("quota")
    (folder / "quota.c").write_text("#define _GNU_SOURCE\n" + QUOTA)
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "quota.c", "-o", "quota.so", "-ldl"], cwd=folder, check=True)
    return folder / "quota.so"


def run_with_quota(job, library, size, folder, **more):
    """Run with a quota; (status, standard output, standard error)."""
    done = subprocess.run([job.exe, "i=job.k", f"d={folder}"], cwd=job.folder, capture_output=True, text=True, timeout=60,
                          check=False, env={**os.environ, "LD_PRELOAD": str(library), "QUOTA_BYTES": str(size),
                                            "ASAN_OPTIONS": "verify_asan_link_order=0:detect_leaks=0", **more})
    assert "HDF5-DIAG" not in done.stderr + done.stdout and "Backtrace" not in done.stderr, done.stderr
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("share", [0.0, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9])
def test_quota(job, quota, share):
    size = sum(path.stat().st_size for path in job.whole.iterdir())
    shutil.rmtree(job.folder / "quota", ignore_errors=True)
    status, said, complaint = run_with_quota(job, quota, int(share * size), "quota")
    # Of HDF5 files the reason is not known.
    assert status == 3 and ("Disk quota exceeded" in complaint or "quota used up?" in complaint), complaint
    assert "quota/job." in complaint, complaint
    check_left(job, job.folder / "quota", said)
    assert run_with_quota(job, quota, 100 * size, "quota")[0] == 0
    kill_runs.check_end(job, job.folder / "quota")


def test_quota_that_a_server_tells_of_late(job, quota):
    """All bytes are taken and the disk refuses them at the end: no restart file takes its name."""
    shutil.rmtree(job.folder / "quota", ignore_errors=True)
    status, said, complaint = run_with_quota(job, quota, 10**12, "quota", QUOTA_LATE="1")
    assert status == 3 and "Disk quota exceeded" in complaint and ".h5" in complaint, complaint
    check_left(job, job.folder / "quota", said)
    assert not list((job.folder / "quota").glob("*.h5"))


def test_the_restart_of_a_run_whose_disk_was_full(job):
    """What a full disk has left goes on to the same end: the last bytes of the results file do not fit."""
    shutil.rmtree(job.folder / "later", ignore_errors=True)
    largest = (job.whole / "job.vtkhdf").stat().st_size
    status, _, _ = run(job, "d=later", limit=largest - 1)
    assert status == 3
    left = kill_runs.check_restarts(job.folder / "later", "")
    assert left, "no restart file had been written"
    job.run(f"r=later/{left[0].name}")
    for name, data in job.csv.items():
        assert (job.folder / "later" / name).read_bytes() == data, name
    with h5py.File(job.folder / "later" / "job.vtkhdf") as stream:
        assert len(stream["VTKHDF/Steps/Values"]) == len(job.times)
