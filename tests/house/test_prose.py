# SPDX-License-Identifier: MIT
"""Wrapped prose reads as before: what would mean something else at the beginning of a line stays where it is."""
from prose import CELL, LONGEST, WIDTH, too_wide, wrapped

LONG = "word " * 50


def test_a_long_line_is_broken_between_its_words_and_a_second_pass_changes_nothing():
    page = f"# Title\n\n{LONG.strip()}\n"
    lines = wrapped(page).split("\n")
    assert max(map(len, lines)) <= WIDTH and len(lines) > 4
    assert " ".join(wrapped(page).split()) == " ".join(page.split())
    assert wrapped(wrapped(page)) == wrapped(page)
    assert too_wide(page) == [f"line 3: prose of {len(LONG.strip())} columns"] and too_wide(wrapped(page)) == []


def test_items_hang_and_short_lines_stay():
    page = "- short - item\n" + "1. " + LONG.strip() + "\n  - " + LONG.strip() + "\n"
    lines = wrapped(page).split("\n")
    assert lines[0] == "- short - item"
    assert all(line.startswith(("1. w", "   w", "  - w", "    w")) for line in lines[1:-1])


def test_signs_that_would_begin_a_list_or_a_title_do_not_begin_a_line():
    for sign in ("-", "+", "*", "#", ">", "=", "1.", "|"):
        for shift in range(6):
            page = "x" * (WIDTH - 3 + shift) + f" {sign} " + LONG.strip()
            assert not any(line.startswith(sign) for line in wrapped(page).split("\n"))


def test_code_links_and_formulas_are_kept_whole():
    for whole in ("`a b c d`", "[some words here](a/b.md)", "$a + b + c$", "![a b c](d.svg)", "([a b](c), `d e f`)"):
        for shift in range(12):
            page = "y" * (WIDTH - 8 + shift) + " and " + whole + " " + LONG.strip()
            assert any(whole in line for line in wrapped(page).split("\n")), (whole, shift)


def test_tables_titles_and_code_are_left_alone():
    page = f"# {LONG}\n\n| a |\n|---|\n| {LONG} |\n\n```\n{LONG}\n```\n\n$$\n{LONG}\n$$\n"
    assert wrapped(page) == page
    assert too_wide(page) == [f"line 5: a cell of {len(LONG.strip())} characters"]
    assert len(LONG.strip()) > max(CELL, LONGEST)


def test_blocks_of_code_stay_as_they_are():
    """Indented after an empty line: also where a line is too long, and beside prose that is filled anew."""
    code = f"    import slideline_tools\n    results = 1  # {'w ' * LONGEST}\n\n    more = 2\n"
    page = f"# Title\n\n{LONG}\n\n{code}\nprose\n    that goes on\n"
    assert code in wrapped(page) and wrapped(code) == code
    assert [line.split(":")[0] for line in too_wide(page)] == ["line 3"]
    assert too_wide(f"prose\n    {'w ' * LONGEST}")
