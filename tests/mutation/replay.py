# SPDX-License-Identifier: MIT
"""Tells quickly that a mutant does the same as the original in a case of tests/verification.

The runs of a case are written down once, with what the original program left behind. A mutant that
leaves the same behind, bit by bit, passes the case as the original does; the case itself, most of
which is the evaluation in Python, is only asked where something differs.
"""
from __future__ import annotations

import hashlib
import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

Runner = Callable[[list[str], Path], tuple[int, float]]  #: of a command and a folder: status, seconds
WRAPPER = """#!/bin/sh
printf '%s\\t' "$PWD" "$@" >> '{log}'
echo >> '{log}'
exec '{program}' "$@"
"""


def start_recording(folder: Path, program: Path) -> Path:
    """A program that writes down how it is called and then is `program`."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    wrapper = folder / "program.sh"
    wrapper.write_text(WRAPPER.format(log=folder / "calls.txt", program=program))
    wrapper.chmod(0o755)
    return wrapper


def finish_recording(folder: Path) -> None:
    """Keep the digests of what the recorded runs have left."""
    calls = []
    for line in (folder / "calls.txt").read_text().splitlines():
        where, *words = line.rstrip("\t").split("\t")
        outputs = [word[2:] for word in words if word.startswith("d=")]
        calls.append({"where": where, "words": words,
                      "digest": digest(Path(where) / outputs[0]) if outputs else ""})
    (folder / "calls.json").write_text(json.dumps(calls, indent=1))


def digest(folder: Path) -> str:
    """Of all numbers in the tables and states of a run, and of what its log says of them."""
    total = hashlib.sha256()
    for path in sorted(folder.glob("*")):
        if path.name.endswith(".csv") and not path.name.endswith("timing.csv"):
            total.update(path.read_bytes())
        elif path.suffix == ".vtkhdf":
            with h5py.File(path, "r") as stream:
                stream["VTKHDF"].visititems(lambda name, item: total.update(
                    name.encode() + np.ascontiguousarray(item[()]).tobytes())
                    if isinstance(item, h5py.Dataset) else None)
        elif path.suffix == ".log":
            total.update("\n".join(re.findall(r"^.*(?:warning|interface|error).*$", path.read_text(
                errors="replace"), re.M | re.I)).encode())
    return total.hexdigest()


def does_the_same(folder: Path, program: Path, scratch: Path, run: Runner) -> bool:
    """Whether a program leaves behind what the recorded one has, in all runs of a case."""
    for k, call in enumerate(json.loads((folder / "calls.json").read_text())):
        output = scratch / f"replay{k}"
        shutil.rmtree(output, ignore_errors=True)
        output.mkdir(parents=True)
        words = [f"d={output}" if word.startswith("d=") else word for word in call["words"]]
        run([str(program), *words], Path(call["where"]))
        try:
            same = bool(call["digest"]) and digest(output) == call["digest"]
        except (OSError, KeyError):
            same = False
        shutil.rmtree(output, ignore_errors=True)
        if not same:
            return False
    return True
