# SPDX-License-Identifier: MIT
"""Our claims about friction: which types transmit a shear exactly."""
