# SPDX-License-Identifier: MIT
"""Surfaces that come and go: outlines slide on, off and fall; a block rattles between dies."""
import outlines
import rattle


def check(run):
    outlines.check(run)
    rattle.check(run)
