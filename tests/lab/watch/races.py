#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Look for races between the threads by the thread sanitiser, and see that it finds those planted on purpose.

The program is built from a copy of the tree with -fsanitize=thread and with team.c in the place of libgomp. Every
scene of the test of same bits runs with every contact type, with two and three threads: nothing may be reported.
Then one mistake after the other is made in the copy: each must be reported where it is. Some minutes in all.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from watching import HERE, ROOT, Plant, build, build_with, copy_tree, jobs_of_machine, run_or_stop, side_by_side

from test_same_bits import SCENES, TYPES, everything  # noqa: E402  (watching sets the path)

FLAGS = "-O1 -g -fsanitize=thread"
#: the locks are all inside libgfortran, whose order the sanitiser dislikes
OPTIONS = "detect_deadlocks=0:exitcode=66"
PLACE = re.compile(r"#\d+ \S+ \S*/src/(\S+?\.f90:\d+)")


PLANTS = (
    Plant("elements start before the contact forces are there", "solve/explicit/explicit.f90",
          "      !$omp end master\n      !$omp barrier\n      if (cycle%finished) exit",
          "      !$omp end master\n      if (cycle%finished) exit", "solve/explicit/explicit_cycle.f90"),
    Plant("no barrier behind the loop over tiles", "solve/explicit/explicit.f90",
          "    end do\n    !$omp end do\n  end subroutine advance_tiles",
          "    end do\n    !$omp end do nowait\n  end subroutine advance_tiles", "element/element_dispatch.f90"),
    Plant("no barrier behind the loop over special nodes", "solve/explicit/explicit.f90",
          "    end do\n    !$omp end do\n  end subroutine advance_special_nodes",
          "    end do\n    !$omp end do nowait\n  end subroutine advance_special_nodes", "solve/explicit/explicit_cycle.f90"),
    Plant("all tiles share the same force slots", "element/element_dispatch.f90",
          "      force_slots(1, i) =", "      force_slots(1, i - tile%first_special + 1) =", "element/element_dispatch.f90"),
    Plant("a tile goes on into the first chunk of the next", "element/element_dispatch.f90",
          "do i_chunk = tile%first_chunk, tile%last_chunk\n",
          "do i_chunk = tile%first_chunk, min(tile%last_chunk + 1, size(model%layout%chunk_part))\n", "element/"),
    Plant("interfaces side by side add to the same nodes", "solve/explicit/explicit_cycle.f90",
          "    do i = 1, size(model%contacts)\n      call apply_contact",
          "    !$omp parallel do num_threads(2)\n    do i = 1, size(model%contacts)\n      call apply_contact",
          "contact/law/nodal_forces.f90"),
)


def build_program(work: Path, jobs: int) -> Path:
    """The program of the copy with the sanitiser."""
    team = work / "team.o"
    run_or_stop(["gcc", "-O1", "-g", "-c", str(HERE / "team.c"), "-o", str(team)], work / "team.log")
    return build(work / "tree", work / "build", "Races", FLAGS, "-DSLIDELINE_TESTS=OFF", "-DSLIDELINE_UMFPACK=OFF",
                 f"-DCMAKE_EXE_LINKER_FLAGS={team}", jobs=jobs)


def two_interfaces() -> str:
    """Everything that acts, with a second interface of the same surfaces."""
    text = everything(5)
    card = re.search(r"\*CONTACT_2D_SLIDELINE[^*]*", text)
    return text.replace(card[0], card[0] + card[0])


def run(program: Path, folder: Path, text: str, words: tuple[str, ...], threads: int) -> tuple[int, set[str], str]:
    """(exit status, places of src/ that reports name, all that was said) of one run."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "job.k").write_text(text)
    done = subprocess.run([program, "i=job.k", "d=out", *words, f"ncpu={threads}", "perthread=1"], cwd=folder,
                          env={**os.environ, "TSAN_OPTIONS": OPTIONS}, capture_output=True, text=True, timeout=600,
                          check=False)
    said = done.stderr + done.stdout
    if "ThreadSanitizer" not in said:
        return done.returncode, set(), said
    return done.returncode, set(PLACE.findall(said)), said


def look(program: Path, work: Path, jobs: int, scenes: list[str]) -> int:
    """Run all scenes; the number of those with a report or another end than the normal one."""
    cases = [(scene, kind, 2 + kind % 2) for scene in scenes for kind in TYPES]

    def one(case):
        scene, kind, threads = case
        write, words = SCENES[scene]
        return case, run(program, work / f"{scene}_{kind}", write(kind), words, threads)

    wrong = 0
    for (scene, kind, threads), (status, places, said) in side_by_side(one, cases, jobs):
        if status or places or "ThreadSanitizer" in said:
            wrong += 1
            print(f"{scene} type {kind}, {threads} threads: status {status}: {' '.join(sorted(places))}")
    print(f"{len(cases)} runs, {wrong} with a report or another end than the normal one", flush=True)
    return wrong


def plant_all(work: Path, jobs: int) -> int:
    """Make one mistake after the other; the number of those that were not reported in their place."""
    missed = 0
    text = two_interfaces()
    for number, plant in enumerate(PLANTS):
        program = build_with(plant, work / "tree", lambda: build_program(work, jobs))
        if program is None:
            print(f"{plant.name}: not to be planted in {plant.file} as it is")
            missed += 1
            continue
        _, places, _ = run(program, work / f"plant_{number}", text, (), 2)
        found = sorted(place for place in places if place.startswith(plant.where))
        missed += not found
        reported = f"found, {found[0]}" if found else f"MISSED among {' '.join(sorted(places))}"
        print(f"{plant.name}: {reported} ({len(places)} places reported)", flush=True)
    return missed


def main() -> int:
    """The true program, then the planted mistakes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "races", help="folder to work in")
    parser.add_argument("--scenes", nargs="*", choices=list(SCENES), default=list(SCENES))
    parser.add_argument("--jobs", type=int, default=jobs_of_machine())
    options = parser.parse_args()
    work = options.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    copy_tree(work / "tree")
    program = build_program(work, options.jobs)
    status, places, said = run(program, work / "two_interfaces", two_interfaces(), (), 2)
    if status or places:
        print(said[-3000:])
    return int(status != 0 or look(program, work, options.jobs, options.scenes) + plant_all(work, options.jobs) > 0)


if __name__ == "__main__":
    sys.exit(main())
