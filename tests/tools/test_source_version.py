# SPDX-License-Identifier: MIT
"""The program knows its commit, built in a clone or from an archive of git."""
import pathlib
import shutil
import subprocess
import tarfile

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="no git")
FILES = ("src/source_version.cmake", "src/source_version.f90.in", ".gitattributes", "CMakeLists.txt")


def git(folder, *words):
    return subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *words], cwd=folder, check=True, capture_output=True,
                          text=True).stdout.strip()


@pytest.fixture
def tree(tmp_path):
    """A repository with the files that tell the commit."""
    for name in FILES:
        (tmp_path / "tree" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / "tree" / name)
    git(tmp_path / "tree", "init", "-q")
    git(tmp_path / "tree", "add", ".")
    git(tmp_path / "tree", "commit", "-q", "-m", "first")
    return tmp_path / "tree"


def reported(folder):
    """The commit that the program would tell."""
    subprocess.run(["cmake", "-D", f"folder={folder}", "-D", f"output={folder}/reported.f90", "-P", f"{folder}/src/source_version.cmake"],
                   check=True, capture_output=True)
    return (folder / "reported.f90").read_text().split("source_version = '")[1].split("'")[0]


def test_clone(tree):
    commit = git(tree, "rev-parse", "HEAD")[:12]
    assert reported(tree) == commit
    with open(tree / "CMakeLists.txt", "a", encoding="utf-8") as stream:
        stream.write("# changed\n")
    assert reported(tree) == commit + "-dirty"


def test_archive_within_another_repository(tree, tmp_path):
    git(tmp_path, "init", "-q")
    git(tmp_path, "commit", "-q", "--allow-empty", "-m", "of somebody else")
    git(tree, "archive", "-o", str(tmp_path / "tree.tar"), "HEAD")
    with tarfile.open(tmp_path / "tree.tar") as archive:
        archive.extractall(tmp_path / "unpacked")
    assert reported(tmp_path / "unpacked") == git(tree, "rev-parse", "HEAD")[:12]
