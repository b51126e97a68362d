# SPDX-License-Identifier: MIT
"""Every deck of doc/examples runs and gives what its head says (tools/docs/examples.py)."""
import re
import shutil
import subprocess

import numpy as np
import pytest

import examples
import keyword_pages
from slideline_tools.histories import TEXT_COLUMNS, read_csv
from slideline_tools.results import STRESS_COMPONENTS, read

KEYWORDS = keyword_pages.read_keywords(
    (examples.ROOT / "doc/keywords.md").read_text(encoding="utf-8"))
EXAMPLES = examples.read_examples()


def text_of(example):
    """The deck with what it includes."""
    return "\n".join(path.read_text(encoding="utf-8")
                     for path in [example.path, *examples.included_files(example)])


@pytest.mark.parametrize("keyword", [keyword.name for keyword in KEYWORDS])
def test_there_is_an_example_of(keyword):
    shown = [example for example in EXAMPLES if keyword in example.keywords]
    assert shown, f"no deck of doc/examples has '$ Keywords: *{keyword}' in its head"
    for example in shown:
        assert re.search(rf"^\*{keyword}(_TITLE|_ID|_\d+)?\b(?!_)", text_of(example), re.M)


def cell_column(results, entry):
    """The values of an element field over the states."""
    stress = re.fullmatch("stress_([xyz]{2})", entry.column)
    field = results.cell_field("stress" if stress else entry.column)
    if stress:
        field = field[:, :, STRESS_COMPONENTS.index(stress.group(1))]
    ids = results.cell_field("element_id")[0]
    return field[:, int(np.flatnonzero(ids == int(entry.where["element_id"]))[0])]


def column_of(out, job, entry):
    """The values of an expectation over time."""
    if entry.table == "cell":
        return cell_column(read(out / f"{job}.vtkhdf"), entry)
    where = {key: value if key in TEXT_COLUMNS else int(value) for key, value in entry.where.items()}
    return read_csv(out / f"{job}.{entry.table}.csv").where(**where)[entry.column]


def found_value(out, job, entry):
    values = column_of(out, job, entry)
    assert len(values) > 0, entry.text
    return {"first": lambda: values[0], "last": lambda: values[-1], "max": values.max,
            "min": values.min, "rows": lambda: len(values)}[entry.pick]()


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_example(example, exe, tmp_path):
    shutil.copytree(examples.FOLDER, tmp_path / "decks")
    done = subprocess.run([exe, f"i=decks/{example.path.name}", "d=out", *example.words],
                          cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == example.status, done.stdout + done.stderr
    out = tmp_path / "out"
    log = (out / f"{example.name}.log").read_text(encoding="utf-8")
    assert int(re.search(r"Warnings += (\d+)", log).group(1)) == example.warnings, log
    for text in example.log_texts:
        assert text in log
    for name in example.files:
        assert (out / name).is_file()
    wrong = []
    for entry in example.expectations:
        found, wanted = float(found_value(out, example.name, entry)), entry.value
        error = abs(found - wanted) / (abs(wanted) or 1.0)
        if not error <= entry.tolerance:
            wrong.append(f"{entry.text}: found {found:.9g}, wanted {wanted:.9g}, error {error:.2g}")
    assert not wrong, "\n".join(wrong)
