# SPDX-License-Identifier: MIT
"""Command line of the studies; `tools/study.sh` builds the program and calls it."""
import argparse
import contextlib
import fcntl
import fnmatch
import os
import pathlib
import re
import shutil
import signal
import sys

from slideline_tools import UserError, counting
from slideline_tools.contact_types import ALL_TYPES, SERIES, parse_series
from slideline_tools.studies.common import write_page
from slideline_tools.studies.framework import pages
from slideline_tools.studies.framework.job import Options, file_digest, interleave, part_of, write_whole
from slideline_tools.studies.framework.progress import Progress
from slideline_tools.studies.framework.runner import Sweep
from slideline_tools.studies.framework.table import FAILED, MISSING, table_of

DONE, UNUSABLE, STOPPED = 0, 2, 4
ROOT = pages.ROOT


def build_parser():
    parser = argparse.ArgumentParser(
        prog="tools/study.sh", description="Run a study: a sweep of runs, its table, charts and page.",
        epilog="A study that was stopped or killed goes on with the same command. Exit status: "
               "0 done (failed runs are results too), 2 unusable, 4 stopped on request.")
    parser.add_argument("name", choices=[*pages.STUDIES, "all"], metavar="NAME",
                        help=", ".join(pages.STUDIES) + "; all: one after the other")
    parser.add_argument("--levels", type=int, nargs="+", help="refinement levels")
    parser.add_argument("--types", type=parse_series, nargs="+", choices=SERIES,
                        help="contact types; some studies have 7i and 7h, type 7 with PUNIT 4, too")
    parser.add_argument("--quick", action="store_true",
                        help="a minute's worth of it, into results/study-NAME-quick")
    parser.add_argument("--repeats", type=int, help="rounds of timing runs")
    parser.add_argument("-j", dest="parallel", type=int, default=len(os.sched_getaffinity(0)), metavar="N",
                        help="runs side by side (one for each core); timing runs stay alone")
    parser.add_argument("--only", metavar="PATTERN", help="runs of these names, for example 'hertz*'")
    parser.add_argument("--retry", action="store_true", help="run anew what has failed before")
    parser.add_argument("--list", action="store_true", help="print the runs and do nothing")
    parser.add_argument("--part", metavar="I/N", help="run only part I (0 to N-1) of N, no table")
    parser.add_argument("--collect", action="store_true", help="no runs: table, charts and page alone")
    parser.add_argument("--publish", action="store_true", help="write the page and its pictures "
                        "into results/doc instead of results/study-NAME/doc")
    parser.add_argument("--folder", type=pathlib.Path, help="instead of results/study-NAME")
    parser.add_argument("--program", type=pathlib.Path, help="default: $SLIDELINE or that of the build")
    return parser


def planned(study, wanted, program):
    """All runs that were asked for."""
    rounds = study.quick_repeats if wanted.quick else study.repeats
    options = Options(
        levels=tuple(wanted.levels or (study.quick_levels if wanted.quick else study.levels)),
        types=tuple(wanted.types or study.types), quick=wanted.quick,
        repeats=rounds if wanted.repeats is None else wanted.repeats, program=str(program))
    if options.repeats < 1 or wanted.parallel < 1:
        raise UserError("--repeats and -j must be at least 1")
    unknown = [one for one in options.types if one not in (*ALL_TYPES, *study.types)]
    if unknown:
        raise UserError(f"study {study.name} has no series {', '.join(unknown)}")
    jobs = interleave(study.jobs(options), options.repeats)
    jobs = [job for job in jobs if fnmatch.fnmatchcase(job.name, wanted.only or "*")]
    if not jobs:
        raise UserError("no runs")
    return jobs


def with_counter(jobs, wanted):
    """The jobs, and the program and its digest of those that are counted; without these where counting is not possible."""
    if not any(job.counted for job in jobs):
        return jobs, None
    try:
        if (wanted.program or "SLIDELINE" in os.environ) and "SLIDELINE_COUNTED" not in os.environ:
            raise UserError("with a program of one's own $SLIDELINE_COUNTED has to name the one to be counted, "
                            "for callgrind one without AVX-512")
        program = counting.counted_program(ROOT, build=not wanted.list)
        return jobs, (program, file_digest(program) if program.is_file() else "")
    except UserError as problem:
        print(f"study: instructions are not counted: {problem}", file=sys.stderr)
        return [job for job in jobs if not job.counted], None


