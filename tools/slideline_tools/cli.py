# SPDX-License-Identifier: MIT
# PYTHON_ARGCOMPLETE_OK
"""The command `slideline-tools`: info, plot, animate, compare, advise and bless are here, the other
commands in the package `commands`."""
import argparse
import dataclasses
import os
import pathlib
import sys
import tempfile

from slideline_tools import UserError, __version__
from slideline_tools.commands import completion, help_texts
from slideline_tools.commands import draw as draw_command
from slideline_tools.commands import from_mesh as from_mesh_command
from slideline_tools.commands import dyna as dyna_command
from slideline_tools.commands import make_deck as make_deck_command
from slideline_tools.commands import report as report_command
from slideline_tools.files import output

OK, FAILED, UNUSABLE = 0, 1, 2
NO_READER = 141  # what a shell gives for a program that SIGPIPE ends


class ToolError(UserError):
    """A request that cannot be met; the text is for the user."""


def add_info(commands):
    parser = commands.add_parser("info", help="say what a results file holds",
                                 description="Print what a results file holds.")
    parser.add_argument("results", help="<job>.vtkhdf, or the folder of one run")
    parser.set_defaults(run=info)


def info(options):
    from slideline_tools.describe import describe
    from slideline_tools.results import open_run
    print("\n".join(describe(open_run(options.results))))
    return OK


def add_picture_options(parser):
    parser.add_argument("results", help="<job>.vtkhdf, or the folder of one run")
    parser.add_argument("--field", help="for example plastic_strain, mises, velocity:y, stress:xy")
    parser.add_argument("--scale", type=float, default=1.0, help="factor on the displacements")
    parser.add_argument("--zoom", type=float, nargs=4, metavar=("X0", "X1", "Y0", "Y1"),
                        help="window to show")
    parser.add_argument("--mirror", action="store_true",
                        help="with the image in x = 0: axisymmetric and half models as a whole")


def opened(options):
    """The results, with their image if it is asked for."""
    from slideline_tools.mirrored import Mirrored
    from slideline_tools.results import open_run
    results = open_run(options.results)
    return Mirrored(results) if options.mirror else results


def add_plot(commands):
    parser = commands.add_parser(
        "plot", help="draw a field, histories, the contact pressure or zones of stick and slip",
        description="Draw a picture of a results file. Without --field, --state, --history, "
                    "--contact or --zones: a field above the energies and the contact force.")
    add_picture_options(parser)
    parser.add_argument("--state", action="append",
                        help="number (-1 = last, 0 = first) or time; may be repeated")
    parser.add_argument("--history", action="append", metavar="TABLE:COLUMN,...[@NAME=VALUE]",
                        help="for example glstat:kinetic,internal or rcforc:fy@side=slave; "
                             "may be repeated")
    parser.add_argument("--contact", action="store_true",
                        help="contact pressure along the slave surface")
    parser.add_argument("--zones", action="store_true",
                        help="with friction: where the slave surface sticks and slips over time, and its "
                             "traction beside mu p at the states")
    parser.add_argument("--output", "-o", required=True, help="picture (.png, .pdf, .svg)")
    parser.set_defaults(run=plot)


def plot(options):
    import slideline_tools
    slideline_tools.plot(options.results, options.field, *options.state or (), scale=options.scale,
                         zoom=options.zoom, history=options.history or (), contact=options.contact,
                         zones=options.zones, mirror=options.mirror, output=options.output)
    print(f"wrote {options.output}")
    return OK


def add_animate(commands):
    parser = commands.add_parser("animate", help="moving picture of a field (GIF or MP4)",
                                 description="Write a moving picture of all states.")
    add_picture_options(parser)
    parser.add_argument("--rate", type=float, default=12.0, help="pictures a second")
    parser.add_argument("--output", "-o", required=True, help="file ending in .gif or .mp4")
    parser.set_defaults(run=animate)


def animate(options):
    from slideline_tools import animation
    results = opened(options)
    count = animation.animate(results, output(options.output, [results.path]), options.field,
                              options.scale, options.rate, options.zoom)
    print(f"wrote {options.output} ({count} states)")
    return OK


def add_compare(commands):
    parser = commands.add_parser(
        "compare", help="compare a history with a reference",
        description="Compare a CSV history with a reference, per column and entity, on the times "
                    "of the reference, with peak, time of peak, impulse and final value.",
        epilog="Exit status: 0 agreed, 1 a column failed, 2 the tables cannot be compared.")
    parser.add_argument("result")
    parser.add_argument("reference")
    parser.add_argument("--columns", help="comma list (default: all of the reference)")
    parser.add_argument("--rtol", type=float, default=1.0e-3, help="relative tolerance (1e-3)")
    parser.add_argument("--floor", type=float, default=1.0e-3,
                        help="absolute tolerance over the column's maximum (1e-3)")
    parser.add_argument("--atol", type=float, help="absolute tolerance instead of --floor")
    parser.add_argument("--time", type=float, default=1.0e-2,
                        help="tolerance of the time of the peak over the time span (1e-2)")
    parser.add_argument("--column-rtol", action="append", default=[], metavar="COLUMN=RTOL",
                        help="relative tolerance of one column; may be repeated")
    parser.add_argument("--measures", help="comma list of: values, peak, time of peak, impulse, "
                                           "final (default: all); start and end, the first and "
                                           "last time, are always judged")
    parser.set_defaults(run=run_compare)


