# SPDX-License-Identifier: MIT
"""The study speed-accuracy: Pareto front, error measures, references, page, one real run of it."""
import dataclasses
import types

import numpy as np
import pandas as pd
import pytest

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES, SERIES
from slideline_tools.studies import block
from slideline_tools.studies import __main__ as command
from slideline_tools.studies.framework.job import Options, interleave
from slideline_tools.studies.framework.table import records
from slideline_tools.studies.speed_accuracy import advice, front as fronts, page as pages, reference, scenes, study


# ---- front -------------------------------------------------------------------------------------

@pytest.mark.parametrize("pairs, expected", [
    ([], []),
    ([(1.0, 5.0)], [0]),
    ([(2.0, 1.0), (1.0, 2.0), (3.0, 3.0)], [1, 0]),
    ([(1.0, 1.0), (1.0, 1.0), (1.0, 2.0)], [0]),
    ([(1.0, 2.0), (2.0, 2.0), (3.0, 1.0)], [0, 2])])
def test_pareto_front(pairs, expected):
    assert fronts.pareto(pairs) == expected


def test_front_by_its_definition():
    """Random points: on the front is exactly what nothing beats or equals in both."""
    numbers = np.random.default_rng(3)
    pairs = [tuple(pair) for pair in numbers.integers(0, 30, (200, 2)).astype(float)]
    found = {pairs[k] for k in fronts.pareto(pairs)}
    expected = {one for one in pairs if not any(
        other != one and other[0] <= one[0] and other[1] <= one[1] for other in pairs)}
    assert found == expected and len(found) > 2


def test_small_differences_count_as_none():
    pairs = [(1.00, 1.0), (1.02, 0.5), (2.0, 0.49), (3.0, 0.40)]
    assert fronts.pareto(pairs) == [0, 1, 2, 3]
    assert fronts.pareto(pairs, gain=0.05) == [0, 1, 3]
    assert fronts.pareto(pairs, gain=0.05, tie=0.03) == [1, 3]


def point(ctype, level, contact, error, floor=0.0, computing=10.0):
    return fronts.Point(ctype, level, {"contact": contact, "computing": computing},
                        {"roughness": error}, {"roughness": floor})


def test_unresolved_errors_are_equal():
    points = [point(1, 1, 1.0, 1e-3, 1e-2), point(2, 1, 2.0, 1e-5, 1e-2), point(3, 1, 0.5, 0.5, 1e-2)]
    assert [one.name for one in fronts.front(points, "contact", "roughness")] == ["3/1", "1/1"]
    assert fronts.cheapest(points, "contact", "roughness", 5e-3) is None
    assert fronts.cheapest(points, "contact", "roughness", 2e-2).name == "1/1"


def test_ratios_compare_on_the_same_mesh():
    points = [point(1, 1, 2.0, 1.0), point(1, 2, 4.0, 1.0), point(5, 1, 4.0, 1.0),
              point(5, 2, 32.0, 1.0), point(5, 3, 99.0, 1.0)]
    found = fronts.ratios(points, 5, lambda one: one.cost["contact"])
    assert found == [2.0, 8.0] and fronts.geometric_mean(found) == pytest.approx(4.0)


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
    assert reference.own_error((2, 4), [0.0]) == (1.0, 0.0)


def test_distances():
    one, other = np.array([1.0, 3.0]), np.array([2.0, 2.0])
    assert reference.force_distance(one, other, other) == pytest.approx(0.5)
    assert reference.work_distance(one, other, other) == pytest.approx(0.5)
    assert reference.plain_distance(np.array([0.3]), np.array([-0.1]), None) == pytest.approx(0.4)


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


def write_force(folder, run, force):
    """A force history of a sliding run."""
    path = folder / "runs" / run
    path.mkdir(parents=True)
    lines = [f"{time!r},1,slave,0,{force!r},1" for time in (np.arange(3001) * 2e-6).tolist()]
    (path / "sliding.rcforc.csv").write_text("time,interface,side,fx,fy,n_active\n"
                                             + "\n".join(lines) + "\n")


