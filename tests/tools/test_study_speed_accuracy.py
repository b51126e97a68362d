# SPDX-License-Identifier: MIT
"""The study speed-accuracy: error measures, references, Pareto front, page, one real run of it."""
import dataclasses
import types

import numpy as np
import pandas as pd
import pytest

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES, SERIES
from slideline_tools.studies import __main__ as command, block, chooses
from slideline_tools.studies.common import verification
from slideline_tools.studies.framework.job import Options, interleave
from slideline_tools.studies.speed_accuracy import points as fronts, reference, scenes, study


# ---- front and comparison ----------------------------------------------------------------------

def errors(*rows):
    """Of one scene and measure: (type, contact time, error, floor), one mesh."""
    table = pd.DataFrame([dict(zip(("type", "contact", "error", "floor"), (*row, 0.0)[:4])) for row in rows])
    return table.assign(scene="sliding", level=1, measure="roughness", judged=table[["error", "floor"]].max(axis=1))


@pytest.mark.parametrize("rows, expected", [
    ([(1, 2.0, 1.0), (2, 1.0, 2.0), (3, 3.0, 3.0)], [2, 1]),
    ([(1, 1.0, 1.0), (2, 1.0, 1.0), (3, 1.0, 2.0)], [1]),
    ([(1, 1.00, 1.0), (2, 1.02, 0.5), (3, 2.0, 0.49), (4, 3.0, 0.40)], [2, 4]),  # small differences count as none
    ([(1, 1.0, 1e-3, 1e-2), (2, 2.0, 1e-5, 1e-2), (3, 0.5, 0.5, 1e-2)], [3, 1])])  # what is not known is equal
def test_front(rows, expected):
    assert list(fronts.front(errors(*rows), "contact")["type"]) == expected


def test_ratios_compare_on_the_same_mesh():
    rows = pd.DataFrame([("a", level, ctype, cost) for level, ctype, cost in (
        (1, 1, 2.0), (2, 1, 4.0), (1, 5, 4.0), (2, 5, 32.0), (3, 5, 99.0))], columns=["scene", "level", "type", "contact"])
    ratios = fronts.over(rows, "contact")
    assert list(ratios[2:4]) == [2.0, 8.0] and np.isnan(ratios[4])
    assert fronts.geometric(ratios, rows["type"])[5] == pytest.approx(4.0)


# ---- references --------------------------------------------------------------------------------

@pytest.mark.parametrize("order", [0.7, 1.0, 1.8])
@pytest.mark.parametrize("levels", [(1, 2, 4), (2, 3, 6)])
def test_own_error_of_a_known_sequence(order, levels):
    values = [3.0 + 0.4 * level ** -order for level in levels]
    found, error = reference.own_error(levels, np.abs(np.diff(values)))
    assert found == pytest.approx(order, rel=1e-6)
    assert error == pytest.approx(abs(values[-1] - 3.0), rel=1e-6)


def test_order_is_bounded_and_two_levels_are_of_first_order():
    assert reference.own_error((1, 2, 4), [1.0, 1.0])[0] == 0.5
    assert reference.own_error((1, 2, 4), [100.0, 1.0])[0] == pytest.approx(2.0)
    assert reference.own_error((2, 4), [0.3]) == (1.0, pytest.approx(0.3))


def test_plastic_work_is_yield_stress_times_strain_times_area():
    """A quad of 0.5 mm x 1 mm in the first column, another in the last; the projectile apart."""
    def quad(x, y):
        return [[x, y, 0], [x + 5e-4, y, 0], [x + 5e-4, y + 1e-3, 0], [x, y + 1e-3, 0]]

    points = np.array(quad(2e-4, -2e-3) + quad(0.0635, -2e-3) + quad(2e-4, 2e-3))
    fields = {"part_id": np.array([[1, 1, 2]]), "plastic_strain": np.array([[0.1, 0.2, 9.0]])}
    results = types.SimpleNamespace(points=points[None], cells=np.arange(12).reshape(3, 4),
                                    cell_field=fields.__getitem__)
    work = reference.plastic_work(results)
    assert len(work) == 36 and np.count_nonzero(work) == 2
    assert work[[0, -1]] == pytest.approx([276e6 * 0.1 * 5e-7, 276e6 * 0.2 * 5e-7], rel=1e-12)


