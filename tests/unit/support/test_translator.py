# SPDX-License-Identifier: MIT
"""The translator and the assertions behind the unit tests: what they refuse, and that tests can fail."""
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
SOURCES = [HERE / f"funit_{part}.f90" for part in ("core", "equal", "order", "lite")]
HEAD = "module test_it\n  use funit\n  implicit none\ncontains\n"
TAIL = "end module test_it\n"


def one_test(*body):
    """A file with one test; each of `body` is a line of it, from line 7 on."""
    lines = "".join(f"    {line}\n" for line in body)
    return HEAD + "  @test\n  subroutine checks()\n" + lines + "  end subroutine checks\n" + TAIL


def translate(folder, text, name="test_it.pf"):
    """Run the translator; returns the finished process."""
    (folder / name).write_text(text)
    return subprocess.run([sys.executable, HERE / "pf2f90.py", folder / name, folder / "out.f90"],
                          capture_output=True, text=True, check=False)


@pytest.fixture(scope="module", name="library")
def compile_library(tmp_path_factory):
    """The assertion modules, compiled once."""
    if not shutil.which("gfortran"):
        pytest.fail("gfortran is needed")
    folder = tmp_path_factory.mktemp("funit")
    subprocess.run(["gfortran", "-std=f2008", "-c", *SOURCES], cwd=folder, check=True)
    return folder


