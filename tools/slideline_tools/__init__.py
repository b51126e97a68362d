# SPDX-License-Identifier: MIT
"""Tools around the program `slideline`: read results, draw, compare, write decks."""

__version__ = "0.1.0"
