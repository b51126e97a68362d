# SPDX-License-Identifier: MIT
"""The rules by which the studies compare types: what counts as alike, who is named, in which words.

A page names the cheapest or the most accurate type only by these rules.  They must give the same
names when the runs are repeated: times scatter by some per cent, and means over all scenes have
moved by up to 15 % between programs whose contact was the same in the large.
"""

#: Costs of contact (means over meshes, or over scenes) that differ by less count as alike.
COST_FACTOR = 1.25
#: The same for the computing time of one run, of which contact is a part.
RUN_FACTOR = 1.10
#: Errors that differ by less count as alike: less than one step of refinement changes them by.
ERROR_FACTOR = 1.5


def least(values, factor):
    """The keys of the dict `values` whose value is the smallest, or less than `factor` times it."""
    if not values:
        return []
    bound = factor * min(values.values())
    return [key for key, value in values.items() if value <= bound]


def share_verdict(answers):
    """'yes' if all answers hold, 'no' if none does, else 'partly'."""
    answers = list(answers)
    return "yes" if all(answers) else "partly" if any(answers) else "no"


def numbers(types, last="and"):
    """'4', '4 and 5', '4, 5 and 7'."""
    words = [str(ctype) for ctype in types]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} {last} {words[-1]}"


def names(types):
    """'no type', 'type 4', 'types 4, 5 and 7'."""
    types = list(types)
    if not types:
        return "no type"
    return f"type{'s' * (len(types) > 1)} {numbers(types)}"


def between(values, form="{:.2f}"):
    """'1.20 to 1.30'; one number where both ends read the same."""
    low, high = (form.format(value) for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"
