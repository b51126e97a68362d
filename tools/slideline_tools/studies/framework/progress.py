# SPDX-License-Identifier: MIT
"""Says how far a sweep is: on a terminal one line that is renewed, elsewhere a line now and then."""
import shutil
import sys
import time

LINE_EVERY = 1.0  # seconds between lines that are not on a terminal


class Progress:
    """Counts runs and guesses the time to go from the seconds and costs of those that have finished."""

    def __init__(self, stream=None):
        self.stream = stream or sys.stdout
        self.seconds = self.cost = 0.0  # measured and expected, of the finished runs
        self.left, self.total, self.finished, self.failed = [], 0, 0, 0
        self.parallel, self.shown = 1, 0.0

    def known(self, job, record):
        """A run that has finished before."""
        self.seconds, self.cost = self.seconds + record["seconds"], self.cost + job.cost
        self.failed += record["status"] != 0
        self.finished += 1

    def start(self, waiting, parallel):
        """The runs to come."""
        self.left, self.parallel = list(waiting), parallel
        self.total = self.finished + len(self.left)
        if self.finished:
            self.line(f"{self.finished} of {self.total} runs have finished before")

    def done(self, job, record):
        """One more run has finished."""
        self.left.remove(job)
        self.known(job, record)
        if record["status"] != 0:
            self.line(f"{job.folder_name} failed: {record['message']}")
        if self.stream.isatty() or time.monotonic() - self.shown > LINE_EVERY or not self.left:
            self.shown = time.monotonic()
            text = f"{self.finished} of {self.total} runs" + f", {self.failed} failed" * bool(self.failed)
            text += f", {span(self.to_go())} to go" * bool(self.left)
            self.line(f"{text}; {job.folder_name} took {record['seconds']:.3g} s", stays=not self.left)

    def killed(self, job):
        """A run that was ended from outside: no result."""
        self.left.remove(job)
        self.line(f"{job.folder_name} was killed; the same command runs it anew")

    def line(self, text, stays=True):
        """One line; one that does not stay is overwritten by the next on a terminal."""
        if self.stream.isatty():
            width = shutil.get_terminal_size().columns - 1
            text = "\r" + (text if stays else text[:width]).ljust(width)
        print(text, end="\n" if stays or not self.stream.isatty() else "", file=self.stream, flush=True)

    def to_go(self):
        """Seconds to go."""
        return self.seconds / self.cost * sum(job.cost / (1 if job.alone else self.parallel) for job in self.left)


def span(seconds):
    """A length of time in words."""
    if seconds < 90.0:
        return f"about {max(1, round(seconds))} s"
    return f"about {round(seconds / 60.0)} min" if seconds < 5400.0 else f"about {seconds / 3600.0:.1f} h"
