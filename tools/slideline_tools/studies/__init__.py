# SPDX-License-Identifier: MIT
"""Studies: runs of one scene with all contact types, put into tables and pictures of `doc/`."""
