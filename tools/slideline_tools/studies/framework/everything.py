# SPDX-License-Identifier: MIT
"""`tools/study.sh all`: the tables of all studies from one program on one machine.

Results and pages gather in one folder. A page that is there, from this program and machine, has been made: stopped, the
same command goes on.
"""
import fnmatch
import os
import signal
import subprocess

from slideline_tools import UserError
from slideline_tools.studies.framework.pages import ORIGIN, PAGES, ROOT, program_source
from slideline_tools.studies.framework.runner import processor


def make_all(folder, pattern=None):
    """Make the pages (of a pattern of names) below `folder`/doc that are not there."""
    names = fnmatch.filter(PAGES, pattern or "*")
    if not names:
        raise UserError(f"no page is named {pattern}")
    origin = {"source": program_source(ROOT / "build" / "release" / "slideline"), "processor": processor()}
    if origin["source"] == "unknown" or origin["source"].endswith("-dirty"):
        raise UserError(f"pages are made from a source that is committed, not from {origin['source']}")
    pages = {name: folder / "doc" / "studies" / f"{name}.md" for name in names}
    made = [name for name in names if pages[name].exists()]
    for name in made:
        check_origin(pages[name], origin)
    trouble = []
    for number, name in enumerate(names, start=1):
        print(f"{number} of {len(names)} pages: {name}", "has been made before" if name in made else "", flush=True)
        if name not in made:
            trouble += make_page(name, folder, pages[name], origin)
    if trouble:
        raise UserError(f"not made: {'; '.join(trouble)}. The same command goes on with these")


def make_page(name, folder, path, origin):
    """Make one page; what went wrong, in a list."""
    log = folder / f"{name}.log"
    print(f"    {' '.join(PAGES[name].command)} (how far it is stands in {log})", flush=True)
    status = run_command(PAGES[name].command, log, folder)
    if status:
        return [f"{name} failed with status {status}, see {log}"]
    if not path.exists():
        return [f"{path} was not written"]
    check_origin(path, origin)
    return []


def run_command(command, log, folder):
    """Exit status of a command in a session of its own, which ends with this program; its results go into `folder`."""
    # A program of the user's own is not the one that this tree builds.
    environment = {name: value for name, value in os.environ.items() if name != "SLIDELINE"}
    with open(log, "ab") as stream:
        process = subprocess.Popen([ROOT / command[0], *command[1:]], cwd=ROOT, stdin=subprocess.DEVNULL, stdout=stream,
                                   stderr=stream, env={**environment, "SLIDELINE_RESULTS": str(folder)}, start_new_session=True)
        try:
            return process.wait()
        except BaseException:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait()
            raise


def check_origin(path, origin):
    """Refuse a page that was not made from this source on this processor."""
    found = ORIGIN.search(path.read_text(encoding="utf-8"))
    for name, value in origin.items():
        told = found[name] if found else "unknown"
        if told != value:
            raise UserError(f"{path} is of {name} {told}, and this is {value}: they are not to be mixed. Remove the "
                            "folder, or name another one with --folder")
