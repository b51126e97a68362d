# SPDX-License-Identifier: MIT
"""Abrupt peaks of a force history: how many, how large, and how rough the history is.

The trend of the history is its running median over a window, smoothed by a running mean over the
same window: a spike shorter than half the window leaves no trace in it, and an oscillation much
longer than the window is followed. What remains, r = F - trend, holds the spikes, steps (a step
of height s leaves s/2) and fast ringing. An abrupt peak is a place where |r| exceeds a given
share of the mean force; places closer than half a window to each other are one peak, since a
structure that was hit once rings for a while.
"""
import typing

import numpy as np
import pandas as pd

from slideline_tools import UserError

FEWEST_SAMPLES = 8
PER_SEGMENT = 101


class Peaks(typing.NamedTuple):
    """The abrupt peaks of one history."""

    mean: float        # mean force in the judged interval, unit of the force
    times: np.ndarray  # (n,) when |r| of each peak is largest
    sizes: np.ndarray  # (n,) that largest |r| over the mean force
    largest: float     # largest |r| in the judged interval over the mean force, a peak or not
    rms: float         # root mean square of r in the judged interval over the mean force


def running(name, values, count):
    """The `mean` or `median` over `count` samples about each; the ends are repeated."""
    half = count // 2
    windows = pd.Series(np.pad(values, half, mode="edge")).rolling(2 * half + 1)
    return getattr(windows, name)().to_numpy()[2 * half:]


def sample_count(time, window):
    """Samples in a window; raises UserError for uneven sampling or too few samples."""
    steps = np.diff(time)
    if len(steps) < FEWEST_SAMPLES or not np.all(np.abs(steps - steps[0]) < 1e-3 * steps[0]):
        raise UserError("peaks of a history: it must be long and evenly sampled")
    count = int(round(window / steps[0]))
    if count < FEWEST_SAMPLES:
        raise UserError(f"peaks of a history: a window of {window:g} holds {count} samples, "
                        f"fewer than {FEWEST_SAMPLES}")
    return count


def trend(time, force, window):
    """The smooth part of a history, sampled as the history."""
    count = sample_count(time, window)
    return running("mean", running("median", force, count), count)


def abrupt_peaks(time, force, window, threshold, interval=None):
    """The peaks of an evenly sampled history, see above.

    `window` in the unit of time; `threshold` over the mean force; `interval` = (first, last) time
    that is judged. Raises UserError for uneven or too coarse sampling or without a mean force.
    """
    time, force = np.asarray(time, dtype=float), np.asarray(force, dtype=float)
    rest = force - trend(time, force, window)
    first, last = interval or (time[0], time[-1])
    judged = (time >= first) & (time <= last)
    time, rest, mean = time[judged], rest[judged], float(np.mean(force[judged]))
    if not mean > 0.0:
        raise UserError("peaks of a history: the mean force is not positive")
    tops = [group[np.argmax(np.abs(rest[group]))]
            for group in groups(time, np.abs(rest) > threshold * mean, 0.5 * window)]
    return Peaks(mean, time[tops], np.abs(rest[tops]) / mean, float(np.abs(rest).max()) / mean,
                 float(np.sqrt(np.mean(rest ** 2))) / mean)


def waviness(time, force, travel, length, window, interval):
    """Slow oscillation of a history while something travels over segments of a given length.

    The trend of the history over the travel, less its running mean over one segment length:
    root mean square in the interval over the mean force. `travel` (n,) must not fall; `length`
    in the unit of `travel`; `window` and `interval` as in `abrupt_peaks`.
    """
    smooth = trend(time, force, window)
    even = np.linspace(travel[0], travel[-1],
                       1 + int(round((travel[-1] - travel[0]) / length * PER_SEGMENT)))
    judged = (even >= np.interp(interval[0], time, travel)) \
        & (even <= np.interp(interval[1], time, travel))
    wave = np.interp(even, travel, smooth)
    rest = (wave - running("mean", wave, PER_SEGMENT))[judged]
    return float(np.sqrt(np.mean(rest ** 2)) / np.mean(wave[judged]))


def groups(time, wanted, distance):
    """Lists of the indices of wanted samples; samples within `distance` share a list."""
    index = np.flatnonzero(wanted)
    if not len(index):
        return []
    return np.split(index, np.flatnonzero(np.diff(time[index]) > distance) + 1)
