# SPDX-License-Identifier: MIT
"""The pages of speed and peers, from made-up tables of the benchmarks (tests/lab/bench)."""
import itertools
import json
import pathlib
import sys

import pandas as pd
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "lab" / "bench"), str(ROOT / "tests" / "lab" / "bench" / "peers")]

import measuring  # noqa: E402
import peers_page as peers  # noqa: E402
import search  # noqa: E402
import speed_page as speed  # noqa: E402
from slideline_tools import UserError  # noqa: E402
from slideline_tools.contact_types import ALL_TYPES  # noqa: E402

STEP = measuring.Variant("step", "elastic", 4000, 1, "ns/element")


def test_disturbed_samples_are_left_out():
    samples = [(10.0, 2.0, 8.0, 0.99), (50.0, 2.0, 8.0, 0.5), (60.0, 2.0, 8.0, 0.4),
               (11.0, 2.0, 8.0, 0.98), (12.0, 2.0, 8.0, 1.0)]
    assert sorted(s[0] for s in measuring.least_disturbed(samples)) == [10.0, 11.0, 12.0]


def test_the_better_half_is_kept_where_all_are_disturbed():
    samples = [(float(k), 2.0, 8.0, 0.1 * k) for k in range(1, 6)]
    assert sorted(s[0] for s in measuring.least_disturbed(samples)) == [3.0, 4.0, 5.0]


def test_ratios_are_those_of_the_same_minute():
    # The second round is twice as slow in everything: the ratio to K must not see it.
    row = measuring.summarise(STEP, [(10.0, 4.0, 8.0, 1.0), (20.0, 8.0, 4.0, 1.0)])
    assert row["over_yardstick"] == pytest.approx(2.5)
    assert row["over_bandwidth"] == pytest.approx(10.0 * 8.0 / measuring.BYTES)
    assert row["over_goal"] == pytest.approx(10.0 / (3.3 * 4.0 + 220.0 / 8.0))
    assert (row["low"], row["median"], row["high"]) == (12.5, 15.0, 17.5)


# ---- pages -------------------------------------------------------------------------------------

def bench_rows():
    """A small table: the elastic step keeps the goal at 4000 elements, the yielding one does not."""
    rows = []
    for material, ns in (("elastic", 10.0), ("yielding", 15.0)):
        for threads, gain in ((1, 1.0), (2, 1.95)):
            variant = measuring.Variant("step", material, 4000, threads, "ns/element")
            rows.append(measuring.summarise(variant, [(ns / gain, 4.0, 8.0, 1.0)]))
        variant = measuring.Variant("step", f"{material}, 2 runs at once", 4000, 1, "ns/element")
        rows.append(measuring.summarise(variant, [(0.8 * ns, 4.0, 8.0, 1.0)]))
    for ctype in ALL_TYPES:
        for size, unit in itertools.product((20, 1000), ("ns/slave node", "ns/point")):
            variant = measuring.Variant("contact", f"flat type {ctype}", size, 1, unit)
            rows.append(measuring.summarise(variant, [(4.0 * ctype, 4.0, 8.0, 1.0)]))
    for case in search.CASES:
        for kind in ("search", "whole"):
            for size, ns in ((1000, 8.0), (64000, 9.0)):
                variant = measuring.Variant("search", f"{case} type 1 {kind}", size, 1,
                                            "ns/slave node")
                rows.append(measuring.summarise(variant, [(ns, 4.0, 8.0, 1.0)]))
    for case, unit, value in (("yardstick", "ns/element", 4.0), ("routine", "ns/element", 12.0), ("bandwidth", "GB/s", 8.0)):
        rows.append(measuring.summarise(measuring.Variant("unit", case, 64, 1, unit),
                                        [(value, 4.0, 8.0, 1.0)]))
    for case, size, value in (("yardstick", 96, 45.64), ("element routine", 64, 91.28)):
        rows.append(measuring.summarise(measuring.Variant("count", case, size, 1, "instructions/element"),
                                        [(value, 1.0, 1.0, 1.0)]))
    return rows


