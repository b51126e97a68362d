# SPDX-License-Identifier: MIT
"""Predicted against measured savings: writes doc/studies/advise.md.

    python -m slideline_tools.advise.study PROGRAM FOLDER DOC [--rounds N]

Runs a deck with several needless things and the deck without each of them in turn, and compares
what `advise` predicts from the first with what the others took.
"""
from __future__ import annotations

import argparse
import pathlib
import resource
import subprocess
import sys

from slideline_tools import UserError, counting
from slideline_tools.advise import advise, bodies, outputs, report, rubbing, stepping, study_decks, touching
from slideline_tools.scenes import collision
from slideline_tools.studies.common import markdown_table, write_page
from slideline_tools.studies.framework.runner import processor
from slideline_tools.summaries import collision_row

ALL = "all"
ROOT = pathlib.Path(__file__).resolve().parents[3]


def run_deck(program: pathlib.Path, folder: pathlib.Path, text: str, *arguments) -> float:
    """Run one deck into `folder`; processor seconds. UserError when it does not end normally."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "deck.k").write_text(text, encoding="ascii")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(program), f"i={folder / 'deck.k'}", f"d={folder}", "jobid=run",
                           *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        raise UserError(f"{folder}: {done.stdout[-500:]}{done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measure(program: pathlib.Path, folder: pathlib.Path, rounds: int):
    """All variants in turn; returns topic -> predicted shares, topic -> processor seconds, the
    advice of the last run with everything and of a run with nothing needless."""
    predicted, totals = {}, {}
    for _ in range(rounds):
        for topic in (ALL, *study_decks.WASTE):
            waste = [other for other in study_decks.WASTE if other != topic]
            place = folder / topic.replace(" ", "_")
            taken = run_deck(program, place, study_decks.deck(waste))
            totals.setdefault(topic, []).append(taken)
            if topic == ALL:
                last = advise(place)[:2]
                for item in last[1]:
                    predicted.setdefault(item.topic, []).append(item.seconds / last[0].total)
    run_deck(program, folder / "nothing", study_decks.deck(()))
    return predicted, totals, last, advise(folder / "nothing")[:2]


def measure_collision(program: pathlib.Path, folder: pathlib.Path, rounds: int) -> dict:
    """The collision of the paper, N_r = 2, and again with the step that the advice names."""
    before, after, predicted, place = [], [], [], folder / "collision"
    for _ in range(rounds):
        before.append(run_deck(program, place, collision(2)))
        run, found, _ = advise(place)
        longer = next(item for item in found if item.topic == "short steps")
        predicted.append(longer.seconds / run.total)
        argument = longer.change.split("command line: ")[1].rstrip(")")
        after.append(run_deck(program, folder / "collision_longer", collision(2), argument))
    rebound = [collision_row(folder / name, "run")["rebound"]
               for name in ("collision", "collision_longer")]
    return {"argument": argument, "rebound": rebound,
            "predicted": 100.0 * predicted[before.index(min(before))],
            "measured": 100.0 * (1.0 - min(after) / min(before))}


def count(folder: pathlib.Path) -> tuple[dict, str]:
    """Topic -> retired instructions of the run, and who counted; {} and why where nobody can."""
    found = {}
    try:
        program = counting.counted_program(ROOT)
        for topic in (ALL, *study_decks.WASTE):
            place = folder / "counted" / topic.replace(" ", "_")
            place.mkdir(parents=True, exist_ok=True)
            deck = place / "deck.k"
            deck.write_text(study_decks.deck([other for other in study_decks.WASTE if other != topic]), encoding="ascii")
            found[topic] = counting.count_instructions([program, f"i={deck}", f"d={place}", "jobid=run"], place).total
    except UserError as problem:
        return {}, f"were not counted ({str(problem).splitlines()[0]})"
    return found, f"counted by {counting.method()}"


def instructions_saved(counts: dict, topic: str) -> str:
    """Per cent of the instructions of the run with everything."""
    return f"{100.0 * (1.0 - counts[topic] / counts[ALL]):.1f}" if topic in counts else ""


def rows(predicted: dict, totals: dict, counts: dict) -> list[tuple]:
    """Topic, predicted and measured per cent of the run, per cent of its instructions; the fastest of all rounds
    counts, since whatever else the machine does only adds."""
    base = min(totals[ALL])
    quickest = totals[ALL].index(base)
    return [(topic, f"{100.0 * predicted[topic][quickest]:.1f}" if topic in predicted
             else "not found", f"{100.0 * (1.0 - min(totals[topic]) / base):.1f}",
             instructions_saved(counts, topic))
            for topic in study_decks.WASTE]


def thresholds() -> list[tuple]:
    """What each check asks for before it speaks."""
    return [
        ("never yielded", "plastic strain exactly 0 in every element at the last state"),
        ("never touched", "no active point in any row of rcforc; the surfaces stayed too far apart to touch "
         "between states, or contact energy 0"),
        ("touched for a while", f"more than {touching.IDLE_TIME:.0%} of the time before the first "
         "and after the last active row, at least 100 rows"),
        ("long surface", f"less than {touching.LONG_SURFACE:.0%} of the slave surface pressed at "
         f"any of at least {touching.STATES_IN_CONTACT} states in contact"),
        ("long flight", f"first contact after {touching.LONG_FLIGHT:.0%} of the time, no loads, "
         f"energies constant to {touching.FREE_FLIGHT:g} until then, parts only translate"),
        ("dear type", f"type 6 or 7, contact at least {touching.CONTACT_MATTERS:.0%} of the run"),
        ("needless friction", f"traction at most {rubbing.NO_TRACTION:.0%} of mu times the pressure (largest values), its work at most "
         f"{rubbing.NO_WORK:g} of the energy"),
        ("undamped sliding", f"explicit, undamped; {rubbing.CHANGING:.0%} of the pressed nodes change between stick and slip; a small "
         f"motion could grow by {rubbing.GROWN:g} e-folds"),
        ("short steps", f"{stepping.SAFETY} of the limit of elements and springs is at least {stepping.LONGER_STEP} steps"),
        ("penalty rules the step", f"the elements allow {stepping.PENALTY_RULES} times the step of the springs; "
         f"with the softer penalty below {stepping.DEEPEST:.0%} of a segment deep"),
        ("rigid", f"largest strain and internal energy of a part at most {bodies.RIGID_STRAIN:.0%}"
         " of the largest of all parts"),
        ("symmetry", "nodes, elements and parts are mirror images, no element across the cut, "
         f"displacements to {bodies.SYMMETRIC:g} of the largest"),
        ("bulk viscosity", f"viscous energy at most {bodies.NO_VISCOUS_ENERGY:g} of the largest "
         "total energy"),
        ("written too often", f"output at least {outputs.OUTPUT_MATTERS:.0%} of the run; straight lines between some rows miss "
         f"the others by at most {outputs.COARSE_ERROR:.0%}"),
        ("never read", "written a day ago or longer, last read no later than last written, where "
         "access times are kept (local, not noatime)"),
        ("threads", f"fewer than {stepping.ELEMENTS_A_THREAD} elements a thread"),
        ("all", f"a saving of at least {report.SMALLEST_SHARE:.0%} of the run and "
         f"{report.SMALLEST_SECONDS} s, unless `--all`")]


def page(predicted: dict, totals: dict, last, clean, scene: dict, counted: tuple = ({}, "were not counted")) -> str:
    """The page."""
    return PAGE.format(
        scene="{argument}: predicted {predicted:.1f} %, measured {measured:.1f} %; rebound velocity "
        "{rebound[0]:.3f} and {rebound[1]:.3f} m/s".format(**scene),
        rounds=len(totals[ALL]), base=min(totals[ALL]), spread=spread(totals),
        processor=processor(), table=markdown_table(
            ("topic", "predicted, %", "measured, %", "instructions, %"), rows(predicted, totals, counted[0])),
        counted=counted[1],
        example=report.as_text(*last_shown(last)), clean=report.as_text(*last_shown(clean)),
        thresholds=markdown_table(("topic", "says something only if"), thresholds()),
        friction_states=rubbing.STATES_IN_CONTACT,
        factors=", ".join(map(str, outputs.FACTORS)), plastic=bodies.PLASTIC_EXTRA, viscous=bodies.VISCOUS_EXTRA)


def spread(totals: dict) -> float:
    """How much the middle round of a deck takes longer than the fastest, over all decks."""
    return max(sorted(seconds)[len(seconds) // 2] / min(seconds) - 1.0
               for seconds in totals.values())


def last_shown(last):
    """Arguments of the report."""
    run, found = last
    shown = report.select(found, run.total)
    return run, shown, [], len(found) - len(shown)


PAGE = """# What a run did not need