def test_force_errors_against_the_finest_level(tmp_path):
    """Forces 10 (1 + 0.4/N): order 1, own error 4 % of 10 over the reference's 10.4."""
    rows = []
    for ctype, level, force in ((7, 2, 12.0), (7, 3, 10.0 + 4.0 / 3.0), (7, 6, 10.0 + 4.0 / 6.0),
                                (5, 2, 13.0)):
        run = f"sliding_{level}_type_{ctype}"
        write_force(tmp_path, run, force)
        rows.append({"run": run, "state": "finished", "scene": "sliding", "level": level,
                     "type": ctype})
    rows = records(reference.add_errors(pd.DataFrame(rows), tmp_path))
    mean = 10.0 + 4.0 / 6.0
    assert [row["force_error"] for row in rows if row["level"] < 6] == pytest.approx(
        [(force - mean) / mean for force in (12.0, 10.0 + 4.0 / 3.0, 13.0)], abs=1e-12)
    assert "force_error" not in rows[2]
    assert rows[0]["force_error_order"] == pytest.approx(1.0)
    assert rows[3]["force_error_floor"] == pytest.approx(4.0 / 6.0 / mean)


def test_implicit_penalty_has_a_reference_without_compliance(tmp_path):
    """Forces 10 (1 + 0.4/N) of type 7 and 11 (1 + 0.4/N) of PUNIT 4: each against its own."""
    rows = []
    for ctype, base in ((7, 10.0), ("7h", 11.0), ("7i", 12.0)):
        for level in (2, 3, 6)[:2 if ctype == "7i" else 3]:
            run = f"sliding_{level}_type_{ctype}"
            write_force(tmp_path, run, base * (1.0 + 0.4 / level))
            rows.append({"run": run, "state": "finished", "scene": "sliding", "level": level, "type": ctype})
    rows = records(reference.add_errors(pd.DataFrame(rows), tmp_path))
    found = {(row["type"], row["level"]): row for row in rows}
    assert found["7h", 2]["force_error"] == pytest.approx(found[7, 2]["force_error"])
    assert found["7i", 2]["force_error"] == pytest.approx((12.0 * 1.2 - 11.0 * 6.4 / 6.0) / (11.0 * 6.4 / 6.0))
    assert all(row["force_error_springs"] == pytest.approx(1.0 / 11.0) for row in rows)
    alone = pd.DataFrame([{**row, "force_error": None} for row in rows if row["type"] == "7i"])
    assert reference.add_errors(alone, tmp_path).get("force_error", alone["force_error"]).isna().all()


def test_without_the_levels_of_a_reference_there_is_no_error(tmp_path):
    rows = [{"run": "x", "state": "finished", "scene": "sliding", "level": 1, "type": 7}]
    assert "force_error" not in reference.add_errors(pd.DataFrame(rows), tmp_path)


# ---- scenes and jobs ---------------------------------------------------------------------------

def test_largest_deviation_looks_at_both_sides():
    assert scenes.largest_deviation([np.array([1.0, 1.1]), np.array([0.7, 1.0])], 1.0) \
        == pytest.approx(0.3)


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
    assert one == scene.penalty(2)
    assert two / slave + two / master == pytest.approx(one / slave, rel=1e-14)
    if name == "sliding":
        assert two / one == pytest.approx(2.0 / 3.0, rel=0.01)


def test_two_passes_of_the_block_have_the_springs_of_one():
    scene = scenes.SCENES["block"]
    factor = scenes.node_penalty(scene, 1, 3) / scene.penalty(1)
    assert block.interface_stiffness(3) * factor == pytest.approx(block.interface_stiffness(5))


def test_implicit_springs_of_the_chain_are_a_step_ahead():
    """Without compliance the faces never overlap; with it the pressure is that of the gap one step later."""
    chain = scenes.chain_module()
    hard = chain.solve(chain.Blocks(penalty=np.inf, ahead=True))
    assert np.all(hard.displacement[:, 0, -1] - hard.displacement[:, 1, 0] <= 1e-15)
    soft = chain.solve(chain.Blocks(penalty=1.0e6, ahead=True))
    overlap = np.maximum(0.0, soft.displacement[1:, 0, -1] - soft.displacement[1:, 1, 0])
    assert soft.pressure[:-1] == pytest.approx(1.0e6 * overlap, rel=1e-9, abs=1e-6) and soft.pressure[-1] > 1e3


def test_implicit_penalty_is_an_interface_of_its_own():
    scene = scenes.SCENES["block"]
    assert scenes.contact_options(scene, 2, "7i") == ("ctype=7", "punit=4", "p:pen=10")
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