def sliding_table(folder, forces):
    """The table of sliding runs with constant forces {(type, level): force}."""
    rows = []
    for (ctype, level), force in forces.items():
        path = folder / "runs" / f"sliding_{level}_type_{ctype}"
        path.mkdir(parents=True)
        lines = [f"{time!r},1,slave,0,{force!r},1" for time in (np.arange(3001) * 2e-6).tolist()]
        (path / "sliding.rcforc.csv").write_text("time,interface,side,fx,fy,n_active\n" + "\n".join(lines) + "\n")
        rows.append({"run": path.name, "state": "finished", "scene": "sliding", "level": level, "type": ctype})
    return pd.DataFrame(rows)


def test_each_has_its_reference(tmp_path):
    """Forces 10 (1 + 0.4/N) of type 7, 11 (1 + 0.4/N) of PUNIT 4 without compliance: order 1, own error 0.4/6 over 6.4/6."""
    forces = {(ctype, level): base * (1.0 + 0.4 / level) for ctype, base in ((7, 10.0), ("7h", 11.0)) for level in (2, 3, 6)}
    table = sliding_table(tmp_path, {**forces, (5, 2): 13.0, ("7i", 2): 14.4})
    found = reference.add_errors(table, tmp_path).set_index(["type", "level"])
    finest = 6.4 / 6.0
    assert found.loc[(7, 2), "force_error"] == found.loc[("7h", 2), "force_error"] == pytest.approx(1.2 / finest - 1.0)
    assert found.loc[(5, 2), "force_error"] == pytest.approx(1.3 / finest - 1.0)
    assert found.loc[("7i", 2), "force_error"] == pytest.approx(14.4 / 11.0 / finest - 1.0)
    assert np.isnan(found.loc[(7, 6), "force_error"]) and found.loc[(5, 2), "force_error_order"] == pytest.approx(1.0)
    assert found.loc[(5, 2), "force_error_floor"] == pytest.approx(0.4 / 6.4)
    assert found["force_error_springs"].tolist() == pytest.approx([1.0 / 11.0] * 8)
    assert "force_error" not in reference.add_errors(table[table["type"] == "7i"], tmp_path)


# ---- scenes and jobs ---------------------------------------------------------------------------

def test_largest_deviation_looks_at_both_sides():
    assert scenes.largest_deviation([np.array([1.0, 1.1]), np.array([0.7, 1.0])], 1.0) == pytest.approx(0.3)


def test_chain_is_that_of_the_verification_at_a_tenth_of_its_step():
    """Twice the springs give a higher pressure; the full step gives nearly the same."""
    soft, stiff = scenes.chain_pressure(5.1e6), scenes.chain_pressure(1.01e7)
    assert soft == pytest.approx(8119.97, rel=0.02) and stiff == pytest.approx(9017.28, rel=0.02)


@pytest.mark.parametrize("name", scenes.SCENES)
def test_two_passes_make_an_interface_as_stiff(name):
    """e/l_sl + e/l_ms of type 3 is penalty/l_sl of the others."""
    scene = scenes.SCENES[name]
    slave, master = scene.lengths
    one, two = (scenes.node_penalty(scene, 2, ctype) for ctype in (7, 3))
    assert one == scene.penalty(2) and two / slave + two / master == pytest.approx(one / slave, rel=1e-14)
    if name == "sliding":
        assert two / one == pytest.approx(2.0 / 3.0, rel=0.01)
    if name == "block":
        assert block.interface_stiffness(3) * two / one == pytest.approx(block.interface_stiffness(5))