def run_compare(options):
    from slideline_tools import compare
    from slideline_tools.histories import read_csv
    result, reference = read_csv(options.result), read_csv(options.reference)
    measures = tuple(options.measures.split(",")) if options.measures else compare.MEASURES
    for name in measures:
        if name not in compare.MEASURES:
            raise ToolError(f"unknown measure '{name}'; there are {', '.join(compare.MEASURES)}")
    default = compare.Tolerance(options.rtol, options.floor, options.atol, options.time, measures)
    special = {}
    for entry in options.column_rtol:
        name, _, value = entry.partition("=")
        try:
            special[name] = dataclasses.replace(default, rtol=float(value))
        except ValueError:
            raise ToolError(f"'{entry}': expected COLUMN=RTOL") from None
    columns = options.columns.split(",") if options.columns else reference.value_columns
    compare.judged_columns(reference, [*columns, *special])
    report = compare.compare(result, reference, columns, special, default)
    report.name = f"{options.result} against {options.reference}"
    print(report.text())
    return OK if report.passed else FAILED


def add_advise(commands):
    parser = commands.add_parser(
        "advise", help="say what in the model of a finished run was not needed",
        description="Read a finished run and say what in its model was not needed, with the "
                    "figures that show it, the expected saving and what to change in the deck.")
    parser.add_argument("result", metavar="RUN", help="results folder, or a file of the run")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--all", action="store_true",
                        help="also what saves less than 1 %% of the run")
    parser.set_defaults(run=run_advise)


def run_advise(options):
    from slideline_tools import advise
    from slideline_tools.advise import report
    run, advice, notes = advise.advise(options.result)
    shown = report.select(advice, run.total, options.all)
    print(report.as_json(run, shown, notes) if options.json
          else report.as_text(run, shown, notes, len(advice) - len(shown)))
    return OK


def add_bless(commands):
    parser = commands.add_parser(
        "bless", help="renew the reference of a regression case",
        description="Run a regression case and make its histories the reference.")
    parser.add_argument("case", help="folder name below tests/regression")
    parser.add_argument("--reason", required=True, help="why the reference changes; kept in "
                                                        "case.toml")
    parser.add_argument("--program", help="default: $SLIDELINE or build/release/slideline")
    parser.add_argument("--root", help="the repository (default: found from here)")
    parser.set_defaults(run=bless)


def bless(options):
    from slideline_tools import regression
    if not options.reason.strip():
        raise ToolError("the reason must say something")
    root = regression.repository_root(options.root)
    program = options.program or os.environ.get("SLIDELINE") or root / "build/release/slideline"
    case = regression.Case(root / "tests/regression" / options.case, root)
    with tempfile.TemporaryDirectory() as work:
        case.run(program, work)
        case.bless(work, options.reason.strip(), regression.program_version(program))
    print(f"renewed the reference of {options.case}")
    return OK


def build_parser():
    parser = argparse.ArgumentParser(
        prog="slideline-tools",
        description="Look into, draw and compare results of slideline, draw models before their run, "
                    "and write scene decks.")
    parser.add_argument("--version", action="version", version=f"slideline-tools {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for add in (add_info, add_plot, add_animate, add_compare, add_advise, report_command.add,
                draw_command.add, dyna_command.add_binout, dyna_command.add_d3plot,
                make_deck_command.add, from_mesh_command.add, add_bless, completion.add):
        add(commands)
    help_texts.add_examples(parser, commands)
    return parser


def one_line(problem):
    """The text of an exception in one line."""
    return " ".join(str(problem).split())


def main(arguments=None):
    """Entry point: returns 0 when done, 1 when a comparison failed, 2 when it could not be done,
    141 when whoever reads the output went away."""
    parser = build_parser()
    completion.offer(parser)
    options = parser.parse_args(arguments)
    try:
        status = options.run(options)
        sys.stdout.flush()
        return status
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is left to flush
        return NO_READER
    except (UserError, OSError) as problem:
        print(f"slideline-tools: {one_line(problem)}", file=sys.stderr)
        return UNUSABLE
    except Exception as problem:
        # A damaged file that no reader has noticed must not end in a traceback, nor hide where it came from.
        if os.environ.get("SLIDELINE_TRACEBACK"):
            raise
        print(f"slideline-tools: {type(problem).__name__}: {one_line(problem)} (a damaged file, or a fault of the tools: "
              "SLIDELINE_TRACEBACK=1 shows where)", file=sys.stderr)
        return UNUSABLE


if __name__ == "__main__":
    sys.exit(main())
