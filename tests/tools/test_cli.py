# SPDX-License-Identifier: MIT
"""Help, information and errors of the command line."""
import os
import subprocess
import sys

import pytest

from slideline_tools import cli

COMMANDS = ("info", "plot", "animate", "compare", "answer", "advise", "report", "draw", "make-deck",
            "completion")


def test_help_lists_the_commands(tool):
    finished = tool("--help")
    assert finished.returncode == 0
    assert all(name in finished.stdout for name in COMMANDS)


def test_no_command_is_an_error(tool):
    assert tool().returncode == 2
    assert tool("paint").returncode == 2


def test_info(tool, results_file):
    finished = tool("info", results_file)
    assert finished.returncode == 0, finished.stderr
    for text in ("three cells", "7 nodes, 3 elements", "part 1: 2, part 2: 1",
                 "3, time 0 to 1", "plastic_strain", "glstat: 11 rows", "interface 1, master"):
        assert text in finished.stdout


def test_folder_of_a_run_will_do(tool, results_file):
    """As for the commands report, advise, d3plot and binout."""
    assert tool("info", results_file.parent).stdout == tool("info", results_file).stdout != ""
    for command, picture in (("plot", "x.png"), ("animate", "x.gif")):
        finished = tool(command, results_file.parent, "-o", results_file.parent / picture)
        assert finished.returncode == 0, finished.stderr
    assert tool("info", results_file.parent / "none").returncode == 2


@pytest.mark.parametrize("command", ["info", "plot", "animate"])
def test_missing_results(tmp_path, tool, command):
    more = [] if command == "info" else ["--output", tmp_path / "x.gif"]
    finished = tool(command, tmp_path / "none.vtkhdf", *more)
    assert finished.returncode == 2
    assert "no such file" in finished.stderr and "Traceback" not in finished.stderr


def test_as_a_program():
    """The console script's module runs by itself and hands its status to the shell."""
    command = [sys.executable, "-m", "slideline_tools.cli"]
    finished = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    assert finished.returncode == 0 and finished.stdout.startswith("slideline-tools ")
    finished = subprocess.run([*command, "info", "none.vtkhdf"], capture_output=True, text=True,
                              check=False)
    assert finished.returncode == 2 and finished.stdout == ""


def test_reader_that_goes_away(results_file):
    """As with `| head`: no message, and no status that means something else."""
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "w") as stream:
        finished = subprocess.run([sys.executable, "-m", "slideline_tools.cli", "info", results_file],
                                  stdout=stream, stderr=subprocess.PIPE, text=True, check=False)
    assert (finished.returncode, finished.stderr) == (cli.NO_READER, "")
