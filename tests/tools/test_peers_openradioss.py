# SPDX-License-Identifier: MIT
"""Decks of OpenRadioss and its files of histories, without the program, and what the page of peers says of it."""
import pathlib
import struct
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "bench" / "peers")]

import openradioss  # noqa: E402
import wave  # noqa: E402
from slideline_tools.studies import peers  # noqa: E402


def cards(deck, keyword):
    """Lines of the first keyword that begins so."""
    first = next(k for k, line in enumerate(deck.lines) if line.startswith(keyword)) + 1
    last = next((k for k, line in enumerate(deck.lines[first:], first) if line.startswith("/")), len(deck.lines))
    return deck.lines[first:last]


def test_places_and_quads_stand_in_their_columns():
    deck = openradioss.Deck("A")
    points, quads = wave.grid(3)
    deck.block(1, points, quads, 1, 1)
    deck.block(2, points, quads, 17, 10)
    nodes = cards(deck, "/NODE")
    assert [[int(line[:10]), *(float(line[k:k + 20]) for k in (10, 30, 50))] for line in nodes] == [
        [k, 0.0, pytest.approx(x), pytest.approx(y)] for k, (x, y) in enumerate(points.tolist(), 1)]
    second = cards(deck, "/QUAD/2")
    assert [int(second[0][k:k + 10]) for k in range(0, 50, 10)] == [10, *(quads[0] + 17).tolist()]


def test_groups_break_after_ten_nodes():
    deck = openradioss.Deck("A")
    deck.nodes(1, range(1, 24))
    lines = cards(deck, "/GRNOD/NODE/1")[1:]
    assert [len(line) for line in lines] == [100, 100, 30]


def test_steps_are_of_one_size_and_as_many_as_asked(tmp_path):
    openradioss.Deck("A").write(tmp_path, 0.25, 8)
    lines = (tmp_path / "A_0001.rad").read_text().splitlines()
    assert float(lines[lines.index("/RUN/A/1") + 1]) == pytest.approx(8.5 * 0.25)
    assert float(lines[lines.index("/TFILE/1") + 1]) == pytest.approx(7.5 * 0.25)
    assert [float(word) for word in lines[lines.index("/DTIX") + 1].split()] == [0.25, 0.25]


def record(*parts):
    """A record of a sequential file of Fortran."""
    data = b"".join(parts)
    return struct.pack("<i", len(data)) + data + struct.pack("<i", len(data))


def whole(*values):
    return struct.pack(f"<{len(values)}i", *values)


def histories(*, version=4021, cut=0):
    """A file of two times with a part of two variables and a group of two nodes with one."""
    title = b"title".ljust(100)
    long = [record(whole(1)), record(whole(100)), record(np.ones(3, "<f8").tobytes())] if version >= openradioss.LONG_HEADS else []
    head = [record(whole(version), b"x" * 80), record(b"x" * 80), *long, record(whole(1, 0, 0, 1, 1, 2)), record(whole(1, 2)),
            record(whole(7), title, whole(0, 1, 1, 2)), record(whole(3, 5)),
            record(whole(1, 0, 0, 1, 0), title), record(whole(7)),
            record(whole(1, 0, 1, 2, 1), title), record(whole(11), title), record(whole(12), title), record(whole(5))]
    times = [record(np.array(values, "<f8").tobytes()) for t in (0.0, 1.0)
             for values in ([t], [8.0, 9.0], [10.0 + t, 20.0 + t], [30.0 + t, 40.0 + t])]
    data = b"".join([*head, *times])
    return data[:len(data) - cut]


@pytest.mark.parametrize("version", [3040, 4021])
def test_histories_are_read_by_number_and_variable(tmp_path, version):
    (tmp_path / "T01").write_bytes(histories(version=version))
    found = openradioss.read_histories(tmp_path / "T01")
    assert {key: values.tolist() for key, values in found.items()} == {
        "time": [0.0, 1.0], ("PART", 7, 3): [10.0, 11.0], ("PART", 7, 5): [20.0, 21.0],
        ("NODE", 11, 5): [30.0, 31.0], ("NODE", 12, 5): [40.0, 41.0]}


def test_a_time_that_is_cut_off_is_not_read(tmp_path):
    (tmp_path / "T01").write_bytes(histories(cut=4))
    found = openradioss.read_histories(tmp_path / "T01")
    assert found["NODE", 12, 5].tolist() == [40.0] and found["time"].tolist() == [0.0]


def test_the_page_says_how_openradioss_was_built_or_that_it_was_not(tmp_path):
    versions = tmp_path / "versions.txt"
    versions.write_text("akantu==5.0\n")
    assert peers.radioss_in_words(versions) == peers.NOT_BUILT
    versions.write_text("akantu==5.0\nOpenRadioss==source abc, gfortran with x==1\n")
    assert "source abc, gfortran with x==1" in peers.radioss_in_words(versions)
    assert "OpenRadioss" not in peers.version_rows(versions)
