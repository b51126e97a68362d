# SPDX-License-Identifier: MIT
"""A large mesh with one bad card. CI has it with the Release program: the sanitised one cannot have a limit of memory."""
import resource
import subprocess
from pathlib import Path

import pytest


def test_a_million_elements_with_one_bad_card(exe, tmp_path):
    """Refused for that card, within seconds and a gigabyte."""
    n = 1000
    rows = ["*KEYWORD", "*CONTROL_TERMINATION", "1.0", "*PART", "all", "1,1,1", "*SECTION_SHELL", "1,13", "1.0",
            "*MAT_ELASTIC", "1,1000.0,1.0e6,0.3", "*NODE"]
    rows += [f"{i * (n + 1) + j + 1:8d}{j:16.1f}{i:16.1f}" for i in range(n + 1) for j in range(n + 1)]
    rows.append("*ELEMENT_SHELL")
    for i in range(n):
        first = i * (n + 1) + 1
        rows += [f"{i * n + j + 1:8d}       1{first + j:8d}{first + j + 1:8d}{first + j + n + 2:8d}{first + j + n + 1:8d}"
                 for j in range(n)]
    bad = len(rows) - 345678
    rows[bad] = rows[bad][:8] + "     one" + rows[bad][16:]
    (tmp_path / "job.k").write_text("\n".join(rows) + "\n*END\n")
    sanitized = b"__asan_init" in Path(exe).read_bytes()

    def memory():
        if not sanitized:
            resource.setrlimit(resource.RLIMIT_AS, (2 ** 30, 2 ** 30))

    done = subprocess.run([exe, "check", "job.k"], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False,
                          preexec_fn=memory)
    assert done.returncode == 1 and f"job.k:{bad + 1}:" in done.stderr and '"one"' in done.stderr, done.stderr
    assert len(done.stderr) < 5000, "one bad card is not a thousand messages"


def pairs(n):
    """Pairs of squares, one upon the other, with a penalty from the step (PUNIT 3) each."""
    rows = []
    for k in range(n):
        for part in (2 * k + 1000, 2 * k + 1001):
            y = part % 2
            rows += [f"*PART\nx\n{part},1,1\n*SET_PART_LIST\n{part}\n{part}\n*NODE"]
            rows += [f"{4 * part + i},{3 * k + x}.0,{y + up}.0" for i, (x, up) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1)))]
            rows += ["*ELEMENT_SHELL", ",".join(str(i) for i in (part, part, *range(4 * part, 4 * part + 4)))]
        rows += ["*CONTACT_2D_SLIDELINE", f"{2 * k + 1000},{2 * k + 1001},2,2,0.5", "0.0,0.0,3"]
    return "\n".join(rows) + "\n"


#: cards of one kind, `n` of them; those that need it have what they refer to
MANY = {
    "parameters": lambda n: "*PARAMETER\n" + "".join(f"R p{k},{k}\n" for k in range(n)) + "*DEFINE_CURVE\n8\n" + "".join(
        f"&p{k},&p{n - 1 - k}\n" for k in range(n)),
    "expressions": lambda n: "*PARAMETER_EXPRESSION\nR q0,1\n" + "".join(f"R q{k},q{k - 1}+1\n" for k in range(1, n)),
    "curves": lambda n: "".join(f"*DEFINE_CURVE\n{1000 + k}\n0.0,1.0\n1.0,1.0\n" for k in range(n)),
    "tables": lambda n: "".join(f"*DEFINE_TABLE\n{1000 + 2 * k}\n1.0\n*DEFINE_CURVE\n{1001 + 2 * k}\n0.0,1.0\n" for k in range(n)),
    "parts": lambda n: "".join(f"*PART\nx\n{1000 + k},1,1\n" for k in range(n)),
    "sections": lambda n: "".join(f"*SECTION_SHELL\n{1000 + k},13\n1.0\n" for k in range(n)),
    "materials": lambda n: "".join(f"*MAT_024\n{1000 + k},1.0,1.0,0.3,1.0\n*MAT_ADD_EROSION\n{1000 + k},,,,1.0\n" for k in range(n)),
    "equations of state": lambda n: "".join(f"*EOS_GRUNEISEN\n{1000 + k},1.0\n" for k in range(n)),
    "hourglass controls": lambda n: "".join(f"*HOURGLASS\n{1000 + k},1\n" for k in range(n)),
    "coordinate systems": lambda n: "".join(f"*DEFINE_COORDINATE_SYSTEM\n{1000 + k},0,0,0,1.0\n0.0,1.0\n" for k in range(n)),
    "include paths": lambda n: "*INCLUDE_PATH\n" + "".join(f"folder{k}\n" for k in range(n)),
    "transducers": lambda n: "*SET_PART_LIST\n900\n1\n" + "*CONTACT_2D_FORCE_TRANSDUCER\n900\n" * n,
    "walls": lambda n: "*RIGIDWALL_PLANAR\n0\n0,-9.0,0,0,-8.0,0\n" * n,
    "ends": lambda n: "*TERMINATION_NODE\n" + "1,1,1.0e9,-1.0e9\n" * n,
    "cross sections": lambda n: "*SET_NODE_LIST\n900\n1,2\n*SET_SHELL_LIST\n900\n1\n" + "*DATABASE_CROSS_SECTION_SET\n900,0,0,900\n" * n,
    "force groups": lambda n: "".join(f"*SET_NODE_LIST\n{1000 + k}\n1\n*DATABASE_NODAL_FORCE_GROUP\n{1000 + k}\n" for k in range(n)),
    "contacts": lambda n: pairs(n // 4),
    "masses": lambda n: "*ELEMENT_MASS\n" + f"{1:8d}{1:8d}{1.0e-9:16.3e}\n" * n,
}


def check_time(exe, folder, text):
    """Processor time of `check` of a deck with a square and other cards, s."""
    mesh = ("*CONTROL_TERMINATION\n1.0\n*PART\nsquare\n1,1,1\n*SECTION_SHELL\n1,13\n1.0\n*MAT_ELASTIC\n1,1.0,100.0,0.3\n"
            "*NODE\n1,0.0,0.0\n2,1.0,0.0\n3,1.0,1.0\n4,0.0,1.0\n*ELEMENT_SHELL\n1,1,1,2,3,4\n")
    (folder / "job.k").write_text("*KEYWORD\n" + text + mesh + "*END\n")
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run([exe, "check", "job.k"], cwd=folder, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr[:1000]
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


@pytest.mark.parametrize("kind", MANY)
def test_many_cards_take_no_longer_each(exe, tmp_path, kind):
    """The time of `check` goes with the number of cards: four times as many took sixteen times as long."""
    few, many = (check_time(exe, tmp_path, MANY[kind](n)) for n in (4000, 16000))
    assert many < 8.0 * few + 0.2, (few, many)
