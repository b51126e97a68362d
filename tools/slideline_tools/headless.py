# SPDX-License-Identifier: MIT
"""Pictures go to files, without a window; except in a notebook, and where $MPLBACKEND says otherwise.

Import this before anything draws.
"""
import os
import sys

import matplotlib

if "IPython" not in sys.modules and not os.environ.get("MPLBACKEND"):
    matplotlib.use("Agg")
