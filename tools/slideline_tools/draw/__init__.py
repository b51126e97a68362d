# SPDX-License-Identifier: MIT
"""A picture of a model before its run: mesh, sets, surfaces, conditions and loads.

The program resolves the deck (includes, parameters, overrides) and writes the effective deck,
which `model` reads; `chains` makes surfaces of it by the rules of the program.

    from slideline_tools.draw import draw
    draw("collision.k", "model.png", program="build/release/slideline")
"""
from __future__ import annotations

import pathlib
import subprocess
import tempfile

from slideline_tools import UserError
from slideline_tools.draw.model import Model, read_model

# So short that the program ends after one step; what it makes of the deck is written before.
SHORT = "endtim=1e-12"
LONGEST = 120.0


def resolve(deck, program, overrides=()) -> Model:
    """The model of a deck as the program understands it; of `<job>.effective.k` without it.

    Raises UserError with the program's own message when the deck is refused.
    """
    deck = pathlib.Path(deck)
    if deck.is_dir() or deck.name.endswith(".effective.k"):
        found = sorted(deck.glob("*.effective.k")) if deck.is_dir() else [deck]
        if len(found) != 1:
            raise UserError(f"{deck}: {len(found)} effective decks, expected one")
        return read_model(found[0].read_text(encoding="utf-8", errors="replace"))
    if not deck.is_file():
        raise UserError(f"{deck}: no such file")
    with tempfile.TemporaryDirectory() as work:
        said = run_shortly(deck, program, overrides, work)
        path = pathlib.Path(work) / "model.effective.k"
        if not path.exists():
            raise UserError(f"{deck} was refused by {program}:\n{said.strip()}")
        model = read_model(path.read_text(encoding="utf-8", errors="replace"))
        model.warnings = [line[len("warning: "):] for line in said.splitlines()
                          if line.startswith("warning: ")]
        return model


def run_shortly(deck, program, overrides, work) -> str:
    """Let the program read the deck and stop; what it said on standard error."""
    command = [str(program), f"i={deck}", f"d={work}", "jobid=model",
               *(one for one in overrides if not one.startswith("endtim=")), SHORT]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False,
                              timeout=LONGEST)
    except subprocess.TimeoutExpired:  # the deck as run was written before the first step
        return ""
    except OSError as problem:
        raise UserError(f"cannot run the program {program}: {problem} (--program names another)"
                        ) from problem
    return done.stderr or done.stdout


def draw(deck, output, program=None, overrides=(), show=None, zoom=None) -> Model:
    """Write the picture of a deck (or of a results folder) and give its model."""
    from slideline_tools.draw.picture import model_figure, save
    model = resolve(deck, program, overrides)
    save(model_figure(model, show, zoom), output)
    return model