def test_page_of_speed_judges_the_goals(tmp_path):
    pd.DataFrame(bench_rows()).to_csv(tmp_path / "bench.csv", index=False)
    (tmp_path / "machine.json").write_text(json.dumps({"processor": "of a test"}))
    speed.write(tmp_path, tmp_path / "doc")
    text = (tmp_path / "doc" / "studies" / "speed.md").read_text(encoding="utf-8")
    for line in ("| elastic, 4000 to 100 000 elements over K | 2.50 to 2.50 | at most 3.6 | kept |",
                 "| yielding, 4000 to 100 000 elements over K | 3.75 to 3.75 | at most 3.6 | missed |",
                 "| elastic, the same sizes, speed-up of two threads | 1.95 to 1.95 | at least 1.9 | kept |",
                 "| type 7, from 100 slave nodes, K a point | 7.00 to 7.00 | at most 6.4 | missed |",
                 "| type 3, 20 slave nodes, K a step | 60.00 to 60.00 | at most 455 | kept |",
                 "| element routine over K | 3.00 to 3.00 | at most 2 | missed |",
                 "| element routine | 64 | 91.28 | 2.00 |",
                 "| flat | 3 two-pass NTS-AR | 12.0 (3.00 K) | 12.0 (3.00 K) |",
                 "| 4000 | 10.00 ns = 2.50 K | 8.00 ns = 2.00 K | 5.13 ns = 1.28 K |"):
        assert line in text
    assert "The runs of the step got 100% to 100%" in " ".join(text.split())
    assert "processor: of a test" in text and (tmp_path / "doc" / "pictures" / "speed.png").exists()


def test_times_of_one_thread_are_freed_of_others():
    assert measuring.without_others(10.0, 0.5, 1, 1.0) == 5.0
    assert measuring.without_others(10.0, 0.98, 1, 1.0) == 10.0
    assert measuring.without_others(10.0, 0.5, 2, 1.0) == 10.0
    assert measuring.without_others(10.0, 0.5, 1, 0.01) == 10.0


def test_page_of_peers(tmp_path):
    """The second round is twice as slow in everything: ratios do not see it."""
    waves = [{"round": n, "program": program, "element": element, "elements": 100, "ns": ns * n, "free_side": 0.5 + error,
              "exact": 0.5, "yardstick_ns": 2.0 * n}
             for n in (1, 2) for program, element, ns, error in (
                 ("slideline", "one point, large strain", 10.0, 1e-3), ("slideline", "2x2 points, large strain", 30.0, 1e-3),
                 ("Other", "2x2 points", 90.0, 2e-3))]
    contact = [{"round": n, "scene": "patch", "elements": 41, "program": program, "contact": contact, "mean": mean, "exact": 1.0,
                "deviation": deviation, "processor_seconds": used * n, "yardstick_ns": 2.0 * n}
               for n in (1, 2) for program, contact, mean, deviation, used in (
                   ("slideline", "type 5", 1.0, 1e-15, 0.1), ("CalculiX", "node to surface", 1.02, 0.03, 0.25),
                   ("CalculiX", "mortar", "nan", "nan", 0.1))]
    strikes = [{"round": n, "program": program, "contact": contact, "elements": 164, "ns": ns * n, "upper": upper, "lower": -0.9,
                "momentum": upper - 0.9, "yardstick_ns": 2.0 * n}
               for n in (1, 2) for program, contact, ns, upper in (
                   ("slideline", "type 2", 40.0, 0.9), ("Other", "penalty", 120.0, 1.4))]
    counts = [{"scene": scene, "elements": elements, "program": program, "what": what, "instructions": count,
               "counted_by": "callgrind, x86-64-v3"} for scene, elements, program, what, count in (
                   ("collision", 164, "Other", "penalty", 778.0), ("step", 100, "Other", "2x2 points", 1234.0))]
    for name, rows in (("elements", waves), ("collision", strikes), ("contact", contact), ("counts", counts)):
        pd.DataFrame(rows).to_csv(tmp_path / f"{name}.csv", index=False)
    (tmp_path / "versions.txt").write_text("akantu==1.2.3\nslideline 7.8 (source abc)\nflags -O9\nThis is Version 2.20\n")
    peers.write(tmp_path, tmp_path / "doc")
    text = (tmp_path / "doc" / "studies" / "peers.md").read_text(encoding="utf-8")
    for line in ("| akantu | 1.2.3 |", "| slideline | 7.8 (source abc) |", "| CalculiX | 2.20 |",
                 "| 100 | Other | 2x2 points | 135 (112 to 158) | 45 | 3.00 | 1234 | 0.50200000 | +2.0e-03 |",
                 "| 164 | Other | penalty | 180 (150 to 210) | 60 | 3.00 | 778 | 1.4000 | -0.9000 | 5.0e-01 |",
                 "| 41 | CalculiX | node to surface | 0.375 (0.312 to 0.438) | 125 | 2.50 |  | 1.02 | 2.0e-02 | 3.0e-02 |",
                 "| 41 | CalculiX | mortar | 0.15 (0.125 to 0.175) | 50 | 1.00 |  |  | refused | refused |"):
        assert line in text
    assert "within 1e-03 of each other" in text and "Counted by callgrind, x86-64-v3" in text
    (tmp_path / "counts.csv").unlink()
    peers.write(tmp_path, tmp_path / "doc")
    assert "No instructions were counted" in (tmp_path / "doc" / "studies" / "peers.md").read_text(encoding="utf-8")
    with pytest.raises(UserError, match="run.sh"):
        peers.write(tmp_path / "nowhere", tmp_path)
