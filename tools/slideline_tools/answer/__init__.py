# SPDX-License-Identifier: MIT
"""The answer with its error: a deck on its mesh divided, quantities, their uncertainty, and the loop that goes on until
they are known well enough."""
