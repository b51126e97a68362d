# SPDX-License-Identifier: MIT
"""Many small jobs in batches that are killed and taken up again, and what must be found of them."""
import csv
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parents[2]
BATCH = ROOT / "tools" / "batch"
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests" / "verification")]
from conftest import drop  # noqa: E402
from kill_runs import with_end  # noqa: E402
from slideline_tools import scenes  # noqa: E402
from slideline_tools.contact_types import ALL_TYPES  # noqa: E402

TYPES = ALL_TYPES
#: scene -> (deck of a type, cycles, parameters that vary)
SCENES = {
    "drop": (lambda kind: drop(kind=kind, parametric=True), 200, ("v0",)),
    "block": (lambda kind: scenes.block(kind, n_slave=21, n_master=20), 100, ("pen", "v0")),
    "block_implicit": (lambda kind: scenes.block(kind, implicit=True, n_slave=9, n_master=8), 10, ("pen", "v0")),
    "oblique": (lambda kind: scenes.oblique(kind), 150, ("pen", "vx", "vy")),
    "patch": (lambda kind: scenes.patch(kind), 200, ("pen",)),
    "patch_static": (lambda kind: scenes.patch(kind, static=True), 0, ()),
    "sliding": (lambda kind: scenes.sliding(1, kind), 300, ("pen", "qh")),
    "rigid_die": (lambda kind: scenes.sliding(1, kind, rigid_die=True), 300, ("pen", "qh")),
    "collision": (lambda kind: scenes.collision(1, kind), 120, ("pen", "v0", "qh")),
    "hertz": (lambda kind: scenes.hertz(1, kind), 60, ("pen", "damp")),
}
#: what tells of a run, not of its result
PASSING = re.compile(r"said\.txt|run\.(status|inputs|lock)|.*\.timing\.csv|.*\.log|(.*\.)?status\.out|.*\.h5")
#: how a batch is begun, in turn
MODES = ("-j 4", "-j 8", "array")
ARRAY = 4


def vary(text, name, factor):
    """Multiply a *PARAMETER of a deck."""
    found = re.search(rf"^R\s+{name}[\s,]+(\S+)$", text, re.MULTILINE)
    assert found, name
    return text[:found.start()] + f"R {name},{float(found[1]) * factor!r}" + text[found.end():]


def write_decks(folder, count, seed):
    """`count` decks, no two the same: all types in all scenes, varied parameters. Their names."""
    chance = random.Random(seed)
    folder.mkdir(parents=True)
    names = []
    for k in range(count):
        kind, scene = TYPES[k % len(TYPES)], list(SCENES)[k % len(SCENES)]
        make, cycles, varied = SCENES[scene]
        made = make(kind)
        text = with_end(made if isinstance(made, str) else made.text(), cycles and cycles + k % 50)
        for name in varied:
            text = vary(text, name, chance.uniform(0.7, 1.3))
        if cycles and "implicit" not in scene and k % 3 == 0:  # restart files too
            text = text.rsplit("*END", 1)[0] + f"*DATABASE_BINARY_D3DUMP\n{max(cycles // 2, 1)},\n*END\n"
        names.append(f"{k:04d}_{scene}_{kind}")
        (folder / f"{names[-1]}.k").write_text(text)
    return names


def programs(sessions):
    """Process ids of the running decks of these sessions; a program that is asked for its version is none.

    (Killed, it leaves a wrong record of what was run, and the batch rightly runs that job again.)
    """
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            text = (entry / "stat").read_text()
            runs_deck = b"\0i=" in (entry / "cmdline").read_bytes()
        except OSError:
            continue
        name, rest = text[text.index("(") + 1:text.rindex(")")], text[text.rindex(")") + 2:].split()
        if runs_deck and name == "slideline" and rest[0] != "Z" and int(rest[3]) in sessions:
            found.append(int(entry.name))
    return found


