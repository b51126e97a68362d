# SPDX-License-Identifier: MIT
"""Cost against error of every type and mesh in five scenes."""
