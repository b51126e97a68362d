# SPDX-License-Identifier: MIT
"""Friction in motion: a shear pulse through an interface, a band on a drum, flutter of steady sliding."""
import flutter
import waves


def check(run):
    waves.check(run)
    flutter.check(run)
