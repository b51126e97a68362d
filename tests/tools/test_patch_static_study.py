# SPDX-License-Identifier: MIT
"""The static patch test study: texts, tables of deviations, the page from runs of the program."""
import os
import subprocess

import pytest

from slideline_tools import UserError
from slideline_tools.studies import patch_static


def test_sizes():
    assert patch_static.size(0.0) == patch_static.size(3e-16) == "< 1e-12"
    assert patch_static.size(2.7e-12) == "< 1e-10"
    assert patch_static.size(0.0123) == "1.2e-2"
    assert patch_static.size(3.66) == "3.7"


def test_tables_of_one_type(tmp_path):
    deviations = {("3_2", 5, 1.0e6): [1e-12, 2e-12], ("3_2", 1, 1.0e6): [0.1, 0.2]}
    patch_static.write_tables(tmp_path, deviations, [5])
    assert (tmp_path / "type_5.csv").read_text().splitlines() == [
        "meshes,penalty,slave_deviation,master_deviation", "3/2,1e+06,1e-12,2e-12"]


def test_log_without_iterations_is_refused(tmp_path):
    run = tmp_path / "7_5_1e06_type_5"
    run.mkdir()
    (run / "patch.log").write_text("nothing\n")
    with pytest.raises(UserError, match="no iterations"):
        patch_static.newton_table(tmp_path, [5])


@pytest.mark.skipif("SLIDELINE" not in os.environ, reason="needs the program")
def test_page_of_one_type(tmp_path, monkeypatch):
    monkeypatch.setattr(patch_static, "ALL", (1.0e6,))
    assert patch_static.main(["decks", str(tmp_path)]) == 0
    for deck in tmp_path.glob("*.k"):
        subprocess.run([os.environ["SLIDELINE"], f"i={deck}", "jobid=patch", "ctype=5",
                        f"d={tmp_path / (deck.stem + '_type_5')}"], check=True,
                       capture_output=True)
    wanted = ["page", str(tmp_path), str(tmp_path / "doc"), "--types", "5"]
    assert patch_static.main(wanted) == 0
    page = (tmp_path / "doc" / "studies" / "patch_test_static.md").read_text()
    assert page.count("| 5 NTS-mAR | < 1e-") == 6 and page.count("< 1e-") == 2 * (5 + 10) and "| 5 NTS-mAR | 1e+00, " in page
    assert (tmp_path / "doc" / "pictures" / "patch_static_deformed.png").exists()
    assert patch_static.main([*wanted[:-1], "6"]) == 2
