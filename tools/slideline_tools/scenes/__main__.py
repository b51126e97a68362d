# SPDX-License-Identifier: MIT
"""Write the decks kept in the repository: `python -m slideline_tools.scenes input`."""
import pathlib
import sys

from slideline_tools.scenes import committed_decks


def main(folder):
    """Write the decks kept in the repository below `folder`."""
    for name, text in committed_decks():
        path = pathlib.Path(folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="ascii")
        print(f"wrote {path}")


if __name__ == "__main__":
    main(sys.argv[1])
