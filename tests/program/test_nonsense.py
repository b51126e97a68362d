# SPDX-License-Identifier: MIT
"""Values out of reason, and messages that say what they are about."""
import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import drop

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

#: keywords of which every honoured field is tried here (check alone; tests/lab/fuzz/sweep_fields.py tries all, with runs)
QUICK = ("*DAMPING_GLOBAL", "*CONTROL_TERMINATION", "*RIGIDWALL_PLANAR")
#: keyword, field -> values that must be refused
REFUSED = {
    ("*DAMPING_GLOBAL", "STX"): ("-1.0", "-1.0E-3", "NAN", "INF", "-INF", "1.0E+300", "x"),
    ("*DAMPING_GLOBAL", "STY"): ("-1.0", "-1.0E-3"), ("*DAMPING_GLOBAL", "VALDMP"): ("-1.0", "-1.0E-3"),
    ("*CONTROL_TERMINATION", "DTMIN"): ("-1.0", "1.0E+30", "1.0E+40"),
    ("*CONTROL_TERMINATION", "ENDTIM"): ("-1.0", "0.0", "NAN"),
    ("*RIGIDWALL_PLANAR", "OFFSET"): ("-1.0",), ("*RIGIDWALL_PLANAR", "DEATH"): ("-1.0", "-1.0E-3"),
}


@pytest.fixture
def said(slideline, tmp_path):
    def run(text, *words):
        (tmp_path / "deck.k").write_text(text)
        done = slideline("check", "deck.k", *words)
        return done.returncode, done.stderr
    return run


def test_every_field_of_some_keywords(tmp_path):
    done = subprocess.run([sys.executable, ROOT / "tests/lab/fuzz/sweep_fields.py", "--program", os.environ["SLIDELINE"], "--check",
                           "--output", tmp_path, "--keywords", *QUICK], capture_output=True, text=True, timeout=250)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = list(csv.DictReader(open(tmp_path / "fields.csv", newline="", encoding="utf-8")))
    assert len(rows) > 150
    found = {(row["keyword"], row["field"], row["value"]): row for row in rows}
    for (keyword, field), values in REFUSED.items():
        for value in values:
            row = found[keyword, field, value]
            assert row["outcome"] == "refused" and f"({field}): " in row["message"], row


def test_a_wrong_override_is_named_once(said):
    two = drop().text().replace("*END", "*CONTACT_2D_SLIDELINE\n-1,-2,1,,1.0e5\n*END")
    assert two.count("*CONTACT_2D_SLIDELINE") >= 2
    status, text = said(two, "ctype=9")
    assert status == 1 and text.count('"ctype=9" on the command line is not a contact type') == 1, text
    status, text = said(two, "ctype=9", "ctype.2=8")
    assert '"ctype=9" on' in text and '"ctype.2=8" on' in text


def test_json_counts_what_it_leaves_out(slideline, tmp_path):
    nodes = "".join(f"{k},0.0,0.0,0.0,9\n" for k in range(1000, 2300))
    (tmp_path / "deck.k").write_text("*KEYWORD\n*NODE\n" + nodes + "*END\n")
    done = slideline("check", "deck.k", "--json")
    errors = [one for one in json.loads(done.stdout)["findings"] if one["severity"] == "error"]
    plain = slideline("check", "deck.k").stderr
    assert 1001 <= len(errors) < 1010, "a thousand, and the first of those of another kind"
    more = int(errors[-1]["message"].split()[1])
    assert errors[-1] == {"severity": "error", "message": f"and {more} more errors"}
    assert "| 1300 times: deck.k:3, deck.k:4, deck.k:5 and so on" in plain
    assert f"refused, {more + len(errors) - 1} errors" in plain and "end time" in plain


def test_fields_of_explicit_runs_warn_in_implicit_ones(said):
    from slideline_tools import scenes
    made = scenes.block(1, implicit=True, n_slave=9, n_master=8)
    text = made if isinstance(made, str) else made.text()
    before = said(text)
    assert before[0] == 0
    more = ("*CONTROL_TIMESTEP\n1.0e-5,0.5,1\n*CONTROL_CONTACT\n1.0,\n,,,,,,1\n*END")
    status, reported = said(text.replace("*END", more), "tssfac=0.8")
    assert status == 0, reported
    for name in ("DTINIT", "ISDO", "ECDT"):
        assert reported.count(f"({name}): ") == 1, (name, reported)
    assert reported.count("has no effect with the implicit method") - before[1].count("has no effect with the implicit method") == 4
    assert '"tssfac=0.8" on the command line has no effect' in reported


@pytest.mark.parametrize("given, meant", [
    ("*MAT_ELASTC", "*MAT_ELASTIC"), ("*MAT_PLASTIC_KINEMATICS_TITLE", "*MAT_PLASTIC_KINEMATIC"),
    ("*BOUNDARY_SPC_NODES", "*BOUNDARY_SPC_NODE"), ("*CONTROL_TERMINATON", "*CONTROL_TERMINATION"),
    ("*CONTACT_2D_SILDELINE", "*CONTACT_2D_SLIDELINE"),
    ("*MAT_MTS", None), ("*LOAD_BODY_Z", None), ("*LOAD_BODY_RX", None), ("*ELEMENT_SOLID", None), ("*NODEX", None)])
def test_nearest_keyword(said, given, meant):
    status, text = said(f"*KEYWORD\n{given}\n1,\n*END\n")
    assert status == 1
    assert (f"did you mean {meant}?" in text) if meant else ("did you mean" not in text), text
