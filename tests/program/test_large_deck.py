# SPDX-License-Identifier: MIT
"""A large mesh with one bad card. CI has it with the Release program: the sanitised one cannot have a limit of memory."""
import resource
import subprocess
from pathlib import Path


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