class Batch:
    """The jobs of a folder, run by the batch scripts."""

    def __init__(self, exe, decks, out):
        self.decks, self.out, self.said = decks, out, out.parent / "said"
        self.said.mkdir(exist_ok=True)
        # Found by its name among the processes.
        self.program = out.parent / "slideline"
        shutil.copy(exe, self.program)
        self.rounds = 0

    def start(self, mode):
        """Begin a batch in one of the modes: its processes, each the head of a session."""
        self.rounds += 1
        calls = [(["run_folder.sh", *mode.split()], {})]
        if mode == "array":
            calls = [(["slurm.sh", "run_folder.sh", "-j", "2"],
                      {"SLURM_ARRAY_TASK_ID": str(k), "SLURM_ARRAY_TASK_COUNT": str(ARRAY), "SLURM_SUBMIT_DIR": str(ROOT)})
                     for k in range(ARRAY)]
        started = []
        for k, (words, more) in enumerate(calls):
            with open(self.said / f"{self.rounds}_{k}.txt", "w") as stream:
                started.append(subprocess.Popen(
                    [BATCH / words[0], *words[1:], "-o", str(self.out), str(self.decks)], stdout=stream,
                    stderr=stream, env={**os.environ, **more, "SLIDELINE": str(self.program)}, start_new_session=True))
        return started

    def begun(self):
        """How many runs this round has begun."""
        text = "".join(path.read_text() for path in self.said.glob(f"{self.rounds}_*.txt"))
        return len(re.findall(r"^== \S+$", text, re.MULTILINE))

    def ended(self, names):
        """How many runs have ended well, by what the batch keeps."""
        return list(self.statuses(names).values()).count("0")

    def disturbed(self, mode, chance, every, names, enough):
        """A round in which about each `every`th run is killed, and all there is at one blow once `enough` more have ended."""
        enough += self.ended(names)
        started = self.start(mode)
        sessions = {process.pid for process in started}
        due = chance.uniform(1, 2 * every)
        while any(process.poll() is None for process in started):
            begun = self.begun()
            if self.ended(names) >= enough and programs(sessions):
                for process in started:
                    if process.poll() is None:
                        os.killpg(process.pid, signal.SIGKILL)
                break
            if begun >= due:
                due += chance.uniform(1, 2 * every)
                time.sleep(chance.uniform(0.0, 0.05))
                running = programs(sessions)
                if running:
                    try:
                        os.kill(chance.choice(running), signal.SIGKILL)
                    except ProcessLookupError:
                        pass  # had just ended
            time.sleep(0.01)
        for process in started:
            process.wait()
        while programs(sessions):
            time.sleep(0.01)
        return self.begun()

    def whole(self, mode):
        """A round to its end: how many runs it has begun."""
        for process in self.start(mode):
            process.wait()
        return self.begun()

    def statuses(self, names):
        """What the batch keeps of each run: 0, 137 (killed), none (cut off)."""
        kept = {}
        for name in names:
            path = self.out / name / "run.status"
            try:
                kept[name] = path.read_text().strip()
            except FileNotFoundError:  # a batch may take it away at any moment
                kept[name] = "none" if path.parent.exists() else "not begun"
        return kept


def contents(folder):
    """All that a run leaves and that tells of its result: name -> bytes."""
    found = {path.name: path.read_bytes() for path in folder.iterdir() if not PASSING.fullmatch(path.name)}
    for path in folder.glob("*.vtkhdf"):
        del found[path.name]
        with h5py.File(path) as stream:
            stream.visititems(lambda key, item: found.update({f"{path.name}/{key}": item[()].tobytes()})
                              if isinstance(item, h5py.Dataset) and item.shape != () else None)
            found.update({f"{path.name}/run:{key}": str(value).encode() for key, value in stream["run"].attrs.items()
                          if key != "options"})
    return found


def check_job(batch, name, alone):
    """The job has ended well, and has left what the same deck leaves that runs alone."""
    folder, single = batch.out / name, alone / name
    done = subprocess.run([batch.program, f"i={batch.decks / name}.k", f"d={single}", f"jobid={name}"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{name}: {done.stderr}"
    kept = {path.name for path in folder.iterdir()} - {"said.txt", "run.status", "run.inputs", "run.lock"}
    assert kept == {path.name for path in single.iterdir()}, f"{name}: {kept}"
    assert "N o r m a l" in (folder / f"{name}.log").read_text(), f"{name}: no normal termination"
    mine, other = contents(folder), contents(single)
    assert mine.keys() == other.keys(), name
    different = [key for key in mine if mine[key] != other[key]]
    assert not different, f"{name} differs from the run alone: {different}"
    return len(mine)


def check_all(batch, names, alone):
    """Every job is in the table once, as ended well, and equal to the run alone. Number of compared arrays and files."""
    with open(batch.out / "summary.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["run"] for row in rows] == sorted(names), "the table does not have every job once"
    assert {row["status"] for row in rows} == {"0"}
    compared = 0
    for name in names:
        compared += check_job(batch, name, alone)
        shutil.rmtree(alone / name)
    return compared


def run_load(exe, folder, count, seed, cuts, say=None):
    """`count` jobs in batches of several modes, `cuts` times cut off; then to the end and compared. What happened."""
    say = say or (lambda text: None)
    chance = random.Random(seed)
    names = write_decks(folder / "decks", count, seed)
    batch, first = Batch(exe, folder / "decks", folder / "out"), time.monotonic()
    sums = {"jobs": count, "begun": 0, "killed alone": 0, "cut off": 0}
    for cut in range(cuts):
        mode, left = MODES[cut % len(MODES)], count - batch.ended(names)
        begun = batch.disturbed(mode, chance, max(count // 60, 2), names, count // (cuts + 2))
        assert begun > 0 or not left, f"a batch ({mode}) did not begin"
        sums["begun"] += begun
        kept = list(batch.statuses(names).values())
        sums["killed alone"] += kept.count("137")
        sums["cut off"] += kept.count("none")
        say(f"round {batch.rounds} ({mode}): {kept.count('0')} ended, {kept.count('137')} killed, {kept.count('none')} cut off")
    missing = sum(kept != "0" for kept in batch.statuses(names).values())
    last = batch.whole("-j 8")
    assert last == missing, f"{missing} jobs were missing and {last} were run"
    sums["begun"] += last
    assert batch.whole("-j 4") == 0, "a finished batch has run jobs again"
    sums["seconds"] = round(time.monotonic() - first)
    say(f"all have ended: {sums}")
    sums["compared"] = check_all(batch, names, folder / "alone")
    return sums
