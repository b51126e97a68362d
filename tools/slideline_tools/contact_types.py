# SPDX-License-Identifier: MIT
"""The contact types that the program has: the one list that tools, studies and tests take them from."""

#: Number (CTYPE) and name, as the program's log has it (src/contact/contact_dispatch.f90).
PROGRAM_NAMES = {1: "classical NTS", 2: "NTS-AR", 3: "NTS-AR two-pass", 4: "VTS-PPT", 5: "NTS-mAR", 6: "mortar",
                 7: "segmented mortar"}

#: The same with the names that tables and pictures use.
TYPES = {**PROGRAM_NAMES, 1: "NTS", 3: "two-pass NTS-AR"}

ALL_TYPES = tuple(TYPES)

#: What studies compare beside the types: type 7 with implicit penalty (PUNIT 4), and its PEN. Below 0: no compliance.
IMPLICIT, HARD = "7i", "7h"
IMPLICIT_PENALTIES = {IMPLICIT: 10.0, HARD: -1.0}

#: All that is compared, with names.
SERIES: dict = {**TYPES, IMPLICIT: "PUNIT 4", HARD: "PUNIT 4, PEN < 0"}


def in_order(some):
    """Those of `SERIES` that are among `some`, in its order."""
    there = set(some)
    return [one for one in SERIES if one in there]


def parse_series(text):
    """The series of a text of the command line."""
    return int(text) if text.isdigit() else text
