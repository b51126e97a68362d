# SPDX-License-Identifier: MIT
"""`tools/study.sh all`: the tables of all studies from one program on one machine.

Results and pages gather in one folder, whose `all.json` names their source and processor and the pages that are
done: stopped, the same command goes on.
"""
import fnmatch
import json
import os
import signal
import subprocess

from slideline_tools import UserError
from slideline_tools.studies.framework.job import write_whole
from slideline_tools.studies.framework.pages import ORIGIN, PAGES, ROOT, program_source
from slideline_tools.studies.framework.progress import span
from slideline_tools.studies.framework.runner import processor

STAMP = "all.json"
STOPPED = 4  # exit status of a study that was asked to stop


def read_stamp(folder, origin):
    """What the folder holds; UserError where that is of another program or machine."""
    try:
        stamp = json.loads((folder / STAMP).read_text(encoding="utf-8"))
    except OSError:
        return {**origin, "done": {}}
    except ValueError as problem:
        raise UserError(f"{folder / STAMP}: {problem}") from problem
    for name, value in origin.items():
        if stamp.get(name) != value:
            raise UserError(f"{folder} holds results of {name} {stamp.get(name)}, and this is {value}: they are not to be "
                            "mixed. Remove the folder, or name another one with --folder")
    return stamp


def run_command(command, log, environment):
    """Exit status of a command in a session of its own, which ends with this program."""
    with open(log, "ab") as stream:
        process = subprocess.Popen([str(ROOT / command[0]), *command[1:]], cwd=ROOT, stdin=subprocess.DEVNULL,
                                   stdout=stream, stderr=stream, env=environment, start_new_session=True)
        try:
            return process.wait()
        except BaseException:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait()
            raise


def check_origin(path, origin):
    """Refuse a page that is not there or was not made from this source on this processor."""
    if not path.exists():
        raise UserError(f"{path} was not written")
    found = ORIGIN.search(path.read_text(encoding="utf-8"))
    told = found.groupdict() if found else {}
    for name, value in origin.items():
        if told.get(name) != value:
            raise UserError(f"{path} says {name} {told.get(name)} and not {value}")


def make_pages(names, folder, origin, stamp, say=print):
    """Make the pages that are not done yet; returns {name: trouble}."""
    # A program of the user's own is not the one that this tree builds.
    environment = {name: value for name, value in os.environ.items() if name != "SLIDELINE"}
    environment["SLIDELINE_RESULTS"] = str(folder)
    trouble = {}
    (folder / "logs").mkdir(parents=True, exist_ok=True)
    for number, name in enumerate(names, start=1):
        head = f"{number} of {len(names)} pages: {name}"
        lacking = [other for other in PAGES[name].after if other not in stamp["done"]]
        if name in stamp["done"]:
            say(f"{head} has been made before")
        elif lacking:
            trouble[name] = f"wants {', '.join(lacking)}"
            say(f"{head} {trouble[name]}")
        else:
            log = folder / "logs" / f"{name}.log"
            say(f"{head}, {' '.join(PAGES[name].command)} (how far it is stands in {log})")
            trouble.update(make_page(name, folder, origin, stamp, environment, log))
            say(f"    {trouble.get(name) or 'took ' + span(stamp['done'][name]).replace('about ', '')}")
    return trouble


def make_page(name, folder, origin, stamp, environment, log):
    """Make one page and note that it is done; returns {name: trouble} or {}."""
    start = os.times().elapsed
    status = run_command(PAGES[name].command, log, environment)
    if status in (STOPPED, -signal.SIGTERM, -signal.SIGINT):
        raise KeyboardInterrupt
    if status:
        return {name: f"failed with status {status}, see {log}"}
    try:
        check_origin(folder / "doc" / "studies" / f"{name}.md", origin)
    except UserError as problem:
        return {name: str(problem)}
    stamp["done"][name] = os.times().elapsed - start
    write_whole(folder / STAMP, json.dumps(stamp, indent=1) + "\n")
    return {}


def make_all(folder, pattern=None, say=print):
    """Make the pages (of a pattern of names) below `folder`/doc."""
    names = [name for name in PAGES if fnmatch.fnmatchcase(name, pattern or "*")]
    if not names:
        raise UserError(f"no page is named {pattern}")
    origin = {"source": program_source(ROOT / "build" / "release" / "slideline"), "processor": processor()}
    if origin["source"] == "unknown" or origin["source"].endswith("-dirty"):
        raise UserError(f"pages are made from a source that is committed, not from {origin['source']}")
    stamp = read_stamp(folder, origin)
    write_whole(folder / STAMP, json.dumps(stamp, indent=1) + "\n")
    say(f"source {origin['source']}, {origin['processor']}; results in {folder}")
    trouble = make_pages(names, folder, origin, stamp, say)
    if trouble:
        raise UserError("not made: " + "; ".join(f"{name} ({why})" for name, why in trouble.items()) +
                        ". The same command goes on with these")
    say(f"made {len(names)} pages in {folder / 'doc' / 'studies'}")
