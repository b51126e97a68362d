# SPDX-License-Identifier: MIT
"""The command `slideline-tools`: its parser, completion by shtab, and exit statuses."""
import argparse
import os
import sys

from slideline_tools import UserError, __version__
from slideline_tools.commands import Formatter, RUN, FILE, add, answers, decks, numbers, pictures

DONE, UNUSABLE = 0, 2
NO_READER = 141  # what a shell gives for a program that SIGPIPE ends
SHELLS = ("bash", "zsh", "tcsh")
EPILOG = f"""Examples:

  slideline-tools draw deck.k -o model.png          # before the run: is this what I meant?
  slideline-tools report {RUN}           # after it: everything in one HTML file
  slideline-tools plot {FILE} -o x.png
  slideline-tools answer deck.k --of glstat:internal:end --within 2%    # a number with its error
  slideline-tools advise {RUN}           # what the run could have done without

A RUN is the folder of its results, or any file in it. Every COMMAND explains its options with
--help. Exit status: 0 done, 1 a comparison failed, 2 it could not be done."""
#: options that take files; "" are words without an option
FILES = ("", "--output", "--program")


def build_parser():
    """The parser of all commands."""
    parser = argparse.ArgumentParser(
        prog="slideline-tools", formatter_class=Formatter, epilog=EPILOG,
        description="Look into, draw and compare results of slideline, draw models before their "
                    "run, and write scene decks.")
    parser.add_argument("--version", action="version", version=f"slideline-tools {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for group in (answers, pictures, numbers, decks):
        group.add_all(commands)
    add(commands, completion, "completion", "script that completes words in the shell", """\
completion bash > ~/.local/share/bash-completion/completions/slideline-tools
completion zsh > ~/.zsh/_slideline-tools    # a folder of $fpath""",
        ("shell", {"choices": SHELLS}))
    return parser


def parsers(parser):
    """A parser and those of all its commands."""
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for one in action.choices.values():
                yield from parsers(one)


def completion(options):
    """Print a script that completes the commands, options and choices of slideline-tools."""
    import shtab
    from slideline_tools.fields import LABELS
    # Words that are offered for options which take others too.
    offered = {"--field": LABELS, "--show": pictures.WHAT, "--measures": ("values", "peak", "impulse", "final")}
    whole = build_parser()
    for action in (action for one in parsers(whole) for action in one._actions):
        name = (action.option_strings or [""])[0]
        if name in offered:
            action.choices = tuple(offered[name])
        elif name in FILES and action.choices is None:
            action.complete = shtab.FILE
    print(shtab.complete(whole, options.shell))
    return DONE


def one_line(problem):
    """The text of an exception in one line; of a file its name and what is wrong with it."""
    if isinstance(problem, OSError) and problem.filename is not None and problem.strerror:
        return f"{problem.filename}: {problem.strerror}"
    return " ".join(str(problem).split())


def main(arguments=None):
    """Entry point: returns 0 when done, 1 when a comparison failed, 2 when it could not be done,
    141 when whoever reads the output went away."""
    options, unknown = build_parser().parse_known_args(arguments)
    if unknown:  # by the command, whose usage and exit status it is
        options.parser.error(f"unrecognized arguments: {' '.join(unknown)}")
    try:
        status = options.run(options)
        sys.stdout.flush()
        return status
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is left to flush
        return NO_READER
    except (UserError, OSError) as problem:
        text = str(problem) if getattr(problem, "has_lines", False) else one_line(problem)
        print(f"slideline-tools: {text}", file=sys.stderr)
        return UNUSABLE
    except Exception as problem:
        # A damaged file that no reader has noticed must not end in a traceback, nor hide where it
        # came from.
        if os.environ.get("SLIDELINE_TRACEBACK"):
            raise
        print(f"slideline-tools: {type(problem).__name__}: {one_line(problem)} (a damaged file, or "
              "a fault of the tools: SLIDELINE_TRACEBACK=1 shows where)", file=sys.stderr)
        return UNUSABLE


if __name__ == "__main__":
    sys.exit(main())