def part_of_text(jobs, text):
    """The jobs of part 'I/N'."""
    try:
        index, count = (int(word) for word in text.split("/"))
    except ValueError:
        raise UserError(f"--part {text}: expected I/N") from None
    if not 0 <= index < count:
        raise UserError(f"--part {text}: I must be 0 to N-1")
    return part_of(jobs, index, count)


@contextlib.contextmanager
def held(folder, shared):
    """The folder of a study, for one command at a time or shared by parts of one sweep."""
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / ".lock", "w", encoding="ascii") as stream:
        try:
            fcntl.flock(stream, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
        except BlockingIOError:
            raise UserError(f"{folder}: another command of this study is under way") from None
        yield


def collect(study, jobs, sweep, doc, publish):
    """Table, pictures and page; UserError where runs of several processors are to be published."""
    folder = sweep.folder
    table = table_of(study, jobs, sweep)
    if study.derive:
        table = study.derive(table, folder)
    write_whole(folder / f"{study.name}.csv", table.to_csv(index=False))
    count = table["state"].value_counts()
    print(f"wrote {folder / study.name}.csv: {len(table)} runs"
          + "".join(f", {count[state]} {state}" for state in (FAILED, MISSING) if state in count))
    study.chart(table, folder)
    if text := study.page(table) if study.page else "":
        processors = sorted(set(table["processor"].dropna()))
        if publish and len(processors) > 1:
            raise UserError(f"runs of several processors are not published together: {'; '.join(processors)}")
        write_page(doc, study.name.replace("-", "_"), text, pages.program_source(sweep.program), "; ".join(processors))
        (doc / "pictures").mkdir(exist_ok=True)
        for picture in re.findall(r"\(\.\./pictures/(\S+\.png)\)", text):
            if (folder / picture).exists():
                shutil.copy(folder / picture, doc / "pictures")


def check_fit_to_publish(wanted, source):
    """Before anything runs: a page has to say what it was made from."""
    if wanted.quick:
        raise UserError("a quick study is not published")
    if source == "unknown" or source.endswith("-dirty"):
        raise UserError(f"pages are published from a source that is committed, not from {source}")


def print_runs(jobs, sweep):
    """The state of each run."""
    for job in jobs:
        record = sweep.record(job)
        state = "to run" if record is None else "failed" if record["status"] else "finished"
        print(f"{state:<9} {job.folder_name}")


def perform(wanted):
    results = ROOT / "results"
    folder = (wanted.folder or results / f"study-{wanted.name}{'-quick' * wanted.quick}").resolve()
    study = pages.load(wanted.name)
    program = pathlib.Path(wanted.program or os.environ.get("SLIDELINE")
                           or ROOT / "build" / study.build / "slideline").resolve()
    if not program.is_file():
        raise UserError(f"no program {program}; build it with tools/build.sh {study.build}")
    if wanted.publish:
        check_fit_to_publish(wanted, pages.program_source(program))
    jobs, counted = with_counter(planned(study, wanted, program), wanted)
    sweep = Sweep(folder, program, file_digest(program), counted)
    chosen = part_of_text(jobs, wanted.part) if wanted.part else jobs
    if wanted.list:
        print_runs(chosen, sweep)
        return
    with held(folder, shared=bool(wanted.part)):
        if not wanted.collect:
            sweep.run(chosen, wanted.parallel, Progress(), wanted.retry)
        if not wanted.part:
            collect(study, jobs, sweep, (results if wanted.publish else folder) / "doc", wanted.publish)


def main(arguments=None):
    """Returns the exit status."""
    wanted = build_parser().parse_args(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    status = DONE
    for name in pages.STUDIES if wanted.name == "all" else (wanted.name,):
        try:
            perform(argparse.Namespace(**vars(wanted) | {"name": name}))
        except (UserError, OSError) as problem:
            print(f"study: {problem}", file=sys.stderr)
            status = UNUSABLE
        except KeyboardInterrupt:
            print("study: stopped; the same command goes on with what is left", file=sys.stderr)
            return STOPPED
    return status


if __name__ == "__main__":
    sys.exit(main())
