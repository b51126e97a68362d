# SPDX-License-Identifier: MIT
"""Contact patch test: damped to rest, static, and of ties."""
import damped
import static
import ties


def check(run):
    damped.check(run)
    static.check(run)
    ties.check(run)
