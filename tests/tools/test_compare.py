# SPDX-License-Identifier: MIT
"""The comparison must notice each kind of deviation, and name it."""
import numpy as np
import pytest

from slideline_tools import UserError
from slideline_tools.compare import Tolerance, compare
from slideline_tools.histories import History, read_csv

TIME = np.linspace(0.0, 2.0, 201)


def table(values=None, time=TIME, **more):
    values = np.sin(np.pi * time) if values is None else values
    return History("glstat", {"time": time, "force": values, **more})


def failed(report):
    return {check.measure for check in report.checks if not check.passed}


def test_equal_tables_agree():
    report = compare(table(), table())
    assert report.passed
    assert len(report.checks) == 7


@pytest.mark.parametrize("column", ["cycle", "n_active", "state"])
def test_counts_have_no_impulse(column):
    """They have the other measures."""
    counts = np.arange(len(TIME), dtype=float)
    report = compare(table(**{column: counts}), table(**{column: counts}))
    reported = {name: [check.measure for check in report.checks if check.column == name] for name in ("force", column)}
    assert "impulse" in reported["force"] and reported[column] == [measure for measure in reported["force"] if measure != "impulse"]
    late = compare(table(**{column: counts + 1.0}), table(**{column: counts}), columns=[column])
    assert failed(late) == {"values", "peak", "final"}


def test_other_time_grid_agrees():
    finer = np.linspace(0.0, 2.0, 1001)
    assert compare(table(time=finer), table()).passed


def test_scaled_values_fail_by_the_known_amount():
    report = compare(table(1.01 * np.sin(np.pi * TIME)), table())
    assert failed(report) == {"values", "peak"}
    peak = next(check for check in report.checks if check.measure == "peak")
    assert peak.difference == pytest.approx(0.01)
    assert peak.allowed == pytest.approx(2.0e-3)
    assert "force" in report.text() and "FAILED" in report.text()


def test_single_spike_fails_values_and_peak():
    values = np.sin(np.pi * TIME)
    values[20] += 2.0
    assert {"values", "peak"} <= failed(compare(table(values), table()))


def test_late_peak_fails():
    late = np.exp(-((TIME - 1.1) / 0.1) ** 2)
    reference = np.exp(-((TIME - 1.0) / 0.1) ** 2)
    report = compare(table(late), table(reference),
                     default=Tolerance(measures=("time of peak",)))
    assert failed(report) == {"time of peak"}


def test_another_equally_high_peak_is_accepted():
    values = np.abs(np.sin(2.0 * np.pi * TIME))
    other = values.copy()
    other[np.argmax(values) + 50] += 1.0e-4
    assert compare(table(other), table(values)).passed


def test_impulse_alone():
    reference = np.ones_like(TIME)
    report = compare(table(reference + 0.0015), table(reference),
                     default=Tolerance(floor=0.0, measures=("impulse",)))
    assert failed(report) == {"impulse"}
    assert report.checks[-1].difference == pytest.approx(0.003)


def test_final_value_alone():
    values = np.sin(np.pi * TIME)
    values[-1] = 0.1
    report = compare(table(values), table(), default=Tolerance(measures=("final",)))
    assert failed(report) == {"final"}


def test_short_run_fails_at_its_end():
    report = compare(table(time=TIME[:101]), table())
    assert "end" in failed(report)


def test_late_start_fails():
    assert "start" in failed(compare(table(time=TIME[50:]), table()))


def test_the_floor_is_a_share_of_the_largest_component():
    """Round-off in a component that should be 0 is no difference; of a column without partner it is one."""
    noise = 2.0e-11 * np.cos(np.pi * TIME)
    report = compare(table(fx=noise, fy=1.0e4 * TIME, energy=noise), table(fx=-noise, fy=1.0e4 * TIME, energy=-noise))
    assert {check.column for check in report.checks if not check.passed} == {"energy"}
    assert not compare(table(fx=30.0 * TIME, fy=1.0e4 * TIME), table(fx=0.0 * TIME, fy=1.0e4 * TIME)).passed


