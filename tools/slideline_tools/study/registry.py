# SPDX-License-Identifier: MIT
"""The studies by name: one line each."""
import importlib

from slideline_tools import UserError

STUDIES = {  # name on the command line: file of this package
    "claims-friction": "claims_friction",
    "paper-tables": "paper_tables",
    "round-contact": "round_contact",
    "stability": "stability",
    "stability-friction": "stability_friction",
    "stability-shapes": "stability_shapes",
    "speed-accuracy": "speed_accuracy",
    "speed-accuracy-friction": "speed_accuracy_friction",
    "simplify": "simplify",
}


def load(name):
    """The `Study` of that name."""
    if name not in STUDIES:
        raise UserError(f"unknown study '{name}'; there are {', '.join(STUDIES)}")
    return importlib.import_module(f"slideline_tools.study.{STUDIES[name]}").STUDY
