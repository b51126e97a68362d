# SPDX-License-Identifier: MIT
"""Statics by the implicit program: plastic blocks, a punch, turned blocks, the elastica."""
import press
import rotation


def check(run):
    press.check(run)
    rotation.check(run)
