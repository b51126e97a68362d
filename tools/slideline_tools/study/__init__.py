# SPDX-License-Identifier: MIT
"""Studies: sweeps of runs that end in one table and charts (`tools/study.sh NAME`).

A study is one file of this package with a `STUDY`, and one line in `registry.STUDIES`.
"""
