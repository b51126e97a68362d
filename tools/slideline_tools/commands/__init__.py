# SPDX-License-Identifier: MIT
"""Commands of `slideline-tools` that have a module of their own: options, and what they call.

Each has `add(commands)` for argparse; what is slow to import is imported when the command runs.
"""
