# SPDX-License-Identifier: MIT
"""Faults by rule: one operator, number, subscript, function, condition or statement of an executable line is broken."""
from __future__ import annotations

import random
import re
from collections.abc import Iterator
from pathlib import Path

#: (kind, what is broken, what takes its place)
RULES = (
    ("sign", r" \+ (?!&)", " - "), ("sign", r" - (?!&)", " + "),
    ("factor", r"(?<=[\w)])\*(?=[\w(])", "/"), ("factor", r"(?<=[\w)])/(?=[\w(])", "*"),
    ("relation", r" <= ", " < "), ("relation", r" < ", " <= "), ("relation", r" >= ", " > "), ("relation", r" > ", " >= "),
    ("relation", r" == ", " /= "), ("relation", r" /= ", " == "),
    ("logic", r"\.and\.", ".or."), ("logic", r"\.or\.", ".and."), ("logic", r"\.not\. ", ""),
    ("logic", r"\.true\.", ".false."), ("logic", r"\.false\.", ".true."),
    ("number", r"\b0\.0_wp", "1.0_wp"), ("number", r"\b(?:0\.5|2\.0)_wp", "1.0_wp"), ("number", r"\b1\.0_wp", "2.0_wp"),
    ("index", r"(?<=\w)\((1|i|j|k|n)(?=[,)])", r"(\1 + 1"), ("index", r", (1|i|j|k|n)\)", r", \1 + 1)"),
    ("function", r"\bmin(?=\(|val\()", "max"), ("function", r"\bmax(?=\(|val\()", "min"), ("function", r"\babs\(", "("),
    ("function", r"\bany\(", "all("), ("function", r"\ball\(", "any("),
    ("condition", r"\bif \((.*)\) then$", r"if (.not. (\1)) then"), ("loop", r"\bexit$", "cycle"), ("loop", r"\bcycle$", "exit"),
    ("left out", r"(?<=^ )( *)(?:call \w|[\w%]+(?:\([^=]*\))?(?:%\w+)* = )[^&]*$", r"\1continue"),
)
HEADER = re.compile(r"\s*(?:(?:pure|impure|elemental|recursive|module)\s+)*(?:subroutine|function)\s")
END = re.compile(r"\s*end (?:subroutine|function)\b")
SKIPPED = re.compile(r"\s*(?:use|implicit|import|contains|private|public|end|interface|allocate|\d+ format)\b|.*(?:::|['\"])")


def edits(text: str) -> Iterator[tuple[int, str, str, str]]:
    """(line number, kind, text that stands there once, text in its place) of all faults of a file."""
    lines, inside = text.split("\n"), False
    for k, line in enumerate(lines):
        inside = not END.match(line) and (inside or bool(HEADER.match(line)))
        code = line.split("!")[0].rstrip()
        goes_on = lines[k - 1].split("!")[0].rstrip().endswith("&")
        find = "\n".join(lines[max(k - 1, 0):k + 1])
        if inside and not HEADER.match(line) and not SKIPPED.match(line) and text.count(find) == 1:
            for kind, pattern, other in RULES:
                for found in re.finditer(pattern, code):
                    if not (goes_on and kind == "left out"):
                        broken = code[:found.start()] + found.expand(other) + code[found.end():]
                        yield k + 1, kind, find, find[:len(find) - len(line)] + broken


def draw(src: Path, folder: str, count: int, seed: int) -> list[dict[str, str]]:
    """`count` faults of the sources below src/FOLDER, drawn at random."""
    found = []
    for path in sorted((src / folder).rglob("*.f90")):
        file = str(path.relative_to(src))
        if not file.startswith("parallel/"):
            found += [{"id": f"{file}:{line}:{kind}:{k}", "file": file, "find": old, "replace": new, "kind": kind}
                      for k, (line, kind, old, new) in enumerate(edits(path.read_text(encoding="utf-8")))]
    return random.Random(seed).sample(found, min(count, len(found)))
