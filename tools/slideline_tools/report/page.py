# SPDX-License-Identifier: MIT
"""What a page is made of, as data for `report.html.j2`: sections of blocks (kind, content).

A block is ("heading", words), ("text", words), ("note", words), ("warning", words),
("table", Table), ("grid", [Picture, ...]) or ("folded", (title, text)).
"""
import base64
import io
import re
import typing

import jinja2
import matplotlib.pyplot as plt

#: what `figures` writes, or nothing
NUMBER = re.compile(r"[-+.\d e]*|–|-?inf|nan")
NO_DATE = {"Date": None, "Creator": None, "Format": None, "Type": None}

Block = tuple[str, typing.Any]


class Section(typing.NamedTuple):
    """A section with the name that links lead to."""

    anchor: str
    title: str
    blocks: list[Block]


class Table(typing.NamedTuple):
    """A table of plain cells."""

    head: list
    rows: list[list]

    @property
    def numeric(self) -> list[int]:
        """The columns of numbers, which are set to the right."""
        return [k for k, column in enumerate(zip(*self.rows)) if all(NUMBER.fullmatch(str(cell)) for cell in column)]


class Picture(typing.NamedTuple):
    """An inline picture with its words; `width` and `height` in pixels."""

    source: str
    words: str
    width: int
    height: int


def picture(figure, words: str, kind: str = "svg") -> Picture:
    """A figure of matplotlib, which is closed: `svg` for lines, `png` for fields."""
    stream = io.BytesIO()
    width, height = figure.get_size_inches()
    figure.savefig(stream, format=kind, dpi=170, metadata=NO_DATE if kind == "svg" else {})
    plt.close(figure)
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    return Picture(f"data:image/{'svg+xml' if kind == 'svg' else 'png'};base64,{data}", words,
                   round(96 * width), round(96 * height))


def figures(value, digits: int = 5) -> str:
    """A number as a reader wants it; a dash for None."""
    if value is None:
        return "–"
    if isinstance(value, int):
        return f"{value:,d}".replace(",", " ")
    return f"{float(value):.{digits}g}"


def page(**content) -> str:
    """The page; what it shows is escaped."""
    loader = jinja2.PackageLoader("slideline_tools.report", "")
    pages = jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined)
    return pages.get_template("report.html.j2").render(content)
