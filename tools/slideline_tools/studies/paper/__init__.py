# SPDX-License-Identifier: MIT
"""The scenes of Kang, Lee & Shin (2023): figures, Tables 1 and 2, claims."""