This page is written by `tools/batch/advise.sh`: do not edit it.

`slideline-tools advise RUN` reads a finished run and says what in its model was not needed, with the
figures that show it, the expected saving and the card to change. Here is what it says of a collision
that was modelled with seven needless things on purpose (`slideline_tools/advise/study_decks.py`):

```
{example}
```

and of the same collision without them:

```
{clean}
```

## Predicted and measured savings

Each needless thing was taken out alone. Per cent of the run with all of them, which took {base:.2g} s of processor time; the fastest of
{rounds} rounds in which all variants ran in turn, one thread ({processor}). Rounds of the same deck differed by {spread:.0%} at the
median, so that differences of a few per cent mean nothing. The last column does not depend on the load of the machine: the share of the
retired instructions of the whole run that is saved, {counted}.

{table}

The collision of the paper (`input/collision/collision_2.k`) has a step somewhat shorter than it must. With the one that
the advice names, {scene}.

## When it speaks

{thresholds}

- Never touched: the surfaces stayed farther apart than they could have moved between states, or the contact energy is
  exactly 0.
- Needless friction: at {friction_states} states in contact at least; the energy is the largest.
- Undamped sliding: without damping and bulk viscosity; nodes are in the other state, stick or slip, at the next plot
  state; the growth is that of [stability_friction](stability_friction.md).
- Short steps: the limit of elements is the smallest of all states, that of springs the bound that the program warns by.
- Penalty rules the step: what counts is the deepest penetration that the softer penalty allows.
- Symmetry: displacements are compared at all states.
- Written too often: every k-th row, k of {factors}; per cent of the range.

Savings are wall clock read from `<job>.timing.csv`. Three of them rest on ratios measured once: a plastic law adds
{plastic} elastic elements to an element (0.05 to 0.2 by mesh and law), bulk viscosity {viscous} (0.5 to 0.6), and the measured time of output is
shared out by what was written. The contact time is that of the interface where the run
kept it (`timing=interface`), else it is shared out by tracked nodes; half of the phase `nodes` is taken for the nodes of
interfaces (two thirds in the deck above).

What it cannot know: whether somebody needs the waves in a stiff body, a later contact, or a row between two others.
Every saving is that of one change alone. A run that is asked again after a change is judged anew.
"""


def main(arguments=None) -> int:
    """Command line; 0 when the page was written."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("doc", type=pathlib.Path)
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args(arguments)
    try:
        write_page(options.doc, "advise",
                   page(*measure(options.program, options.folder, options.rounds),
                        measure_collision(options.program, options.folder, options.rounds),
                        count(options.folder)))
    except UserError as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
