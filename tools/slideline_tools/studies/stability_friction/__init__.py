# SPDX-License-Identifier: MIT
"""How fast steady sliding flutters, and what damps it."""
