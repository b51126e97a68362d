# SPDX-License-Identifier: MIT
"""Reports: one HTML file that is well formed, holds the numbers of the run and needs nothing else."""
import base64
import html.parser
import os
import pathlib
import re
import shutil
import subprocess

import conftest
import numpy as np
import pytest

from slideline_tools import UserError, scenes
from slideline_tools.histories import read_csv
from slideline_tools.report import write_report
from slideline_tools.report.gather import read_ending
from slideline_tools.results import read

VOID = {"meta", "img", "br", "hr", "link", "input"}
#: attributes that make a browser fetch something
FETCHING = {"src", "href", "srcset", "poster", "data", "action", "background"}
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")


@pytest.fixture(autouse=True)
def plain(plain_pictures):
    """The report of `written`, whose scope is wider, is drawn in full."""


class Reader(html.parser.HTMLParser):
    """Balance, ids, links, pictures and words of a page."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.links, self.pictures, self.words = [], [], [], [], []
        self.fetched = []
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)
        found = dict(attrs)
        if "id" in found:
            self.ids.append(found["id"])
        assert not any(name.startswith("on") for name in found) and '"' not in found.get("class", "")
        for name in FETCHING & set(found):
            value = found[name]
            if tag == "img" and value.startswith("data:image/"):
                self.pictures.append(found)
            elif tag == "a" and value.startswith("#"):
                self.links.append(value[1:])
            else:
                self.fetched.append((tag, name, value))

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, (tag, self.open)
        self.open.pop()

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


def read_page(path):
    """The page, after what every report has to keep to has been looked at."""
    text = path.read_text(encoding="utf-8")
    page = Reader(text)
    assert not page.fetched
    assert not re.search(r"@import|url\(|<script|<link|<iframe", text)
    assert len(set(page.ids)) == len(page.ids) and set(page.links) <= set(page.ids)
    assert set(page.links) >= {"summary", "warnings", "files", "top"}
    for picture in page.pictures:
        kind, data = re.fullmatch(r"data:image/([a-z+]+);base64,(.*)", picture["src"]).groups()
        content = base64.b64decode(data, validate=True)
        assert content.startswith(b"\x89PNG" if kind == "png" else b"<?xml")
        assert picture["alt"] and int(picture["width"]) > 0
        if kind != "png":
            assert not re.search(rb'(href|src)="(?!#)', content)
    return page


def run_program(program, deck, folder, *arguments):
    done = subprocess.run([program, f"i={deck}", f"d={folder}", *arguments], capture_output=True,
                          text=True, check=False)
    assert done.returncode in (0, 2), done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def collision(tmp_path_factory):
    """Forty microseconds of the collision."""
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    deck = conftest.ROOT / "input" / "collision" / "collision.k"
    return run_program(os.environ["SLIDELINE"], deck, tmp_path_factory.mktemp("run"),
                       "p:endtim=4e-5", "p:dthist=1e-6")


def test_report_shows_how_good_the_answer_of_contact_is(tmp_path):
    """Curves and figures of sleout, where it was written; a run without has none (`written`)."""
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    deck = tmp_path / "block.k"
    text = (conftest.ROOT / "input" / "block" / "block.k").read_text(encoding="utf-8")
    deck.write_text(text.replace("*END", "*DATABASE_SLEOUT\n1.0e-3,\n*END"), encoding="utf-8")
    folder = run_program(os.environ["SLIDELINE"], deck, tmp_path / "run")
    page, sleout = read_page(write_report(folder)), read_csv(folder / "block.sleout.csv")
    assert {"How good the answer of interface 1 is", "Energy that contact of interface 1 has lost"} <= {
        one["alt"] for one in page.pictures}
    assert f"largest estimate {sleout['estimate'].max():.4g}" in page.text
    assert 0.0 < sleout["estimate"].max()


@pytest.mark.parametrize("name, title, sums", [("elout", "Elements", ()), ("rbdout", "Rigid bodies", ()),
                                               ("bndout", "Loads and prescribed motion", ()),
                                               ("nodfor", "Groups of nodes", ("fx", "fy")),
                                               ("secforc", "Cross sections", ())])
def test_report_draws_histories_that_were_asked_for(tmp_path, slideline, name, title, sums):
    """A curve of each column in which something happens; of a group of nodes the sum over them."""
    deck = conftest.ROOT / "doc" / "examples" / f"database_{name}.k"
    folder = run_program(slideline, deck, tmp_path / "run")
    page, rows = read_page(write_report(folder)), read_csv(folder / f"{deck.stem}.{name}.csv")
    drawn = [one["alt"] for one in page.pictures if one["alt"].startswith(f"{title}: ")]
    assert drawn and len(set(drawn)) == len(drawn)
    reported = [rows.where(group=rows["group"][0], time=rows["time"][-1])[column].sum() for column in sums]
    reported = [one for one in reported if abs(one) > 1.0e-9]
    assert bool(reported) == bool(sums)
    row = re.search(rf"group {rows['group'][0]} (.*?) (group|to the top)", page.text)[1].split() if reported else []
    assert {f"{one:.6g}" for one in reported} <= set(row)


@pytest.fixture(scope="module")
def written(collision):
    """Its report in the default place."""
    return write_report(collision)


def test_report_holds_the_numbers_of_the_run(collision, written):
    assert written == collision / "collision.report.html"
    page = read_page(written)
    glstat, rcforc, contact, matsum = (read_csv(collision / f"collision.{name}.csv") for name in
                                       ("glstat", "rcforc", "contact", "matsum"))
    slave = rcforc.where(side="slave")
    results = read(collision / "collision.vtkhdf")
    assert results.run["machine"] and results.run["source"]
    expected = {
        "ratio": f"{glstat['energy_ratio'][-1]:.7g} energy ratio at the end",
        "kinetic": f"{glstat['kinetic'][-1]:.7g}", "hourglass": f"{glstat['hourglass'][-1]:.7g}",
        "force": f"{np.hypot(slave['fx'], slave['fy']).max():.6g}",
        "impulse": f"{np.dot(slave['fy'][1:] + slave['fy'][:-1], np.diff(slave['time'])) / 2:.6g}",
        "pressure": f"{contact['pressure'].max():.6g}",
        "penetration": f"{-contact['gap'].min():.4g}",
        "mass": f"{matsum.where(part=2)['mass'][-1]:.5g}",
        "cycles": "400 cycles", "ending": "normal termination termination time reached",
        "title": "collision of a projectile with a plate", "mesh": "310 nodes, 240 elements, 2 parts",
        "law": "1 elastic-plastic", "density": "7850", "interface": "Interface 1 (NTS-AR, type 2)",
        "machine": f"machine {results.run['machine']}", "source": f"source {results.run['source']}",
        "deck": "*CONTACT_2D_SLIDELINE",
    }
    missing = {name: words for name, words in expected.items() if words not in page.text}
    assert not missing
    assert {"energies", "contact", "fields", "asked", "model", "timing"} <= set(page.ids)
    lines = [one["alt"] for one in page.pictures if one["src"].startswith("data:image/svg+xml")]
    assert len(lines) == 7  # none of the time step, which is constant, nor of what is zero
    assert "The time step is 1e-07 throughout" in page.text
    fields = [one["alt"] for one in page.pictures if one["src"].startswith("data:image/png")]
    top = min(read(collision / "collision.vtkhdf").times,
              key=lambda time: abs(time - slave["time"][np.argmax(slave["fy"])]))
    for name in ("effective plastic strain", "von Mises stress (deck units)"):
        assert any(re.fullmatch(rf"{re.escape(name)} at time .*\b{top:.4g} and 4e-05", one) for one in fields)


def test_timing_of_the_report_is_that_of_the_table(collision, written):
    page = read_page(written)
    table = read_csv(collision / "collision.timing.csv")
    for phase, seconds, calls in zip(table["phase"], table["seconds"], table["calls"]):
        assert f"{phase.replace('_', ' ')} {seconds:.4f}" in page.text
        assert f"{calls:,d}".replace(",", " ") in page.text


def test_chosen_fields_and_states(collision, tmp_path, tool):
    finished = tool("report", collision / "collision.vtkhdf", "--field", "stress:xy", "--field",
                    "gap", "--state", "2e-5", "-o", tmp_path / "new" / "r.html")
    assert finished.returncode == 0, finished.stderr
    page = read_page(tmp_path / "new" / "r.html")
    assert [picture["alt"] for picture in page.pictures if "png" in picture["src"][:20]] == [
        f"{name} (deck units) at time 2e-05" for name in ("stress xy", "contact gap")]
    assert tool("report", collision, "--field", "colour", "-o", tmp_path / "s.html").returncode == 2


def test_a_program_that_is_not_there_is_reported_with_how_to_name_one(collision, tmp_path):
    page = write_report(collision, tmp_path / "page.html", program="/nowhere/slideline").read_text(encoding="utf-8")
    assert "cannot run the program /nowhere/slideline" in page and "name it by --program" in page


# ---- runs that lack something -------------------------------------------------------------------

def test_killed_run(collision, tmp_path):
    """Empty log, no timing, tables cut off, no histories in the results."""
    cut = tmp_path / "cut"
    shutil.copytree(collision, cut)
    (cut / "collision.log").write_text("")
    (cut / "collision.timing.csv").unlink()
    lines = (cut / "collision.glstat.csv").read_text().splitlines()[:21]
    (cut / "collision.glstat.csv").write_text("\n".join(lines) + "\n")
    page = read_page(write_report(cut, tmp_path / "r.html"))
    assert "not finished" in page.text and "the log is empty" in page.text
    ratio = float(lines[-1].split(",")[lines[0].split(",").index("energy_ratio")])
    assert f"{ratio:.7g} energy ratio" in page.text
    assert f"{float(lines[-1].split(',')[0]):.6g} problem time" in page.text
    assert "*MAT_PLASTIC_KINEMATIC" in page.text and "timing" not in page.ids
    assert {"energies", "contact", "fields"} <= set(page.ids)


@pytest.mark.parametrize("kept", ["glstat.csv", "effective.k", "log", "vtkhdf"])
def test_single_file(collision, tmp_path, kept):
    (tmp_path / "one").mkdir()
    shutil.copy(collision / f"collision.{kept}", tmp_path / "one")
    page = read_page(write_report(tmp_path / "one" / f"collision.{kept}", tmp_path / "r.html"))
    assert ("energies" in page.ids) == (kept in ("glstat.csv", "vtkhdf"))
    assert ("fields" in page.ids) == (kept == "vtkhdf")
    assert ("model" in page.ids) == (kept in ("effective.k", "vtkhdf"))


def test_run_before_its_first_state(collision, tmp_path):
    (tmp_path / "x.vtkhdf.part").write_bytes(b"\x89HDF")
    shutil.copy(collision / "collision.effective.k", tmp_path / "x.effective.k")
    (tmp_path / "x.log").write_text("")
    page = read_page(write_report(tmp_path, tmp_path / "r.html"))
    assert "before it had written the first one" in page.text


def test_run_without_plot_states_or_contact(tmp_path, slideline):
    deck = tmp_path / "plate.k"
    text = scenes.symmetric_plate(8, 4)
    deck.write_text(re.sub(r"\*DATABASE_BINARY_D3PLOT\n(\$.*\n)*.*\n", "", text))
    folder = run_program(slideline, deck, tmp_path / "run", "endtim=1e-4")
    page = read_page(write_report(folder, tmp_path / "r.html"))
    assert "normal termination" in page.text
    assert "contact" not in page.ids and "energies" in page.ids


def test_implicit_run(tmp_path, slideline):
    deck = tmp_path / "hertz.k"
    deck.write_text(scenes.hertz(1, static=True))
    folder = run_program(slideline, deck, tmp_path / "run")
    page = read_page(write_report(folder, tmp_path / "r.html"))
    peak = read_csv(folder / "hertz.rcforc.csv").where(side="slave")["fy"].max()
    assert f"fy {peak:.5g}" in page.text and "solver" in page.text


def test_error_termination_and_warnings():
    text = """slideline 0.1.0 (Release, GNU)
