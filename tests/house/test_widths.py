# SPDX-License-Identifier: MIT
"""Lines of prose and cells of tables keep to the widths of prose.py, on every page that is written by hand.

Left out are pages of doc/studies that may be behind the code.
"""
import pytest

from fortran_source import ROOT
from test_house import tracked_files
from test_pages import STUDIES, allowances
from prose import CELL, LONGEST, too_wide

BEHIND = {f"doc/studies/{name}.md" for name in allowances((STUDIES / "README.md").read_text(encoding="utf-8"))}
PAGES = [name for name in tracked_files()
         if name.endswith(".md") and name not in BEHIND]


def test_pages_are_found():
    assert {"README.md", "doc/keywords.md", "doc/verification.md", "doc/studies/README.md"} <= set(PAGES)


@pytest.mark.parametrize("name", PAGES)
def test_widths(name):
    assert too_wide((ROOT / name).read_text(encoding="utf-8")) == []


def test_what_is_too_wide_is_noticed():
    page = (ROOT / "doc" / "keywords.md").read_text(encoding="utf-8")
    wide = f"\n{'w ' * LONGEST}\n\n| card |\n|---|\n| {'c' * (CELL + 1)} |\n"
    assert ["prose" in line for line in too_wide(page + wide)] == [True, False]