def test_atol_replaces_the_floor():
    noise = table(1.0e-15 * np.cos(7.0 * TIME))
    zero = table(0.0 * TIME)
    assert not compare(noise, zero).passed
    assert compare(noise, zero, default=Tolerance(atol=1.0e-12)).passed


def entities(factor):
    rows = {"time": np.repeat(TIME, 2), "node": np.tile([1, 2], len(TIME))}
    values = np.repeat(np.sin(np.pi * TIME), 2) * np.tile([1.0, factor], len(TIME))
    return History("nodout", {**rows, "uy": values})


def test_entities_are_reported_apart():
    report = compare(entities(0.9), entities(1.0))
    assert {check.entity for check in report.checks if not check.passed} == {"node 2"}


def test_other_entities_are_unusable():
    other = entities(1.0)
    other.columns["node"] = other["node"] + 1
    with pytest.raises(UserError, match="only one of the tables"):
        compare(other, entities(1.0))


@pytest.mark.parametrize("broken", [np.nan, np.inf])
@pytest.mark.parametrize("side", ["result", "reference"])
def test_not_a_number_is_refused(broken, side):
    values = np.sin(np.pi * TIME)
    values[7] = broken
    pair = {"result": table(), "reference": table(), side: table(values)}
    with pytest.raises(UserError, match=f"{side} holds {broken} in column force, row 8"):
        compare(pair["result"], pair["reference"])


def test_not_a_number_in_a_column_that_is_not_judged():
    other = table(other=np.full_like(TIME, np.nan))
    with pytest.raises(UserError, match="column other"):
        compare(other, table(), ["force"])


def test_missing_column_empty_table_and_no_overlap():
    with pytest.raises(UserError, match="result lacks the column torque"):
        compare(table(), table(torque=TIME))
    with pytest.raises(UserError, match="result has no rows"):
        compare(table(np.array([]), np.array([])), table())
    with pytest.raises(UserError, match="reference has no rows"):
        compare(table(), table(np.array([]), np.array([])))
    with pytest.raises(UserError, match="no common time"):
        compare(table(time=TIME + 10.0), table())


def test_time_that_runs_back():
    with pytest.raises(UserError, match="back in time"):
        compare(table(time=TIME[::-1]), table())


def test_tolerance_per_column():
    pair = table(1.01 * np.sin(np.pi * TIME)), table()
    assert not compare(*pair).passed
    assert compare(*pair, tolerances={"force": Tolerance(rtol=0.02)}).passed


def write(path, time, values):
    rows = "\n".join(f"{t!r},{v!r}" for t, v in zip(time.tolist(), values.tolist()))
    path.write_text(f"time,force\n{rows}\n")
    return path


@pytest.mark.parametrize("factor, options, status", [
    (1.0, [], 0), (1.01, [], 1), (1.01, ["--rtol", "0.02"], 0),
    (1.01, ["--column-rtol", "force=0.02"], 0), (np.nan, [], 2),
    (1.0, ["--columns", "torque"], 2), (1.0, ["--measures", "mean"], 2)])
def test_command_line_status(tmp_path, tool, factor, options, status):
    reference = write(tmp_path / "ref.csv", TIME, np.sin(np.pi * TIME))
    result = write(tmp_path / "job.glstat.csv", TIME, factor * np.sin(np.pi * TIME))
    finished = tool("compare", result, reference, *options)
    assert finished.returncode == status, finished.stdout + finished.stderr
    if status == 1:
        assert "failed: force" in finished.stdout


def test_command_line_missing_file(tmp_path, tool):
    finished = tool("compare", tmp_path / "a.csv", tmp_path / "b.csv")
    assert finished.returncode == 2
    assert "cannot read" in finished.stderr


def test_what_is_no_table_is_said(tmp_path):
    (tmp_path / "a.vtkhdf").write_bytes(b"\x89HDF\r\n\x1a\n")
    with pytest.raises(UserError, match="no text; wanted is a CSV table"):
        read_csv(tmp_path / "a.vtkhdf")
    with pytest.raises(UserError, match="compare_folder"):
        read_csv(tmp_path)
