# SPDX-License-Identifier: MIT
"""The commands of `slideline-tools`. Each imports what it needs when it runs, so that help and
completion are quick."""
import argparse
import textwrap
import typing

RUN = "results/collision"
FILE = f"{RUN}/collision.vtkhdf"
#: what may name a run
ANY_FILE = "results folder, or a file of the run"
PROGRAM = ("--program", {"help": "program that reads the deck (default: $SLIDELINE or "
                                 "build/release/slideline)"})
ZOOM = ("--zoom", {"type": float, "nargs": 4, "metavar": ("X0", "X1", "Y0", "Y1"),
                   "help": "window to show"})

Argument = tuple[typing.Any, ...]


class Formatter(argparse.HelpFormatter):
    """Fills paragraphs, keeps lines that begin with two blanks."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        blocks = textwrap.dedent(text).strip("\n").split("\n\n")
        return "\n\n".join(block if block.startswith("  ") else
                           textwrap.fill(" ".join(block.split()), width, initial_indent=indent,
                                         subsequent_indent=indent) for block in blocks)


def add(commands, run, name: str, summary: str, examples: str, *arguments: Argument) -> argparse.ArgumentParser:
    """Add a command: `run` does it, gives its exit status and has its description; an argument is its names and, last,
    what argparse is to know of it; `examples` are lines without `slideline-tools` and notes behind
    a blank line."""
    lines, _, notes = examples.partition("\n\n")
    lines = "\n".join(f"  slideline-tools {line}" if not line.startswith(" ") else f"  {line}"
                      for line in lines.splitlines())
    head = "Examples" if lines.count("slideline-tools") > 1 else "Example"
    parser = commands.add_parser(name, help=summary, description=run.__doc__,
                                 formatter_class=Formatter, epilog=f"{head}:\n\n{lines}\n\n{notes}")
    for *names, words in arguments:
        parser.add_argument(*names, **words)
    parser.set_defaults(run=run, parser=parser)
    return parser


def output_to(what: str, **more) -> Argument:
    """The option for the file that a command writes."""
    return "--output", "-o", {"metavar": "FILE", "help": what, **more}
