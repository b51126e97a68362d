# SPDX-License-Identifier: MIT
"""The study simplify: its decks, how results are compared, its figures, and real runs of it."""
import os
import re

import conftest
import numpy as np
import pandas as pd
import pytest

from slideline_tools import scenes
from slideline_tools.histories import History
from slideline_tools.studies import __main__ as command
from slideline_tools.studies.framework.job import Options
from slideline_tools.studies.simplify import compare, decks as simplify_decks, study as simplify

LEVEL = 2


# ---- decks -------------------------------------------------------------------------------------

def cards(deck, keyword, widths):
    """Numbers of the cards of all keywords of that name."""
    rows, inside = [], False
    for line in deck.splitlines():
        if line.startswith("*"):
            inside = line == "*" + keyword
        elif inside and not line.startswith("$"):
            if "," in line:
                rows.append([float(word) for word in line.split(",")])
                continue
            edges = np.concatenate([[0], np.cumsum(widths)])
            rows.append([float(line[a:b] or 0) for a, b in zip(edges[:-1], edges[1:])])
    return rows


def mesh(deck):
    nodes = {int(n): (x, y) for n, x, y in cards(deck, "NODE", (8, 16, 16))}
    quads = {int(row[0]): [int(n) for n in row[2:]]
             for row in cards(deck, "ELEMENT_SHELL", (8,) * 6)}
    return nodes, quads


def areas(nodes, quads):
    corners = np.array([[nodes[n] for n in quad] for quad in quads.values()])
    x, y = corners[..., 0], corners[..., 1]
    return 0.5 * np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)


def set_of(deck, number):
    found = re.search(rf"\*SET_NODE_LIST_TITLE\n[^\n]*\n[^\n]*\n +{number}\n\$[^\n]*\n([ \d\n]+)",
                      deck)
    return [int(word) for word in found[1].split()]


def test_full_model_is_the_half_model_and_its_mirror_image():
    (nodes, quads), (half_nodes, half_quads) = (
        mesh(deck) for deck in (simplify_decks.full_collision(LEVEL), scenes.collision(LEVEL)))
    assert len(quads) == 2 * len(half_quads)
    on_axis = sum(x == 0.0 for x, _ in half_nodes.values())
    assert len(nodes) == 2 * len(half_nodes) - on_axis
    assert all(nodes[n] == place for n, place in half_nodes.items())
    assert set(nodes.values()) == {(-x, y) for x, y in nodes.values()} and areas(nodes, quads).min() > 0
    assert areas(nodes, quads).sum() == pytest.approx(2.0 * areas(half_nodes, half_quads).sum())


def test_surfaces_of_the_full_model_are_walked_with_the_body_on_the_left():
    deck = simplify_decks.full_collision(LEVEL)
    nodes = mesh(deck)[0]
    slave, master = (np.array([nodes[n] for n in set_of(deck, k)]) for k in (3, 4))
    assert (np.diff(slave[:, 0]) > 0).all() and (np.diff(master[:, 0]) < 0).all()
    assert slave[0, 0] == -slave[-1, 0] and master[0, 0] == -master[-1, 0] == 0.025
    assert len(slave) == 2 * 24 * LEVEL + 1 and len(master) == 2 * 20 * LEVEL + 1
    clamped = [nodes[n][0] for n in set_of(deck, 2)]
    assert sorted(set(clamped)) == [-0.065, 0.065]
    assert deck.count("*BOUNDARY_SPC_SET") == 1


def test_awake_adds_one_card_that_asks_for_a_search_each_cycle():
    deck = scenes.collision(1)
    added = [line for line in simplify_decks.awake(deck).splitlines()
             if line not in deck.splitlines()]
    assert len(added) == 2 and added[0].split()[-2:] == ["freq", "srch"]
    assert [float(added[1][k:k + 10]) for k in range(0, 80, 10)] == [0, 0, 0, 0, 0, 0, 1, 0]


def test_plastic_law_has_the_elastic_numbers():
    deck = simplify_decks.plastic_hertz(scenes.hertz(1))
    assert "MAT_ELASTIC" not in deck and deck.count("*MAT_PLASTIC_KINEMATIC") == 2
    law = cards(deck, "MAT_PLASTIC_KINEMATIC", (10,) * 7)
    assert [row[4] for row in law[::2]] == [simplify_decks.UNREACHABLE] * 2
    assert [row[:4] for row in law[::2]] == cards(scenes.hertz(1), "MAT_ELASTIC", (10,) * 4)


def test_a_text_that_is_not_there_once_is_an_error():
    with pytest.raises(ValueError, match="2 times"):
        simplify_decks.exchanged("a a", "a", "b")


# ---- comparison --------------------------------------------------------------------------------

def force(times, values):
    return History("rcforc", {"time": np.array(times), "fy": np.array(values),
                              "side": np.array(["slave"] * len(times))})


def test_force_distance_by_hand():
    one, other = force([0., 1., 2.], [0., 3., 0.]), force([0., 1., 2.], [0., 4., 0.])
    found = compare.force_distance(one, other, 0.5)
    assert found["force_error"] == pytest.approx(0.5)
    assert compare.force_distance(one, force([0., 2.], [0., 0.]), 1.0) == {}


