# SPDX-License-Identifier: MIT
"""doc/gallery.md shows every scene of input/, and every picture that tools/docs/gallery.py draws is shown."""
import re

from fortran_source import ROOT

PAGE = (ROOT / "doc/gallery.md").read_text(encoding="utf-8")


def test_every_scene_of_input_has_its_command():
    shown = set(re.findall(r" i=input/(\w+)/\w+\.k ", PAGE))
    assert shown == {path.name for path in (ROOT / "input").iterdir() if path.is_dir()}


def test_every_deck_of_the_page_is_there():
    decks = re.findall(r" i=(\S+\.k) ", PAGE) + [f"doc/examples/{name}" for name in re.findall(r"^\| `(\w+\.k)` \|", PAGE, re.M)]
    assert len(decks) > 20
    assert [deck for deck in decks if not (ROOT / deck).is_file()] == []


def test_pictures_are_those_of_the_script():
    drawn = set(re.findall(r'^    "(\w+)": (?:Scene)?\(', (ROOT / "tools/docs/gallery.py").read_text(encoding="utf-8"), re.M))
    shown = set(re.findall(r"pictures/gallery_(\w+)\.png", PAGE))
    kept = {path.stem.removeprefix("gallery_") for path in (ROOT / "doc/pictures").glob("gallery_*.png")}
    assert shown == kept == drawn - {"impact"}
