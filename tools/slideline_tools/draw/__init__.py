# SPDX-License-Identifier: MIT
"""A picture of a model before its run: mesh, sets, surfaces, conditions and loads.

    from slideline_tools.draw import draw
    draw("collision.k", "model.png", program="build/release/slideline")
"""
import os
import pathlib
import typing

from slideline_tools import UserError, files
from slideline_tools.draw.model import Model, check_deck
from slideline_tools.program import find_program


def resolve(deck: str | os.PathLike, program: str | os.PathLike | None = None,
            overrides: typing.Sequence[str] = ()) -> Model:
    """The model of a deck, or of the deck as run in a results folder, as the program understands it.

    Raises UserError with the program's own message when the deck is refused.
    """
    deck = pathlib.Path(deck)
    if deck.is_dir():
        deck = pathlib.Path(f"{files.find_run(deck, '.effective.k')}.effective.k")
    if not deck.is_file():
        raise UserError(f"{deck}: no such file")
    return check_deck(deck, find_program(program), overrides)


def draw(deck: str | os.PathLike, output: str | os.PathLike, program: str | os.PathLike | None = None,
         overrides: typing.Sequence[str] = (), show: typing.Iterable[str] | None = None,
         zoom: typing.Sequence[float] | None = None) -> Model:
    """Write the picture of a deck (or of a results folder) and give its model."""
    from slideline_tools.draw.picture import model_figure
    from slideline_tools.plots import plt
    model = resolve(deck, program, overrides)
    figure = model_figure(model, show, zoom)
    figure.savefig(files.output(output, [deck]))
    plt.close(figure)
    return model
