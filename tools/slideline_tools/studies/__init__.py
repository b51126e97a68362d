# SPDX-License-Identifier: MIT
"""Studies: runs that are put into tables, charts and pages of `doc/studies`.

A study of one file is a module of this package, one of several a folder. A sweep (`tools/study.sh NAME`) has a `STUDY` in
its module, or in `study.py` of its folder, and one line in `framework.registry.STUDIES`.
"""
