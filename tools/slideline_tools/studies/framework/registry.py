# SPDX-License-Identifier: MIT
"""The studies by name: one line each."""
import importlib

from slideline_tools import UserError

STUDIES = {  # name on the command line: module of slideline_tools.studies
    "paper-tables": "paper_tables",
    "stability": "stability.study",
    "speed-accuracy": "speed_accuracy.study",
    "simplify": "simplify.study",
}


def load(name):
    """The `Study` of that name."""
    if name not in STUDIES:
        raise UserError(f"unknown study '{name}'; there are {', '.join(STUDIES)}")
    return importlib.import_module(f"slideline_tools.studies.{STUDIES[name]}").STUDY
