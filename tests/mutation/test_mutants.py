# SPDX-License-Identifier: MIT
"""What the rules of the mutants break, and what they leave alone."""
from __future__ import annotations

import csv

import pytest

import mutate
from mutants import Mutant, make_mutants, read_statements

SOURCE = """! a + b
module m
  use kinds_m, only : wp
  real(wp), parameter :: round_off = 1.0e-9_wp
contains
  subroutine s(a, n) ! x < y
    integer, intent(in) :: n
    real(wp), intent(inout) :: a(3, n)
    integer :: i
{body}
  end subroutine s
end module m
"""


def mutants_of(body: str) -> list[Mutant]:
    """Mutants of a procedure with this body."""
    return make_mutants("contact/m.f90", SOURCE.format(body=body))


def afters(body: str, rule: str) -> list[str]:
    """Broken forms of a statement by one rule."""
    return [mutant.after for mutant in mutants_of(body) if mutant.rule == rule]


@pytest.mark.parametrize("body, rule, expected", [
    ("x = a + b", "sign", ["x = a - b"]),
    ("x = -1.5e-3_wp - b", "sign", ["x = +1.5e-3_wp - b", "x = -1.5e-3_wp + b"]),
    ("x = a*b/c**2", "factor", ["x = a/b/c**2", "x = a*b*c**2"]),
    ("if (a <= b) x = c", "relation", ["if (a < b) x = c", "if (a >= b) x = c"]),
    ("q = a == b", "relation", ["q = a /= b"]),
    ("q = a .and. .not. b", "logic", ["q = a .or. .not. b", "q = a .and. b"]),
    ("q = .true.", "logic", ["q = .false."]),
    ("x = a(2, i)", "index", ["x = a(1, i)", "x = a(2, i + 1)", "x = a(2, i - 1)"]),
    ("x = a(1, j)", "index", ["x = a(2, j)"]),
    ("x = 0.5_wp*y", "number", ["x = 1.0_wp*y"]),
    ("x = 3.0_wp", "number", ["x = 6.0_wp"]),
    ("k = i + 1", "number", ["k = i + 2"]),
    ("x = max(y, tiny(1.0_wp))", "number", []),
    ("x = max(y, abs(z))", "function", ["x = min(y, abs(z))", "x = max(y, (z))"]),
    ("x = y", "left out", ["continue"]),
    ("if (q) x = y", "left out", ["if (q) continue"]),
    ("call f(x)", "left out", ["continue"]),
    ("do i = 1, n", "left out", []),
    ("allocate (x(n), source=y)", "left out", []),
    ("if (q) exit", "loop", ["if (q) cycle"]),
    ("else if (a(1) > b) then", "condition", ["else if (.not. (a(1) > b)) then"]),
    ("associate (x => y)", "relation", []),
])
def test_rules(body: str, rule: str, expected: list[str]) -> None:
    assert afters(body, rule) == expected


def test_a_statement_over_several_lines_is_one() -> None:
    body = "    x = a & ! first + part\n      - b\n    y = c; z = d"
    assert [mutant.after for mutant in mutants_of(body) if mutant.rule in ("sign", "left out")] == [
        "continue", "x = a + b", "continue", "continue"]
    broken = mutants_of(body)[0].apply(SOURCE.format(body=body))
    assert "continue\n    y = c; z = d" in broken and "x = a" not in broken


@pytest.mark.parametrize("body", [
    "! x = a + b", "real(wp) :: y = 1.0_wp", "integer, parameter :: k(2) = [1, 2]", "end if",
    "use m, only : a => b", "return_value: block", "write (*, *) 'a + b < 1.0'"])
def test_nothing_to_break(body: str) -> None:
    assert mutants_of(body) == []


def test_text_of_messages_is_left_alone() -> None:
    kept = mutants_of("call fail('1 < 2 ! no', x + 1)")
    assert {mutant.rule for mutant in kept} == {"sign", "number"}
    assert all("'1 < 2 ! no'" in mutant.after for mutant in kept)


def test_the_sources_themselves() -> None:
    """Every mutant of the layers differs from its original in one place, and has a key of its own."""
    drawn = mutate.draw(["contact", "material"], 0, 1)
    assert len({mutant.key for mutant in drawn}) == len(drawn) > 5000
    for mutant in drawn[:300]:
        text = (mutate.ROOT / "src" / mutant.file).read_text(encoding="utf-8")
        broken = mutant.apply(text)
        assert broken != text and len(read_statements(broken)) == len(read_statements(text))
    assert mutate.draw(["contact"], 7, 3) == mutate.draw(["contact"], 7, 3) != mutate.draw(["contact"], 7, 4)


def test_known_survivors_have_reasons() -> None:
    with open(mutate.EQUIVALENT, newline="", encoding="utf-8") as stream:
        entries = list(csv.DictReader(stream))
    assert all(all(entry.values()) for entry in entries)
