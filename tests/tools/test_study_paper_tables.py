# SPDX-License-Identifier: MIT
"""The study paper-tables: its runs, its medians, its charts and page, and one real run of it."""
import os
import pathlib
import re
import subprocess
import sys

import pandas as pd
import pytest

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.studies import __main__ as command
from slideline_tools.studies import paper_tables
from slideline_tools.studies.framework import times
from slideline_tools.studies.framework.job import Options, interleave, part_of

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROCESSOR = "slow one, 1 logical cores"

TABLE = """phase,seconds,calls,share
elements,0.5,11,0.1
contact_search,0.25,11,0.1
contact_pairing,0.125,11,0.1
contact_force,1.0,11,0.1
nodes,2.0,11,0.1
output,8.0,11,0.1
input,4.0,1,0.1
solver,0.0,0,0.0
total,16.0,1,1.0
"""


def test_phases_of_a_timing_table(tmp_path):
    path = tmp_path / "x.timing.csv"
    path.write_text(TABLE)
    row = times.phases(path)
    assert (row["search"], row["pairing"], row["force"], row["contact"]) == (0.25, 0.125, 1.0, 1.375)
    assert (row["total"], row["computing"], row["element_calls"]) == (16.0, 4.0, 11)
    path.write_text(TABLE.replace("contact_force", "contact_else"))
    with pytest.raises(UserError, match="no phase 'contact_force'"):
        times.phases(path)


def row(scene, level, ctype, steps, slow=1.0, state="finished"):
    """A run whose machine was `slow` times slower."""
    a, m, b = (slow * step for step in steps)
    return {"state": state, "scene": scene, "level": level, "type": ctype, "search": a, "pairing": m,
            "force": b, "contact": a + m + b, "elements": slow * 10.0, "element_calls": 10,
            "computing": slow * (39.0 + ctype), "points": 10 * ctype, "processor": PROCESSOR, "load": 1.5,
            "quick": 0}


def all_rows():
    """Three rounds of every variant; type k costs k times type 1; half of the runs on a slow spell."""
    rows = []
    for name, scene in paper_tables.SCENES.items():
        for level in scene.levels:
            for number in range(3):
                rows += [row(name, level, k, (2.0 * k, 1.0 * k, 1.0 * k), 1.0 + (number + k) % 2)
                         for k in ALL_TYPES]
    return pd.DataFrame(rows)


def test_medians_are_free_of_the_pace_of_the_machine():
    found = times.Times(all_rows(), "collision")
    assert found.levels == [1, 2, 3, 4] and found.rounds == 3
    assert [found.ratio(2, k) for k in ALL_TYPES] == pytest.approx(ALL_TYPES, rel=1e-14)
    assert found.ratio(2, 6, "search") == pytest.approx(3.0, rel=1e-14)
    assert found.share(3, 5) == pytest.approx(20.0 / 44.0, rel=1e-14)
    assert found.computing_ratio(3, 5) == pytest.approx(44.0 / 40.0, rel=1e-14)
    assert found.points[3] == {k: 10 * k for k in ALL_TYPES}
    assert found.spread == pytest.approx(0.0, abs=1e-14)


def test_median_is_not_moved_by_one_disturbed_run():
    rows = [row("sliding", 1, 1, (1.0, 0.0, 1.0))] * 3
    rows += [row("sliding", 1, 5, (1.0, 1.0, b)) for b in (1.0, 1.2, 99.0)]
    assert times.Times(pd.DataFrame(rows), "sliding").ratio(1, 5) == pytest.approx(3.2 / 2.0)
    rows.append(row("sliding", 1, 4, (1.0, 1.0, 1.0), state="failed"))
    assert not times.Times(pd.DataFrame(rows), "sliding").has(1, 4)
    with pytest.raises(UserError, match="no timing runs"):
        times.Times(pd.DataFrame(rows), "collision")


def test_the_paper_s_ratios_are_those_of_its_tables():
    """From the seconds it prints, which have fewer digits than its ratios."""
    seconds = {"sliding": {1: (62, 451, 1446), 3: (140, 1020, 3269), 4: (130, 941, 3177),
                           5: (76, 493, 1623), 6: (310, 2474, 8462)},
               "collision": {1: (3, 23, 74, 170), 3: (6, 45, 143, 328), 4: (7, 46, 150, 348),
                             5: (4, 25, 78, 179), 6: (11, 85, 281, 642)}}
    for scene, columns in seconds.items():
        for ctype, ratios in paper_tables.SCENES[scene].paper.items():
            for level, ratio in ratios.items():
                mine, base = columns[ctype][level - 1], columns[1][level - 1]
                assert (mine - 0.5) / (base + 0.5) - 0.005 <= ratio <= (mine + 0.5) / (base - 0.5) + 0.005


def test_runs_are_alone_interleaved_and_include_type_1():
    options = Options(levels=(1, 2), types=(5,), repeats=2)
    jobs = interleave(paper_tables.jobs(options), 2)
    assert all(job.alone != job.counted for job in jobs)
    assert {job.labels["level"] for job in jobs if job.counted} == {1}
    assert [job.labels["type"] for job in jobs[:2]] == [1, 5]
    assert {(job.labels["scene"], job.labels["level"]) for job in jobs} == {
        ("block_implicit", 1), ("block", 1), ("sliding", 1), ("sliding", 2), ("collision", 1),
        ("collision", 2)}
    assert sum(job.name == "collision_2_type_5" for job in jobs) == 2 * 6
    for index in range(3):
        part = part_of(jobs, index, 3)
        groups = {job.group for job in part}
        assert len(part) == sum(job.group in groups for job in jobs)


