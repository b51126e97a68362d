# SPDX-License-Identifier: MIT
"""Coulomb friction of interfaces and of rigid walls: blocks, and a disc that rolls."""
import blocks
import rolling


def check(run):
    blocks.check(run)
    rolling.check(run)
