# SPDX-License-Identifier: MIT
"""Pictures go to files, without a window; except in a notebook, and where $MPLBACKEND says otherwise.

Import this before anything draws.
"""
import os
import sys

import matplotlib
import matplotlib.pyplot

if "IPython" not in sys.modules and not os.environ.get("MPLBACKEND"):
    matplotlib.use("Agg")
elif "IPython" in sys.modules:
    # A notebook sets up its backend with the first figure: within the style of ours what that sets would be lost.
    matplotlib.pyplot.close(matplotlib.pyplot.figure())
