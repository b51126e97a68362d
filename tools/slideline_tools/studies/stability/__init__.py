# SPDX-License-Identifier: MIT
"""Where each contact type is stable: maps over penalty and step."""