def test_same_bits_of_all_histories(tmp_path):
    one, other = tmp_path / "one", tmp_path / "other"
    for folder in (one, other):
        folder.mkdir()
        (folder / "run.glstat.csv").write_text("time\n1.0\n")
    assert compare.same_bits(one, other, "run")
    (one / "run.rcforc.csv").write_text("time\n1.0\n")
    assert not compare.same_bits(one, other, "run")
    (other / "run.rcforc.csv").write_text("time\n1.0000000000000002\n")
    assert not compare.same_bits(one, other, "run")


def test_medians_and_shares_of_processor_time():
    def table(*runs):
        rows = [dict(zip(("processor_seconds", "total", "contact"), run)) for run in runs]
        return pd.DataFrame(rows).assign(state="finished", variant="a", level=1, elements=5.0, nodes=0.0, input=0.0,
                                         computing=10.0)

    runs = simplify.medians_of(table((1.0, 10.0, 4.0), (3.0, 10.0, 2.0), (2.0, 20.0, 2.0))).loc["a", 1]
    assert runs["seconds"] == 2.0 and runs["elements"] == pytest.approx(2.0 * 15.0 / 40.0)
    assert runs["contact"] == pytest.approx(2.0 * 8.0 / 40.0) and runs["output"] == pytest.approx(2.0 * 10.0 / 40.0)
    assert runs["spread"] == pytest.approx(0.5)
    assert simplify.medians_of(table((1.0, 10.0, 4.0), (1.0, 10.0, 0.1))).loc[("a", 1), "contact"] == 0.1


def test_differences_in_words():
    assert [simplify.small_share(value) for value in (None, 0.0, 0.0123, 2e-13)] == ["", "the same", "1.2 %", "2e-13"]


def test_all_that_is_compared_is_run():
    names = set(simplify.variants())
    assert {one.against[0] for one in simplify.variants().values()} - {""} <= names
    assert {name for step in simplify.STEPS for name in step[1:]} <= names


def test_types_that_are_not_asked_for_do_not_run():
    jobs = simplify.jobs(Options((1,), (2,), True, 1))
    assert not [job.name for job in jobs if re.search("_type_[^2]", job.name)]


# ---- real runs ---------------------------------------------------------------------------------

@pytest.fixture(scope="module")
def short_study(tmp_path_factory):
    """The study on the coarsest meshes, one round, each run cut after the first contact."""
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE names no program")
    folder = tmp_path_factory.mktemp("simplify")
    original = simplify.jobs

    def shortened(options):
        return [simplify.dataclasses.replace(job, options=(
                    *job.options, "endtim=2.5e-5"))
                for job in original(options) if job.labels["variant"].startswith("collision")]

    with pytest.MonkeyPatch.context() as patch:
        conftest.draw_plainly(patch)
        study = simplify.dataclasses.replace(simplify.STUDY, jobs=shortened)
        patch.setattr(command.pages, "load", lambda _: study)
        assert command.main(["simplify", "--quick", "--repeats", "1", "--folder", str(folder)]) == 0
    return folder


def first_rows(folder):
    """The first run of each variant."""
    table = pd.read_csv(folder / "simplify.csv")
    return table[table["repeat"] == 1].set_index("variant").to_dict("index")


def test_asleep_and_awake_give_the_same_bits(short_study):
    rows = first_rows(short_study)
    for ctype in (1, 2, 4, 5, 6, 7):
        assert rows[f"collision_awake_type_{ctype}"]["same_bits"] == 1, ctype
    assert rows["collision_wider_awake_type_3"]["same_bits"] == 1
    # What is not the same must be seen.
    assert rows["collision"]["same_bits"] == rows["collision_no_states"]["same_bits"] == 0


def test_half_model_agrees_with_the_full_one(short_study):
    """Type 7 to round-off; type 2 but for the tilt of the last segment at the plane of symmetry."""
    rows = first_rows(short_study)
    assert rows["collision_type_7"]["force_error"] < 1e-10
    assert 1e-10 < rows["collision"]["force_error"] < 1e-4
    assert rows["collision_type_7"]["displacement_error"] < 1e-12


def test_elastic_law_changes_no_field(short_study):
    rows = first_rows(short_study)
    assert rows["collision_plastic_projectile"]["same_states"] == 1
    assert 0.0 < rows["collision"]["processor_seconds"] < 60.0
    assert rows["collision_no_states"]["bytes"] < rows["collision"]["bytes"]


def test_page(short_study):
    page = (short_study / "doc" / "studies" / "simplify.md").read_text(encoding="utf-8")
    assert "{" not in page and "nan" not in page
    lines = [line for line in page.splitlines() if line.startswith("| search asleep: collision |")]
    assert len(lines) == 1 and lines[0].count("same bits") == 3
    assert len(re.findall(r"^\| [1-7] .*\| yes \|$", page, re.MULTILINE)) == 7
    assert (short_study / "doc" / "pictures" / "simplify.png").stat().st_size < 100_000
