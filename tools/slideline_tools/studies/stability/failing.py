# SPDX-License-Identifier: MIT
"""Decks of failing cells, one for each, ready to run; meshes that several have in common are written once.

A cell's deck is the deck as run (options resolved) with its nodes and elements in an include file beside it.
"""
from __future__ import annotations

import hashlib
import pathlib
import re
import shutil
from typing import Iterable, Mapping, Optional

from slideline_tools.studies.framework.table import FAILED
from slideline_tools.studies.stability.measures import STABLE, VERDICTS

FOLDER = "failing"
MESH = re.compile(r"^\*(?:NODE|ELEMENT_SHELL)\b[^\n]*\n(?:(?!\*)[^\n]*\n)*", re.MULTILINE)


def verdict_of(row: Mapping) -> Optional[str]:
    """What failed in a cell, None if nothing did. A run that could not be measured has failed too."""
    if "verdict" in row:
        return None if row["verdict"] == VERDICTS[STABLE] else row["verdict"]
    return "not measured" if row.get("state") == FAILED else None


def split_mesh(text: str) -> tuple[str, str, str]:
    """(deck with an *INCLUDE, name of the include file, its text); a deck without a mesh stays whole."""
    blocks = MESH.findall(text)
    if not blocks:
        return text, "", ""
    mesh = "*KEYWORD\n" + "".join(blocks) + "*END\n"
    name = f"mesh_{hashlib.sha256(mesh.encode()).hexdigest()[:8]}.k"
    first = MESH.search(text).start()
    return text[:first] + f"*INCLUDE\n{name}\n" + MESH.sub("", text[first:]), name, mesh


def keep_failing(rows: Iterable[Mapping], folder: pathlib.Path) -> int:
    """Write the deck of every failing cell into `folder`/failing, named by cell and verdict; how many."""
    target = folder / FOLDER
    shutil.rmtree(target, ignore_errors=True)
    count = 0
    for row in rows:
        verdict = verdict_of(row)
        run = folder / "runs" / str(row.get("run"))
        source = next(iter(sorted(run.glob("*.effective.k")) or sorted(run.glob("*.k"))), None)
        if verdict is None or source is None:
            continue
        target.mkdir(exist_ok=True)
        deck, name, mesh = split_mesh(source.read_text(encoding="utf-8"))
        (target / f"{row['run']}_{verdict.replace(' ', '_')}.k").write_text(deck, encoding="utf-8")
        if name and not (target / name).exists():
            (target / name).write_text(mesh, encoding="utf-8")
        count += 1
    return count
