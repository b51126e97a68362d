# SPDX-License-Identifier: MIT
"""Files that the tools read and write, and which of them are a run. The rules are those of the
program: a pipe or a device is not read, nothing is written through a link, and what a tool writes
is a file of its own."""
import glob
import os
import pathlib
import stat

from slideline_tools import UserError

KINDS = {stat.S_IFDIR: "a folder", stat.S_IFLNK: "a symbolic link", stat.S_IFIFO: "a pipe",
         stat.S_IFSOCK: "a socket"}
#: history tables, each <job>.<name>.csv
TABLES = ("glstat", "rcforc", "nodout", "matsum", "contact", "rwforc", "sleout", "spcforc", "elout",
          "rbdout", "bndout", "nodfor", "secforc")
#: what the names of result files end with, behind the job
ENDINGS = (*(f".{name}.csv" for name in TABLES), ".vtkhdf", ".timing.csv", ".log", ".effective.k")


def find_run(path: str | os.PathLike, *marks: str) -> pathlib.Path:
    """Folder and job name of the run that `path` names: its folder, where the first of `marks` (of
    ENDINGS) that is there tells the job, a file of it, or that path itself. UserError where there
    is no single one."""
    path = pathlib.Path(path)
    if path.is_dir():
        found = next((some for mark in marks if (some := sorted(path.glob(f"*{mark}")))), [])
        if len(found) == 1:
            return find_run(found[0])
        names = ", ".join(one.name for one in found)
        raise UserError(f"{path}: " + (f"several runs: {names}; name a file of one" if found
                                       else f"no run (no {' and no '.join(marks)})"))
    for ending in ENDINGS:
        if path.name.endswith(ending):
            return path.with_name(path.name.removesuffix(ending))
    if any(path.parent.glob(f"{glob.escape(path.name)}.*")):
        return path
    raise UserError(f"{path}: neither a results folder nor a file of a run")


def source(path: str | os.PathLike) -> pathlib.Path:
    """The path of a file to be read; UserError where a pipe or a device stands there, which may
    have no end."""
    path = pathlib.Path(path)
    if path.exists() and not path.is_file() and not path.is_dir():
        raise UserError(f"cannot read {path}: it is {kind_of(path.stat())} and no file")
    return path


def output(path: str | os.PathLike, inputs=()) -> pathlib.Path:
    """The path of a file to be made, in a folder that is there. A file of that name goes before, so
    that other names of it (hard links) keep what they have; UserError where anything else stands
    there, or one of the files that are read."""
    path = pathlib.Path(path)
    folder(path.parent)
    if not os.path.lexists(path):
        return path
    if not stat.S_ISREG(path.lstat().st_mode):
        raise UserError(f"cannot write {path}: it is {kind_of(path.lstat())}")
    for read in map(pathlib.Path, inputs):
        if read.exists() and read.samefile(path):
            raise UserError(f"cannot write {path}: it is {read}, which is read; name another file")
    path.unlink()
    return path


def folder(path: pathlib.Path) -> pathlib.Path:
    """A folder, made with its parents; UserError where that cannot be."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise UserError(f"cannot make the folder {path}: {problem.strerror}") from problem
    return path


def kind_of(facts: os.stat_result) -> str:
    """What stands under a name, in words."""
    return KINDS.get(stat.S_IFMT(facts.st_mode), "a device")
