# SPDX-License-Identifier: MIT
"""What all studies share: the list of contact types, tables in Markdown, small pictures."""
import argparse
import io
import pathlib
import sys

from PIL import Image

from slideline_tools import UserError
from slideline_tools.contact_types import HARD, IMPLICIT, SERIES, TYPES
from slideline_tools.fields import scalar_field
from slideline_tools.plots import (COLOURS, MARKERS, PAGE_WIDTH, STYLE, colour_bar, draw_field,
                                   panel_height, plt)
from slideline_tools.prose import wrapped
from slideline_tools.studies.framework.pages import with_origin

LARGEST_PICTURE = 100_000
IMPLICIT_LOOKS = {IMPLICIT: ("#e6007e", "X"), HARD: ("#111111", "*")}  # colour and marker


def label(ctype):
    """Text for a contact type (or series), for example '5 NTS-mAR'."""
    return f"{ctype} {SERIES[ctype]}"


def colour(ctype):
    """The colour of a contact type, the same in every picture."""
    return IMPLICIT_LOOKS[ctype][0] if ctype in IMPLICIT_LOOKS else COLOURS[ctype - 1]


def marker(ctype):
    """Its marker, where points of types are told apart by shape too."""
    return IMPLICIT_LOOKS[ctype][1] if ctype in IMPLICIT_LOOKS else MARKERS[ctype - 1]


def markdown_table(names, rows=None):
    """Lines of a Markdown table from a `pandas.DataFrame`, or from names and rows.

    A real number is printed with 4 digits, any other value as it is, a missing one as nothing.
    """
    if rows is None:
        names, rows = list(names.columns), names.itertuples(index=False)
    lines = ["| " + " | ".join(names) + " |", "|" + "---|" * len(names)]
    lines += ["| " + " | ".join(cell(value) for value in row) + " |" for row in rows]
    return "\n".join(lines)


def cell(value):
    """Text of one value: text and integers as they are, other numbers with 4 digits."""
    if value is None or value != value:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def save_small(figure, path, colours=256, lines=False):
    """Write a PNG with a palette of few colours; raises UserError if it is over 100 kB.

    `lines`: a chart of thin lines, whose rare colours must stay true.
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    plt.close(figure)
    buffer.seek(0)
    method = Image.Quantize.MAXCOVERAGE if lines else Image.Quantize.MEDIANCUT
    picture = Image.open(buffer).convert("RGB").quantize(colours, method=method)
    path.parent.mkdir(parents=True, exist_ok=True)
    picture.save(path, optimize=True)
    if path.stat().st_size > LARGEST_PICTURE:
        raise UserError(f"{path}: {path.stat().st_size} bytes, more than {LARGEST_PICTURE}")


def field_panels(results, name, limits, zoom, time=None):
    """A figure with the same field of several runs side by side, on one colour range.

    `results` is a dict of Results by contact type; `limits` = (lowest, highest) colour; `zoom` =
    (x0, x1, y0, y1); the state nearest to `time`, the last without it.
    """
    columns, rows = 2, (len(results) + 1) // 2
    with plt.rc_context({**STYLE, "figure.dpi": 110, "savefig.dpi": 110}):
        height = panel_height(zoom, 0.45 * PAGE_WIDTH)
        figure, panels = plt.subplots(rows, columns, squeeze=False, layout="constrained",
                                      figsize=(PAGE_WIDTH + 1.0, rows * (height + 0.3) + 0.2))
        for axes in panels.flat:
            axes.set_axis_off()
        for axes, (ctype, result) in zip(panels.flat, results.items()):
            state = -1 if time is None else result.state_index(repr(float(time)))
            artist = draw_field(axes, result, scalar_field(result, name), state, 1.0, limits)
            axes.set_xlim(zoom[:2])
            axes.set_ylim(zoom[2:])
            axes.set_title(label(ctype), loc="left")
        colour_bar(artist, list(panels.flat), scalar_field(result, name).label)
        return figure


def study_main(text, write, arguments=None):
    """Command line `FOLDER DOC [--levels ...] [--types ...]` of a study; returns the exit status.

    A scene without refinement levels needs no --levels.
    `write(folder, doc, levels, types)` reads the runs below FOLDER and writes below DOC.
    """
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("doc", type=pathlib.Path)
    parser.add_argument("--levels", type=int, nargs="+", default=[1])
    parser.add_argument("--types", type=int, nargs="+", default=list(TYPES), choices=TYPES,
                        help="contact types (all)")
    options = parser.parse_args(arguments)
    try:
        write(options.folder, options.doc, options.levels, options.types)
    except UserError as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


def page_main(text, write, arguments=None):
    """Command line `FOLDER DOC` of what is measured already; returns the exit status.

    `write(folder, doc)` reads the tables in FOLDER and writes below DOC.
    """
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("doc", type=pathlib.Path)
    options = parser.parse_args(arguments)
    try:
        write(options.folder, options.doc)
    except UserError as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


def decks_and_page_main(text, write_decks, write, arguments=None):
    """Command line of a study that writes its own decks; returns the exit status.

    `decks FOLDER`: write_decks(folder) writes decks and prints their names;
    `page FOLDER DOC [--types ...]`: write(folder, doc, types) reads the runs and writes below DOC.
    """
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("decks").add_argument("folder", type=pathlib.Path)
    page = commands.add_parser("page")
    page.add_argument("folder", type=pathlib.Path)
    page.add_argument("doc", type=pathlib.Path)
    page.add_argument("--types", type=int, nargs="+", default=list(TYPES), choices=TYPES,
                      help="contact types (all)")
    options = parser.parse_args(arguments)
    try:
        if options.command == "decks":
            write_decks(options.folder)
        else:
            write(options.folder, options.doc, options.types)
    except UserError as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


def write_page(doc, name, text):
    """Write DOC/studies/NAME.md, with the source and the processor it was made from below its title."""
    path = doc / "studies" / f"{name}.md"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(wrapped(with_origin(name, text)), encoding="utf-8")
    print(f"wrote {path}")


def by_level(runs, table):
    """One table of runs per refinement level, each under its level."""
    levels = sorted({run.level for run in runs})
    return "\n\n".join(f"N_r = {level}:\n\n" + table([run for run in runs if run.level == level])
                       for level in levels)
