# SPDX-License-Identifier: MIT
"""Restart files made by hand: each dataset of a good one gets another shape, type or content, head and checksum are mended,
and the run that goes on must refuse the file with its reason (status 1) or go on as any run; never a signal, never for ever.

    SLIDELINE=build/release/slideline build/venv/bin/python tests/lab/fuzz/fuzz_restarts.py [--scene NAME] [--share 0.1] [--seed 1]
        [--only watch/]
"""
import argparse
import os
import random
import shutil
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1] / "program"), str(HERE.parents[2] / "tools")]
HEAD = 512


def mend(path):
    """Length and checksum of what the file holds now in its head, whose format stays."""
    whole = path.read_bytes()
    mark, data = whole[:HEAD].splitlines()[0].decode("ascii"), whole[HEAD:]
    head = f"{mark}\nlength {len(data)}\nchecksum {zlib.crc32(data):08X}\n"
    path.write_bytes(head.encode().ljust(HEAD) + data)


def names_of(path):
    """All datasets of a file."""
    found = []
    with h5py.File(path) as stream:
        stream.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
    return found


def shapes(old):
    """Other shapes of an array: (name, array)."""
    yield "longer", np.concatenate([old, old[-1:]]) if len(old) else np.zeros((1, *old.shape[1:]), old.dtype)
    if len(old):
        yield "shorter", old[:-1]
        yield "empty", old[:0]
    yield "flat", np.concatenate([old.ravel(), old.ravel()[:1]]) if old.ndim > 1 else old[:, None]
    yield "rank 3", old.reshape(*old.shape, 1, *([1] if old.ndim == 1 else []))
    if old.ndim == 2:
        yield "transposed", old.T.copy() if old.shape[0] != old.shape[1] else old[:, :1].copy()


def types(old):
    """The same numbers as something else."""
    yield "int64" if old.dtype != np.int64 else "int32", old.astype(np.int64 if old.dtype != np.int64 else np.int32)
    yield "float32", old.astype(np.float32)
    yield "big endian", old.astype(old.dtype.newbyteorder(">"))
    if old.dtype.kind == "i":
        yield "unsigned", old.astype(f"u{old.dtype.itemsize}")
        yield "float64", old.astype(np.float64)
    else:
        yield "int32", np.zeros(old.shape, np.int32)
    yield "text", np.full(old.shape, b"abcdefgh", "S8")


def values(old, is_checked):
    """Other numbers in one place, all places or the last."""
    if not old.size:
        return
    if old.dtype.kind == "f":
        kinds = {"nan": np.nan, "inf": np.inf, "-inf": -np.inf}
        if not is_checked:  # where reals leave their range a checked build stops on purpose
            kinds |= {"1e300": 1e300, "zero": 0.0, "negative": -1.0, "tiny": 5e-324}
    else:
        most = np.iinfo(old.dtype).max
        kinds = {"zero": 0, "-1": -1, "largest": most, "smallest": -most - 1, "2": 2, "some": 1000, "next": None}
    for name, value in kinds.items():
        for place in ("first", "last", "all"):
            new = old.copy()
            where = {"first": 0, "last": -1, "all": slice(None)}[place]
            if value is None:
                new.ravel()[where] += 1
            else:
                new.ravel()[where] = value
            yield f"{name} in {place}", new
    if old.dtype.kind == "i" and old.size > 2:
        yield "backwards", old.ravel()[::-1].reshape(old.shape).copy()
        yield "one for all", np.full_like(old, old.ravel()[0])


def replace(stream, name, data):
    """Another dataset under this name."""
    del stream[name]
    stream.create_dataset(name, data=data)


def structural(stream, name):
    """Mutations that are no arrays: (name, what to do)."""
    def huge(rank):
        del stream[name]
        stream.create_dataset(name, shape=(2**40,) * rank, dtype="f8" if rank == 1 else "i4")

    def chunked():
        old = stream[name][()]
        del stream[name]
        stream.create_dataset(name, data=old, chunks=True)

    def outside():
        shape, kind = stream[name].shape, stream[name].dtype
        del stream[name]
        stream.create_dataset(name, shape=shape, dtype=kind, external=[("/etc/passwd", 0, h5py.h5f.UNLIMITED)])

    def link(target):
        del stream[name]
        stream[name] = target

    yield "missing", lambda: stream.__delitem__(name)
    yield "a folder", lambda: (stream.__delitem__(name), stream.create_group(name))
    yield "huge", lambda: huge(1)
    yield "huge table", lambda: huge(2)
    yield "a scalar", lambda: replace(stream, name, np.float64(1.0))
    yield "a scalar integer", lambda: replace(stream, name, np.int32(1))
    yield "a text", lambda: replace(stream, name, np.bytes_(b"some words"))
    yield "a text of any length", lambda: replace(stream, name, "some words")
    yield "nothing", lambda: replace(stream, name, h5py.Empty("f8"))
    yield "nothing of integers", lambda: replace(stream, name, h5py.Empty("i4"))
    yield "a soft link", lambda: link(h5py.SoftLink("/state/motion"))
    yield "a loop", lambda: link(h5py.SoftLink("/" + name))
    yield "an external link", lambda: link(h5py.ExternalLink("/dev/zero", "/a"))
    if stream[name].shape and stream[name].size:
        yield "chunked", chunked
        yield "stored outside", outside