def test_implicit_springs_of_the_chain_are_a_step_ahead():
    """Without compliance the faces never overlap; with it the pressure is that of the gap one step later."""
    chain = verification("block_to_block", "chain")
    hard = chain.solve(chain.Blocks(penalty=np.inf, ahead=True))
    assert np.all(hard.displacement[:, 0, -1] - hard.displacement[:, 1, 0] <= 1e-15)
    soft = chain.solve(chain.Blocks(penalty=1.0e6, ahead=True))
    overlap = np.maximum(0.0, soft.displacement[1:, 0, -1] - soft.displacement[1:, 1, 0])
    assert soft.pressure[:-1] == pytest.approx(1.0e6 * overlap, rel=1e-9, abs=1e-6) and soft.pressure[-1] > 1e3


def test_implicit_penalty_is_an_interface_of_its_own():
    scene = scenes.SCENES["block"]
    assert scenes.contact_options(scene, 2, "7h") == ("ctype=7", "punit=4", "p:pen=-1")
    assert scenes.contact_options(scene, 2, 5) == ("ctype=5", "p:pen=500000")
    assert scenes.block_springs(2, "7i") == (pytest.approx(10.0 * 1.0e6 / 3.0 / 0.25), True)
    assert scenes.block_springs(2, "7h") == (np.inf, True) and not scenes.block_springs(2, 5)[1]


def test_net_moment_of_a_couple():
    """Two opposite forces of 2 N, 0.3 m apart, over 2 N times a segment of 0.1 m."""
    points = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0]])
    fields = {"contact_force": np.array([[[0.0, 2.0, 0.0], [0.0, -2.0, 0.0]]])}
    results = types.SimpleNamespace(points=points[None], point_field=fields.__getitem__)
    assert scenes.net_moment(results, 0.1) == pytest.approx(3.0)
    fields["contact_force"] *= 0.0
    assert scenes.net_moment(results, 0.1) is None


def test_references_run_once_and_are_not_timed(monkeypatch):
    for name, scene in scenes.SCENES.items():
        monkeypatch.setitem(scenes.SCENES, name, dataclasses.replace(scene, deck=str))
    runs = interleave(study.jobs(Options(levels=(1, 2, 3, 4), types=(1, 5), repeats=2)), 2)
    once = [job for job in runs if job.labels["role"] == "reference"]
    assert {(job.labels["scene"], job.labels["level"]) for job in once} == {
        ("sliding", 2), ("sliding", 3), ("sliding", 6), ("collision", 2), ("collision", 4), ("collision", 6)}
    assert len(once) == 6 and runs[:6] == once and not any(job.alone for job in once)
    swept = [job for job in runs if job.name == "sliding_3_type_5"]
    assert [job.repeat for job in swept] == [1, 2] and all(job.alone for job in swept)
    assert not any(job.labels["scene"] == "sliding" and job.labels["level"] == 4 for job in runs)


# ---- page --------------------------------------------------------------------------------------

def made_table(types_of=tuple(SERIES)):
    """The k-th of the series costs k; types 4, 5, 7, 7i and 7h are exact; errors fall with k, and with N_r."""
    rows, place = [], list(SERIES)
    for name, scene in scenes.SCENES.items():
        for level in scene.levels:
            for series in types_of:
                k = place.index(series) + 1
                row = {"state": "finished", "role": "sweep", "scene": name, "level": level, "type": series, "repeat": 1,
                       "search": 1.0 * k, "pairing": 0.0, "force": 0.0, "contact": 1.0 * k,
                       "computing": 100.0 * level + 10.0 * k, "elements": 1.0, "element_calls": 101, "build": "slideline 0",
                       "moment": 2e-3 if series == 4 else 1e-15, "reference_levels": "2, 3, 6"}
                for measure in scene.measures:
                    row[measure.key] = 0.2 / level / (8 - k if k == 6 else k)
                    if measure.key in reference.DISTANCES:
                        row[f"{measure.key}_floor"], row[f"{measure.key}_order"] = 0.02, 1.0
                if name in ("patch", "block") and k in (4, 5, 7, 8, 9):
                    row["pressure_error"] = 1e-12
                rows.append(row)
    return pd.DataFrame(rows)


