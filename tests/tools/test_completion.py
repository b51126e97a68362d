# SPDX-License-Identifier: MIT
"""The completion script, in a real bash, and the help that goes with it."""
import shutil
import subprocess

import pytest

from slideline_tools import cli
from slideline_tools.commands import completion, draw, help_texts

PARSER = cli.build_parser()


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    path = tmp_path_factory.mktemp("completion") / "script.bash"
    path.write_text(completion.script(PARSER, "bash"))
    return path


def complete(script, *words):
    """What bash offers for the last word, in its own order."""
    program = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
               'complete -p slideline-tools >/dev/null || exit 9; '
               '_slideline_tools; printf "%s\\n" "${COMPREPLY[@]}"')
    done = subprocess.run([shutil.which("bash"), "-u", "-c", program, "bash", script,
                           "slideline-tools", *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and not done.stderr, done.stderr
    return done.stdout.split()


def test_commands(script):
    assert set(complete(script, "")) == set(completion.subcommands(PARSER))
    assert complete(script, "re") == ["report"]
    assert complete(script, "--v") == ["--version"]


def test_options_of_every_command(script):
    for path, parser in completion.walk(PARSER, ""):
        expected = {name for action in parser._actions for name in action.option_strings
                    if name.startswith("--")}
        assert set(complete(script, *path.split(), "--")) == expected, path


@pytest.mark.parametrize("words, offered", [
    (["make-deck", "h"], ["hertz"]),
    (["make-deck", "symmetric_plate", "--hourglass", "s"], ["stiffness"]),
    (["make-deck", "-o", "x", "hertz", "--l"], ["--level"]),
    (["plot", "x.vtkhdf", "--field", "plas"], ["plastic_strain"]),
    (["draw", "--show", ""], list(draw.WHAT)),
    (["completion", ""], ["bash", "zsh"]),
    (["plot", ""], []),               # files, by the shell
    (["report", "run", "-o", ""], []),
])
def test_values(script, words, offered):
    assert complete(script, *words) == offered


def test_command(tool):
    for shell in completion.SHELLS:
        finished = tool("completion", shell)
        assert finished.returncode == 0 and "complete -o default" in finished.stdout
    assert "bashcompinit" in finished.stdout
    assert tool("completion", "fish").returncode == 2


def test_names_of_draw_are_those_of_the_picture():
    from slideline_tools.draw import picture
    assert draw.WHAT == picture.WHAT


def test_every_command_has_an_example(tool):
    commands = completion.subcommands(PARSER)
    assert set(help_texts.EXAMPLES) <= set(commands)
    for name in help_texts.EXAMPLES:
        shown = tool(name, "--help").stdout
        assert f"\n  slideline-tools {name}" in shown or "<(slideline-tools" in shown


def test_examples_are_commands_that_exist():
    """Every example line parses, up to files that need not be there."""
    for words in help_texts.EXAMPLES.values():
        text = words.replace("\\\n", " ")
        for line in text.splitlines():
            if line.startswith("  slideline-tools") and "--help" not in line and ">" not in line:
                arguments = [word.strip('"') for word in line.split("#")[0].split()[1:]]
                PARSER.parse_args(quoted(line) if '"' in line else arguments)


def quoted(line):
    """The words of a line with quotes."""
    import shlex
    return shlex.split(line, comments=True)[1:]
