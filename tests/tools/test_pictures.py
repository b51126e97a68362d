# SPDX-License-Identifier: MIT
"""Pictures come out non-empty, show the right numbers, and wrong requests are named."""
import shutil

import h5py
import numpy as np
import pytest
from PIL import Image

from slideline_tools import UserError, plots
from slideline_tools.fields import default_field, scalar_field
from slideline_tools.report import charts
from slideline_tools.results import read


def assert_picture(path):
    with Image.open(path) as picture:
        assert min(picture.size) > 200
        assert len(picture.convert("RGB").getcolors(2**24)) > 50


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
    with pytest.raises(UserError):
        plots.report_figure(results, state="9")


def test_a_flat_model_has_room_for_its_labels(results_file):
    """The label of x was cut in two where a flat mesh has its y in thousandths."""
    for states in (["-1"], ["1", "-1"]):
        figure = plots.field_figure(read(results_file), "mises", states, zoom=(0.0, 0.036, -0.006, 0.003))
        figure.canvas.draw()
        for axes in figure.axes[:len(states)]:
            assert axes.xaxis.label.get_window_extent().y0 > 0.0
            assert axes.yaxis.get_offset_text().get_window_extent().y1 <= axes.title.get_window_extent().y0 + 2.0
        plots.plt.close(figure)


def test_pictures_and_reports_write_powers_alike(results_file):
    """Pictures had a cross and an exponent, reports the E of a number."""
    with plots.plt.rc_context(plots.STYLE):
        figures = [charts.lines([("", np.arange(3.0), 1.0e8 * np.arange(3.0))], "pressure"),
                   plots.field_figure(read(results_file), "mises", zoom=(0.0, 0.036, -0.006, 0.003))]
    for figure in figures:
        figure.canvas.draw()
        assert "times" in figure.axes[0].yaxis.get_offset_text().get_text()
        plots.plt.close(figure)


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


@pytest.mark.parametrize("low, high, beyond", [(0.0, 0.2417, "neither"), (-3.1e8, 3.1e8, "neither"), (0.0, 0.1, "max"),
                                               (0.05, 1.0, "min"), (0.05, 0.1, "both")])
def test_colour_bar_has_round_ticks(low, high, beyond):
    """Multiples of 1, 2, 2.5 or 5 times a power of ten within the scale; pointed where values lie beyond it."""
    figure, axes = plots.plt.subplots()
    artist = axes.pcolormesh(np.array([[low, high], [0.02, 0.2417]]))
    artist.set_clim(low, high)
    bar = plots.colour_bar(artist, [axes], "stress (deck units)")
    ticks = np.array([tick for tick in bar.get_ticks() if low <= tick <= high])
    step = np.diff(ticks)
    assert 3 <= len(ticks) <= 7 and np.allclose(step, step[0])
    assert min(abs(step[0] / 10.0 ** np.floor(np.log10(step[0])) - axisym_one) for axisym_one in (1, 2, 2.5, 5, 10)) < 1e-9
    assert np.allclose(ticks / step[0], np.round(ticks / step[0])) and bar.extend == beyond
    plots.plt.close(figure)


def test_round_off_is_drawn_as_zero(results_file):
    """Beside the largest value of all components of the field, and of all columns of one kind."""
    with h5py.File(results_file, "r+") as stream:
        stress = stream["VTKHDF/CellData/stress"]
        stress[:] = np.where(np.arange(6) == 3, 1e-9, 2e4 * np.ones((9, 6)))
        stream["history/rcforc/fx"][:] = 1e-14
    results = read(results_file)
    assert np.all(scalar_field(results, "stress:xy").values == 0.0)
    assert np.all(scalar_field(results, "stress:xx").values == 2e4)
    rows = results.history("rcforc")
    assert np.all(plots.drawn(rows, "fx", rows) == 0.0) and np.array_equal(
        plots.drawn(rows, "fy", rows)[1:-2], rows["fy"][1:-2])
    figure = plots.history_figure(results, ["rcforc:fx"])
    assert all(np.all(line.get_ydata() == 0.0) for line in figure.axes[0].lines)
    plots.plt.close(figure)


def test_what_a_scale_cuts_is_marked():
    figure, axes = plots.plt.subplots()
    axes.set(xlim=(0.0, 4.0), ylim=(-1.0, 1.0))
    plots.mark_cut(axes, [0.0, 1.0, 2.0, 3.0, 9.0], np.array([5.0, 0.5, -3.0, 2.0, 7.0]), "red")
    up, down = axes.lines
    assert (up.get_xdata().tolist(), down.get_xdata().tolist()) == ([0.0, 3.0], [2.0])
    plots.plt.close(figure)
