# SPDX-License-Identifier: MIT
"""Pictures come out non-empty, show the right numbers, and wrong requests are named."""
import shutil

import numpy as np
import pytest
from PIL import Image

from slideline_tools import plots
from slideline_tools.fields import default_field, scalar_field
from slideline_tools.results import ResultsError, read


def assert_picture(path):
    with Image.open(path) as picture:
        colours = np.asarray(picture.convert("RGB")).reshape(-1, 3)
        assert min(picture.size) > 200
    assert len(np.unique(colours, axis=0)) > 50


@pytest.mark.parametrize("options", [
    [], ["--field", "plastic_strain"], ["--field", "stress:xy", "--state", "0.5"],
    ["--field", "displacement:y", "--scale", "3"], ["--field", "displacement"],
    ["--field", "mises", "--state", "0", "--state", "1", "--state", "-1"],
    ["--zoom", "0", "1", "0", "1"],
    ["--history", "glstat:kinetic,internal"],
    ["--history", "glstat:total", "--history", "rcforc:fy@side=slave"],
    ["--contact"], ["--contact", "--state", "1", "--state", "2"]])
def test_plot(tmp_path, tool, results_file, options):
    path = tmp_path / "pictures" / "x.png"
    finished = tool("plot", results_file, *options, "--output", path)
    assert finished.returncode == 0, finished.stderr
    assert_picture(path)


@pytest.mark.parametrize("options, message", [
    (["--field", "strain"], "no field 'strain'"),
    (["--field", "stress"], "stress:xx, stress:yy"),
    (["--field", "mises:x"], "no components"),
    (["--state", "7"], "no state 7"),
    (["--history", "glstat:"], "expected TABLE:COLUMN"),
    (["--history", "glstat"], "with columns of cycle, internal, kinetic, total"),
    (["--history", "glstat:heat"], "no column 'heat'"),
    (["--history", "elout:x"], "no history 'elout'"),
    (["--history", "rcforc:fy@side=left"], "no side 'left'"),
    (["--history", "rcforc:fy@interface=9"], "no rows"),
    (["--contact", "--history", "glstat:total"], "choose one")])
def test_plot_refusals(tmp_path, tool, results_file, options, message):
    finished = tool("plot", results_file, *options, "--output", tmp_path / "x.png")
    assert finished.returncode == 2
    assert message in finished.stderr and "Traceback" not in finished.stderr
    assert not (tmp_path / "x.png").exists()


def test_scale_multiplies_the_displacement(results_file):
    results = read(results_file)
    start = plots.deformed(results, 2, 0.0)
    np.testing.assert_allclose(start, results.points[0][:, :2], atol=1e-14)
    twice = plots.deformed(results, 2, 2.0) - start
    np.testing.assert_allclose(twice, 2.0 * results.point_field("displacement")[2][:, :2])


def test_colours_span_the_values_of_the_shown_states(results_file):
    results = read(results_file)
    field = scalar_field(results, "plastic_strain")
    assert field.limits() == (0.0, 0.2)
    assert field.limits([1]) == (0.0, 0.1)
    signed = scalar_field(results, "stress:xx")
    low, high = signed.limits()
    assert low == -high == -8.0


def test_vector_without_component_is_its_length(results_file):
    field = scalar_field(read(results_file), "displacement")
    assert field.values[2, 6] == pytest.approx(np.hypot(0.3, 0.2))


def test_default_field(results_file):
    assert default_field(read(results_file)) == "plastic_strain"


def test_two_panels_in_the_report_picture(results_file):
    results = read(results_file)
    assert [title for _, title in plots.report_requests(results)] == [
        "energy", "contact force in y"]
    with pytest.raises(ResultsError):
        plots.report_figure(results, state="9")


def test_animation(tmp_path, tool, results_file):
    path = tmp_path / "x.gif"
    finished = tool("animate", results_file, "--field", "mises", "--output", path)
    assert finished.returncode == 0, finished.stderr
    with Image.open(path) as picture:
        assert picture.n_frames == 3


def test_mp4_is_made_or_refused_with_the_reason(tmp_path, tool, results_file):
    path = tmp_path / "x.mp4"
    finished = tool("animate", results_file, "--output", path)
    if shutil.which("ffmpeg"):
        assert finished.returncode == 0 and path.stat().st_size > 0
    else:
        assert finished.returncode == 2 and "ffmpeg" in finished.stderr


def test_animation_of_another_kind(tmp_path, tool, results_file):
    finished = tool("animate", results_file, "--output", tmp_path / "x.avi")
    assert finished.returncode == 2 and ".gif or .mp4" in finished.stderr
