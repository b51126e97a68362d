# SPDX-License-Identifier: MIT
"""The block-to-block study: numbers of its table from known pressures, and the page of a run."""
import subprocess
import sys

import conftest
import numpy as np
import pytest

from slideline_tools import UserError, counting, scenes
from slideline_tools.histories import History
from slideline_tools.prose import too_wide
from slideline_tools.studies import block, block_implicit
from slideline_tools.studies.common import study_main

CHAIN = conftest.ROOT / "tests" / "verification" / "block_to_block" / "chain.py"


def test_half_segments_add_up_and_ends_have_one_half():
    np.testing.assert_allclose(block.half_segments(np.array([0.0, 1.0, 3.0])), [0.5, 1.5, 1.0])


@pytest.mark.parametrize("ctype, springs", [(1, 4), (2, 3), (3, 5), (4, 3), (5, 3), (6, 3), (7, 3)])
def test_springs_of_the_interface(ctype, springs):
    assert block.interface_stiffness(ctype, 3, 2) == pytest.approx(springs * 1.0e5)


def test_chain_of_another_stiffness_is_refused():
    chain = History("chain", {"penalty": np.array([1.0, 1.0, 2.0]), "pressure": np.array([3, 4, 5])})
    assert block.chain_pressure(chain, 1.0) == 4.0
    with pytest.raises(UserError, match="1.5"):
        block.chain_pressure(chain, 1.5)


@pytest.mark.parametrize("worst, verdict", [(1.0e-3, "no"), (1.0e-10, "yes")])
def test_row_judges_both_sides(worst, verdict):
    x = np.arange(3.0)
    level, bent = np.full(3, 50.0), 50.0 * np.array([1.0, 1.0 - worst, 1.0])
    row = dict(zip(block.COLUMNS, block.table_row(
        2, block.Pressures(x, level, x, bent, 0.25, 100.0), 50.0)))
    assert row["type"] == "2 NTS-AR"
    assert row["master: min"] == pytest.approx(-worst, rel=1e-4)
    assert row["uniform to 1e-08"] == verdict


def test_page_of_a_run(slideline, tmp_path, plain_pictures):
    deck = tmp_path / "block.k"
    deck.write_text(scenes.block(2), encoding="ascii")
    folder = tmp_path / "type_2"
    finished = subprocess.run([slideline, f"i={deck}", f"d={folder}", "jobid=block"],
                              capture_output=True, text=True, check=False)
    assert finished.returncode == 0, finished.stdout + finished.stderr
    with open(tmp_path / "chain.csv", "w", encoding="ascii") as stream:
        subprocess.run([sys.executable, CHAIN, "5.1e6"], stdout=stream, check=True)
    assert study_main("block", block.write, [str(tmp_path), str(tmp_path / "doc"), "--types", "2"]) == 0
    page = (tmp_path / "doc" / "studies" / "block_to_block.md").read_text()
    assert "| 2 NTS-AR |" in page and too_wide(page) == []
    assert (tmp_path / "doc" / "pictures" / "block_pressure.png").exists()
    # Forces of both sides, each pressure times length, are the same total.
    run = block.read_pressures(folder, scenes.block_grids())
    for x, p in ((run.slave_x, run.slave), (run.master_x, run.master)):
        assert np.sum(p * block.half_segments(x)) == pytest.approx(run.force, rel=1e-6)
    assert study_main("block", block.write, [str(tmp_path), str(tmp_path / "doc"), "--types", "1"]) == 2


LINE = "step to {} iteration {}: energy ratio {}, |R| 1.0E+00 (round-off 1.0E-13)\n"


def test_energy_history_of_a_log():
    text = "deck: x\n" + LINE.format("1.0E-03", 1, "1.0E+00") + LINE.format("1.0E-03", 2, "2.5E-24")
    text += LINE.format("2.0E-03", 1, "1.0E+00")
    steps = block_implicit.energy_history(text)
    assert steps == [(1.0e-3, [1.0, 2.5e-24]), (2.0e-3, [1.0])]
    assert block_implicit.largest_count(steps) == 2
    assert block_implicit.ratio_table(steps).splitlines()[-1] == "| 2 | 1.0e+00 |  |"


def test_answers_follow_the_pressures():
    x = np.arange(5.0)
    def run(end):
        p = np.array([1.0 + end, 1.0, 1.0, 1.0, 1.0 + end])
        return block.Pressures(x, p, x, p, 0.0, 4.0)
    few, many = ([(1.0, [1.0] * count)] for count in (3, 4))
    ends = {1: 0.2, 3: -0.01, 4: 0.0, 5: 1.0e-3, 6: 1.0e-3}
    runs = {("implicit", ctype): run(end) for ctype, end in ends.items()}
    def verdicts(histories):
        return [line.split(" | ")[1] for line in
                block_implicit.answers(runs, histories).splitlines()[2:]]
    assert verdicts({1: few}) == ["yes", "yes", "yes", "yes", "no", "yes", "yes"]
    assert verdicts({1: few, 5: many})[-1] == "no"


def test_the_counted_run_is_cut_short_as_the_page_says():
    script = (conftest.ROOT / "tools" / "batch" / "block_implicit.sh").read_text(encoding="utf-8")
    assert f" {block_implicit.COUNTED_OPTION}\n" in script
    assert "No instructions were counted" in block_implicit.count_section(conftest.ROOT, [1, 5])


def test_implicit_page_of_runs(tool, slideline, tmp_path, plain_pictures):
    for method, flags in (("implicit", ["--implicit"]), ("explicit", [])):
        deck = tmp_path / f"{method}.k"
        assert tool("make-deck", "block", *flags, "-o", deck).returncode == 0
        assert ("*CONTROL_IMPLICIT_DYNAMICS" in deck.read_text()) == (method == "implicit")
        finished = subprocess.run([slideline, f"i={deck}", f"d={tmp_path / method}_5", "jobid=block",
                                   "ctype=5"], capture_output=True, text=True, check=False)
        assert finished.returncode == 0, finished.stdout + finished.stderr
    (tmp_path / "implicit_5" / "counted").mkdir()
    (tmp_path / "implicit_5" / "counted" / counting.COUNTS).write_text(
        '{"total": 9000000, "parts": {"contact": 900000}, "by": "callgrind, x86-64-v3"}', encoding="ascii")
    wanted = [str(tmp_path), str(tmp_path / "doc"), "--types", "5"]
    assert study_main("block", block_implicit.write, wanted) == 0
    page = (tmp_path / "doc" / "studies" / "block_to_block_implicit.md").read_text()
    assert "| NTS-mAR: perfectly uniform (to 1e-08) | yes |" in page
    prose = " ".join(page.split())  # lines are wrapped
    assert "Counted by callgrind, x86-64-v3" in prose and "Cut short: implicit (endtim=0.02)" in prose
    assert "Implicit, N_r = 1:" in page and "Explicit, N_r = 1:" not in page and "| 5 NTS-mAR | 9.0 |" in page
    assert (tmp_path / "doc" / "pictures" / "block_implicit_pressure.png").exists()
    (tmp_path / "implicit_5" / "block.log").write_text("nothing", encoding="ascii")
    assert study_main("block", block_implicit.write, wanted) == 2
