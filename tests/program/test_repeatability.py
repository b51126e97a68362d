# SPDX-License-Identifier: MIT
"""The same bits again: effective deck, thread count, plain repetition."""
import pytest
from conftest import drop
from meshes import Deck, grid

TABLES = ("glstat", "rcforc", "nodout", "contact", "matsum")


def tables(folder, job="job"):
    return {name: (folder / f"{job}.{name}.csv").read_bytes() for name in TABLES}


def cards(text):
    """A deck without its comments."""
    return [line for line in text.splitlines() if not line.startswith("$")]


def test_effective_deck_runs_to_the_same_bits(slideline, tmp_path):
    (tmp_path / "part.k").write_text("*PARAMETER\nR  extra,0.25\n")
    text = drop(parametric=True).text().replace("0.3,&v0", "&extra,&v0")
    text = text.replace("*TITLE", "*INCLUDE\npart.k\n*TITLE", 1)
    done = slideline("d=a", "ctype=3", "pen=1.5e5", "p:v0=-1.5", "endtim=0.015", "tssfac=0.5",
                     deck=text)
    assert done.returncode == 0, done.stderr
    effective = (tmp_path / "a" / "job.effective.k").read_text()
    assert "&" not in effective.split("*NODE")[0] and "*INCLUDE" not in effective
    (tmp_path / "part.k").unlink()
    done = slideline("i=a/job.effective.k", "d=b", "jobid=job")
    assert done.returncode == 0, done.stderr
    assert tables(tmp_path / "a") == tables(tmp_path / "b")
    again = (tmp_path / "b" / "job.effective.k").read_text()
    assert cards(again) == cards(effective)


def test_effective_deck_with_dt(slideline, tmp_path):
    assert slideline("d=a", "dt=3.0e-5", "endtim=0.003", deck=drop()).returncode == 0
    assert slideline("i=a/job.effective.k", "d=b", "jobid=job").returncode == 0
    assert tables(tmp_path / "a") == tables(tmp_path / "b")


def large_drop():
    """Enough elements for several blocks of chunks: 40 x 20 on 60 x 20."""
    deck = Deck("large drop")
    deck.control(0.004, scale=0.8).part(1).elastic(1000.0, 1.0e6, 0.3, 1)
    deck.part(2).plastic(1000.0, 1.0e6, 0.3, 1.0e4, 1.0e5, 0.5, 2)
    upper = deck.mesh(*grid(40, 20, 0.6, 0.3, (0.2, 0.0005)), part=1)
    lower = deck.mesh(*grid(60, 20, 1.0, 0.3, (0.0, -0.3)), part=2)
    deck.node_set(1, upper).node_set(2, upper[:41]).node_set(3, lower[-61:][::-1])
    deck.fix(lower[:61], x=1, y=1).add("*INITIAL_VELOCITY", (1,), (0.3, -3.0))
    deck.contact(2, 3, 3, 1.0e5)
    return deck.output(plot=0.001, glstat=2.0e-4, matsum=2.0e-4, rcforc=2.0e-4, nodout=2.0e-4,
                       nodes=[1, 20])


@pytest.mark.parametrize("threads", [2, 4])
def test_any_thread_count_gives_the_same_bits(slideline, tmp_path, threads):
    assert slideline("d=one", "ncpu=1", deck=large_drop()).returncode == 0
    done = slideline("d=many", f"ncpu={threads}", deck=large_drop())
    assert done.returncode == 0, done.stderr
    assert tables(tmp_path / "one") == tables(tmp_path / "many")


def test_twice_is_the_same(slideline, tmp_path):
    for folder in "ab":
        assert slideline(f"d={folder}", deck=drop()).returncode == 0
    assert tables(tmp_path / "a") == tables(tmp_path / "b")
