# SPDX-License-Identifier: MIT
"""What all studies share: names and colours of the contact types, tables in Markdown, small pictures, pages."""
import functools
import importlib.util
import io
import pathlib
import sys

from PIL import Image

from slideline_tools import UserError
from slideline_tools.contact_types import HARD, IMPLICIT, SERIES, TYPES
from slideline_tools.plots import COLOURS, MARKERS, plt
from slideline_tools.studies.framework.pages import with_origin

LARGEST_PICTURE = 100_000
VERIFICATION = pathlib.Path(__file__).resolve().parents[3] / "tests" / "verification"
#: Colour and marker of each type and series, the same in every picture.
LOOKS: dict[object, tuple[str, str]] = {
    **{ctype: (COLOURS[ctype - 1], MARKERS[ctype - 1]) for ctype in TYPES}, IMPLICIT: ("#e6007e", "X"), HARD: ("#111111", "*")}


def label(ctype):
    """Text for a contact type (or series), for example '5 NTS-mAR'."""
    return f"{ctype} {SERIES[ctype]}"


def colour(ctype):
    """The colour of a contact type."""
    return LOOKS[ctype][0]


def marker(ctype):
    """Its marker, where points of types are distinguished by shape too."""
    return LOOKS[ctype][1]


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


def page_of(*blocks):
    """The text of a page of headings, texts and tables."""
    return "\n\n".join(block for block in blocks if block).rstrip("\n") + "\n"


def write_page(doc, name, text, *origin):
    """Write DOC/studies/NAME.md; the source and the processor it was made from (see `with_origin`) stand below its title."""
    path = doc / "studies" / f"{name}.md"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(with_origin(name, text, *origin), encoding="utf-8")
    print(f"wrote {path}")


@functools.lru_cache(maxsize=None)
def verification(case, name="check"):
    """A module of a verification case, for the decks and solutions that studies share with it."""
    before = list(sys.path)
    sys.path[:0] = [str(VERIFICATION / case), str(VERIFICATION)]
    try:
        spec = importlib.util.spec_from_file_location(f"{case}_{name}", VERIFICATION / case / f"{name}.py")
        module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module
    except OSError as problem:
        raise UserError(f"cannot read {VERIFICATION / case}: {problem}") from problem
    finally:
        sys.path[:] = before
