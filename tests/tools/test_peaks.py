# SPDX-License-Identifier: MIT
"""The measure of abrupt peaks, on made histories whose peaks are known."""
import numpy as np
import pytest

from slideline_tools import UserError
from slideline_tools.studies.peaks import abrupt_peaks, trend, waviness

MEAN, PERIOD, WINDOW, THRESHOLD = 3.0e6, 0.3, 0.04, 0.005
SPIKES = (1.213, 1.700, 2.345, 3.111, 3.9005)


def smooth(time):
    """A force that rises slowly and swings by 2 % of the mean."""
    return MEAN * (1.0 + 0.04 * (time - 2.5) + 0.02 * np.sin(2.0 * np.pi * time / PERIOD))


def sampled(interval=0.0004):
    return np.arange(0.0, 5.0, interval)


def spikes(time, height, width=0.008):
    """Ringing that starts at each time of SPIKES and dies out, `height` over the mean."""
    force = np.zeros_like(time)
    for start in SPIKES:
        t = np.clip(time - start, 0.0, None)
        force += height * MEAN * np.sin(2.0 * np.pi * t / width) * np.exp(-t / width)
    return force


def judged(time, force, threshold=THRESHOLD, window=WINDOW):
    return abrupt_peaks(time, force, window, threshold, (0.5, 4.5))


def test_smooth_oscillation_has_no_peaks():
    found = judged(sampled(), smooth(sampled()))
    assert len(found.sizes) == 0
    assert found.largest < 0.2 * THRESHOLD


# The first crest of sin(2 pi t / w) exp(-t / w): at tan(2 pi t / w) = 2 pi.
CREST = np.sin(np.arctan(2 * np.pi)) * np.exp(-np.arctan(2 * np.pi) / (2 * np.pi))


@pytest.mark.parametrize("interval", [0.0001, 0.0004, 0.001])
def test_ringing_is_one_peak_each_at_any_sampling_that_sees_it(interval):
    time = sampled(interval)
    found = judged(time, smooth(time) + spikes(time, 0.02))
    assert len(found.sizes) == len(SPIKES)
    assert np.allclose(found.times, SPIKES, atol=0.006)
    assert found.sizes == pytest.approx(0.02 * CREST, rel=0.15)
    assert found.largest == found.sizes.max()


def test_sizes_follow_the_height():
    time = sampled()
    small = judged(time, smooth(time) + spikes(time, 0.01))
    large = judged(time, smooth(time) + spikes(time, 0.04))
    assert len(small.sizes) == len(large.sizes) == len(SPIKES)
    assert np.median(large.sizes) / np.median(small.sizes) == pytest.approx(4.0, rel=0.1)


def test_peaks_below_the_threshold_do_not_count_but_are_seen():
    time = sampled()
    found = judged(time, smooth(time) + spikes(time, 0.004))
    assert len(found.sizes) == 0
    assert found.largest == pytest.approx(0.004 * CREST, rel=0.2)


def test_step_leaves_half_its_height():
    time = sampled()
    found = judged(time, MEAN * (1.0 + 0.03 * (time > 2.0)))
    assert len(found.sizes) == 1
    assert found.sizes * found.mean == pytest.approx(0.5 * 0.03 * MEAN, rel=0.05)


def test_peaks_outside_the_interval_are_not_judged():
    time = sampled()
    force = smooth(time) + spikes(time, 0.02)
    assert len(abrupt_peaks(time, force, WINDOW, THRESHOLD, (1.5, 3.5)).sizes) == 3


def test_rms_of_a_fast_oscillation():
    time = sampled()
    found = judged(time, MEAN * (1.0 + 0.01 * np.sin(2.0 * np.pi * time / 0.004)))
    assert found.rms == pytest.approx(0.01 / np.sqrt(2.0), rel=0.02)


def test_trend_follows_the_smooth_part():
    time = sampled()
    inner = (time > 0.5) & (time < 4.5)
    rest = trend(time, smooth(time) + spikes(time, 0.02), WINDOW) - smooth(time)
    assert np.abs(rest[inner]).max() < 0.002 * MEAN


def test_waviness_is_the_oscillation_over_one_segment():
    time = sampled()
    travel = time ** 2  # the speed of travel changes
    force = MEAN * (1.0 + 0.02 * travel + 0.01 * np.sin(2.0 * np.pi * travel))
    even = waviness(time, force, travel, 1.0, 0.01, (1.0, 4.0))
    mean = 1.0 + 0.02 * 8.5
    assert even == pytest.approx(0.01 / np.sqrt(2.0) / mean, rel=0.03)
    straight = waviness(time, MEAN * (1.0 + 0.02 * travel), travel, 1.0, 0.01, (1.0, 4.0))
    assert straight < 1e-3 * even


@pytest.mark.parametrize("time, force, message", [
    (np.array([0.0, 1.0, 2.0]), np.ones(3), "evenly sampled"),
    (np.linspace(0.0, 5.0, 2000) ** 2, np.ones(2000), "evenly sampled"),
    (np.arange(0.0, 5.0, 0.01), np.ones(500), "fewer than"),
    (np.arange(0.0, 5.0, 0.001), np.zeros(5000), "not positive")])
def test_unusable_histories_are_refused(time, force, message):
    with pytest.raises(UserError, match=message):
        judged(time, force)
