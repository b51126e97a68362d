# SPDX-License-Identifier: MIT
"""Studies: sweeps of runs, their tables and pictures, that pages of `doc/studies` quote.

`tools/study.sh NAME` runs the `STUDY` of a module, or of `study.py` in a folder; `framework.pages.PAGES` lists them. The
modules block, patch, sliding, collision and hertz say what runs of these scenes are judged by.
"""
