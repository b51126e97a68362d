# SPDX-License-Identifier: MIT
"""The benchmarks run and fill their table; no time is judged. SLIDELINE_BUILD: a Release build with them."""
import os
import pathlib
import subprocess
import sys

import pytest

from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.studies import speed

HERE = pathlib.Path(__file__).resolve().parent


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    if "SLIDELINE_BUILD" not in os.environ:
        pytest.skip("SLIDELINE_BUILD is not set")
    out = tmp_path_factory.mktemp("bench")
    subprocess.run([sys.executable, HERE / "bench.py", "--build", os.environ["SLIDELINE_BUILD"],
                    "--out", out, "--quick", "--threads", "2"], check=True)
    return out


def test_table_has_every_part(folder):
    bench = speed.Bench(folder / "bench.csv")
    assert bench.value("unit", "yardstick") > 0.0
    assert bench.value("unit", "routine", name="over_yardstick") > 0.5
    assert bench.value("unit", "bandwidth", threads=2) > 0.0
    for material in ("elastic", "yielding"):
        for threads in (1, 2):
            rows = bench.of("step", material, threads)
            assert [row["size"] for row in rows] == [100, 306]
            assert all(row["median"] > 0.0 and row["over_goal"] > 0.0 for row in rows)
        assert [row["size"] for row in bench.of("step", material + speed.AT_ONCE)] == [100, 306]
    for ctype in ALL_TYPES:
        assert [row["size"] for row in speed.contact_rows(bench, "flat", ctype)] == [10, 20]
    assert len(speed.search_lines(bench, "search")) == 4 * 3
    assert bench.value("output", "states over plain file") > 0.0


def test_page_is_written(folder, tmp_path):
    speed.write(folder, tmp_path)
    text = (tmp_path / "studies" / "speed.md").read_text(encoding="utf-8")
    assert "nan" not in text
    assert (tmp_path / "pictures" / "speed.png").exists()
