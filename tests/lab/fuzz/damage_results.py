#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Damage the files of a run and give them to every Python tool: each must end with one line and its status.

    damage_results.py [--program build/release/slideline] [--count N] [--seed N] [--quick]

Runs a small deck, then N times takes its results, damages one file (cut short, bytes changed, emptied, rows and columns
of tables changed; in HDF5 files groups and arrays taken away, of another shape, kind or content) and calls every tool.
--quick leaves the slow tools (animate, plot of all) out. Prints what broke the rule: a traceback, a status that is none of 0, 1,
2, or 2 with more or less than one line. Exit status: 0, or 1 where one did.
"""
import argparse
import contextlib
import io
import os
import random
import shutil
import subprocess
import sys
import tempfile
import traceback
import warnings
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))
os.environ.setdefault("MPLBACKEND", "Agg")
DECK = ROOT / "input/block/block.k"

#: name -> words of the command, with {run}, {job}, {out}
TOOLS = {
    "info": "info {run}/{job}.vtkhdf",
    "plot": "plot {run} --field mises -o {out}/a.png",
    "plot history": "plot {run}/{job}.vtkhdf --history glstat:kinetic,internal -o {out}/b.png",
    "plot contact": "plot {run} --contact -o {out}/c.png",
    "plot all": "plot {run} -o {out}/d.png",
    "animate": "animate {run} --rate 5 -o {out}/e.gif",
    "compare": "compare {run}/{job}.glstat.csv {sound}/{job}.glstat.csv",
    "compare reference": "compare {sound}/{job}.rcforc.csv {run}/{job}.rcforc.csv",
    "advise": "advise {run}",
    "advise json": "advise --json --all {run}",
    "report": "report {run} -o {out}/f.html",
    "d3plot": "d3plot {run} -o {out}/g",
    "binout": "binout {run} -o {out}/h",
    "draw run": "draw {run} -o {out}/i.png",
    "draw": "draw {run}/{job}.effective.k -o {out}/j.png",
}
SLOW = ("animate", "plot all")
JOB = "job"


def make_run(program, folder):
    """A small run with all tables."""
    text = DECK.read_text(encoding="utf-8").rsplit("*END", 1)[0]
    text += "*DATABASE_SLEOUT\n1.0e-4,\n*DATABASE_SPCFORC\n1.0e-4,\n*RIGIDWALL_PLANAR\n,\n0.0,-50.0,,0.0,1.0\n*DATABASE_RWFORC\n1.0e-4,\n*END\n"
    (folder / "deck.k").write_text(text, encoding="utf-8")
    subprocess.run([program, "i=deck.k", "d=run", f"jobid={JOB}"], cwd=folder, check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    return folder / "run"


def damage_bytes(path, chance):
    """Cut, change, fill or empty a file; what was done."""
    data = bytearray(path.read_bytes())
    kind = chance.choice(("empty", "cut", "bytes", "zeros", "random", "doubled"))
    if kind == "empty":
        data = b""
    elif kind == "cut":
        data = data[:chance.randrange(max(len(data), 1))]
    elif kind == "bytes":
        for _ in range(chance.choice((1, 5, 50))):
            data[chance.randrange(len(data))] = chance.randrange(256)
    elif kind == "zeros":
        start = chance.randrange(len(data))
        data[start:start + 500] = bytes(500)
    elif kind == "random":
        data = chance.randbytes(2000)
    else:
        data = bytes(data)*2
    path.write_bytes(bytes(data))
    return f"{path.name}: {kind}"


def damage_table(path, chance):
    """Change cells, rows and columns of a table or the lines of a text."""
    lines = path.read_text(encoding="latin-1").splitlines()
    kind = chance.choice(("cell", "row", "ragged", "header", "column", "no rows", "name", "swapped", "line"))
    k = chance.randrange(len(lines))
    words = lines[k].split(",")
    if kind == "cell":
        words[chance.randrange(len(words))] = chance.choice(("", "nan", "inf", "-1", "1e400", "x", "99999999999999999999", "\u00e4"))
        lines[k] = ",".join(words)
    elif kind == "row":
        del lines[k]
    elif kind == "ragged":
        lines[k] = ",".join(words[:-1])
    elif kind == "header":
        del lines[0]
    elif kind == "column":
        j = chance.randrange(len(lines[0].split(",")))
        lines = [",".join(w for i, w in enumerate(line.split(",")) if i != j) for line in lines]
    elif kind == "no rows":
        lines = lines[:1]
    elif kind == "name":
        names = lines[0].split(",")
        names[chance.randrange(len(names))] = chance.choice(("time", "", "other"))
        lines[0] = ",".join(names)
    elif kind == "swapped":
        chance.shuffle(lines)
    else:
        lines[k] = chance.choice(("*", "$", "*PART", "*NODE", "\x00", "1,2,3", "part x", lines[k][:5], lines[k].replace(" ", "")))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return f"{path.name}: {kind} in line {k + 1}"


def damage_hdf5(path, chance):
    """Take something of an HDF5 file away, or put something else in its place."""
    with h5py.File(path, "r+") as stream:
        names = []
        stream.visit(names.append)
        name = chance.choice(names)
        item = stream[name]
        if chance.random() < 0.2 and item.attrs:
            attribute = chance.choice(list(item.attrs))
            value = chance.choice((None, -1, 10**12, "text", np.array([1.5, np.nan]), b"\xff\xfe"))
            del item.attrs[attribute]
            if value is not None:
                item.attrs[attribute] = value
            return f"{name}@{attribute} = {value!r}"
        kind = chance.choice(("gone", "gone", "short", "long", "flat", "deep", "text", "group", "huge", "negative", "nan", "scalar",
                              "empty"))
        values = item[()] if isinstance(item, h5py.Dataset) else None
        del stream[name]
        if kind == "gone":
            return f"{name}: gone"
        if values is None or kind == "text":
            stream[name] = np.array([b"some", b"text"])
        elif kind == "group":
            stream.create_group(name)
        elif kind == "scalar" or not isinstance(values, np.ndarray):
            stream[name] = 1.5
        elif kind == "empty":
            stream[name] = values[:0]
        elif kind == "short":
            stream[name] = values[:len(values) // 2]
        elif kind == "long":
            stream[name] = np.concatenate([values, values])
        elif kind == "flat":
            stream[name] = values.ravel()
        elif kind == "deep":
            stream[name] = np.stack([values, values], axis=-1)
        elif values.dtype.kind not in "iuf":
            stream[name] = 3
        elif kind == "huge":
            stream[name] = np.full(values.shape, 10**15 if values.dtype.kind in "iu" else 1.0e300)
        elif kind == "negative":
            stream[name] = -1 - np.abs(values.astype(float)).astype("i8")
        else:
            stream[name] = np.full(values.shape, np.nan)
        return f"{name}: {kind}"


def damage(folder, chance):
    """Damage one file of a folder; what was done."""
    results = folder / f"{JOB}.vtkhdf"
    if chance.random() < 0.5:
        done = damage_hdf5(results, chance) if chance.random() < 0.85 else damage_bytes(results, chance)
        if chance.random() < 0.5:  # without the tables beside it
            for path in folder.glob("*.csv"):
                if "timing" not in path.name and chance.random() < 0.8:
                    path.unlink()
        return done
    paths = sorted(path for path in folder.iterdir() if path.suffix in (".csv", ".log", ".k"))
    path = chance.choice(paths)
    return damage_table(path, chance) if chance.random() < 0.7 else damage_bytes(path, chance)


def call(words):
    """(status, standard error, traceback or '') of one call of the tools in this process."""
    from slideline_tools.cli import main
    said, out = io.StringIO(), io.StringIO()
    out.fileno = lambda: 1
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(out), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            status = main(words)
        except SystemExit as problem:
            status = problem.code
        except Exception:  # noqa: BLE001  what is looked for
            return None, said.getvalue(), traceback.format_exc()
    return status, said.getvalue(), ""


def judge(status, said, trace):
    """What breaks the rule, or ''."""
    if trace:
        return "traceback: " + trace.strip().splitlines()[-1][:150] + " | " + "; ".join(
            line.strip()[-90:] for line in trace.splitlines() if line.strip().startswith("File"))[-280:]
    if status not in (0, 1, 2):
        return f"status {status}"
    if status == 2 and len(said.strip().splitlines()) != 1:
        return f"status 2 with {len(said.splitlines())} lines: {said[:200]}"
    if "a fault of the tools" in said:
        return said.strip()[:300]
    return ""


def words_of(tool, run, sound, out):
    return [word.format(run=run, job=JOB, out=out, sound=sound) for word in TOOLS[tool].split()]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=str(ROOT / "build/release/slideline"))
    parser.add_argument("--count", type=int, default=150)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    os.environ["SLIDELINE"] = options.program
    failed, seen = 0, {}
    with tempfile.TemporaryDirectory() as work:
        work = Path(work)
        sound = make_run(options.program, work)
        for tool in TOOLS:
            if broken := judge(*call(words_of(tool, sound, sound, work / "out"))):
                print(f"sound run, {tool}: {broken}")
                return 1
        for k in range(options.count):
            chance = random.Random(f"{options.seed} {k}")
            shutil.rmtree(work / "damaged", ignore_errors=True)
            shutil.copytree(sound, work / "damaged")
            done = damage(work / "damaged", chance)
            for tool in TOOLS:
                if options.quick and tool in SLOW:
                    continue
                broken = judge(*call(words_of(tool, work / "damaged", sound, work / "out")))
                if broken:
                    failed += 1
                    if broken not in seen:
                        print(f"{k} ({done}), {tool}: {broken}", flush=True)
                    seen[broken] = seen.get(broken, 0) + 1
    for broken, count in sorted(seen.items(), key=lambda item: -item[1]):
        print(f"{count} x {broken}")
    print(f"{options.count} damaged runs, {failed} calls broke the rule, in {len(seen)} ways")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
