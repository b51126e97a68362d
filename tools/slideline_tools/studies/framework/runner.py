# SPDX-License-Identifier: MIT
"""Runs jobs one after the other or side by side, and keeps what has finished.

A finished run has a `job.json` in its folder, written last and whole. A run without one, or with
the fingerprint of another deck, option or program, is run anew.
"""
import collections
import ctypes
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

RECORD, PROGRESS, ERRORS = "job.json", "progress.txt", "errors.txt"
PATIENCE = 5.0
STOPPED = 4  # exit status of the program when it is asked to stop
# Ended by somebody else: no result, to be run anew.
FROM_OUTSIDE = (STOPPED, -signal.SIGTERM, -signal.SIGKILL, -signal.SIGINT, -signal.SIGHUP)
PARENT_DIES = 1  # PR_SET_PDEATHSIG
LIBC = ctypes.CDLL(None) if sys.platform == "linux" else None


def read_record(run_folder, fingerprint):
    """The record of a finished run, or None."""
    try:
        record = json.loads((run_folder / RECORD).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return record if record.get("fingerprint") == fingerprint else None


class Sweep:
    """The runs of one study folder with one program, and with the one whose instructions are counted."""

    def __init__(self, folder, program, digest, counted=None):
        """`digest`: the `file_digest` of the program; `counted`: program and digest of the runs that are counted."""
        self.folder, self.program, self.digest = pathlib.Path(folder), program, digest
        self.counted, self.counted_digest = counted or (program, digest)

    def run_folder(self, job):
        return self.folder / "runs" / job.folder_name

    def record(self, job):
        """The record of a finished job, or None."""
        return read_record(self.run_folder(job), self.fingerprint(job))

    def fingerprint(self, job):
        """Of a job with the program that it takes."""
        return job.fingerprint(self.counted_digest if job.counted else self.digest)

    def command(self, job, deck):
        """What runs a job."""
        folder = str(self.run_folder(job))
        words = [f"i={deck}", f"d={folder}", f"jobid={job.jobid}", *job.options]
        if job.counted:
            return [sys.executable, "-m", "slideline_tools.counting", folder, str(self.counted), *words]
        return [str(self.program), *words]

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
                progress.show([run.job for run in running])
                running = [run for run in running if not run.ended(len(running), progress)]
        finally:
            stop_all(running)
            progress.end()


def has_room(job, running, parallel):
    """Whether a job may start beside those that run."""
    if not running:
        return True
    alone = job.alone or any(run.job.alone for run in running)
    return not alone and len(running) < parallel


class Run:
    """One running process."""

    def __init__(self, sweep, job):
        self.job, self.folder = job, sweep.run_folder(job)
        self.fingerprint = sweep.fingerprint(job)
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        deck = self.folder / f"{job.jobid}.k"
        deck.write_text(job.deck_text, encoding="utf-8")
        self.command = sweep.command(job, deck)
        self.load, self.spent_before = os.getloadavg()[0], processor_seconds()
        with open(self.folder / PROGRESS, "wb") as out, open(self.folder / ERRORS, "wb") as err:
            self.begun = time.perf_counter()
            # A session of its own: an interrupt from the keyboard reaches this program alone.
            self.process = subprocess.Popen(
                self.command, stdin=subprocess.DEVNULL, stdout=out, stderr=err, cwd=self.folder,
                env={**os.environ, **job.environment}, start_new_session=True,
                preexec_fn=die_with_parent if LIBC else None)

    def ended(self, count, progress):
        """Whether the process has ended (then it is recorded); waits a little for it."""
        try:
            self.process.wait(timeout=0.5 if count == 1 else 0.02 / count)
        except subprocess.TimeoutExpired:
            limit = self.job.limit
            if limit is None or time.perf_counter() - self.begun <= limit:
                return False
            stop_all([self])
            return self.keep(progress, f"stopped after {limit:g} s")
        return self.keep(progress, None)

    def keep(self, progress, message):
        """Write the record of the finished run."""
        seconds, status = time.perf_counter() - self.begun, self.process.returncode
        if message is None and status in FROM_OUTSIDE:
            progress.killed(self.job)
            return True
        if message is None:
            message = "" if status == 0 else reason(status, self.folder / ERRORS)
        if message and status == 0:
            status = STOPPED
        record = {"fingerprint": self.fingerprint, "name": self.job.name, "status": status,
                  "message": message, "seconds": seconds, "processor": processor(),
                  "load": self.load, "command": self.command,
                  # That of all runs that ended meanwhile: its own where it ran alone.
                  "processor_seconds": processor_seconds() - self.spent_before}
        write_whole(self.folder / RECORD, json.dumps(record, indent=1) + "\n")
        progress.done(self.job, record)
        return True


def reason(status, path):
    """Why a run failed: the first line of its errors that is no warning, or its signal."""
    if status < 0:
        return f"killed by {signal.Signals(-status).name}"
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    told = [line.strip() for line in lines if line.strip() and not line.startswith("warning")]
    return told[0][:200] if told else f"exit status {status}"


def die_with_parent():
    """Between fork and exec: the run is killed when this program is, even by SIGKILL."""
    LIBC.prctl(PARENT_DIES, signal.SIGKILL)


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
    names = [line.split(":", 1)[1].strip() for line in text.splitlines()
             if line.startswith("model name")]
    return f"{names[0]}, {os.cpu_count()} logical cores" if names else "unknown"
