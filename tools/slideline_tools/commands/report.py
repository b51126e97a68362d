# SPDX-License-Identifier: MIT
"""The command `slideline-tools report`."""
from __future__ import annotations


def add(commands) -> None:
    """Add the command and its options."""
    parser = commands.add_parser(
        "report", help="write an HTML report of a run",
        description="Write one HTML file about a run: how it ended, energies and their balance, force "
                    "and pressure of each interface, rigid walls, fields, warnings, parts, timing. It needs no "
                    "network and no other file. Killed and running runs are reported as far as "
                    "they got.")
    parser.add_argument("run_path", metavar="RUN", help="results folder, or a file of the run")
    parser.add_argument("--output", "-o", metavar="FILE",
                        help="HTML file to write (default: <job>.report.html beside the results)")
    parser.add_argument("--field", action="append", default=[],
                        help="field to show, for example mises, stress:xy, velocity:y; may be repeated "
                             "(default: plastic strain if any, and mises)")
    parser.add_argument("--state", action="append", default=[],
                        help="state to show: number (-1 = last, 0 = first) or time; may be repeated "
                             "(default: at the largest contact force, and the last)")
    parser.add_argument("--scale", type=float, default=1.0,
                        help="factor on the displacements in the pictures (1)")
    parser.add_argument("--program", help="program that reads the deck as run (default: $SLIDELINE or "
                                          "build/release/slideline)")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Write the report."""
    from slideline_tools.report import write_report
    path = write_report(options.run_path, options.output, options.field, options.state,
                        options.scale, options.program)
    print(f"wrote {path} ({path.stat().st_size / 1e6:.1f} MB)")
    return 0
