# SPDX-License-Identifier: MIT
"""The table of history files (src/model/history_tables.f90) with their columns, the keywords that the reader knows,
and doc/results.md name the same."""
import re
import sys

from fortran_source import ROOT

sys.path.insert(0, str(ROOT / "tools"))
from slideline_tools import histories  # noqa: E402

TABLES = (ROOT / "src/model/history_tables.f90").read_text(encoding="utf-8")
RESULTS = (ROOT / "doc/results.md").read_text(encoding="utf-8").replace(",` |\n| | `", ",")  # long rows go on below
ROWS = re.findall(r"history_table_t\('(\w+)', (\w+)(.*?)\)(?=, &|\])", TABLES, re.DOTALL)
NAMES = [(name, asked) for name, asked, _ in ROWS]


def csv_columns(name):
    """Those before the semicolon, without the marks of their kinds."""
    texts = next(re.findall(r"'([^']+)'", rest) for one, _, rest in ROWS if one == name)
    return re.sub(r"[-+#@]", "", "".join(texts).partition(";")[0])


def test_results_page_names_the_columns_of_every_history():
    assert len(NAMES) > 7
    for name, _ in NAMES:
        assert f"\n| {name} | `{csv_columns(name)}` |\n" in RESULTS, name
        assert f"| `<job>.{name}.csv` |" in RESULTS, name


def test_tools_know_every_history():
    assert sorted(histories.TABLES) == sorted(name for name, _ in NAMES)


def test_keyword_of_every_history_is_read_and_described():
    schema = (ROOT / "src/deck/schema/deck_schema_tables.f90").read_text(encoding="utf-8")
    keywords = (ROOT / "doc/keywords.md").read_text(encoding="utf-8")
    for name, asked in NAMES:
        keyword = f"DATABASE_{name.upper()}"
        assert (f"'{keyword}" in schema) == (asked != "asked_by_states"), name
        assert (f"*{keyword}" in keywords) == (asked != "asked_by_states"), name
