# SPDX-License-Identifier: MIT
"""Published benchmarks with friction, static: a cylinder on a block (NAFEMS), a plate on a rigid plane (GRECO)."""
import cylinder
import plate


def check(run):
    cylinder.check(run)
    plate.check(run)
