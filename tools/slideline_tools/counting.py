# SPDX-License-Identifier: MIT
"""Retired instructions of a run: a cost that a busy machine does not change.

Where the kernel lends the processor's counters (perf_event_open) they count the program as it is. Elsewhere
callgrind counts, on a program built for x86-64-v3 (`tools/build.sh counted`), since emulators lack AVX-512; it
tells the parts of the program apart too. A run under callgrind takes some fifty times as long: shorten it.
"""
import ctypes
import dataclasses
import functools
import json
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys

from slideline_tools import UserError

HARDWARE, CALLGRIND = "hardware counters", "callgrind, x86-64-v3"
# Parts of the program by the folders of src/ that their procedures are in: inclusive of what those call elsewhere.
PARTS = {"contact": ("contact",), "elements": ("element", "material")}
SOURCES = pathlib.Path(__file__).resolve().parents[2] / "src"
PROFILE = "callgrind.out"

# What the allocator takes to find a piece depends on what others have freed before: on texts of times, and on looks for
# requests whose number the clock decides. So that a part does not depend on it each of its calls counts as so many.
ALLOCATION = 100
ALLOCATOR = re.compile(r"(__wrap_)?(malloc|calloc|realloc|free)('\d+)?$")

# callgrind counts each byte of `rep movsb` and `rep stosb`, which a processor counts as one instruction: the C library, told
# so, copies by vectors.
COPIES = "glibc.cpu.x86_rep_movsb_threshold=0x7fffffff:glibc.cpu.x86_rep_stosb_threshold=0x7fffffff"

# <linux/perf_event.h>
_SYSTEM_CALL = {"x86_64": 298, "aarch64": 241}
_HARDWARE_TYPE, _INSTRUCTIONS = 0, 1
_DISABLED, _INHERIT, _NO_KERNEL, _NO_HYPERVISOR, _ON_EXEC = 1 << 0, 1 << 1, 1 << 5, 1 << 6, 1 << 12


@dataclasses.dataclass(frozen=True)
class Counts:
    """Instructions of a run: all of them, those of parts where they can be told, and who counted."""

    total: int
    parts: dict
    by: str


def open_counter(pid, kind=_HARDWARE_TYPE, event=_INSTRUCTIONS):
    """A descriptor that counts an event in a process, its threads and what it starts, from its next exec on.

    Raises OSError where the machine does not lend the counter.
    """
    attributes = (ctypes.c_uint64 * 8)()  # struct perf_event_attr, version 0: 64 bytes
    attributes[0] = kind | 64 << 32
    attributes[1] = event
    attributes[5] = _DISABLED | _INHERIT | _NO_KERNEL | _NO_HYPERVISOR | _ON_EXEC
    number = _SYSTEM_CALL.get(platform.machine())
    if platform.system() != "Linux" or number is None:
        raise OSError("no perf_event_open here")
    library = ctypes.CDLL(None, use_errno=True)
    found = library.syscall(ctypes.c_long(number), attributes, ctypes.c_int(pid), ctypes.c_int(-1),
                            ctypes.c_int(-1), ctypes.c_ulong(0))
    if found < 0:
        raise OSError(ctypes.get_errno(), "perf_event_open")
    return found


@functools.lru_cache(maxsize=None)
def hardware_is_there():
    """Whether the machine lends its counter of instructions."""
    try:
        os.close(open_counter(0))
    except OSError:
        return False
    return True


def method():
    """Who counts on this machine; UserError where nobody can."""
    if hardware_is_there():
        return HARDWARE
    if shutil.which("valgrind"):
        return CALLGRIND
    raise UserError("no retired instructions: the machine lends no counters (perf_event_open) and "
                    "valgrind is not installed")


def counted_program(root, build=True):
    """The program to be counted: $SLIDELINE_COUNTED, that of the release, or the one for callgrind, which is built."""
    if "SLIDELINE_COUNTED" in os.environ:
        return pathlib.Path(os.environ["SLIDELINE_COUNTED"]).resolve()
    if method() == HARDWARE:
        return pathlib.Path(root) / "build" / "release" / "slideline"
    if build and subprocess.run([pathlib.Path(root) / "tools" / "build.sh", "counted"], check=False,
                                stdout=sys.stderr).returncode:
        raise UserError("the program to be counted could not be built")
    return pathlib.Path(root) / "build" / "counted" / "slideline"


def counting_command(command, folder):
    """The command that runs `command` under callgrind; its profile goes to `folder`."""
    return ["valgrind", "--tool=callgrind", "--error-exitcode=0", "--compress-strings=no", "--compress-pos=no",
            f"--callgrind-out-file={pathlib.Path(folder) / PROFILE}", *map(str, command)]


def count_instructions(command, folder, by=None, **options):
    """`Counts` of a command, by the `method` of this machine or the one named; UserError where it fails.

    `folder` takes the profile; `options` go to subprocess (env, cwd ...).
    """
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    if (by or method()) == HARDWARE:
        status, trouble, total = run_counted(command, **options)
        found = Counts(total, {}, HARDWARE)
    else:
        options["env"] = {**(options.get("env") or os.environ), "GLIBC_TUNABLES": COPIES}
        done = subprocess.run(counting_command(command, folder), stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, errors="replace", check=False, **options)
        status, trouble = done.returncode, done.stderr
        found = None if status else read_profile(folder / PROFILE)
    if status:
        raise UserError(f"{' '.join(map(str, command))}: exit status {status}\n{trouble[-1000:]}")
    return found


def run_counted(command, kind=_HARDWARE_TYPE, event=_INSTRUCTIONS, **options):
    """Exit status, standard error and count of an event of a command, by perf_event_open.

    The child waits for a line, that its counter is there, before it becomes the command.
    """
    with subprocess.Popen(["/bin/sh", "-c", 'read -r _; exec "$@" </dev/null', "sh", *map(str, command)],
                          stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                          errors="replace", **options) as process:
        try:
            counter = open_counter(process.pid, kind, event)
        except OSError:
            process.kill()
            raise
        try:
            _, trouble = process.communicate("\n")
            return process.returncode, trouble, int.from_bytes(os.read(counter, 8), "little")
        finally:
            os.close(counter)


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
