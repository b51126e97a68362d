# SPDX-License-Identifier: MIT
"""Implicit dynamics: one element against its own recursion, and free bodies."""
import bodies
import element


def check(run):
    element.check(run)
    bodies.check(run)
