#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run the program on broken decks: it may refuse them, but not crash, hang, or eat the memory.

Each deck goes through `slideline check`, some with words behind it; one that is accepted then runs a few cycles.
Decks of changes go on from a restart file. What breaks a rule is kept with its words and what was said, one folder
for each kind of failure.
"""
import argparse
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from mutate import CHANGES, Mutator, corpus, read, short

ROOT = Path(__file__).resolve().parents[3]
CRASH = re.compile(r"Sanitizer|runtime error|received signal|Backtrace for this error|Error termination\. Backtrace"
                   r"|Fortran runtime|HDF5-DIAG|stack smashing|double free|corrupted", re.IGNORECASE)
#: a checked build stops where a number leaves the range; the Release one goes on to a named error
TRAP = "Floating-point exception"
NOT_FINITE = re.compile(r"\b(nan|inf|infinity)\b", re.IGNORECASE)
STATUSES = {0, 1, 2, 3, 4}


class Judge:
    """Runs the program and says what rule it breaks."""

    def __init__(self, program: str, limit: float, memory: int):
        self.program, self.limit, self.memory = program, limit, memory
        self.sanitized = b"__asan_init" in Path(program).read_bytes()
        self.counts: Counter = Counter()
        self.lock = threading.Lock()
        self.prepared = Path()

    def restrict(self) -> None:
        """Limits of one run; the sanitiser reserves address space and has a limit of its own."""
        if not self.sanitized:
            resource.setrlimit(resource.RLIMIT_AS, (self.memory, self.memory))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000_000, 200_000_000))

    def run(self, words: list[str], folder: Path) -> tuple[str, int, str]:
        """(broken rule or '', status, what was said) of one command."""
        options = f"detect_leaks=0:hard_rss_limit_mb={self.memory // 2**20}"
        process = subprocess.Popen([self.program, *words], cwd=folder, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, preexec_fn=self.restrict,
                                   env={**os.environ, "ASAN_OPTIONS": options, "OMP_NUM_THREADS": "1"})
        rule = ""
        try:
            said = process.communicate(timeout=self.limit)[1]
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGTERM)  # many cycles are no fault, deafness is
            try:
                said = process.communicate(timeout=self.limit)[1]
            except subprocess.TimeoutExpired:
                process.kill()
                said, rule = process.communicate()[1], "hangs"
            if words[0] == "check":
                rule = "hangs"
        said = said.decode("utf-8", errors="replace")
        status = process.returncode
        trapped = TRAP in said or status == -signal.SIGFPE
        if trapped and not rule:
            rule = "trap" if self.sanitized else "crash"
        elif not rule and CRASH.search(said):
            rule = "crash"
        elif not rule and status not in STATUSES:
            rule = f"status {status}"
        elif not rule and status != 0 and not said.strip():
            rule = "says nothing"
        elif not rule and status == 3:
            rule = "status 3 though all can be written"
        elif not rule and len(said) > 300_000:
            rule = "talks too much"
        with self.lock:
            mode = {"c": "check", "r": "restart", "i": "run"}[words[0][0]]
            self.counts[f"{mode}: {rule or f'status {status}'}"] += 1
        return rule, status, said

    def prepare(self, folder: Path) -> None:
        """A run with a restart file, for the decks of changes."""
        lines = read(ROOT / "doc/examples/contact_2d_slideline.k")
        at = next(i for i in reversed(range(len(lines))) if lines[i].startswith("*END"))
        (folder / "job.k").write_text("\n".join([*short(lines[:at], 8), "*DATABASE_BINARY_D3PLOT", "1.0e-6,",
                                                     "*DATABASE_BINARY_D3DUMP", "4,", "*END", ""]))
        done = subprocess.run([self.program, "i=job.k", "d=."], cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"the run before the restarts failed:\n{done.stderr}")
        self.prepared = folder

    def judge_changes(self, data: bytes) -> tuple[str, str, str]:
        """(broken rule or '', mode, what was said) of a deck of changes."""
        with tempfile.TemporaryDirectory(prefix="fuzz") as name:
            folder = Path(name)
            for path in self.prepared.glob("job.*"):
                shutil.copy(path, folder)
            (folder / "deck.k").write_bytes(data)
            os.mkfifo(folder / "fifo")
            rule, _, said = self.run(["r=job.dump01.h5", "i=deck.k"], folder)
            return rule, "restart", said

    def judge(self, data: bytes, words: list[str]) -> tuple[str, str, str]:
        """(broken rule or '', mode, what was said) of one deck with words behind it."""
        with tempfile.TemporaryDirectory(prefix="fuzz") as name:
            folder = Path(name)
            (folder / "deck.k").write_bytes(data)
            os.mkfifo(folder / "fifo")
            rule, status, said = self.run(["check", "deck.k", *words], folder)
            if rule or status not in (0, 2):
                return rule, "check", said
            rule, status, said = self.run(["i=deck.k", "d=out", *words], folder)
            if not rule and status == 0 and any(NOT_FINITE.search(path.read_text()) for path in folder.glob("out/*.csv")):
                rule = "ends well with values that are not finite"
                self.counts[f"run: {rule}"] += 1
            return rule, "run", said


def signature(rule: str, said: str) -> str:
    """A name for failures that are alike: where the program was."""
    frames = re.findall(r"(?:/src/|in __)([\w/]+(?:\.f90:\d+|_MOD_\w+))", said)
    error = re.search(r"(runtime error: .{0,60}|ERROR: AddressSanitizer: [\w-]+|Fortran runtime error: .{0,50})", said)
    text = "-".join([rule, error[1] if error else "", *frames[:2]])
    return re.sub(r"[^\w.-]+", "_", re.sub(r"0x[0-9a-f]+|==\d+==", "", text))[:120]


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=os.environ.get("SLIDELINE"), help="the program (default: $SLIDELINE)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60.0, help="how long (default 60)")
    parser.add_argument("--decks", type=int, default=10**9, help="decks at most")
    parser.add_argument("--only", type=int, help="this deck of the seed alone, written to standard output")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=float, default=10.0, help="seconds of one run")
    parser.add_argument("--memory", type=int, default=1500, help="megabytes of one run")
    parser.add_argument("--keep", type=Path, default=Path("fuzz_failures"), help="where failures go")
    parser.add_argument("--traps", action="store_true", help="count traps of a checked build as failures")
    options = parser.parse_args()
    named = [(name, short(lines, 5)) for name, lines in corpus()]
    decks = [lines for _, lines in named]
    # Most refused decks stay refused, whatever else is broken.
    weights = [0.1 if name.startswith("tests/rejected") else 1.0 for name, _ in named]

    def deck(k: int) -> tuple[bytes, list[str], bool]:
        """Deck k of the seed, words behind it, and whether it is one of changes."""
        mutator = Mutator(options.seed * 1_000_003 + k, decks)
        base = mutator.random.choices(decks, weights)[0]
        changes = mutator.random.random() < 0.05
        if changes:
            base = mutator.random.choice(CHANGES).splitlines()
        return mutator.mutate(base, mutator.random.choice((0, 1, 1, 1, 2, 2, 3, 5, 10))), mutator.words(), changes

    if options.only is not None:
        sys.stdout.buffer.write(deck(options.only)[0])
        return 0
    if not options.program:
        parser.error("--program or SLIDELINE is needed")
    judge = Judge(str(Path(options.program).resolve()), options.limit, options.memory * 2**20)
    end, kinds, numbers, lock = time.monotonic() + options.seconds, Counter(), iter(range(options.decks)), threading.Lock()
    done = [0]

    def work(_: int) -> None:
        while time.monotonic() < end:
            with lock:
                k = next(numbers, None)
            if k is None:
                return
            data, words, changes = deck(k)
            rule, mode, said = judge.judge_changes(data) if changes else judge.judge(data, words)
            with lock:
                done[0] += 1
                if not rule or (rule == "trap" and not options.traps):
                    continue
                kind = signature(rule, said)
                kinds[kind] += 1
                if kinds[kind] > 3:
                    continue
                place = options.keep / kind
                place.mkdir(parents=True, exist_ok=True)
                (place / f"{options.seed}_{k}.k").write_bytes(data)
                (place / f"{options.seed}_{k}.txt").write_text(f"{mode} {words}: {rule}\n{said[:20000]}")
                print(f"FAILED deck {k} of seed {options.seed} ({mode}): {kind}", flush=True)

    with tempfile.TemporaryDirectory(prefix="fuzz") as name, ThreadPoolExecutor(options.jobs) as pool:
        judge.prepare(Path(name))
        list(pool.map(work, range(options.jobs)))
    print(f"{done[0]} decks of seed {options.seed}, {sum(kinds.values())} failed in {len(kinds)} ways")
    for name, count in sorted(judge.counts.items()):
        print(f"  {count:7d}  {name}")
    return 1 if kinds else 0


if __name__ == "__main__":
    sys.exit(main())
