# SPDX-License-Identifier: MIT
"""The pages of speed and peers, from made-up tables of the benchmarks (tests/lab/bench)."""
import csv
import itertools
import json
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "lab" / "bench"))

import measuring  # noqa: E402
import search  # noqa: E402
from slideline_tools.contact_types import ALL_TYPES  # noqa: E402
from slideline_tools.studies import peers, speed  # noqa: E402

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
    rows = bench_rows()
    with open(tmp_path / "bench.csv", "w", newline="", encoding="ascii") as stream:
        writer = csv.DictWriter(stream, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    (tmp_path / "machine.json").write_text(json.dumps({"processor": "of a test"}))
    assert speed.main([str(tmp_path), str(tmp_path / "doc")]) == 0
    text = (tmp_path / "doc" / "studies" / "speed.md").read_text(encoding="utf-8")
    assert "elastic, 4000 to 100 000 elements, step over K, the largest: **2.50**" in text
    kept = [line.endswith("kept") for line in text.splitlines() if "step over K" in line and "**" in line]
    assert kept == [True, False]
    assert "type 3, 1000 to 1000 slave nodes, K per contact point, the most (at 1000 slave nodes): **3.00**, goal at most 6.4: kept" in text
    assert "type 7, 1000 to 1000 slave nodes, K per contact point, the most (at 1000 slave nodes): **7.00**, goal at most 6.4: missed" in text
    assert "type 3, 20 slave nodes (20 points), K a step: **60.00**, goal at most 455: kept\n" in text
    assert "Here 4.00 ns." in text and "Here 12.00 ns = 3.00 K" in text
    assert "element routine over K: **3.00**, goal at most 2: missed" in text
    assert "| yardstick | 96 | 45.6 | 1.00 |\n| element routine | 64 | 91.3 | 2.00 |" in text
    assert "elastic, the same sizes, speed-up of two threads, the least: **1.95**, goal at least 1.9: kept" in text
    assert "yielding, the same sizes, two threads over one of two runs at once: 1.56 to 1.56\n" in text
    assert "| elements | elastic, 1 thread | elastic, 2 threads | elastic, 2 runs at once |" in text
    assert "processor: of a test" in text
    assert (tmp_path / "doc" / "pictures" / "speed_search.png").exists()


def test_page_of_speed_says_when_the_machine_was_shared():
    bench = speed.Bench.__new__(speed.Bench)
    bench.rows = [measuring.summarise(STEP, [(10.0, 4.0, 8.0, share)]) for share in (1.0, 0.5)]
    assert "50 to 100 % with 1 thread" in speed.disturbed(bench)
    assert "shared the machine" in speed.disturbed(bench)
    bench.rows = bench.rows[:1]
    at_once = measuring.Variant("step", "elastic, 2 runs at once", 4000, 1, "ns/element")
    bench.rows.append(measuring.summarise(at_once, [(10.0, 4.0, 8.0, 0.5)]))
    assert "shared the machine" not in speed.disturbed(bench)


def test_times_of_one_thread_are_freed_of_others():
    assert measuring.without_others(10.0, 0.5, 1, 1.0) == 5.0
    assert measuring.without_others(10.0, 0.98, 1, 1.0) == 10.0
    assert measuring.without_others(10.0, 0.5, 2, 1.0) == 10.0
    assert measuring.without_others(10.0, 0.5, 1, 0.01) == 10.0


def test_ratios_of_peers_are_taken_round_by_round():
    ours = [{"round": "1", "ns": "10"}, {"round": "2", "ns": "20"}, {"round": "3", "ns": "10"}]
    other = [{"round": "1", "ns": "40"}, {"round": "2", "ns": "80"}, {"round": "3", "ns": "50"}]
    assert peers.ratio(other, ours, "ns") == 4.0


def test_page_of_peers(tmp_path):
    waves = [{"round": n, "program": program, "element": element, "elements": 100, "steps": 10,
              "ns": ns * n, "free_side": 0.5 + error, "exact": 0.5, "yardstick_ns": 2.0 * n}
             for n in (1, 2) for program, element, ns, error in (
                 ("slideline", "one point, large strain", 10.0, 1e-3),
                 ("slideline", "2x2 points, large strain", 30.0, 1e-3),
                 ("Other", "2x2 points", 90.0, 2e-3))]
    contact = [{"round": n, "scene": "patch", "elements": 41, "program": program,
                "contact": contact, "mean": mean, "exact": 1.0, "deviation": deviation,
                "processor_seconds": used * n, "seconds": used, "yardstick_ns": 2.0 * n, "message": message}
               for n in (1, 2) for program, contact, mean, deviation, used, message in (
                   ("slideline", "type 5", 1.0, 1e-15, 0.1, ""),
                   ("CalculiX", "node to surface", 1.02, 0.03, 0.25, ""),
                   ("CalculiX", "mortar", "nan", "nan", 0.1, "*ERROR: node 17 is tied"))]
    strikes = [{"round": n, "program": program, "contact": contact, "elements": 164, "steps": 10, "ns": ns * n, "upper": upper,
                "lower": -0.9, "momentum": upper - 0.9, "yardstick_ns": 2.0 * n}
               for n in (1, 2) for program, contact, ns, upper in (
                   ("slideline", "type 2", 40.0, 0.9), ("Other", "penalty", 120.0, 1.4), ("Third", "penalty", 80.0, 0.9))]
    counts = [{"round": 1, "scene": scene, "elements": elements, "program": program, "what": what, "instructions": count,
               "counted_by": "callgrind, x86-64-v3"} for scene, elements, program, what, count in (
                   ("collision", 164, "Other", "penalty", 777.7), ("step", 100, "Other", "2x2 points", 1234.4), ("patch", 41, "CalculiX", "node to surface", 2.5e8))]
    for name, rows in (("elements", waves), ("collision", strikes), ("contact", contact), ("counts", counts)):
        with open(tmp_path / f"{name}.csv", "w", newline="", encoding="ascii") as stream:
            writer = csv.DictWriter(stream, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)
    (tmp_path / "versions.txt").write_text("akantu==1.2.3\nslideline 7.8 (source abc)\nflags -O9\nThis is Version 2.20\n")
    assert peers.main([str(tmp_path), str(tmp_path / "doc")]) == 0
    text = (tmp_path / "doc" / "studies" / "peers.md").read_text(encoding="utf-8")
    assert "| akantu | 1.2.3 | PyPI, wheel |" in text and "version 7.8 (source abc), built with `-O9`" in text
    assert "Other (2x2 points) takes 3.0 to 3.0 times as long as slideline's element with 2x2 points and 9.0 to 9.0" in text
    assert "within 1e-03 of each other" in text
    assert "| patch | 41 | CalculiX | node to surface | 1.02 | 2.0e-02 | 3.0e-02 | 0.375 (0.312 to 0.438) | 125 | 250 |" in text
    assert "| 1234 | 0.50200000 |" in text and "Counted by callgrind, x86-64-v3" in text
    assert "takes 2.50 times the processor time" in text
    assert "| 164 | Other | penalty | 180 (150 to 210) | 60 | 778 | 1.4000 | -0.9000 | 5.0e-01 |" in text
    assert "164 elements: Other, penalty, takes 3.0 times as long as slideline with type 2" in text
    assert text.count("contact forces do not balance") == 1 and "Other's contact forces do not balance: it makes 0.5 times" in text
    assert "median 3.00 ns, from 2.00 to 4.00" in text
    assert text.count("refused (`*ERROR: node is tied`)") == 1
    (tmp_path / "counts.csv").unlink()
    assert peers.main([str(tmp_path), str(tmp_path / "doc")]) == 0
    assert "No instructions were counted" in (tmp_path / "doc" / "studies" / "peers.md").read_text(encoding="utf-8")


def test_the_page_says_how_openradioss_was_built_or_that_it_was_not(tmp_path):
    versions = tmp_path / "versions.txt"
    versions.write_text("akantu==5.0\n")
    assert peers.radioss_in_words(versions) == peers.NOT_BUILT
    versions.write_text("akantu==5.0\nOpenRadioss==source abc, gfortran with x==1\n")
    assert "source abc, gfortran with x==1" in peers.radioss_in_words(versions)
    assert "OpenRadioss" not in peers.version_rows(versions)
