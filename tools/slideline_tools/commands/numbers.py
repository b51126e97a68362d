# SPDX-License-Identifier: MIT
"""The commands that judge a run or write it for others: compare, advise, binout, d3plot."""
import dataclasses

from slideline_tools import UserError
from slideline_tools.commands import ANY_FILE, RUN, add, output_to

RUN_PATH = ("run_path", {"metavar": "RUN", "help": ANY_FILE})


def add_all(commands) -> None:
    """Add these commands."""
    add(commands, compare, "compare", "compare a history with a reference", """\
compare new/x.rcforc.csv old/x.rcforc.csv --rtol 0.01
compare new/x.glstat.csv old/x.glstat.csv --columns kinetic,internal \\
      --column-rtol internal=0.02 --measures peak,final

Exit status: 0 agreed, 1 a column failed, 2 the tables cannot be compared.""",
        ("result", {}), ("reference", {}),
        ("--columns", {"help": "comma list (default: all of the reference)"}),
        ("--rtol", {"type": float, "default": 1.0e-3, "help": "relative tolerance (1e-3)"}),
        ("--floor", {"type": float, "default": 1.0e-3,
                     "help": "absolute tolerance over the largest value of the column, or of all components of its vector (1e-3)"}),
        ("--atol", {"type": float, "help": "absolute tolerance instead of --floor"}),
        ("--time", {"type": float, "default": 1.0e-2,
                    "help": "tolerance of the time of the peak over the time span (1e-2)"}),
        ("--column-rtol", {"action": "append", "default": [], "metavar": "COLUMN=RTOL",
                           "help": "relative tolerance of one column; may be repeated"}),
        ("--measures", {"help": "comma list of: values, peak, time of peak, impulse, final "
                                "(default: all); start and end, the first and last time, are "
                                "always judged"}))
    add(commands, advise, "advise", "say what in the model of a finished run was not needed",
        f"advise {RUN}\nadvise {RUN} --all --json", RUN_PATH,
        ("--json", {"action": "store_true", "help": "print JSON"}),
        ("--all", {"action": "store_true", "help": "also what saves less than 1 %% of the run"}))
    add(commands, binout, "binout", "write DYNA's binout from the histories of a run", f"""\
binout {RUN}
binout {RUN} -o binout0000

With lasso-python: Binout("binout0000").as_df("rcforc", "y_force").""",
        RUN_PATH, output_to("file to write (default: <job>.binout0000 beside the results)"))
    add(commands, d3plot, "d3plot", "write the d3plot family from the states of a run", f"""\
d3plot {RUN}           # collision.d3plot, collision.d3plot01, ...
d3plot {RUN} -o d3plot""",
        RUN_PATH, output_to("first file of the family (default: <job>.d3plot beside the results)"))


def compare(options) -> int:
    """Compare a CSV history with a reference, per column and entity, on the times of the reference, with peak, time of peak,
    impulse and final value."""
    from slideline_tools import compare as judge
    from slideline_tools.histories import read_csv
    result, reference = read_csv(options.result), read_csv(options.reference)
    measures = tuple(options.measures.split(",")) if options.measures else judge.MEASURES
    if unknown := [name for name in measures if name not in judge.MEASURES]:
        raise UserError(f"unknown measure '{unknown[0]}'; there are {', '.join(judge.MEASURES)}")
    default = judge.Tolerance(options.rtol, options.floor, options.atol, options.time, measures)
    special = {}
    for entry in options.column_rtol:
        name, _, value = entry.partition("=")
        try:
            special[name] = dataclasses.replace(default, rtol=float(value))
        except ValueError:
            raise UserError(f"'{entry}': expected COLUMN=RTOL") from None
    columns = options.columns.split(",") if options.columns else reference.value_columns
    judge.judged_columns(reference, [*columns, *special])
    report = judge.compare(result, reference, columns, special, default)
    report.name = f"{options.result} against {options.reference}"
    print(report.text())
    return 0 if report.passed else 1


def advise(options) -> int:
    """Read a finished run and say what in its model was not needed, with the figures that show it, the expected saving and
    what to change in the deck."""
    from slideline_tools import advise as adviser
    from slideline_tools.advise import report
    run, advice, notes = adviser.advise(options.run_path)
    shown = report.select(advice, run.total, options.all)
    print(report.as_json(run, shown, notes) if options.json
          else report.as_text(run, shown, notes, len(advice) - len(shown)))
    return 0


def binout(options) -> int:
    """Write all history tables of a run (glstat, rcforc, nodout, matsum, sleout, spcforc, rwforc, elout, rbdout, bndout,
    nodfor, secforc) to one binout in DYNA's LSDA format. A killed run is taken as far as it got."""
    from slideline_tools.binout import write_binout
    from slideline_tools.finished_run import Run
    run = Run(options.run_path)
    path = options.output or f"{run.prefix}.binout0000"
    print(f"wrote {path} ({', '.join(write_binout(run, path))})")
    return 0


def d3plot(options) -> int:
    """Write the states of a run as a d3plot family (single precision) for LS-PrePost, lasso-python and VTK's LS-DYNA reader."""
    from slideline_tools.d3plot import write_d3plot
    from slideline_tools.finished_run import Run
    run = Run(options.run_path)
    path = options.output or f"{run.prefix}.d3plot"
    print(f"wrote {path} ({write_d3plot(run, path)} states)")
    return 0
