# SPDX-License-Identifier: MIT
"""Slave and master exchanged: decks, penalties, differences."""
import re

import numpy as np
import pytest

from slideline_tools import scenes
from slideline_tools.studies import exchange

SCENES = ("patch", "block", "sliding", "collision", "oblique")


def contact_card(text):
    lines = text.splitlines()
    start = lines.index("*CONTACT_2D_SLIDELINE")
    return next(line.split()[:2] for line in lines[start + 1:] if not line.startswith("$"))


@pytest.mark.parametrize("scene", SCENES)
def test_exchange_swaps_the_two_surfaces_and_nothing_else(scene):
    plain = getattr(scenes, scene)()
    other = getattr(scenes, scene)(exchanged=True)
    assert contact_card(plain) == ["-3", "-4"]
    assert contact_card(other) == ["-4", "-3"]
    changed = [pair for pair in zip(plain.splitlines(), other.splitlines()) if pair[0] != pair[1]]
    assert len(plain.splitlines()) == len(other.splitlines())
    # title, two headings, the contact card
    assert len(changed) == 4
    assert sum("slave" in old and "master" in new for old, new in changed) == 1
    assert sum("master" in old and "slave" in new for old, new in changed) == 1


def test_mean_lengths_are_those_of_the_decks():
    grids = {"patch": scenes.patch_grids(), "block": scenes.block_grids(),
             "collision": scenes.collision_grids(1), "sliding": scenes.sliding_grids(1)}
    for scene, (lower, upper) in grids.items():
        found = exchange.mean_lengths()[scene]
        steps = np.linalg.norm(np.diff(upper.points[:, 0], axis=0), axis=-1)
        assert found[0] == pytest.approx(steps.mean(), rel=1e-12)
        master = np.diff(lower.points[:, -1, 0])
        if scene == "collision":
            master = master[:20]  # the master surface ends at 25 mm
        assert found[1] == pytest.approx(master.mean(), rel=1e-12)


def test_turned_block_of_the_oblique_impact():
    large, turned = scenes.oblique_grids()
    lowest = turned.points[..., 1].min()
    assert lowest == pytest.approx(0.01)
    assert np.argmin(turned.points[..., 1]) == 0  # the lower left corner hits first
    edge = turned.points[-1, 0] - turned.points[0, 0]
    assert np.degrees(np.arctan2(edge[1], edge[0])) == pytest.approx(30.0)
    assert exchange.mean_lengths()["oblique"] == pytest.approx(
        (np.linalg.norm(edge) / 7, np.diff(large.points[:, -1, 0]).mean()))


def test_difference_is_in_per_cent_of_the_value_or_of_the_scale():
    own = exchange.Quantity("a", None)
    scaled = exchange.Quantity("b", None, scale=80.0)
    assert exchange.difference(own, -2.0, -3.0) == pytest.approx(-50.0)
    assert exchange.difference(scaled, 5.0, 9.0) == pytest.approx(5.0)


def test_list_of_runs(tmp_path, capsys):
    exchange.write_decks(tmp_path)
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [row[0] for row in rows] == [f"{scene}{tail}" for scene in SCENES
                                        for tail in ("", "_exchanged")]
    for name, scene, penalty, penalty_3 in rows:
        assert (tmp_path / f"{name}.k").exists()
        assert float(penalty_3) == exchange.PENALTIES[scene]
    # eps / l_sl stays: 1e6 / 0.2 = 1.25e6 / 0.25
    assert float(rows[1][2]) == pytest.approx(1.25e6)


def test_energy_that_contact_made_is_named(monkeypatch):
    """Type 4 keeps 6.3 % when exchanged, type 5 makes 3 and 9 %, type 1 neither by 1 %."""
    made = {(1, False): 0.004, (1, True): 0.009, (4, False): 0.0, (4, True): 0.0, (5, False): 0.031,
            (5, True): 0.094}
    kept = {(1, False): 0.004, (1, True): -0.009, (4, False): 0.0, (4, True): 0.063, (5, False): -0.2,
            (5, True): 0.0}

    class Made:
        def __init__(self, _folder, _scene, ctype, exchanged):
            self.case = ctype, exchanged

        def made(self):
            return made[self.case]

        def kept(self):
            return kept[self.case]

    monkeypatch.setattr(exchange, "Run", Made)
    assert exchange.made_text(None, (1, 4, 5)) == (
        "Of the energy of the flight, where it is more than 1 %: as it is contact made: type 5 3.1 %; "
        "exchanged contact made: type 5 9.4 %; exchanged contact kept: type 4 6.3 %.")
    assert exchange.made_text(None, ()) == ""


@pytest.mark.parametrize("scene", SCENES)
def test_decks_ask_for_the_energies_of_interfaces(scene):
    """At the times of glstat, whatever lines stand between keyword and card."""
    plain = getattr(exchange.scenes, scene)()
    deck = exchange.with_interface_energies(plain)
    cards = {name: re.search(rf"\*DATABASE_{name}\n((?:[^*\n].*\n)+)", deck) for name in ("GLSTAT", "SLEOUT")}
    assert cards["GLSTAT"].group(1) == cards["SLEOUT"].group(1) and "SLEOUT" not in plain
