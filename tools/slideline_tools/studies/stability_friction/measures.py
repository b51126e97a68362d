# SPDX-License-Identifier: MIT
"""How fast a run's flutter grows: the speeds of the slave nodes across the interface after the damping has gone."""
import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.results import read
from slideline_tools.studies.stability_friction.scene import SPEED, calm_after

SLIPS = 2          # column `state`
SMOOTHED = 16      # rows in a running mean of squares
SLOW = 49          # rows whose mean is no flutter: the bodies settle as nodes move along
LARGEST = 0.01     # of the sliding speed: far below that at which slip may stop, speeds along being larger
STRETCH = 20.0     # amplitudes over which the rate is fitted
RATES = 400        # of a first look, then as many about the best
SPECTRUM = 256     # rows
GROWN = np.e       # over the stretch: amplitudes from which a rate is told
TOLD = 1.0         # growing part over the rest, at the end, from which a rate is told


def speeds(folder, jobid):
    """Times, s, and speeds of the slave nodes across the interface (time, node), m/s."""
    table = read(folder / f"{jobid}.vtkhdf").history("nodout")
    times = np.unique(table["time"])
    n_node = len(np.unique(table["node"]))
    if len(times) * n_node != len(table):
        raise UserError(f"{folder}: rows are missing")
    return times, table["vy"].reshape(len(times), n_node)


def amplitude(times, speed):
    """Times, s, and mean squares of the speeds, (m/s)^2, from the calm on; both of the rows until then, so that what
    comes later, when slip may have stopped, has no part in it."""
    kernel = np.full(SLOW, 1.0 / SLOW)
    quick = speed[SLOW - 1:] - np.apply_along_axis(np.convolve, 0, speed, kernel, mode="valid")
    smooth = np.convolve(np.mean(quick ** 2, axis=1), np.full(SMOOTHED, 1.0 / SMOOTHED), mode="valid")
    until = times[SLOW + SMOOTHED - 2:]
    late = until > calm_after() + (SLOW + SMOOTHED) * (times[1] - times[0])
    return until[late], smooth[late]


def last_stretch(times, squares):
    """The rows before the speeds first pass `LARGEST` of the sliding speed, from a `STRETCH`-th of the last of them on:
    there the fastest of all motions that grow has the upper hand."""
    beyond = np.flatnonzero(squares > (LARGEST * SPEED) ** 2)
    last = beyond[0] if len(beyond) else len(times)
    times, squares = times[:last], squares[:last]
    small = np.flatnonzero(squares < squares[-1] / STRETCH ** 2) if last else []
    first = small[-1] if len(small) else 0
    return times[first:], squares[first:]


def fitted_rate(times, squares):
    """(rate, 1/s, and growing part over the rest at the end) of B + C exp(2 rate t), B and C not negative, by least
    squares of the relative differences."""
    t = (times - times[-1]) / (times[-1] - times[0])

    def misfit(rate):
        shape = np.stack([np.ones_like(t), np.exp(2.0 * rate * t)], axis=1) / squares[:, None]
        parts = np.linalg.lstsq(shape, np.ones_like(t), rcond=None)[0]
        if parts.min() < 0.0:  # one of them alone
            ones = [np.where(np.arange(2) == k, (shape[:, k] @ np.ones_like(t)) / (shape[:, k] @ shape[:, k]), 0.0)
                    for k in (0, 1)]
            parts = min(ones, key=lambda one: np.sum((shape @ one - 1.0) ** 2))
        return np.sum((shape @ parts - 1.0) ** 2), parts

    rates = np.geomspace(0.05, 200.0, RATES)
    for _ in range(2):
        best = min(rates, key=lambda rate: misfit(rate)[0])
        rates = np.linspace(0.95 * best, 1.05 * best, RATES)
    rest, growing = misfit(best)[1]
    return best / (times[-1] - times[0]), growing / rest if rest > 0.0 else np.inf


def frequency(times, speed, last):
    """The strongest frequency of the `SPECTRUM` rows until the time `last`, rad/s."""
    end = int(np.searchsorted(times, last))
    rows = speed[max(0, end - SPECTRUM):end]
    wave = np.fft.rfft(rows * np.hanning(len(rows))[:, None], axis=0)
    strongest = int(np.argmax(np.sum(np.abs(wave[1:]) ** 2, axis=1))) + 1
    return 2.0 * np.pi * strongest / (len(rows) * (times[1] - times[0]))


def pressed_share(folder, jobid):
    """Share of the slave nodes that slip when the damping has gone; the prediction is for all of them."""
    table = read_csv(folder / f"{jobid}.contact.csv")
    times = np.unique(table["time"])
    rows = table.where(time=times[np.argmin(np.abs(times - calm_after()))])
    return float(np.mean(rows["state"] == SLIPS))


def measure_run(folder, jobid):
    """`rate`, 1/s: 0 where nothing grows that can be told; `shown`: growing part over the rest at the end; `omega`, rad/s,
    of what grows."""
    times, speed = speeds(folder, jobid)
    when, squares = last_stretch(*amplitude(times, speed))
    if len(when) < SMOOTHED:
        raise UserError("flutter is there before the damping has gone")
    rate, shown = fitted_rate(when, squares)
    closed = pressed_share(folder, jobid)
    if shown <= TOLD or squares[-1] < GROWN ** 2 * squares[0]:
        return {"rate": 0.0, "shown": float(min(shown, 1.0e9)), "closed": closed}
    return {"rate": float(rate), "shown": float(min(shown, 1.0e9)), "closed": closed,
            "omega": float(frequency(times, speed, when[-1]))}