def test_divided_lines_keep_the_old_ones():
    lines = np.array([0.0, 0.3, 1.0])
    assert scenes.divided(lines, 2) == pytest.approx([0.0, 0.15, 0.3, 0.65, 1.0])


def test_references_run_once_and_are_not_timed(monkeypatch):
    for name, scene in scenes.SCENES.items():
        monkeypatch.setitem(scenes.SCENES, name, dataclasses.replace(scene, deck=str))
    options = Options(levels=(1, 2, 3, 4), types=(1, 5), repeats=2)
    runs = interleave(study.jobs(options), 2)
    once = [job for job in runs if job.labels["role"] == "reference"]
    assert {(job.labels["scene"], job.labels["level"]) for job in once} == {
        ("sliding", 2), ("sliding", 3), ("sliding", 6), ("collision", 2), ("collision", 4),
        ("collision", 6)}
    assert len(once) == 6 and runs[:6] == once and not any(job.alone for job in once)
    swept = [job for job in runs if job.name == "sliding_3_type_5"]
    assert [job.repeat for job in swept] == [1, 2] and all(job.alone for job in swept)
    assert not any(job.labels["scene"] == "sliding" and job.labels["level"] == 4 for job in runs)


# ---- page --------------------------------------------------------------------------------------

def made_rows(types_of=ALL_TYPES):
    """Type k costs k, the k-th of the series; types 4, 5 and 7 are exact; roughness falls with the type, and with N_r."""
    rows, place = [], list(SERIES)
    for name, scene in scenes.SCENES.items():
        for level in scene.levels:
            for series in types_of:
                ctype = place.index(series) + 1
                row = {"state": "finished", "role": "sweep", "scene": name, "level": level,
                       "type": series, "search": 1.0 * ctype, "pairing": 0.0, "force": 0.0,
                       "contact": 1.0 * ctype,
                       "computing": 100.0 * level + 10.0 * ctype, "elements": 1.0, "element_calls": 101,
                       "processor": "slow one", "load": 1.0, "build": "slideline 0", "points": 10.0 * ctype,
                       "reference_levels": "2, 3, 6"}
                for measure in scene.measures:
                    row[measure.key] = 0.2 / level / (8 - ctype if ctype == 6 else ctype)
                    if measure.referenced:
                        row[f"{measure.key}_floor"], row[f"{measure.key}_order"] = 0.02, 1.0
                if name in advice.PRESSURE_SCENES and ctype in (4, 5, 7, 8, 9):
                    row["pressure_error"] = 1e-12
                rows.append(row)
    return rows


def overview(rows):
    rows = pd.DataFrame(rows)
    return advice.Overview(fronts.points_of(rows, fronts.times_of(rows)))


def test_advice_follows_the_figures():
    over = overview(made_rows())
    assert [ctype for ctype in over.types if over.passes(ctype)] == [4, 5, 7]
    chosen, text = advice.general_advice(over)
    assert chosen == [4, 5] and "**In general type 4 or 5 (VTS-PPT, NTS-mAR).**" in text
    assert "type 4 4.00 (4.00), type 5 5.00 (5.00), type 7 7.00 (7.00)" in text
    assert "so type 7 is dearer and types 4 and 5 are not told apart" in text
    assert "0.80 in Hertz" in text and "of types 4 and 5: alike in Hertz profile (0.25, 0.20)" in text
    smooth = advice.smooth_advice(over, chosen)
    assert "Where the force must be smooth type 5 or 7" in smooth and "type 7 0.14, 7.0 times" in smooth
    assert over.error(5, "hertz", "profile_error") == pytest.approx(0.2)
    # Type 6 errs as type 2 does and is dearer; type 7 errs less than 5, but by less than counts.
    assert advice.outdone(over, 6) == [2, 3, 4] and advice.outdone(over, 7) == [5]


