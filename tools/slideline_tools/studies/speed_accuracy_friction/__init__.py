# SPDX-License-Identifier: MIT
"""Cost against error with friction: partial slip and ironing."""
