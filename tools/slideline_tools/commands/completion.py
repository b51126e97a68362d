# SPDX-License-Identifier: MIT
"""The command `slideline-tools completion`: a script for the shell, made from the parser; and completion by argcomplete."""
from __future__ import annotations

import argparse
import os

SHELLS = ("bash", "zsh")
HEAD = """# Completion of slideline-tools for {shell}; made by: slideline-tools completion {shell}
{start}_slideline_tools() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} said= words= k
  for ((k = 1; k < COMP_CWORD; k++)); do
    case "$said ${{COMP_WORDS[k]}}" in
"""
MIDDLE = """    esac
  done
  COMPREPLY=()
  case "$said $prev" in
"""
OPTIONS = """    *) case "$said" in
"""
# Nothing to offer lets the shell offer files.
FOOT = """       esac
       [[ $cur == -* ]] || words=${words%%--*} ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$cur"))
}
complete -o default -F _slideline_tools slideline-tools
"""


def add(commands) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "completion", help="script that completes commands and options in the shell",
        description="Print a script for bash or zsh that completes the commands, options and choices "
                    "of slideline-tools.")
    parser.add_argument("shell", choices=SHELLS)
    parser.set_defaults(run=run)


def run(options) -> int:
    """Print the script."""
    from slideline_tools.cli import build_parser
    print(script(build_parser(), options.shell), end="")
    return 0


def offer(parser: argparse.ArgumentParser) -> None:
    """Answer argcomplete, where the shell asks by it and it is installed, and end; else nothing."""
    if "_ARGCOMPLETE" not in os.environ:
        return
    import argcomplete
    for _, one in walk(parser, ""):
        for action in one._actions:
            if action.option_strings and action.choices is None and (words := values(action)):
                setattr(action, "completer", argcomplete.ChoicesCompleter(words))
    argcomplete.autocomplete(parser)


def script(parser: argparse.ArgumentParser, shell: str) -> str:
    """The script for a parser and all its commands."""
    start = "autoload -U +X bashcompinit && bashcompinit\n" if shell == "zsh" else ""
    levels = list(walk(parser, ""))
    text = HEAD.format(shell=shell, start=start)
    text += "".join(f'      "{path} {name}") said="{path} {name}" ;;\n' for path, one in levels
                    for name in subcommands(one))
    text += MIDDLE
    for path, one in levels:
        by_words: dict[str, list[str]] = {}
        for action in one._actions:
            if action.option_strings and action.nargs != 0:
                by_words.setdefault(" ".join(values(action)), []).extend(action.option_strings)
        for words, names in by_words.items():
            patterns = "|".join(f'"{path} {name}"' for name in names)
            text += f'    {patterns}) words="{words}" ;;\n'
    text += OPTIONS
    for path, one in levels:
        offered = list(subcommands(one)) or [value for action in one._actions
                                             if not action.option_strings
                                             for value in values(action)]
        offered += sorted(name for action in one._actions for name in action.option_strings
                          if name.startswith("--"))
        text += f'         "{path}") words="{" ".join(offered)}" ;;\n'
    return text + FOOT


def walk(parser: argparse.ArgumentParser, path: str):
    """(words before, parser) of the program and all its commands."""
    yield path, parser
    for name, one in subcommands(parser).items():
        yield from walk(one, f"{path} {name}")


def subcommands(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """The commands of a parser by name."""
    return {name: one for action in parser._actions
            if isinstance(action, argparse._SubParsersAction)
            for name, one in action.choices.items()}


def values(action: argparse.Action) -> list[str]:
    """What may follow an option, as far as it is known; empty for files and numbers."""
    if action.choices is not None:
        return [str(choice) for choice in action.choices]
    return known_values().get(action.option_strings[0] if action.option_strings else "", [])


def known_values() -> dict[str, list[str]]:
    """Names that options take without being bound to them."""
    from slideline_tools.commands.draw import WHAT
    from slideline_tools.compare import MEASURES
    # Without components: a colon parts words in the shell.
    return {"--field": ["plastic_strain", "mises", "pressure", "stress", "displacement", "velocity",
                        "contact_force", "contact_pressure", "gap", "contact_traction", "contact_slip",
                        "contact_state"],
            "--show": list(WHAT), "--measures": [name for name in MEASURES if " " not in name]}