def test_implicit_penalty_stands_beside_type_7():
    rows = [row for row in made_rows(tuple(SERIES)) if row["scene"] != "patch"]
    over = overview(rows)
    assert over.types == list(SERIES) and advice.chosen_types(over) == [4, 5]
    text = advice.general_advice(over)[1]
    assert "so types 7, 7i and 7h are dearer" in text and "Types 4, 5, 7, 7i and 7h transmit" in text
    told = advice.implicit_advice(over)
    assert "**Implicit penalty (PUNIT 4), types 7i and 7h,**" in told
    assert "type 7i (PEN 10): contact 1.14 times" in told and "type 7h (PEN below 0, no compliance): contact 1.29 times" in told
    assert "Hertz profile 0.88, sliding force 0.96, sliding roughness 0.88" in told
    assert advice.outdone(over, "7h") == [7]
    assert "| 7 7i/1, 1.7e+02 s |" in advice.target_table(over)  # 170 and 180 s
    assert advice.implicit_advice(overview(made_rows())) == ""


def test_the_net_moment_is_told_of_the_type_that_has_one():
    rows = made_rows()
    for row in rows:
        row["moment"] = 2e-3 if row["type"] == 4 and row["scene"] == "sliding" else 1e-15
    text = advice.general_advice(overview(rows))[1]
    assert "of type 4 have a net moment, here up to 0.002 of" in text
    assert "with type 5 it is round-off" in text


def test_the_target_table_names_all_that_are_alike():
    over = overview(made_rows())
    cell = advice.target_table(over).splitlines()[2].split("|")[2]  # patch, 30 %
    assert cell.strip() == "1 2/1, 1.1e+02 s"  # 110 and 120 s; 130 s is more than 1.1 times 110 s
    # Type 6 stood alone in such a table beside a sentence that nothing asks for it.
    assert "asks for" not in advice.advice(over)


def test_mesh_or_type_decides():
    rows = made_rows()
    assert "mesh and type both count" in advice.mesh_advice(overview(rows))
    for row in rows:
        row.update({key: 0.9 / row["level"] ** 2 for key in
                    ("force_error", "plastic_error", "total_work_error") if key in row})
    assert "refine first" in advice.mesh_advice(overview(rows))


def test_charts(tmp_path):
    study.chart(pd.DataFrame([row for row in made_rows() if row["scene"] == "block"]), tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        f"block_speed_accuracy.{kind}" for kind in ("svg", "png")}


def test_page(tmp_path, plain_pictures):
    study.page(pd.DataFrame(made_rows(tuple(SERIES))), tmp_path)
    text = (tmp_path / "studies/speed_accuracy.md").read_text()
    assert "**In general type 4 or 5 (VTS-PPT, NTS-mAR).**" in text
    assert "| 4 VTS-PPT | 4 / 1.4e+02 s; < 1e-7 % |" in text
    assert "| 7i PUNIT 4 | 8 / 1.8e+02 s; < 1e-7 % |" in text
    assert "| Sliding: force, rms difference over the mean | 7h | N_r = 2, 3, 6 | 1.00 | 2 % |  |" in text
    assert "(1), (1), (1), 1 %" in text and "nan" not in text  # 0.2/4/5 is below the reference's 0.02
    for name in scenes.SCENES:
        assert (tmp_path / f"pictures/speed_accuracy_{name}.png").stat().st_size < 100_000
    width = None
    for line in text.splitlines():
        width = (width or line.count("|")) if line.startswith("|") else None
        assert width is None or line.count("|") == width, line


def test_page_of_one_type_alone(tmp_path, plain_pictures):
    pages.page(pd.DataFrame([row for row in made_rows((5,)) if row["scene"] != "collision"]), tmp_path)
    assert "In general" not in (tmp_path / "studies/speed_accuracy.md").read_text()
    assert "nan" not in (tmp_path / "studies/speed_accuracy.md").read_text()
    with pytest.raises(UserError, match="no finished runs"):
        pages.page(pd.DataFrame(made_rows((5,)))[:0], tmp_path)


# ---- with the program --------------------------------------------------------------------------

def test_real_runs_of_the_block(slideline, tmp_path, plain_pictures):
    arguments = ["speed-accuracy", "--program", slideline, "--folder", str(tmp_path), "--quick",
                 "--types", "1", "3", "5", "7i", "7h", "--only", "block_1*"]
    assert command.main(arguments) == 0
    rows = pd.read_csv(tmp_path / "speed-accuracy.csv")
    found = dict(zip(rows["type"].astype(str), rows["pressure_error"]))
    assert max(found["5"], found["7i"], found["7h"]) < scenes.ROUND_OFF and 1e-4 < found["3"] < 0.01 < found["1"] < 0.2
    assert (tmp_path / "doc/studies/speed_accuracy.md").exists()
