# SPDX-License-Identifier: MIT
"""The contact types that the program has: the one list that tools, studies and tests take them from."""

#: Number (CTYPE) and name, as the program's log has it (src/contact/contact_dispatch.f90).
PROGRAM_NAMES = {1: "classical NTS", 2: "NTS-AR", 3: "NTS-AR two-pass", 4: "VTS-PPT", 5: "NTS-mAR", 6: "mortar",
                 7: "segmented mortar"}

#: The same with the names that tables and pictures use.
TYPES = {**PROGRAM_NAMES, 1: "NTS", 3: "two-pass NTS-AR"}

ALL_TYPES = tuple(TYPES)