def mutants(good, is_checked):
    """(dataset, mutation) of all there are."""
    for name in names_of(good):
        with h5py.File(good) as stream:
            old = stream[name]
            kinds = [kind for kind, _ in structural(stream, name)]
            if old.shape:
                data = old[()]
                for make in (shapes, types, lambda data: values(data, is_checked)):
                    kinds += [kind for kind, _ in make(data)]
        for kind in kinds:
            yield name, kind


def mutate(good, path, name, kind, is_checked):
    """Make one mutant."""
    shutil.copy(good, path)
    with h5py.File(path, "r+") as stream:
        for found, change in structural(stream, name):
            if found == kind:
                change()
                break
        else:
            data = stream[name][()]
            for make in (shapes, types, lambda data: values(data, is_checked)):
                for found, new in make(data):
                    if found == kind:
                        replace(stream, name, new)
    mend(path)


def judge(exe, path, folder, seconds=20):
    """What is wrong with the end of the run that goes on ('' if nothing), its status and what it said."""
    out = folder / "out"
    shutil.rmtree(out, ignore_errors=True)
    try:
        done = subprocess.run([exe, f"r={path}", f"d={out}"], cwd=folder, capture_output=True, text=True, timeout=seconds,
                              check=False, errors="replace",
                              env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1"})
    except subprocess.TimeoutExpired:
        return "runs for ever", None, ""
    if done.returncode not in range(5):
        return f"status {done.returncode}", done.returncode, done.stderr
    if done.returncode == 1 and str(path.name) not in done.stderr:
        return "refused without a reason", 1, done.stderr
    if done.returncode == 3:
        return "status 3", 3, done.stderr
    return "", done.returncode, done.stderr


def make_job(exe, scene, folder):
    """A run with a restart file in its middle; the path of that file."""
    import kill_runs

    job = kill_runs.Job(exe, scene, folder)
    files = sorted(job.whole.glob("job.dump*.h5"))
    return files[len(files) // 2 - 1 if len(files) > 1 else 0]


def must_be_refused(kind):
    """Mutations after which no file is sound."""
    return kind in {"missing", "a folder", "huge", "huge table", "a text", "a text of any length", "rank 3", "text", "float32",
                    "big endian", "unsigned", "a loop", "an external link", "chunked", "stored outside", "a soft link",
                    "a scalar", "a scalar integer"} or kind.startswith(("nan", "inf", "-inf"))


def run(exe, scene, share, seed, folder, is_checked=False, tell=None, only=""):
    """Try a share of the mutants of a scene; (how many, statuses, those that broke a rule)."""
    good = make_job(exe, scene, folder)
    every = [mutant for mutant in mutants(good, is_checked) if only in mutant[0]]
    chosen = random.Random(seed).sample(every, max(1, int(share * len(every))))
    broken, statuses = [], {}
    path = folder / "mutant.h5"
    for name, kind in chosen:
        mutate(good, path, name, kind, is_checked)
        trouble, status, said = judge(exe, path, folder)
        statuses[status] = statuses.get(status, 0) + 1
        if not trouble and status == 0 and must_be_refused(kind):
            trouble = "accepted"
        if trouble:
            broken.append((name, kind, trouble, said[-300:]))
            if tell:
                tell(f"{scene}: {name}: {kind}: {trouble}: {said[-300:]}")
    return len(chosen), statuses, broken


def main():
    import kill_runs

    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--scene", action="append", help="of tests/program/kill_runs.py; default: all")
    words.add_argument("--share", type=float, default=0.1, help="part of all mutants")
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--only", default="", help="datasets whose names have this text in them")
    words.add_argument("--checked", action="store_true", help="the program is a checked (Debug) build")
    args = words.parse_args()
    total = 0
    for scene in args.scene or kill_runs.SCENES:
        with tempfile.TemporaryDirectory() as folder:
            n, statuses, broken = run(os.path.abspath(os.environ["SLIDELINE"]), scene, args.share, args.seed, Path(folder),
                                      args.checked, tell=lambda text: print(text, flush=True), only=args.only)
        total += len(broken)
        print(f"{scene}: {n} files, statuses {statuses}, {len(broken)} broke a rule", flush=True)
    return min(total, 1)


if __name__ == "__main__":
    sys.exit(main())
