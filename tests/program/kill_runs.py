# SPDX-License-Identifier: MIT
"""Runs that are killed, and what must be found of them."""
import csv
import random
import re
import shutil
import subprocess
import sys
import time
import zlib
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests" / "verification")]
from slideline_tools import scenes  # noqa: E402
from slideline_tools.contact_types import ALL_TYPES  # noqa: E402
from conftest import drop  # noqa: E402

HEAD = 512
ARRAYS = ("Points", "PointData/displacement", "PointData/velocity", "PointData/contact_force",
          "CellData/stress", "CellData/plastic_strain")
REPORTED = "write vtkhdf state"


def everything():
    """Damping, loads, prescribed motion, springs that limit the step."""
    import test_restart

    return test_restart.everything().text()


#: scene -> (deck, cycles)
SCENES = {
    "drop": (lambda: drop().text(), 200),
    "plate_8x4_elastic": (lambda: scenes.symmetric_plate(8, 4), 400),
    "plate_8x4_elastoplastic": (lambda: scenes.symmetric_plate(8, 4, True), 400),
    "plate_16x8_elastic": (lambda: scenes.symmetric_plate(16, 8), 300),
    "plate_16x8_elastoplastic": (lambda: scenes.symmetric_plate(16, 8, True), 300),
    "plate_32x16_elastic": (lambda: scenes.symmetric_plate(32, 16), 200),
    "plate_32x16_elastoplastic": (lambda: scenes.symmetric_plate(32, 16, True), 200),
    **{f"collision_{level}": (lambda level=level: scenes.collision(level, ctype=1 + level), 600 // level)
       for level in (1, 2, 3, 4)},
    **{f"block_{kind}": (lambda kind=kind: scenes.block(ctype=kind), 90) for kind in ALL_TYPES},
    "sliding": (lambda: scenes.sliding(1, ctype=5), 1500),
    "rigid_die": (lambda: scenes.sliding(1, ctype=7, rigid_die=True), 1500),
    "hertz": (lambda: scenes.hertz(1, ctype=6), 600),
    "oblique": (lambda: scenes.oblique(ctype=3), 280),
    "patch": (lambda: scenes.patch(ctype=4), 300),
    "patch_static": (lambda: scenes.patch(ctype=7, static=True), 0),
    "everything": (everything, 300),
    "block_implicit": (lambda: scenes.block(ctype=2, implicit=True, n_slave=11, n_master=10), 40),
}


def first_field(text, keyword, value):
    """Replace the first field of the first card of a keyword, by `value` and no more."""
    pattern = re.compile(rf"(^\*{keyword}\n(?:\$.*\n)*).*\n", re.MULTILINE)
    return pattern.sub(lambda found: f"{found[1]}{value}\n", text, count=1)


def with_end(text, cycles):
    """The deck with an end after some cycles."""
    if not cycles:
        return text
    return re.sub(r"(\*CONTROL_TERMINATION\n(?:\$.*\n)*) *([^\s,]+).*\n", rf"\g<1>\g<2>,{cycles}\n", text, count=1)


class Job:
    """A deck with many states and restart files, and its undisturbed run."""

    def __init__(self, exe, name, folder):
        make, cycles = SCENES[name]
        self.exe, self.name, self.folder = exe, name, folder / name
        self.folder.mkdir(parents=True)
        text = with_end(make(), cycles)
        self.write(text)
        self.run("d=first")
        with open(self.folder / "first" / "job.glstat.csv", newline="") as stream:
            last = list(csv.DictReader(stream))[-1]
        end, count = float(last["time"]), int(last["cycle"])
        for keyword in ("DATABASE_BINARY_D3PLOT", "DATABASE_RCFORC", "DATABASE_NODOUT", "DATABASE_MATSUM"):
            text = first_field(text, keyword, f"{end / 20:.6e},")
        text = text.rsplit("*END", 1)[0] + (f"*DATABASE_BINARY_D3DUMP\n{max(count // 4, 1)},\n"
                                            f"*DATABASE_BINARY_RUNRSF\n{max(count // 15, 1)},\n*END\n")
        self.write(text)
        shutil.rmtree(self.folder / "first")
        start = time.monotonic()
        self.run("d=whole")
        self.seconds = time.monotonic() - start
        self.whole = self.folder / "whole"
        self.csv = {path.name: path.read_bytes() for path in self.whole.glob("*.csv") if "timing" not in path.name}
        with h5py.File(self.whole / "job.vtkhdf") as stream:
            self.times = stream["VTKHDF/Steps/Values"][()]
            self.arrays = {name: stream[f"VTKHDF/{name}"][()] for name in ARRAYS}

    def write(self, text):
        """Write the deck."""
        (self.folder / "job.k").write_text(text)

    def run(self, *words):
        """Run to the end."""
        words = words if any(word.startswith("r=") for word in words) else ("i=job.k", *words)
        done = subprocess.run([self.exe, *words], cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{self.name} {words}: status {done.returncode}\n{done.stderr}"
        return done.stdout

    def kill(self, instant, *words):
        """Run, kill after `instant` seconds; (whether it was killed, what it had said)."""
        words = words if any(word.startswith("r=") for word in words) else ("i=job.k", *words)
        said = self.folder / "said.txt"
        with open(said, "w") as out:
            process = subprocess.Popen([self.exe, *words], cwd=self.folder, stdout=out, stderr=out)
            try:
                process.wait(timeout=instant)
            except subprocess.TimeoutExpired:
                process.kill()
            status = process.wait()
        assert status in (0, -9), said.read_text()
        return status == -9, said.read_text()


def check_results(job, folder, said, vtk=False):
    """States in the results file: all that were reported, each that of the undisturbed run. Their number."""
    path = folder / "job.vtkhdf"
    reported = said.count(REPORTED)
    if not path.exists():
        assert reported == 0, f"{reported} states were reported and there is no file"
        return 0
    with h5py.File(path) as stream:
        root = stream["VTKHDF"]
        count = int(root["Steps"].attrs["NSteps"])
        assert count >= reported, f"{count} states in the file, {reported} reported"
        assert np.array_equal(root["Steps/Values"][()], job.times[:count])
        for name in ARRAYS:
            rows = job.arrays[name].shape[0] // len(job.times) * count
            assert np.array_equal(root[name][:rows], job.arrays[name][:rows]), name
    if vtk and count:
        check_vtk(path, job.times[:count])
    return count


def check_vtk(path, times):
    """VTK opens the file at its first and last state."""
    import vtk

    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    found = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    if len(times) > 1:  # VTK takes a file of one state for one without time
        assert np.array_equal(found, times)
    for instant in (times[0], times[-1]):
        reader.UpdateTimeStep(instant)
        assert reader.GetOutput().GetNumberOfCells() > 0


def check_tables(job, folder):
    """CSV files hold whole lines, those of the undisturbed run from its start. Their number."""
    files = [path for path in folder.glob("*.csv") if "timing" not in path.name]
    for path in files:
        data = path.read_bytes()
        assert not data or data.endswith(b"\n"), f"{path.name} ends within a line"
        assert job.csv[path.name].startswith(data), f"{path.name} is not the start of the undisturbed one"
    return len(files)


def check_restarts(folder, said):
    """Restart files under their names are whole, and all that were reported are there. Newest first."""
    files = sorted(folder.glob("*.h5"), key=lambda path: path.stat().st_mtime_ns, reverse=True)
    for path in files:
        data = path.read_bytes()
        head = data[:HEAD].decode(errors="replace")
        assert f"length {len(data) - HEAD}\n" in head and f"checksum {zlib.crc32(data[HEAD:]):08X}\n" in head, path.name
        with h5py.File(path) as stream:
            assert "state" in stream
    for name in re.findall(r"^restart file \S*?/?(job\.\w+\.h5) at", said, re.MULTILINE):
        assert (folder / name).exists(), f"{name} was reported"
    return files


def check_end(job, folder):
    """The folder holds what an undisturbed run leaves, and nothing else."""
    assert {path.name for path in folder.iterdir()} == {path.name for path in job.whole.iterdir()}
    for name, data in job.csv.items():
        assert (folder / name).read_bytes() == data, f"{name} differs"
    assert check_results(job, folder, "") == len(job.times)


def disturb(job, chance, vtk=False):
    """Kill one run and check what is left; go on from its restart file, or run it again. What happened."""
    folder = job.folder / "cut"
    shutil.rmtree(folder, ignore_errors=True)
    killed, said = job.kill(chance.uniform(0.0, 1.05 * job.seconds), "d=cut")
    happened = {"killed": killed, "states": 0, "part": False, "went on": False, "killed again": False}
    if not folder.exists():
        assert killed
    else:
        happened["states"] = check_results(job, folder, said, vtk)
        check_tables(job, folder)
        happened["part"] = any(folder.glob("*.h5.part"))
        files = check_restarts(folder, said)
        if killed and files and chance.random() < 0.7:
            go_on(job, folder, files[0].name, chance, happened)
            return happened
    job.run("d=cut")
    check_end(job, folder)
    return happened


def go_on(job, folder, name, chance, happened):
    """Go on from a restart file, sometimes after one more kill; the end is that of the undisturbed run."""
    happened["went on"] = True
    if chance.random() < 0.3:
        before = check_results(job, folder, "")
        instant = chance.uniform(0.0, 0.8 * job.seconds)
        happened["killed again"], said = job.kill(instant, f"r=cut/{name}")
        after = check_results(job, folder, "")
        assert after > 0 or not before, "the states before the restart are lost"
        check_tables(job, folder)
        name = check_restarts(folder, said)[0].name
    job.run(f"r=cut/{name}")
    for path in folder.glob("*.part"):
        raise AssertionError(f"{path.name} is left")
    for table, data in job.csv.items():
        assert (folder / table).read_bytes() == data, f"{table} differs after the restart from {name}"
    assert check_results(job, folder, "") == len(job.times)


def run_kills(exe, folder, kills, seed, names=None, vtk=False, say=None):
    """Kill `kills` runs over all scenes in turn; the sums of what happened. Runs that end before come on top."""
    chance = random.Random(seed)
    names = list(names or SCENES)
    chance.shuffle(names)
    jobs, sums = {}, {"runs": 0, "killed": 0}
    while sums["killed"] < kills and sums["runs"] < 3 * kills:
        name = names[sums["runs"] % len(names)]
        if name not in jobs:
            jobs[name] = Job(exe, name, folder)
        happened = disturb(jobs[name], chance, vtk)
        sums["runs"] += 1
        for key, value in happened.items():
            sums[key] = sums.get(key, 0) + int(value)
        if say:
            say(f"{sums['runs']} {name}: {happened}")
    return sums
