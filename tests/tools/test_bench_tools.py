# SPDX-License-Identifier: MIT
"""What the benchmarks make of samples, their decks, and the pages of speed and peers, from made-up tables."""
import csv
import itertools
import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "bench"), str(ROOT / "tests" / "bench" / "peers")]

import calculix  # noqa: E402
import collision  # noqa: E402
import counted  # noqa: E402
import elements  # noqa: E402
import measuring  # noqa: E402
import search  # noqa: E402
import wave  # noqa: E402
from slideline_tools import UserError  # noqa: E402
from slideline_tools.contact_types import ALL_TYPES  # noqa: E402
from slideline_tools.counting import Counts  # noqa: E402
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


def test_samples_over_an_older_unit_are_refused(tmp_path):
    (tmp_path / "program").write_text("1")
    (tmp_path / "s.csv").write_text("part,case,size,threads,unit,value,kernel_ns,bandwidth_gb_s,share,program\n")
    with pytest.raises(SystemExit, match="older unit"):
        measuring.Samples(tmp_path / "s.csv", tmp_path / "program")


def test_samples_of_another_program_are_left_alone(tmp_path):
    first, second = tmp_path / "first", tmp_path / "second"
    first.write_text("1")
    second.write_text("2")
    units = measuring.Units(4.0, {1: 8.0, 2: 16.0})
    measuring.Samples(tmp_path / "s.csv", first).add(STEP, 10.0, units)
    samples = measuring.Samples(tmp_path / "s.csv", second)
    samples.add(STEP, 30.0, units, 0.5)
    assert samples.of_program() == {STEP: [(30.0, 4.0, 8.0, 0.5)]}


def test_bandwidth_is_that_of_as_many_threads(tmp_path):
    (tmp_path / "program").write_text("1")
    samples = measuring.Samples(tmp_path / "s.csv", tmp_path / "program")
    two = measuring.Variant("step", "elastic", 4000, 2, "ns/element")
    samples.add(two, 10.0, measuring.Units(4.0, {1: 8.0, 2: 16.0}))
    assert samples.of_program()[two][0][2] == 16.0


def test_a_run_that_takes_too_long_is_no_sample(tmp_path, monkeypatch):
    slow = tmp_path / "slow"
    slow.write_text("#!/bin/sh\nexec sleep 20\n")
    slow.chmod(0o755)
    monkeypatch.setattr(measuring, "LONGEST", 0.2)
    with pytest.raises(measuring.Disturbed):
        measuring.run_program(slow, "deck.k", tmp_path)


# ---- decks -------------------------------------------------------------------------------------

def test_block_of_about_as_many_elements(tmp_path):
    count = elements.write_deck(tmp_path / "block.k", 300, True, steps=20)
    assert abs(count - 300) <= 10
    mesh = (tmp_path / "mesh_17x18.inc").read_text().split("*ELEMENT_SHELL\n")
    assert len(mesh[0].splitlines()) == 2 + 18 * 19
    assert mesh[1].splitlines()[0].split() == ["1", "1", "1", "20", "21", "2"]


def test_steps_are_counted_as_taken(tmp_path):
    """Elements that get shorter take more steps than the deck was planned for."""
    (tmp_path / "bench.timing.csv").write_text("phase,seconds,calls\nelements,1.5,40\nnodes,0.5,80\n")
    assert elements.step_time(tmp_path, {"elements": 1.5, "nodes": 0.5}, 1000) == pytest.approx(5.0e4)


@pytest.mark.parametrize("case", search.CASES)
def test_search_deck_runs_with_contact(case, tmp_path):
    text = search.search_deck(case, 200)
    assert search.slave_nodes(case, 200)[0] == 200
    assert text.count("*CONTACT_2D_SLIDELINE") == (50 if case == "interfaces" else 1)
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    (tmp_path / "s.k").write_text(text)
    text = text.replace("*DATABASE_GLSTAT", f"*DATABASE_RCFORC\n{10.0 * search.STEP:.9g},\n*DATABASE_GLSTAT")
    (tmp_path / "s.k").write_text(text)
    subprocess.run([os.environ["SLIDELINE"], f"i={tmp_path}/s.k", f"d={tmp_path}", "jobid=s"],
                   check=True, capture_output=True)
    with open(tmp_path / "s.rcforc.csv", newline="", encoding="ascii") as stream:
        rows = [row for row in csv.DictReader(stream) if row["side"] == "slave"]
    assert max(float(row["fy"]) for row in rows) > 0.0
    assert max(int(row["n_active"]) for row in rows) > 0


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


def test_stresses_of_calculix_are_those_of_the_last_state(tmp_path):
    head = " stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz) for set EALL and time  {}\n\n"
    line = "{:10d}{:4d} 0.0 {:13.6E} 0.0 0.0 0.0 0.0\n"
    text = head.format(0.5) + line.format(1, 1, -9.0) + "\n" + head.format(1.0) + line.format(
        1, 1, -1.0) + line.format(1, 2, -3.0) + line.format(7, 1, -4.0)
    (tmp_path / "a.dat").write_text(text)
    assert calculix.stresses(tmp_path / "a.dat") == {1: -2.0, 7: -4.0}


def test_mesh_of_the_peers_is_that_of_slideline():
    points, quads = wave.grid(3)
    assert len(points) == 16 and len(quads) == 9
    x, y = points[quads[4]].T
    area = 0.5 * sum(x[k] * y[(k + 1) % 4] - x[(k + 1) % 4] * y[k] for k in range(4))
    assert area == pytest.approx(1.0 / 9.0)


def test_blocks_of_the_collision_have_the_mass_of_the_grid(capsys):
    n, m = 10, collision.below(10)
    assert collision.weights(n).sum() == pytest.approx(1.0) and collision.elements(n) == 164
    assert collision.steps(n) * collision.step(n) >= 4.0 * collision.LENGTH / collision.C
    speeds = np.full((n + 1) ** 2, -0.5 * collision.V), np.full((m + 1) ** 2, 0.25 * collision.V)
    collision.report("Some", "contact", n, 5, 164.0e-8, speeds)
    found = json.loads(capsys.readouterr().out)
    assert found["ns"] == pytest.approx(2.0)
    assert [found[name] for name in ("upper", "lower", "momentum")] == pytest.approx([-1.0, 0.5, -0.5])


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


def test_counted_steps_of_peers_are_the_difference_of_two_runs(tmp_path, monkeypatch):
    commands = {"few": 5000, "many": 9000}
    def count(command, folder):
        if command not in commands:
            raise UserError("no such program")
        return Counts(commands[command], {}, "somebody")
    monkeypatch.setattr(counted, "count_instructions", count)
    labels = {"elements": 20, "program": "Other", "element": "2x2 points", "steps": 10}
    assert counted.step_row(labels, ("few", "many"), tmp_path) == [
        {"scene": "step", "elements": 20, "program": "Other", "what": "2x2 points", "instructions": 20.0,
         "counted_by": "somebody"}]
    assert counted.step_row(labels, ("few", "none"), tmp_path) == []
