# SPDX-License-Identifier: MIT
"""Frictional patch tests: static, and dragged in full slip and damped to rest."""
import damped
import static


def check(run):
    static.check(run)
    damped.check(run)
