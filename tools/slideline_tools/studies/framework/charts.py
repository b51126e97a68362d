# SPDX-License-Identifier: MIT
"""Charts of studies: each as SVG and PNG."""
from slideline_tools.plots import STYLE, plt


def styled():
    """Context in which charts are drawn; the same text of an SVG on every run."""
    return plt.rc_context({**STYLE, "svg.hashsalt": "slideline", "svg.fonttype": "none"})


def save(figure, folder, name):
    """Write FOLDER/NAME.svg and FOLDER/NAME.png; call it within `styled()`."""
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None})
    figure.savefig(folder / f"{name}.png")
    plt.close(figure)
