# SPDX-License-Identifier: MIT
"""Tools around the program `slideline`: read results, draw, compare, write decks."""

__version__ = "0.1.0"


class UserError(Exception):
    """A request that cannot be met; the text is for the user."""