def run(library, folder, text):
    """Translate, compile and run; returns the finished process."""
    done = translate(folder, text)
    assert done.returncode == 0, done.stderr
    objects = sorted(library.glob("*.o"))
    subprocess.run(["gfortran", "-std=f2008", f"-I{library}", "out.f90", *objects, "-o", "it"],
                   cwd=folder, check=True, capture_output=True)
    return subprocess.run([folder / "it"], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("text, where, what", [
    (one_test("@assertAssociated(p)"), ":7:", "@assertAssociated"),
    (one_test("@mpiAssertEqual(1, 2)"), ":7:", "@mpiAssertEqual"),
    (one_test("@assertEqual(1, &", "  2)"), ":7:", "closed on its line"),
    (one_test("@assertEqual(1, 2) ! two"), ":7:", "nothing after it"),
    (one_test("@assertEqual(f(1, 2))"), ":7:", "needs 2 arguments"),
    (one_test("@assertRelativelyEqual(1.0, 2.0)"), ":7:", "needs 3 arguments"),
    (HEAD + "  @test(ifdef=X)\n  subroutine s()\n  end subroutine s\n" + TAIL, ":5:", "@test(ifdef=X)"),
    (HEAD + "  @test\n  integer function f()\n  end function f\n" + TAIL, ":6:", "subroutine NAME()"),
    (HEAD + "  @test\n  subroutine s(this)\n  end subroutine s\n" + TAIL, ":6:", "no arguments"),
    (HEAD + "  @test\n  @test\n  subroutine s()\n  end subroutine s\n" + TAIL, ":6:", "@test"),
    (one_test("x = 1", "contains", "subroutine keep_all()", "end subroutine keep_all"), ":9:", "keep_all is a name of pFUnit"),
    (one_test("x = 1", "contains", "pure real function Near(a)", "end function near"), ":9:", "Near is a name of pFUnit"),
    (HEAD + TAIL, "test_it.pf:", "no @test"),
    ("@suite(name='x')\n" + one_test("@assertTrue(.true.)"), ":1:", "@suite"),
    (one_test("@assertTrue(.true.)").replace("test_it", "test_it_m"), ":1:", "must be named test_it"),
    (one_test("@assertTrue(.true.)").replace("module test_it\n", "module test_it ! it\n", 1), ":1:",
     "nothing after"),
])
def test_refused_by_name_with_its_line(tmp_path, text, where, what):
    done = translate(tmp_path, text)
    assert done.returncode != 0
    assert where in done.stderr and what in done.stderr
    assert not (tmp_path / "out.f90").exists()


PASSING = [
    "@assertEqual(3, 3)",
    "@assertEqual([1, 2], [1, 2])",
    "@assertEqual(2, [2, 2])",
    "@assertEqual(.true., .true.)",
    "@assertEqual('a, b', ' a, b ')",
    "@assertEqual(0.1d0 + 0.2d0, 0.3d0, tolerance=1.0d-15)",
    "@assertEqual(1.0d0, 1.0d0 + 1.0d-9, 1.0d-8, message='positional tolerance')",
    "@assertEqual(0, 1.0d-9, tolerance=1.0d-8)",
    "@assertEqual(reshape([1d0, 2d0], [2, 1]), reshape([1d0, 2d0], [2, 1]))",
    "@assertEqual(0.0d0, reshape([0d0, 0d0], [2, 1]))",
    "@assertRelativelyEqual(1.0d9, 1.0d9 + 1.0d0, 1.0d-8)",
    "@assertLessThan(1, 2)",
    "@assertLessThan(1.0d0, [2.0d0, 3.0d0])",
    "@assertLessThanOrEqual(1.0d0, 1.0d0)",
    "@assertGreaterThan(2.0d0, 1.0d0, message='order')",
    "@assertGreaterThanOrEqual(2, 2)",
    "@assertTrue([.true., .true.])",
    "@assertFalse(1 > 2, message='a, (b)')",
    "@assertIsNaN(transfer(-1_8, 1.0d0))",
    "@assertIsFinite(1.0d0)",
]

FAILING = [
    ("@assertEqual(3, 4, message='count')", ["count", "expected 3, found 4"]),
    ("@assertEqual([1, 2, 3], [1, 2])", ["shapes"]),
    ("@assertEqual([1, 2, 3], [1, 5, 6])", ["expected 2, found 5 at (2)"]),
    ("@assertEqual(.true., .false.)", ["expected true"]),
    ("@assertEqual('abc', 'abd')", ['expected "abc", found "abd"']),
    ("@assertEqual(0.1d0 + 0.2d0, 0.3d0)", ["tolerance 0.0"]),
    ("@assertEqual(1.0d0, 1.0d0 + 1.0d-7, tolerance=1.0d-8)", ["difference"]),
    ("@assertEqual(1.0d0, transfer(-1_8, 1.0d0), tolerance=1.0d0)", ["NaN"]),
    ("@assertEqual(0.0d0, reshape([0d0, 0d0, 0d0, 7d0], [2, 2]))", ["at (2,2)"]),
    ("@assertRelativelyEqual(0.0d0, 0.0d0, 1.0d-8)", ["expected zero"]),
    ("@assertRelativelyEqual(1.0d9, 1.0d9 + 1.0d2, 1.0d-8)", ["relative difference"]),
    ("@assertLessThan(2, 2)", ["2 < 2"]),
    ("@assertLessThan(1.0d0, [2.0d0, 1.0d0])", ["at (2)"]),
    ("@assertLessThanOrEqual(3, 2)", ["3 <= 2"]),
    ("@assertGreaterThan(1.0d0, transfer(-1_8, 1.0d0))", ["NaN"]),
    ("@assertGreaterThanOrEqual(1, 2)", ["1 >= 2"]),
    ("@assertTrue([.true., .false.])", ["expected true"]),
    ("@assertFalse(.true.)", ["expected false"]),
    ("@assertIsNaN(1.0d0)", ["expected NaN"]),
    ("@assertIsFinite(transfer(-1_8, 1.0d0))", ["finite"]),
    ("@assertFail('here')", ["here"]),
]


def test_true_assertions_pass(library, tmp_path):
    done = run(library, tmp_path, one_test(*PASSING))
    assert done.stdout.splitlines()[-1] == "1 passed, 0 failed"
    assert done.returncode == 0


def test_each_false_assertion_fails_and_the_others_still_run(library, tmp_path):
    tests = "".join(f"  @test\n  subroutine t{i}()\n    {line}\n    stop 'went on'\n  end subroutine t{i}\n"
                    for i, (line, _) in enumerate(FAILING))
    done = run(library, tmp_path, HEAD + tests + TAIL)
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1] == f"0 passed, {len(FAILING)} failed"
    assert "went on" not in done.stdout + done.stderr
    reports = done.stdout.split("test t")[1:]
    for i, (report, (_, parts)) in enumerate(zip(reports, FAILING)):
        assert f"test_it.pf:{7 + 5 * i}:" in report
        for part in parts:
            assert part in report


def test_fixtures_run_around_each_test(library, tmp_path):
    text = HEAD.replace("contains", "integer :: depth = 0\ncontains") + (
        "  @before\n  subroutine enter()\n    depth = depth + 1\n  end subroutine enter\n"
        "  @after\n  subroutine leave()\n    depth = depth - 1\n  end subroutine leave\n"
        "  @test\n  subroutine fails()\n    @assertEqual(9, depth)\n  end subroutine fails\n"
        "  @test\n  subroutine passes()\n    @assertEqual(1, depth)\n  end subroutine passes\n") + TAIL
    done = run(library, tmp_path, text)
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1] == "1 passed, 1 failed"


def test_comparing_what_is_not_supported_does_not_compile(library, tmp_path):
    with pytest.raises(subprocess.CalledProcessError):
        run(library, tmp_path, one_test("@assertEqual('1', 1)"))