def test_page():
    text = study.page(made_table())
    # Costs and errors over type 1, net moment; of implicit penalty over type 7.
    assert re_cells(text, "4 VTS-PPT") == ["yes", "4.00 (4.00)", "1.16 (1.14 to 1.17)", "0.25", "0.27", "0.25", "0.29", "0.002"]
    assert re_cells(text.split("## Over type 7")[1], "7h PUNIT 4, PEN < 0")[1:4] == ["1.29 (1.29)", "1.08 (1.07 to 1.08)", "0.78"]
    assert "| 4 VTS-PPT | 4 / 1.4e+02 s; < 1e-7 % |" in text and "| 7i PUNIT 4 | 8 / 1.8e+02 s; < 1e-7 % |" in text
    assert "| Sliding: force, rms difference over the mean | 7h | N_r = 2, 3, 6 | 1.00 | 2 % |  |" in text
    assert "(1), (1), (1), 1 %" in text and "nan" not in text  # 0.2/4/5 is below the reference's 0.02
    # 110 and 120 s; 130 s is more than 1.1 times 110 s.
    assert "| Patch test: p/p0, largest deviation from 1 | 1 2/1, 1.1e+02 s | 2 3/1, 1.2e+02 s |" in text


def re_cells(text, name):
    """Cells of the first row of that name."""
    line = next(line for line in text.splitlines() if line.startswith(f"| {name} |"))
    return [cell.strip() for cell in line.split("|")[2:-1]]


def test_page_of_one_type_alone():
    table = made_table((5,))
    assert "nan" not in study.page(table[table["scene"] != "collision"])
    with pytest.raises(UserError, match="no finished runs"):
        study.page(table[:0])


def test_charts(tmp_path, plain_pictures):
    table = made_table(ALL_TYPES)
    study.chart(table[table["scene"] == "block"], tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["speed_accuracy_block.png"]


def test_choice_of_the_program_over_the_front(tmp_path):
    """CTYPE 0 takes type 5 between the blocks, exact as type 4, which takes 400 instructions; its files are not quite the same."""
    (tmp_path / "study-speed-accuracy").mkdir()
    made_table().to_csv(tmp_path / "study-speed-accuracy/speed-accuracy.csv", index=False)
    runs = [{"run": f"block_{ctype}_none", "scene": "block", "type": ctype, "target": "none", "state": "finished"} for ctype in range(8)]
    table = pd.DataFrame(runs + [{**row, "run": f"{row['run']}_counted", "state": "counted",
                                  "instructions": 100.0 * row["type"] or 520.0} for row in runs])
    table.loc[table["run"] == "block_0_none", "chosen"] = 5
    for name, text in (("block_0_none", "1"), ("block_5_none", "2")):
        (tmp_path / "study-chooses/runs" / name).mkdir(parents=True)
        (tmp_path / "study-chooses/runs" / name / "run.rcforc.csv").write_text(text)
    found = chooses.derive(table, tmp_path / "study-chooses").set_index("run").loc["block_0_none"]
    assert found["over_front"] == pytest.approx(1.3) and found["over_type"] == pytest.approx(0.04)
    assert found["alone"] == "1.300" and found["same_files"] == False  # noqa: E712
    with pytest.raises(UserError, match="run tools/study.sh speed-accuracy"):
        chooses.derive(table, tmp_path / "nowhere")


# ---- with the program --------------------------------------------------------------------------

def test_real_runs_of_the_block(slideline, tmp_path, plain_pictures):
    arguments = ["speed-accuracy", "--program", slideline, "--folder", str(tmp_path), "--quick",
                 "--types", "1", "3", "5", "7i", "7h", "--only", "block_1*"]
    assert command.main(arguments) == 0
    found = pd.read_csv(tmp_path / "speed-accuracy.csv").groupby("type")["pressure_error"].first()
    assert found[["5", "7i", "7h"]].max() < scenes.ROUND_OFF and 1e-4 < found["3"] < 0.01 < found["1"] < 0.2
    assert (tmp_path / "doc/pictures/speed_accuracy_block.png").exists()