title: a <b>bold</b> title
warning: the step is long
restart from the restart file x
warning: interface 1: deep & bad

 *** element 7 has turned inside out ***
 E r r o r    t e r m i n a t i o n

 Problem time        =   1.25000000E-03
 Problem cycle       = 12500
 Elapsed time        = .195 seconds
"""
    end = read_ending(text, {}, None, None)
    assert (end.kind, end.reason) == ("error", "element 7 has turned inside out")
    assert (end.time, end.cycle, end.seconds) == (1.25e-3, 12500, 0.195)
    assert read_ending(text + "restart from the restart file y\n", {}, None, None).kind == "unfinished"


def test_text_is_escaped(tmp_path):
    """A title with markup, and warnings in the order of the log."""
    (tmp_path / "x.log").write_text("title: a <b>bold</b> & \"quoted\" title\nwarning: one <i>\n"
                                    "warning: two\n")
    path = write_report(tmp_path, tmp_path / "r.html")
    page = read_page(path)
    assert 'a <b>bold</b> & "quoted" title' in page.text and "<b>bold" not in path.read_text()
    assert page.text.index("one <i>") < page.text.index("two")
    assert "2 warnings" in page.text


def test_hand_written_results(results_file, tmp_path):
    """A lone results file whose histories lack most columns is no reason to fail."""
    page = read_page(write_report(results_file, tmp_path / "r.html"))
    assert "three cells" in page.text and "could not be made" in page.text
    assert "glstat has no column" in page.text and "fields" in page.ids


def test_no_run(tmp_path, tool):
    with pytest.raises(UserError, match="no such"):
        write_report(tmp_path / "nothing")
    finished = tool("report", tmp_path)
    assert finished.returncode == 2 and "no run" in finished.stderr


# ---- a browser ----------------------------------------------------------------------------------

@pytest.fixture
def browser():
    for name in BROWSERS:
        if path := shutil.which(name):
            return path
    pytest.skip(f"no browser ({', '.join(BROWSERS)})")


@pytest.mark.parametrize("width", [390, 1100])
def test_in_a_browser(written, tmp_path, browser, width):
    """Every picture is decoded, nothing is wider than the window, nothing is fetched."""
    path = tmp_path / "r.html"
    probe = ("<script>addEventListener('load', () => { const images = [...document.images];"
             "document.documentElement.dataset.seen = [images.length,"
             "images.filter(i => i.complete && i.naturalWidth > 0).length,"
             "document.documentElement.scrollWidth - innerWidth,"
             "performance.getEntriesByType('resource')"
             ".filter(e => !e.name.startsWith('data:')).length].join(' ') })</script>")
    path.write_text(written.read_text().replace("</body>", f"{probe}</body>"))
    frame = tmp_path / "frame.html"  # a window of a browser is not narrower than about 500 pixels
    frame.write_text(f'<iframe src="r.html" width="{width}" height="900"></iframe><script>'
                     "addEventListener('load', () => setTimeout(() => { document.title = "
                     "document.querySelector('iframe').contentDocument"
                     ".documentElement.dataset.seen }, 0))</script>")
    done = subprocess.run(
        [browser, "--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files",
         f"--user-data-dir={tmp_path / 'profile'}", "--virtual-time-budget=5000", "--dump-dom",
         frame.as_uri()], capture_output=True, text=True, timeout=240, check=False)
    found = re.search(r"<title>(\d+) (\d+) (-?\d+) (\d+)</title>", done.stdout)
    assert found, done.stdout[-2000:] + done.stderr[-2000:]
    images, decoded, beyond, fetched = (int(number) for number in found.groups())
    assert images == decoded > 5 and beyond <= 0 and fetched == 0


def walled(folder, program, more=""):
    """The bar of doc/examples that hits a wall, with states."""
    text = (conftest.ROOT / "doc/examples/rigidwall_planar.k").read_text()
    deck = folder / "bar.k"
    deck.write_text(text.replace("*END", f"*DATABASE_BINARY_D3PLOT\n0.02,\n{more}*END"))
    return run_program(program, deck, folder / "run")


def test_rigid_walls(tmp_path, slideline):
    """Where a wall stands, and its impulse: twice the momentum of the bar less what the end nodes lose."""
    page = write_report(walled(tmp_path, slideline)).read_text(encoding="utf-8")
    section = page[page.index("Rigid walls</h2>"):]
    words = re.sub(r"<[^>]+>", " ", section[:section.index("</section>")] if "</section>" in section else section[:400000])
    row = re.search(r"\b1((?:\s+[-0-9.e+]+){9})", words)[1].split()
    assert row[:4] == ["1.001", "0", "-1", "0"]
    impulse = float(row[6])
    assert abs(impulse - 2.0 * 1000.0 * 0.1 * 0.5) < 5.0
    assert "Force of wall 1 on the nodes" in page


def test_no_wall_no_section(written):
    assert "Rigid walls" not in pathlib.Path(written).read_text(encoding="utf-8")


def test_walls_without_forces_and_in_pictures(tmp_path, slideline):
    """A wall with a number of its own, in the picture of a state; no rwforc."""
    from matplotlib import pyplot
    from slideline_tools import plots
    from slideline_tools.results import read
    run = walled(tmp_path, slideline, "*RIGIDWALL_PLANAR_ID\n        77\n,\n0.0,-0.001,,0.0,1.0\n")
    (run / "bar.rwforc.csv").unlink()
    results = read(run)
    figure = plots.field_figure(results, "mises", ["-1"])
    axes = figure.axes[0]
    assert {word.get_text() for word in axes.texts} == {"wall 1", "wall 77"}
    ends = sorted(tuple(np.round(line.get_xydata().mean(axis=0), 9)) for line in axes.lines)
    assert len(ends) == 2 and any(abs(x - 1.001) < 1e-9 for x, _ in ends) and any(abs(y + 0.001) < 1e-9 for _, y in ends)
    pyplot.close(figure)
