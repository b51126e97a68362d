# SPDX-License-Identifier: MIT
"""The contact types that the verification cases run over: one list for all of them."""

#: Number (CTYPE) and name of every type that the program has.
TYPES = {1: "NTS", 2: "NTS-AR", 3: "two-pass NTS-AR", 4: "VTS-PPT", 5: "NTS-mAR", 6: "mortar",
         7: "segmented mortar"}

#: Types whose points lie on one line of action, so that the net moment vanishes (all but VTS-PPT).
MOMENT_FREE = {1, 2, 3, 5, 6, 7}

#: Types that transmit a uniform pressure between non-matching flat meshes.
PASS_PATCH = {4, 5, 7}