def test_quick_is_shorter():
    full, quick = (next(job for job in paper_tables.jobs(Options(quick=quick))
                        if job.name == "sliding_1_type_1") for quick in (False, True))
    assert [word for word in quick.options if word not in full.options] == ["endtim=2.0e-3"]
    assert not any(job.counted for job in paper_tables.jobs(Options(quick=True)))


def test_charts_and_page(tmp_path):
    rows = all_rows()
    paper_tables.chart(rows[rows["scene"].isin(["block", "sliding"])], tmp_path)
    names = {f"{name}.{kind}" for kind in ("svg", "png") for name in
             ("block_contact_time", "sliding_contact_time", "sliding_ratio_by_level")}
    assert {path.name for path in tmp_path.iterdir()} == names
    first = (tmp_path / "block_contact_time.svg").read_text()
    paper_tables.chart(rows[rows["scene"] == "block"], tmp_path)
    assert (tmp_path / "block_contact_time.svg").read_text() == first
    paper_tables.page(rows, tmp_path / "doc")
    page = (tmp_path / "doc/studies/paper_tables.md").read_text()
    assert re.search(r"\| 5 NTS-mAR \| \S+ s, 5.00 \(1.22\) \| \S+ s, 5.00 \(1.09\)", page)
    assert "| 4 VTS-PPT | 2.00 | 1.00 | 1.00 | 4.00 | 37.2 % | 1.07 | 40 |" in page
    assert PROCESSOR in page and "Load of the machine: 1.5." in page and "quick run" not in page
    assert (tmp_path / "doc/pictures/paper_tables.png").stat().st_size < 100_000


def test_time_of_a_slave_node_is_that_of_the_paper_s_seconds():
    found = times.Times(all_rows(), "sliding")
    assert paper_tables.slave_node_time(found, 62.0, 150_000) == pytest.approx(62e9 / 150e3 / 19)
    assert paper_tables.slave_node_time(found, 1.0) == pytest.approx(1e9 / 9 / 19)
    text = paper_tables.reading(found, times.Times(all_rows(), "collision"))
    assert "costs 5.00 to 5.00 times type 1" in text and "make 22 and 12 microseconds" in text
    assert "is 0.50 to 0.50 of the contact time of type 1" in text
    assert "type 4 takes 0.80 times as long as type 5 in the sliding" in text
    assert paper_tables.reading(found, None) == ""


def test_durations_have_three_digits():
    assert [paper_tables.duration(x) for x in (0.00034567, 0.99, 1.2345)] == ["0.346 ms", "990 ms",
                                                                           "1.23 s"]


def test_page_without_type_1_is_refused(tmp_path):
    rows = pd.DataFrame([row("sliding", 1, 5, (1.0, 1.0, 1.0))])
    paper_tables.chart(rows, tmp_path)
    with pytest.raises(UserError, match="type 1"):
        paper_tables.page(rows, tmp_path / "doc")


# ---- with the program --------------------------------------------------------------------------

A_FEW = ("--quick", "--types", "1", "--only", "block_1*", "--repeats", "1")


def test_a_few_real_runs(slideline, tmp_path, plain_pictures):
    arguments = ["paper-tables", "--program", slideline, "--folder", str(tmp_path), *A_FEW]
    assert command.main(arguments) == 0
    rows = pd.read_csv(tmp_path / "paper-tables.csv")
    assert rows["repeat"].tolist() == list(range(1, 13)) and set(rows["state"]) == {"finished"}
    for _, one in rows.iterrows():
        assert one["search"] > 0.0 and one["force"] > 0.0
        assert one["computing"] < one["total"] < one["seconds"]
        assert one["points"] == 52
    before = (tmp_path / "paper-tables.csv").read_bytes()
    assert command.main(arguments) == 0
    assert (tmp_path / "paper-tables.csv").read_bytes() == before


def test_points_of_a_short_contact_are_found(slideline, tmp_path):
    """The bodies of the collision touch for a tenth of the run: all nodes of the slave at once."""
    job = next(job for job in paper_tables.jobs(Options()) if job.name == "collision_1_type_1")
    (tmp_path / "deck.k").write_text(job.deck, encoding="ascii")
    subprocess.run([slideline, "i=deck.k", f"jobid={job.jobid}", *job.options], cwd=tmp_path, check=True,
                   capture_output=True)
    assert paper_tables.measure(job, tmp_path)["points"] == 25


def test_array_script_shares_the_runs_out(slideline, tmp_path):
    """The batch script, called as the scheduler calls each of two tasks, then to collect."""
    script = ROOT / "tools/batch/study_array.sh"
    arguments = ["sh", str(script), "paper-tables", "--program", slideline, "--folder",
                 str(tmp_path / "sweep"), "--quick", "--types", "1", "--repeats", "1", "--only",
                 "[bs]*[tg]_1_type_1"]  # scenes of one run a round
    environment = {**os.environ, "PYTHON": sys.executable, "SLURM_SUBMIT_DIR": str(ROOT),
                   "PYTHONPATH": str(ROOT / "tools")}
    counts = []
    for task in ("0", "1", None):
        array = {} if task is None else {"SLURM_ARRAY_TASK_ID": task, "SLURM_ARRAY_TASK_COUNT": "2"}
        done = subprocess.run([*arguments, *([] if task else ["--collect"])], check=False, text=True,
                              env={**environment, **array}, capture_output=True)
        assert done.returncode == 0, done.stderr
        counts.append(len(list((tmp_path / "sweep" / "runs").glob("*/job.json"))))
        assert (tmp_path / "sweep" / "paper-tables.csv").exists() == (task is None)
    # Groups in turn: implicit block, then sliding.
    assert counts == [1, 2, 2]
    assert "2 runs\n" in done.stdout
