# SPDX-License-Identifier: MIT
"""Retired instructions of a run: a cost that a busy machine does not change.

callgrind counts, on a program built for x86-64-v3 (`tools/build.sh counted`), since emulators lack AVX-512; it tells the
parts of the program apart too. A run under callgrind takes some fifty times as long: shorten it.
"""
import dataclasses
import functools
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

from slideline_tools import UserError

CALLGRIND = "callgrind, x86-64-v3"
# Parts of the program by the folders of src/ that their procedures are in: inclusive of what those call elsewhere.
PARTS = {"contact": ("contact",), "elements": ("element", "material")}
SOURCES = pathlib.Path(__file__).resolve().parents[2] / "src"
PROFILE = "callgrind.out"

# What the allocator takes to find a piece depends on what others have freed before: on texts of times, and on looks for
# requests whose number the clock decides. So that a part does not depend on it each of its calls counts as so many.
ALLOCATION = 100
ALLOCATOR = re.compile(r"(__wrap_)?(malloc|calloc|realloc|free)('\d+)?$")

# callgrind counts each byte of `rep movsb` and `rep stosb`, which a processor counts as one instruction: the C library, reported
# so, copies by vectors.
COPIES = "glibc.cpu.x86_rep_movsb_threshold=0x7fffffff:glibc.cpu.x86_rep_stosb_threshold=0x7fffffff"


@dataclasses.dataclass(frozen=True)
class Counts:
    """Instructions of a run: all of them, those of parts where they can be known, and who counted."""

    total: int
    parts: dict
    by: str


def require_counter():
    """UserError where nothing can be counted."""
    if not shutil.which("valgrind"):
        raise UserError("no retired instructions: valgrind is not installed")


def counted_program(root, build=True):
    """The program to be counted: $SLIDELINE_COUNTED, or the one for callgrind, which is built."""
    if "SLIDELINE_COUNTED" in os.environ:
        return pathlib.Path(os.environ["SLIDELINE_COUNTED"]).resolve()
    require_counter()
    if build and subprocess.run([pathlib.Path(root) / "tools" / "build.sh", "counted"], check=False,
                                stdout=sys.stderr).returncode:
        raise UserError("the program to be counted could not be built")
    return pathlib.Path(root) / "build" / "counted" / "slideline"


def counting_command(command, folder):
    """The command that runs `command` under callgrind; its profile goes to `folder`."""
    return ["valgrind", "--tool=callgrind", "--error-exitcode=0", "--compress-strings=no", "--compress-pos=no",
            f"--callgrind-out-file={pathlib.Path(folder) / PROFILE}", *map(str, command)]


def count_instructions(command, folder, **options):
    """`Counts` of a command; UserError where it fails or cannot be counted.

    `folder` takes the profile; `options` go to subprocess (env, cwd ...).
    """
    require_counter()
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    options["env"] = {**(options.get("env") or os.environ), "GLIBC_TUNABLES": COPIES}
    done = subprocess.run(counting_command(command, folder), stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, errors="replace", check=False, **options)
    if done.returncode:
        raise UserError(f"{' '.join(map(str, command))}: exit status {done.returncode}\n{done.stderr[-1000:]}")
    return read_profile(folder / PROFILE)


def read_profile(path):
    """`Counts` of a callgrind profile (written without compression of strings and places).

    Calls of the allocator count alike in parts; the total has them as they were.
    """
    total, own, calls = 0, {}, {}
    name = called = None
    n_call = 0
    with open(path, encoding="utf-8", errors="replace") as stream:
        for line in stream:
            if line.startswith("fn="):
                name = line[3:].strip()
            elif line.startswith("cfn="):
                called = line[4:].strip()
            elif line.startswith("calls="):
                n_call = int(line[6:].split()[0])
            elif line.startswith("totals:") or line.startswith("summary:"):
                total = int(line.split()[1])
            elif line[:1].isdigit() or line[:1] in "+-*":
                cost = int(line.split()[1])
                if n_call:
                    if ALLOCATOR.match(called):
                        cost = n_call * ALLOCATION
                    calls[name, called] = calls.get((name, called), 0) + cost
                    n_call = 0
                else:
                    own[name] = own.get(name, 0) + cost
    if not total:
        raise UserError(f"{path}: not a profile of callgrind")
    parts = {part: share_of(procedures_in(folders), own, calls) for part, folders in PARTS.items()}
    return Counts(total, parts, CALLGRIND)


@functools.lru_cache(maxsize=None)
def procedures_in(folders):
    """What the procedures of all modules in these folders of src/ are called in a profile: a module is named as its file."""
    names = sorted(path.stem for folder in folders for path in (SOURCES / folder).rglob("*.f90"))
    return re.compile(rf"__({'|'.join(names)})_m_MOD_")


def share_of(pattern, own, calls):
    """Instructions of the procedures that match, with all that they call outside of them."""
    inside = sum(cost for name, cost in own.items() if pattern.search(name))
    return inside + sum(cost for (name, called), cost in calls.items()
                        if pattern.search(name) and not pattern.search(called))


# ---- a counted run of a study -------------------------------------------------------------------

COUNTS = "counts.json"


def main(arguments):
    """`python -m slideline_tools.counting FOLDER COMMAND...`: runs it, counted; the figures go to FOLDER/counts.json.

    Without arguments it says which program is to be counted, and builds it. Ends with 0, or with 1 and the reason.
    """
    try:
        if not arguments:
            print(counted_program(pathlib.Path(__file__).resolve().parents[2]))
            return 0
        folder, *command = arguments
        counts = count_instructions(command, folder)
    except UserError as problem:
        print(problem, file=sys.stderr)
        return 1
    profile = pathlib.Path(folder) / PROFILE
    profile.unlink(missing_ok=True)  # megabytes
    (pathlib.Path(folder) / COUNTS).write_text(json.dumps(dataclasses.asdict(counts)) + "\n", encoding="ascii")
    return 0


def columns(folder):
    """The columns of a counted run's row."""
    counts = json.loads((pathlib.Path(folder) / COUNTS).read_text(encoding="ascii"))
    return {"instructions": counts["total"], "counted_by": counts["by"],
            **{f"{part}_instructions": count for part, count in counts["parts"].items()}}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
