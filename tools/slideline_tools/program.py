# SPDX-License-Identifier: MIT
"""Run the program from Python: one deck, or one deck with many values.

    outcome = slideline_tools.run("input/collision/collision.k", ctype=5, v0=-60.0)
    outcome.history("rcforc").where(side="slave")["fy"].max()
"""
from __future__ import annotations

import concurrent.futures
import dataclasses
import itertools
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import typing

from slideline_tools import UserError
from slideline_tools.histories import History, read_csv
from slideline_tools.names import missing, nearest, one_line
from slideline_tools.results import Results

if typing.TYPE_CHECKING:
    import pandas

#: what the command line may change of any deck; those of a contact also as `name.INTERFACE`
OF_CONTACT = ("ctype", "ngauss", "pen", "punit", "pent", "vdc", "fs", "fd", "dc", "vc", "tfac", "target", "smooth")
OVERRIDES = (*OF_CONTACT, "endtim", "dt", "tssfac")
#: exit status -> words
ENDINGS = {0: "normal termination", 1: "refused", 2: "error termination", 3: "trouble with files",
           4: "stopped on request"}
REFUSED, STOPPED = 1, 4
MOST_MESSAGE = 2000   # characters of what the program said
LONGEST_NAME = 200    # of a folder, in characters


class RunError(UserError):
    """A run that could not start or has not ended normally; `outcome` is None where it did not start."""

    def __init__(self, message: str, outcome: Outcome | None = None) -> None:
        super().__init__(message)
        self.outcome = outcome


@dataclasses.dataclass(repr=False)
class Outcome:
    """One run of the program, ended.

    `parameters` as given to `run`, `status` the exit status, `said` what it wrote on standard error.
    """

    folder: pathlib.Path
    job: str
    parameters: dict[str, typing.Any]
    status: int
    said: str

    def __repr__(self) -> str:
        values = "".join(f", {name}={value}" for name, value in self.parameters.items())
        return one_line(f"Outcome {self.job}: {ENDINGS.get(self.status, self.status)}{values}, in {self.folder}")

    @property
    def ended_well(self) -> bool:
        """Whether it ended with status 0."""
        return self.status == 0

    def require_run(self) -> None:
        """A refused deck has not run: what its folder may hold is of an earlier run."""
        if self.status == REFUSED:
            raise RunError(failure(self), self)

    @property
    def results(self) -> Results:
        """States, fields and histories. UserError where the deck asks for no states."""
        self.require_run()
        return Results(self.folder / f"{self.job}.vtkhdf")

    def history(self, name: str) -> History:
        """A table such as 'glstat' or 'rcforc', from its CSV file."""
        self.require_run()
        path = self.folder / f"{self.job}.{name}.csv"
        if not path.exists():
            there = [file.name[len(self.job) + 1:-len(".csv")]
                     for file in sorted(self.folder.glob(f"{self.job}.*.csv"))]
            raise RunError(f"{self.folder / self.job}: no history '{name}'{missing(name, there)}")
        return read_csv(path)

    def frame(self, name: str) -> pandas.DataFrame:
        """The same as a pandas DataFrame."""
        return self.history(name).frame()


def find_program(program: str | os.PathLike | None = None) -> str:
    """The program: as named, $SLIDELINE, the one installed with these tools, build/release/slideline of their tree, of
    the present folder or one above it, that of the path."""
    if named := program or os.environ.get("SLIDELINE"):
        return os.fspath(named)
    here, tools = pathlib.Path.cwd(), pathlib.Path(__file__).resolve()
    installed = []
    if tools.is_relative_to(sys.prefix):  # by pip
        installed.append(pathlib.Path(sysconfig.get_path("scripts")))
    if tools.parents[3].name == "share":  # by cmake --install, in PREFIX/share/slideline/python
        installed.append(tools.parents[4] / "bin")
    for folder in installed:
        if (beside := folder / "slideline").exists():
            return str(beside)
    for tree in (tools.parents[2], here, *here.parents):
        if (built := tree / "build" / "release" / "slideline").exists():
            return str(built)
    return "slideline"


def not_run(program: str | os.PathLike, problem: OSError) -> str:
    """That a program can not be run, and how to name another."""
    return (f"cannot run the program {os.fspath(program)}: {problem.strerror or problem} (name it by --program or program=, or in "
            "the environment as SLIDELINE; tools/build.sh builds it)")


def words_of(parameters: typing.Mapping[str, typing.Any]) -> list[str]:
    """Arguments of the command line: ctype=5 for what every deck has, p:NAME=VALUE for the others."""
    words = []
    for name, value in parameters.items():
        value = value.item() if getattr(value, "size", 0) == 1 else value
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            raise RunError(f"{name}={value!r}: expected a number or a text")
        base, dot, number = name.partition(".")
        known = name in OVERRIDES or (dot and base in OF_CONTACT and number.isdigit())
        words.append(f"{name if known or name.startswith('p:') else f'p:{name}'}={value}")
    return words


