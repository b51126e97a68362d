# SPDX-License-Identifier: MIT
"""What CTYPE 0 is judged by."""
import pathlib

import pytest

from slideline_tools.studies import chooses

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("scene", chooses.SCENES)
def test_ctype_0_is_judged_by_the_errors_of_the_page(scene):
    titles, errors = chooses.published(scene, ROOT / "doc")
    assert all(title == " ".join(title.split()) for title in titles)
    assert all(len(found) == len(titles) and min(found) > 0.0 for found in errors.values())


def test_an_error_below_that_of_its_reference_counts_as_that():
    page = ("| Collision: rebound | 7 | N_r = 2, 4, 6 | 0.50 | 2.4 % | 11 % |\n"
            "| Collision: rebound | 7h | N_r = 2, 4, 6 | 0.50 | 1.9 % | 11 % |\n")
    assert chooses.known_error(page, "Collision: rebound", "(0.0026)") == 2.4
    assert chooses.known_error(page, "Collision: rebound", "3.1") == 3.1
