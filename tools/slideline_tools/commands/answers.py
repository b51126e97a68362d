# SPDX-License-Identifier: MIT
"""The command answer: a number with its error, at least cost."""
import math
import pathlib
import signal
import sys

from slideline_tools import UserError
from slideline_tools.commands import PROGRAM, add

WITHIN, REFUSED, FAILED, NOT_REACHED = 0, 1, 2, 4
#: contact types by their time (doc/studies/speed_accuracy.md), cheapest first
CHEAPEST_FIRST = (1, 2, 3, 5, 4, 6, 7)


def add_all(commands) -> None:
    """Add this command."""
    parser = add(commands, answer, "answer", "a number with its uncertainty, at least cost", """\
answer deck.k --of rcforc:fy@interface=1,side=slave:largest --within 2%%
answer deck.k --of nodout:uy@node=5:end --of field:plastic_strain:largest --seconds 60
answer deck_{level}.k --mesh-parameter level --of glstat:internal:at=1e-3 --within 1%%

A quantity is HISTORY:COLUMN[@KEY=VALUE,...][:MEASURE] with MEASURE largest (where none is given), smallest, mean,
impulse, end or at=T, or field:NAME[@x=X,y=Y]:MEASURE. Exit status: 0 within, 1 refused, 2 a run failed, 4 not reached
(the best is written all the same). See doc/answer.md.""".replace("%%", "%"),
        ("deck", {"metavar": "DECK", "help": "deck to run"}),
        ("--of", {"action": "append", "required": True, "metavar": "QUANTITY", "help": "what is asked for; may be repeated"}),
        ("--within", {"metavar": "X%", "help": "largest uncertainty, of the value, as 2%%"}),
        ("--seconds", {"type": float, "metavar": "N",
                       "help": "seconds for all runs together: alone, the best answer for them; with --within, the limit (600)"}),
        ("--choose", {"action": "store_true", "help": "try contact types, cheapest first, and say which is best"}),
        ("--adapt", {"action": "store_true", "help": "refine where it pays instead of everywhere"}),
        ("--mesh-parameter", {"metavar": "NAME", "help": "parameter of the deck that makes the mesh (1, 2, 3 ...), or {NAME} in "
                                                         "the deck's name: decks of a generator"}),
        ("--json", {"action": "store_true", "help": "print answer.json in place of the table"}),
        ("--folder", {"metavar": "DIR", "help": "of runs and results (results/DECK-answer)"}),
        ("--ncpu", {"type": int, "default": 1, "metavar": "N", "help": "threads of a run (1)"}), PROGRAM)
    parser.error = lambda message: parser.exit(REFUSED, f"{parser.format_usage()}{parser.prog}: error: {message}\n")


def answer(options) -> int:
    """Run a deck on its mesh divided by 1, 2, 3 and further until a quantity is known as well as was asked for, or for so
    many seconds, and say it with its uncertainty. Results, the table, answer.png and answer.json go to a folder;
    runs that are there already are taken as they are. Progress goes to standard error."""
    from slideline_tools.program import ENDINGS, STOPPED, RunError
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)  # a batch system stops it as a keyboard does, with its run
    try:
        return found_of(options)
    except KeyboardInterrupt:
        print("slideline-tools: answer: stopped", file=sys.stderr)
        return NOT_REACHED
    except RunError as problem:
        print(f"slideline-tools: answer: {options.deck}: {problem}", file=sys.stderr)
        status = problem.outcome.status if problem.outcome else REFUSED
        return NOT_REACHED if status == STOPPED else FAILED if status in ENDINGS and status > REFUSED else REFUSED
    except UserError as problem:
        print(f"slideline-tools: answer: {problem}", file=sys.stderr)
        return REFUSED
    finally:
        signal.signal(signal.SIGTERM, before)


def found_of(options) -> int:
    """Find the answer, write and print it; UserError where that cannot be."""
    from slideline_tools.answer import report
    from slideline_tools.answer.loop import find
    from slideline_tools.answer.meshes import AdaptedMeshes, Meshes
    from slideline_tools.answer.quantity import parse
    from slideline_tools.program import find_program
    within = share_of(options.within) if options.within is not None else None
    check(options, within)
    quantities = [parse(text) for text in options.of]
    deck = pathlib.Path(options.deck)
    meshes = (AdaptedMeshes if options.adapt else Meshes)(deck, pathlib.Path(), find_program(options.program), options.ncpu, options.mesh_parameter or "")
    folder = pathlib.Path(options.folder or f"results/{meshes.name}-answer{'-adapt' * options.adapt}")

    def loop(ctype, seconds, most=math.inf):
        meshes.folder = folder / f"type_{ctype}" if ctype else folder
        meshes.parameters = {"ctype": ctype} if ctype else {}
        before = f"type {ctype}, " if ctype else ""
        meshes.tell = lambda line: print(before + line, file=sys.stderr, flush=True)
        found = find(meshes, quantities, within, seconds, most)
        found.contact_type = ctype
        return found
    tried = []
    if options.choose:
        found = chosen(loop, tried, options.seconds)
    else:
        found = loop(None, options.seconds)
    text = report.json_of(deck, found, tried)
    (folder / "answer.json").write_text(text, encoding="utf-8")
    report.chart(found, folder / "answer.png")
    print(text.rstrip() if options.json else "\n".join(
        [report.table(found), *([report.choice(found, tried)] if tried else []), f"wrote {folder}/answer.json and answer.png"]))
    return WITHIN if found.reached else NOT_REACHED if found.failure is None else FAILED


def chosen(loop, tried: list, seconds):
    """The loops of all types, cheapest first: on three meshes, and where none of these does, on further ones for no longer than the
    best took; the one that reached the target at least cost, else that of least uncertainty. Types that the program refuses for
    this deck, or whose first mesh takes too long, are left out."""
    from slideline_tools.answer.loop import FIRST
    from slideline_tools.program import STOPPED, RunError
    types, best, refused = list(CHEAPEST_FIRST), None, None
    for most in (len(FIRST), math.inf):
        tried.clear()
        for ctype in list(types):
            try:
                tried.append(one := loop(ctype, min(best.seconds, seconds or math.inf) if best and most > len(FIRST) else seconds, most))
            except RunError as problem:
                if problem.outcome is None or problem.outcome.status not in (REFUSED, STOPPED):
                    raise
                print(f"type {ctype} is left out: {problem}", file=sys.stderr)
                types.remove(ctype)
                refused = problem
                continue
            if one.reached and (best is None or one.seconds < best.seconds):
                best = one
        if not tried:
            raise refused
        if best:
            return best
    return min(tried, key=lambda one: max(single.estimate.relative for single in one.answers))


def check(options, within) -> None:
    """Refuse what cannot be asked for."""
    if options.adapt and options.mesh_parameter:
        raise UserError("--adapt refines the mesh of the deck: it goes with no --mesh-parameter")
    if within is None and options.seconds is None:
        raise UserError("how well, or for how long? --within X% or --seconds N")
    if options.choose and within is None:
        raise UserError("--choose says which type reaches a target at least cost: --within X%")
    if options.seconds is not None and not 0.0 < options.seconds < math.inf:
        raise UserError(f"--seconds {options.seconds:g}: expected more than 0")
    if options.ncpu < 1:
        raise UserError(f"--ncpu {options.ncpu}: expected 1 or more")


def share_of(text: str) -> float:
    """The share that '2%' says."""
    try:
        share = float(text.removesuffix("%")) / 100.0
        if text.endswith("%") and 0.0 < share < math.inf:
            return share
    except ValueError:
        pass
    raise UserError(f"--within {text}: expected a percentage above 0 such as 2%")
