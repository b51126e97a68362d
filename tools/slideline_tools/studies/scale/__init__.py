# SPDX-License-Identifier: MIT
"""What processes exchange: counted runs, and independent tiles to compare them with."""
