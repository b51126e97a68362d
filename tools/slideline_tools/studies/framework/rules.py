# SPDX-License-Identifier: MIT
"""The rules by which the studies compare types: what counts as alike, so that a repeat of the runs names the same types.

Times scatter by some per cent, and means over all scenes have moved by up to 15 % between programs whose contact was the
same in the large.
"""
import numpy as np

#: Costs of contact (means over meshes, or over scenes) that differ by less count as alike.
COST_FACTOR = 1.25
#: The same for the computing time of one run, of which contact is a part.
RUN_FACTOR = 1.10


def least(values, factor):
    """The keys of the dict `values` whose value is the smallest, or at most `factor` times it."""
    bound = factor * min(values.values(), default=0.0)
    return [key for key, value in values.items() if value <= bound]


def share_verdict(answers):
    """'yes' if all answers hold, 'no' if none does, else 'partly'."""
    answers = list(answers)
    return "yes" if all(answers) else "partly" if any(answers) else "no"


def between(values, form="{:.2f}"):
    """'1.20 to 1.30'; one number where both ends read the same."""
    low, high = (form.format(value) for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def geometric_mean(values):
    """The mean of factors."""
    return float(np.exp(np.mean(np.log(values))))
