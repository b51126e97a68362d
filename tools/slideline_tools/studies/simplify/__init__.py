# SPDX-License-Identifier: MIT
"""What each simplification of a model saves, and what it costs in accuracy."""
