# SPDX-License-Identifier: MIT
"""The contact types that the verification cases run over: one list for all of them."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))

# Number (CTYPE) and name of every type that the program has.
from slideline_tools.contact_types import TYPES  # noqa: E402,F401

#: Types whose points lie on one line of action, so that the net moment vanishes (all but VTS-PPT).
MOMENT_FREE = {1, 2, 3, 5, 6, 7}

#: Types that transmit a uniform pressure between non-matching flat meshes.
PASS_PATCH = {4, 5, 7}
