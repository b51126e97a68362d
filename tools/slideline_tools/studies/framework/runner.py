# SPDX-License-Identifier: MIT
"""Runs jobs one after the other or side by side, and keeps what has finished.

A finished run has a `job.json` in its folder, written last and whole. A run without one, or with
the fingerprint of another deck, option or program, is run anew.
"""
import collections
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import time

from slideline_tools.studies.framework.job import write_whole

RECORD, ERRORS = "job.json", "errors.txt"
PATIENCE = 5.0  # seconds that a process has to end when it is asked to
STOPPED = 4  # exit status of the program when it is asked to stop
# Ended by somebody else: no result, to be run anew.
FROM_OUTSIDE = (STOPPED, -signal.SIGTERM, -signal.SIGKILL, -signal.SIGINT, -signal.SIGHUP)
# The run is killed when this program is, even by SIGKILL (Linux). Not a `preexec_fn`: an interrupt while Python forks is lost.
GUARD = ["setpriv", "--pdeathsig", "KILL"] if shutil.which("setpriv") else []


class Sweep:
    """The runs of one study folder with one program, and with the one whose instructions are counted."""

    def __init__(self, folder, program, digest, counted=None):
        """`digest`: the `file_digest` of the program; `counted`: program and digest of the runs that are counted."""
        self.folder, self.program, self.digest = pathlib.Path(folder), program, digest
        self.counted, self.counted_digest = counted or (program, digest)

    def run_folder(self, job):
        """Folder of the run of a job."""
        return self.folder / "runs" / job.folder_name

    def fingerprint(self, job):
        """Of a job with the program that it takes."""
        return job.fingerprint(self.counted_digest if job.counted else self.digest)

    def record(self, job):
        """The record of a finished job, or None."""
        try:
            record = json.loads((self.run_folder(job) / RECORD).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return record if record.get("fingerprint") == self.fingerprint(job) else None

    def command(self, job, deck):
        """What runs a job."""
        folder = str(self.run_folder(job))
        words = [f"i={deck}", f"d={folder}", f"jobid={job.jobid}", *job.options]
        if job.counted:
            return [sys.executable, "-m", "slideline_tools.counting", folder, str(self.counted), *words]
        return [*job.launcher, str(self.program), *words]

    def run(self, jobs, parallel, progress, retry=False):
        """Run what has no record yet; `retry`: what has failed too. `progress`: see progress.py."""
        waiting, running = collections.deque(), []
        for job in jobs:
            record = self.record(job)
            if record is None or (retry and record["status"] != 0):
                waiting.append(job)
            else:
                progress.known(job, record)
        progress.start(waiting, parallel)
        try:
            while waiting or running:
                while waiting and has_room(waiting[0], running, parallel):
                    running.append(Run(self, waiting.popleft()))
                running = [run for run in running if not run.ended(len(running), progress)]
        finally:
            stop_all(running)


def has_room(job, running, parallel):
    """Whether a job may start beside those that run."""
    alone = job.alone or any(run.job.alone for run in running)
    return not running or (not alone and len(running) < parallel)


class Run:
    """One running process."""

    def __init__(self, sweep, job):
        self.job, self.folder = job, sweep.run_folder(job)
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        deck = self.folder / f"{job.jobid}.k"
        deck.write_text(job.deck, encoding="utf-8")
        self.record = {"fingerprint": sweep.fingerprint(job), "name": job.name, "processor": processor(),
                       "load": os.getloadavg()[0], "command": sweep.command(job, deck)}
        self.spent_before = processor_seconds()
        with open(self.folder / "progress.txt", "wb") as out, open(self.folder / ERRORS, "wb") as err:
            self.begun = time.perf_counter()
            # A session of its own: an interrupt from the keyboard reaches this program alone.
            self.process = subprocess.Popen(
                [*GUARD, *self.record["command"]], stdin=subprocess.DEVNULL, stdout=out, stderr=err, cwd=self.folder,
                env={**os.environ, **job.environment}, start_new_session=True)

    def ended(self, count, progress):
        """Whether the process has ended (then it is recorded); waits a little for it."""
        message = ""
        try:
            self.process.wait(timeout=0.5 if count == 1 else 0.02 / count)
        except subprocess.TimeoutExpired:
            if self.job.limit is None or time.perf_counter() - self.begun <= self.job.limit:
                return False
            stop_all([self])
            message = f"stopped after {self.job.limit:g} s"
        if not message and self.process.returncode in FROM_OUTSIDE:
            progress.killed(self.job)
        else:
            self.keep(progress, message)
        return True

    def keep(self, progress, message):
        """Write the record of the finished run."""
        status = self.process.returncode or (STOPPED if message else 0)
        # The processor's seconds are those of all runs that ended meanwhile: its own where it ran alone.
        self.record.update(status=status, message=message or reason(status, self.folder / ERRORS),
                           seconds=time.perf_counter() - self.begun,
                           processor_seconds=processor_seconds() - self.spent_before)
        write_whole(self.folder / RECORD, json.dumps(self.record, indent=1) + "\n")
        progress.done(self.job, self.record)


def reason(status, path):
    """Why a run failed: the first line of its errors that is no warning, or its signal; '' if it has not."""
    if status <= 0:
        return f"killed by {signal.Signals(-status).name}" if status else ""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    reported = [line.strip() for line in lines if line.strip() and not line.startswith("warning")]
    return reported[0][:200] if reported else f"exit status {status}"


def stop_all(running):
    """End processes: asked first, killed when they do not listen."""
    for run in running:
        run.process.terminate()
    for run in running:
        try:
            run.process.wait(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            run.process.kill()
            run.process.wait()


def processor_seconds():
    """Processor time of all ended runs, s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def processor():
    """The kind of processor this runs on."""
    try:
        text = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return "unknown"
    names = [line.split(":", 1)[1].strip() for line in text.splitlines() if line.startswith("model name")]
    return f"{names[0]}, {os.cpu_count()} logical cores" if names else "unknown"
