# SPDX-License-Identifier: MIT
"""The completion script, in a real bash, and the help that goes with it."""
import re
import shlex
import shutil
import subprocess

import pytest

from slideline_tools import cli
from slideline_tools.commands import pictures

PARSER = cli.build_parser()
COMMANDS = PARSER._subparsers._group_actions[0].choices


@pytest.fixture
def complete(tmp_path, tool):
    """What bash offers for the last word."""
    script = tmp_path / "script.bash"
    script.write_text(tool("completion", "bash").stdout)
    (tmp_path / "deck.k").touch()

    def offered(*words):
        program = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
                   'complete -p slideline-tools >/dev/null || exit 9; '
                   '_shtab_slideline_tools 2>/dev/null; printf "%s\\n" "${COMPREPLY[@]}"')
        done = subprocess.run([shutil.which("bash"), "-c", program, "bash", script, "slideline-tools", *words],
                              cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0 and not done.stderr, done.stderr
        return set(done.stdout.split())
    return offered


def test_commands_and_options(complete):
    assert complete("") == set(COMMANDS) and complete("rep") == {"report"}
    for name, parser in COMMANDS.items():
        assert complete(name, "--") == {word for action in parser._actions for word in action.option_strings
                                        if word.startswith("--")}, name


@pytest.mark.parametrize("words, offered", [
    (["make-deck", "h"], {"hertz"}),
    (["make-deck", "patch", "--surfaces", "t"], {"tied"}),
    (["make-deck", "hertz", "-o", "x", "--l"], {"--level"}),
    (["plot", "x.vtkhdf", "--field", "plas"], {"plastic_strain"}),
    (["draw", "x", "--show", ""], set(pictures.WHAT)),
    (["completion", ""], set(cli.SHELLS)),
    (["draw", "d"], {"deck.k"}),
    (["report", "run", "-o", "de"], {"deck.k"}),
])
def test_values(complete, words, offered):
    assert complete(*words) == offered


def test_zsh(tool):
    assert tool("completion", "zsh").stdout.startswith("#compdef slideline-tools")
    assert tool("completion", "fish").returncode == 2


def test_names_of_draw_are_those_of_the_picture():
    from slideline_tools.draw import picture
    assert pictures.WHAT == picture.WHAT


@pytest.mark.parametrize("name", COMMANDS)
def test_examples_are_commands_that_exist(name, tool):
    """Every example line parses, up to files that need not be there."""
    lines = re.findall(r"^  slideline-tools (.*)", tool(name, "--help").stdout.replace("\\\n", " "), re.M)
    assert lines and lines[0].startswith(name)
    for line in lines:
        if "--help" not in line:
            PARSER.parse_args(shlex.split(line.partition(">")[0], comments=True))