def run(deck: str | os.PathLike, folder: str | os.PathLike | None = None, *,
        program: str | os.PathLike | None = None, threads: int = 1, check: bool = True,
        limit: float | None = None, **parameters: typing.Any) -> Outcome:
    """Run a deck and wait for its end.

    `folder` of the results (default: results/<deck>); `parameters` are what may be changed of every
    deck (ctype, ngauss, pen, punit, pent, vdc, fs, fd, dc, vc, tfac, target, smooth, endtim, dt,
    tssfac; of interface 2 alone **{"ctype.2": 6}), and otherwise a *PARAMETER of the deck (**{"p:dt": 1e-7}
    where it has one of those names). RunError where the run does not end normally, unless `check`
    is False. After `limit` seconds the run is stopped.
    """
    deck = pathlib.Path(deck)
    if not deck.is_file():
        raise RunError(f"{deck}: no such file")
    folder = pathlib.Path(folder) if folder is not None else pathlib.Path("results") / deck.stem
    command = [find_program(program), f"i={deck}", f"d={folder}", f"ncpu={threads}", "quiet=1",
               *words_of(parameters)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=limit)
    except OSError as problem:
        raise RunError(not_run(command[0], problem)) from problem
    except subprocess.TimeoutExpired as problem:
        raise RunError(f"{folder / deck.stem}: stopped after {limit:.3g} s", Outcome(folder, deck.stem, dict(parameters), STOPPED, "")) from problem
    outcome = Outcome(folder, deck.stem, dict(parameters), done.returncode, done.stderr.strip())
    if check and not outcome.ended_well:
        raise RunError(failure(outcome), outcome)
    return outcome


def failure(outcome: Outcome) -> str:
    """Why a run has not ended normally."""
    said = outcome.said or "nothing on standard error"
    said = said if len(said) <= MOST_MESSAGE else said[:MOST_MESSAGE] + " ..."
    unknown = re.search(r"p:(\S+) on the command line: the deck has no such parameter(?:;.*)?$", said, re.M)
    hint = nearest(unknown[1], OVERRIDES) if unknown else ""
    words = ENDINGS.get(outcome.status, f"status {outcome.status}")
    return f"{outcome.folder / outcome.job}: {words}: {said}{hint and hint + ' of what the command line knows'}"


class Sweep(list[Outcome]):
    """The runs of a sweep of `deck` in the order of their values; those that failed too."""

    def __init__(self, deck: pathlib.Path, runs: typing.Iterable[Outcome]) -> None:
        super().__init__(runs)
        self.deck = deck

    def __repr__(self) -> str:
        well = sum(outcome.ended_well for outcome in self)
        names = ", ".join(self[0].parameters) if self else ""
        return one_line(f"Sweep of {self.deck.name} over {names}: {len(self)} runs, {well} ended well")

    def frame(self, measure: typing.Callable[[Outcome], typing.Mapping[str, typing.Any]]
              ) -> pandas.DataFrame:
        """A row for each run: its values, its exit status and, where it ended well, what `measure` says of it."""
        import pandas
        return pandas.DataFrame([{**outcome.parameters, "status": outcome.status,
                                  **(measure(outcome) if outcome.ended_well else {})} for outcome in self])


def sweep(deck: str | os.PathLike, folder: str | os.PathLike | None = None, *,
          program: str | os.PathLike | None = None, jobs: int = 1, threads: int = 1,
          **parameters: typing.Any) -> Sweep:
    """Run a deck with every combination of values; a parameter is a value or a list of them, as in `run`.

    `jobs` runs at a time, each into a folder of its own below `folder` (default: results/<deck>-sweep).
    A run that fails is part of the sweep; what is refused raises RunError.
    """
    deck = pathlib.Path(deck)
    base = pathlib.Path(folder) if folder is not None else pathlib.Path("results") / f"{deck.stem}-sweep"
    values = {name: listed(name, value) for name, value in parameters.items()}
    chosen = [dict(zip(values, combination)) for combination in itertools.product(*values.values())]

    def one(pair: tuple[str, dict[str, typing.Any]]) -> Outcome:
        name, picked = pair
        return run(deck, base / name, program=program, threads=threads, check=False, **picked)

    with concurrent.futures.ThreadPoolExecutor(max(jobs, 1)) as pool:
        runs = list(pool.map(one, zip(folder_names(chosen), chosen)))
    for outcome in runs:
        if outcome.status == REFUSED:
            raise RunError(failure(outcome))
    return Sweep(deck, runs)


def listed(name: str, value: typing.Any) -> list:
    """The values of a parameter, each once."""
    values = [value] if isinstance(value, str) or not hasattr(value, "__iter__") else list(value)
    if not values:
        raise RunError(f"{name}: no value")
    for number, one in enumerate(values):
        if one in values[:number]:
            raise RunError(f"{name}: {one} is given twice")
    return values


def folder_names(chosen: list[dict[str, typing.Any]]) -> list[str]:
    """A name for each combination, made of its values; the same ones up to case get a number."""
    names: list[str] = []
    for values in chosen:
        name = "_".join(re.sub(r"[^A-Za-z0-9_.+-]", "_", f"{key.removeprefix('p:')}_{value}")
                        for key, value in values.items()) or "run"
        if len(name) > LONGEST_NAME:
            raise RunError("the name of a run would be too long for a file system: sweep fewer at once")
        used = {one.lower() for one in names}
        number, whole = 1, name
        while whole.lower() in used:
            number, whole = number + 1, f"{name}-{number + 1}"
        names.append(whole)
    return names
