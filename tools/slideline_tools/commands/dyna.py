# SPDX-License-Identifier: MIT
"""The commands `slideline-tools binout` and `slideline-tools d3plot`."""
from __future__ import annotations


def add_binout(commands) -> None:
    """Add the command `binout` and its options."""
    parser = commands.add_parser(
        "binout", help="write DYNA's binout from the histories of a run",
        description="Write all history tables of a run (glstat, rcforc, nodout, matsum, sleout, "
                    "spcforc, rwforc, elout, rbdout, bndout, nodfor, secforc) to one binout in DYNA's LSDA format. A killed run is "
                    "taken as far as it got.")
    parser.add_argument("run_path", metavar="RUN", help="results folder, or a file of the run")
    parser.add_argument("--output", "-o", metavar="FILE",
                        help="file to write (default: <job>.binout0000 beside the results)")
    parser.set_defaults(run=run_binout)


def add_d3plot(commands) -> None:
    """Add the command `d3plot` and its options."""
    parser = commands.add_parser(
        "d3plot", help="write the d3plot family from the states of a run",
        description="Write the states of a run as a d3plot family (single precision) for LS-PrePost, "
                    "lasso-python and VTK's LS-DYNA reader.")
    parser.add_argument("run_path", metavar="RUN", help="results folder, or a file of the run")
    parser.add_argument("--output", "-o", metavar="FILE",
                        help="first file of the family (default: <job>.d3plot beside the results)")
    parser.set_defaults(run=run_d3plot)


def run_binout(options) -> int:
    """Write the binout."""
    from slideline_tools.binout import write_binout
    from slideline_tools.finished_run import Run
    run = Run(options.run_path)
    path = options.output or f"{run.prefix}.binout0000"
    names = write_binout(run, path)
    print(f"wrote {path} ({', '.join(names)})")
    return 0


def run_d3plot(options) -> int:
    """Write the d3plot family."""
    from slideline_tools.d3plot import write_d3plot
    from slideline_tools.finished_run import Run
    run = Run(options.run_path)
    path = options.output or f"{run.prefix}.d3plot"
    count = write_d3plot(run, path)
    print(f"wrote {path} ({count} states)")
    return 0
