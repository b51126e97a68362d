# SPDX-License-Identifier: MIT
"""Examples in the help of every command, and the formatter that keeps their lines."""
from __future__ import annotations

import argparse
import textwrap

RUN = "results/collision"
FILE = f"{RUN}/collision.vtkhdf"
MAIN = f"""Examples:

  slideline-tools draw deck.k -o model.png          # before the run: is this what I meant?
  slideline-tools report {RUN}           # after it: everything in one HTML file
  slideline-tools plot {FILE} -o x.png
  slideline-tools advise {RUN}           # what the run could have done without

A RUN is the folder of its results, or any file in it. Every COMMAND explains its options with
--help. Exit status: 0 done, 1 a comparison failed, 2 it could not be done."""

EXAMPLES = {
    "info": f"""Example:

  slideline-tools info {FILE}""",
    "plot": f"""Examples:

  slideline-tools plot {FILE} -o x.png
  slideline-tools plot {FILE} --field stress:xy --state 0.0007 --scale 5 -o x.png
  slideline-tools plot {FILE} --field mises --state 10 --state -1 -o x.pdf
  slideline-tools plot {FILE} --history glstat:kinetic,internal \\
      --history rcforc:fy@side=slave -o x.svg
  slideline-tools plot {FILE} --contact --state 28 --state 30 -o x.png
  slideline-tools plot {FILE} --zones --state 20 --state -1 -o x.png

Fields: displacement, velocity, contact_force (with :x or :y, else the length), contact_pressure,
gap, contact_traction, contact_slip, contact_state (with friction), stress:xx (yy, zz, xy),
plastic_strain, pressure, mises. `info` lists those of a file.""",
    "animate": f"""Example:

  slideline-tools animate {FILE} --field mises --rate 24 -o x.gif""",
    "compare": """Examples:

  slideline-tools compare new/x.rcforc.csv old/x.rcforc.csv --rtol 0.01
  slideline-tools compare new/x.glstat.csv old/x.glstat.csv --columns kinetic,internal \\
      --column-rtol internal=0.02 --measures peak,final""",
    "advise": f"""Examples:

  slideline-tools advise {RUN}
  slideline-tools advise {RUN} --all --json""",
    "report": f"""Examples:

  slideline-tools report {RUN}
  slideline-tools report {RUN} --field mises --field stress:xy --state 0.0003 --state -1 -o r.html

A batch: for run in results/*/; do slideline-tools report "$run"; done""",
    "draw": """Examples:

  slideline-tools draw deck.k
  slideline-tools draw deck.k p:level=2 --show mesh,surfaces --zoom 0 0.02 -0.002 0.002 -o gap.png
  slideline-tools draw results/collision -o collision.png""",
    "binout": f"""Examples:

  slideline-tools binout {RUN}
  slideline-tools binout {RUN} -o binout0000

With lasso-python: Binout("binout0000").as_df("rcforc", "y_force").""",
    "d3plot": f"""Examples:

  slideline-tools d3plot {RUN}           # collision.d3plot, collision.d3plot01, ...
  slideline-tools d3plot {RUN} -o d3plot""",
    "make-deck": """Examples:

  slideline-tools make-deck collision --level 2 -o collision_2.k
  slideline-tools make-deck hertz --static -o hertz.k
  slideline-tools make-deck patch --mesh 7/5 --penalty 1e4 -o patch.k
  slideline-tools make-deck SCENE --help""",
    "from-mesh": """Examples:

  slideline-tools from-mesh model.msh                    # model.k: fill in materials, conditions, contact
  slideline-tools from-mesh model.msh -o decks/first.k

gmsh: recombine to quads, Mesh.ElementOrder 1, physical groups for bodies and edges (doc/meshes.md).""",
    "bless": """Example:

  slideline-tools bless collision_type_1 --reason "search reads the clock less often" """,
    "completion": """Examples:

  source <(slideline-tools completion bash)                    # this shell
  slideline-tools completion bash > ~/.local/share/bash-completion/completions/slideline-tools
  slideline-tools completion zsh > ~/.slideline.zsh            # and source that in .zshrc""",
}


class Formatter(argparse.HelpFormatter):
    """Fills paragraphs, keeps lines that begin with two blanks."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        blocks = textwrap.dedent(text).strip("\n").split("\n\n")
        return "\n\n".join(block if block.startswith("  ") else
                           textwrap.fill(" ".join(block.split()), width, initial_indent=indent,
                                         subsequent_indent=indent) for block in blocks)


def add_examples(parser: argparse.ArgumentParser, commands) -> None:
    """Give the program and its commands their examples, after what they say already."""
    parser.formatter_class, parser.epilog = Formatter, MAIN
    for name, words in EXAMPLES.items():
        if command := commands.choices.get(name):
            command.formatter_class = Formatter
            command.epilog = "\n\n".join(filter(None, (command.epilog, words)))
