# SPDX-License-Identifier: MIT
"""The tools that watch (tests/watch): what of them can be tried in seconds."""
import os
import shutil
import subprocess
import sys

import pytest

from fortran_source import ROOT

sys.path.insert(0, str(ROOT / "tests" / "watch"))
os.environ.setdefault("SLIDELINE", "none")  # the scenes of the program tests are used, no program is run
import line_coverage  # noqa: E402
import memcheck  # noqa: E402
import races  # noqa: E402

BARRIER = """program barrier
  implicit none
  integer :: i
  real(8) :: a(100), b(100)
  !$omp parallel num_threads(2) default(shared) private(i)
  !$omp do schedule(static)
  do i = 1, 100
    a(i) = i
  end do
  !$omp end do WAIT
  !$omp do schedule(static)
  do i = 1, 100
    b(i) = a(101 - i)
  end do
  !$omp end do
  !$omp end parallel
  if (abs(sum(b) - 5050.0d0) > 0.0d0) error stop 1
end program barrier
"""


@pytest.mark.parametrize("plant", (*races.PLANTS, *memcheck.PLANTS), ids=lambda plant: plant.name)
def test_mistake_can_still_be_planted(plant):
    assert (ROOT / "src" / plant.file).read_text().count(plant.old) == 1


def test_reasons_can_be_read():
    reasons = line_coverage.read_reasons(line_coverage.REASONS)
    text = "    allocate (a(n), b(n), &"
    assert line_coverage.reason_of("src/state/any.f90", text, reasons) is not None
    assert line_coverage.reason_of("src/state/any.f90", "    a = b", reasons) is None


def test_sums_of_coverage():
    counts = {"src/a/x.f90": {1: 3, 2: 0}, "src/a/y.f90": {5: 1, 6: 1}, "src/b/z.f90": {1: 0}}
    (total,) = line_coverage.table(counts, lambda name: "all")
    assert total.split() == ["60.00", "%", "3", "of", "5", "all"]
    assert [row.split()[-1] for row in line_coverage.table(counts, lambda name: name.split("/")[1])] == ["b", "a"]


@pytest.mark.parametrize("wait, status", [("", 0), ("nowait", 66)])
def test_a_missing_barrier_is_seen_and_a_barrier_understood(tmp_path, wait, status):
    """A program of two loops under the thread sanitiser with team.c in the place of libgomp."""
    if not shutil.which("gcc"):
        pytest.skip("no gcc")
    (tmp_path / "barrier.f90").write_text(BARRIER.replace("WAIT", wait))
    for command in (["gcc", "-O1", "-c", str(races.HERE / "team.c"), "-o", "team.o"],
                    ["gfortran", "-O1", "-fopenmp", "-fsanitize=thread", "barrier.f90", "team.o", "-o", "barrier"]):
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        if done.returncode:
            pytest.skip(f"no thread sanitiser: {done.stderr[-200:]}")
    done = subprocess.run(["./barrier"], cwd=tmp_path, env={**os.environ, "TSAN_OPTIONS": races.OPTIONS},
                          capture_output=True, text=True, timeout=60, check=False)
    if "unexpected memory mapping" in done.stderr:
        pytest.skip("the thread sanitiser does not run in this address space")
    assert done.returncode == status, done.stderr
    assert ("data race" in done.stderr) == (status != 0)
