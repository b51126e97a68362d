# SPDX-License-Identifier: MIT
"""Bodies of revolution in contact."""
