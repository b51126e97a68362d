# SPDX-License-Identifier: MIT
"""Pieces of HTML: escaped text, tables, sections, pictures, and the style of the page."""
from __future__ import annotations

import base64
import dataclasses
import html
import io

import matplotlib.pyplot as plt

STYLE = """
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { font: 16px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; color: #1c2530;
  background: #fff; margin: 0 auto; padding: 1rem; max-width: 62rem; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: .2rem 0 .4rem; }
h2 { font-size: 1.2rem; margin: 2.2rem 0 .6rem; padding-top: .6rem; border-top: 2px solid #0b559f; }
h3 { font-size: 1rem; margin: 1.2rem 0 .3rem; }
p { margin: .5rem 0; overflow-wrap: anywhere; }
a { color: #0b559f; }
nav { margin: .8rem 0; }
nav a { display: inline-block; padding: .35rem .7rem; margin: 0 .25rem .35rem 0;
  background: #eef3f9; border-radius: .3rem; text-decoration: none; }
.state { display: inline-block; padding: .1rem .6rem; border-radius: 1rem; font-weight: 600; }
.normal { background: #dff1e1; color: #17521c; }
.error { background: #fbe0db; color: #8a1f0d; }
.unfinished { background: #fdf0cf; color: #6b4a00; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(9.5rem, 1fr)); gap: .6rem;
  margin: 1rem 0; }
.tile { border: 1px solid #d5dce5; border-radius: .4rem; padding: .5rem .7rem; }
.tile b { display: block; font-size: 1.15rem; overflow-wrap: anywhere; }
.tile span { font-size: .85rem; color: #55606d; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: .5rem 0; font-size: .92rem;
  font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .25rem .7rem .25rem 0;
  border-bottom: 1px solid #e3e8ee; }
td.n, th.n { text-align: right; white-space: nowrap; }
figure { margin: .8rem 0; }
figure img { width: 100%; height: auto; display: block; }
figcaption { font-size: .9rem; color: #55606d; }
.grid { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 27rem), 1fr));
  gap: .4rem 1.2rem; }
.warning { border-left: .3rem solid #d99a00; background: #fdf7e6; padding: .4rem .8rem;
  margin: .5rem 0; overflow-wrap: anywhere; }
.note { color: #55606d; font-size: .92rem; }
pre { font-size: .78rem; line-height: 1.35; background: #f6f8fa; padding: .7rem; overflow-x: auto; }
summary { cursor: pointer; padding: .3rem 0; }
footer { margin-top: 2.5rem; border-top: 1px solid #d5dce5; padding-top: .5rem; }
@media print {
  body { max-width: none; padding: 0; font-size: 10pt; }
  nav, .up, details:not([open]) { display: none; }
  h2, h3 { break-after: avoid; }
  figure img { max-height: 20cm; object-fit: contain; }
  figure, table, .tiles, .warning { break-inside: avoid; }
  .wide { overflow: visible; }
  pre { white-space: pre-wrap; }
}
"""


MOST_COLUMNS = 9   # of a table, on a page


@dataclasses.dataclass
class Section:
    """A section with the name that links lead to; `body` is HTML."""

    anchor: str
    title: str
    body: str


def text(value) -> str:
    """Any value as escaped text."""
    return html.escape(str(value), quote=True)


def figures(value, digits: int = 5) -> str:
    """A number as a reader wants it; a dash for None."""
    if value is None:
        return "–"
    return f"{value:,d}".replace(",", " ") if isinstance(value, int) else f"{value:.{digits}g}"


def paragraph(words: str, kind: str = "") -> str:
    """A paragraph of plain words."""
    return f'<p{f" class={chr(34)}{kind}{chr(34)}" if kind else ""}>{text(words)}</p>\n'


def table(head: list[str], rows: list[list], numeric: set[int] = frozenset()) -> str:
    """A table; columns in `numeric` are set to the right. Cells are plain text.

    One with more columns than fit a page is cut into several below each other, each with the first column.
    """
    if len(head) > MOST_COLUMNS:
        parts = -(-(len(head) - 1) // (MOST_COLUMNS - 1))
        size = -(-(len(head) - 1) // parts)
        return "".join(
            table([head[0], *head[start:start + size]], [[row[0], *row[start:start + size]] for row in rows],
                  {0} & numeric | {1 + column - start for column in numeric if start <= column < start + size})
            for start in range(1, len(head), size))

    def cell(tag: str, column: int, value) -> str:
        kind = ' class="n"' if column in numeric else ""
        return f"<{tag}{kind}>{text(value)}</{tag}>"

    lines = ["<tr>" + "".join(cell("th", k, name) for k, name in enumerate(head)) + "</tr>"] \
        if head else []
    lines += ["<tr>" + "".join(cell("td", k, value) for k, value in enumerate(row)) + "</tr>"
              for row in rows]
    return '<div class="wide"><table>\n' + "\n".join(lines) + "\n</table></div>\n"


def tiles(pairs: list[tuple[str, str]]) -> str:
    """Large figures with small words below."""
    return '<div class="tiles">\n' + "".join(
        f'<div class="tile"><b>{text(value)}</b><span>{text(name)}</span></div>\n'
        for name, value in pairs) + "</div>\n"


def picture(figure, words: str, kind: str = "svg") -> str:
    """A figure of matplotlib as an inline picture with its words; closes the figure.

    `svg` for lines, `png` for fields with many elements.
    """
    stream = io.BytesIO()
    width, height = figure.get_size_inches()
    metadata = {"Date": None, "Creator": None, "Format": None, "Type": None} if kind == "svg" else {}
    figure.savefig(stream, format=kind, dpi=170, metadata=metadata)
    plt.close(figure)
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    mime = "image/svg+xml" if kind == "svg" else "image/png"
    return (f'<figure><img src="data:{mime};base64,{data}" alt="{text(words)}" '
            f'width="{round(96 * width)}" height="{round(96 * height)}">'
            f"<figcaption>{text(words)}</figcaption></figure>\n")


def folded(title: str, body: str) -> str:
    """A body that opens on demand."""
    return f"<details><summary>{text(title)}</summary>\n{body}</details>\n"


def page(title: str, head: str, sections: list[Section], foot: str) -> str:
    """The whole page."""
    links = "".join(f'<a href="#{item.anchor}">{text(item.title)}</a>\n' for item in sections)
    bodies = "".join(
        f'<section id="{item.anchor}">\n<h2>{text(item.title)}</h2>\n{item.body}'
        '<p class="up"><a href="#top">to the top</a></p>\n</section>\n' for item in sections)
    return ('<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>{text(title)}</title>\n<style>{STYLE}</style>\n</head>\n"
            f'<body id="top">\n<header>\n{head}</header>\n<nav>\n{links}</nav>\n'
            f"<main>\n{bodies}</main>\n<footer>{foot}</footer>\n</body>\n</html>\n")
