# SPDX-License-Identifier: MIT
"""What to say of a name that does not exist, objects in one line, numbers of things and numbers in texts."""
import difflib
import typing

from slideline_tools import UserError

#: least likeness (difflib) of a name that is offered instead
ALIKE = 0.65
#: a line of a terminal
LINE = 79


def nearest(name: str, known: typing.Iterable[str]) -> str:
    """'; the nearest name is ...' where one of the known names is near, else nothing."""
    by_lower = {one.lower(): one for one in map(str, known)}
    found = difflib.get_close_matches(str(name).lower(), by_lower, 1, ALIKE)
    return f"; the nearest name is '{by_lower[found[0]]}'" if found else ""


def missing(name: str, known: typing.Iterable[str]) -> str:
    """The end of a refusal: the nearest name, and all there are."""
    known = list(map(str, known))
    return f"{nearest(name, known)}; there are {', '.join(known) or 'none'}"


def one_line(words: str) -> str:
    """Words in angle brackets that fit a line."""
    words = " ".join(words.split())
    return f"<{words}>" if len(words) <= LINE - 2 else f"<{words[:LINE - 5]}...>"


def counted(count: int, what: str) -> str:
    """A number of things: `1 node`, `2 nodes`."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def number(what: str, text: str) -> float:
    """The number in a text; `what` it is for."""
    try:
        return float(text)
    except ValueError:
        raise UserError(f"{what}: '{text}' is no number") from None
