# SPDX-License-Identifier: MIT
"""The studies by name, and their tables: what makes each, which sources it speaks of, the page of doc/studies that quotes it.

Made tables (all levels and types, with their pictures) go to results/doc and are kept with releases; pages of
doc/studies are written and quote them. Both name in the third line the source and the processor they were made from, and
the digest of those sources. Where the digest is another today a page is behind the code; that has to be allowed openly,
in doc/studies/README.md (tests/house/test_pages.py).
"""
import dataclasses
import hashlib
import importlib
import os
import pathlib
import re
import subprocess

from slideline_tools.studies.framework.runner import processor

ROOT = pathlib.Path(__file__).resolve().parents[4]
STEP = ("base", "linear", "model", "state", "material", "element", "loads", "run", "solve")  # folders of src: an explicit step
CONTACT = (*STEP, "contact")
ALL = (*CONTACT, "deck", "output")


@dataclasses.dataclass(frozen=True)
class Page:
    """Tables: `quoted` by a page of doc/studies, made by a `command` from the top of the tree, of `sources`, folders of src."""

    quoted: str
    command: tuple
    sources: tuple = CONTACT


STUDIED = (  # module of slideline_tools.studies, page that quotes its tables, sources; `chooses` reads what speed_accuracy wrote
    ("estimates", "choosing", CONTACT),
    ("uncertainty", "uncertainty", CONTACT),
    ("round", "speed_accuracy", CONTACT),
    ("paper", "paper", CONTACT),
    ("stability", "stability", CONTACT),
    ("speed_accuracy", "speed_accuracy", CONTACT),
    ("chooses", "choosing", CONTACT),
    ("simplify", "simplify", ALL),
    ("scale", "scale", ("parallel",)),
)
STUDIES = {module.replace("_", "-"): module for module, *_ in STUDIED}
PAGES = {
    **{module: Page(quoted, ("tools/study.sh", module.replace("_", "-"), "--publish"), sources) for module, quoted, sources in STUDIED},
    "peers": Page("peers", ("tests/lab/bench/peers/run.sh", "--publish")),
    "speed_laws": Page("speed", ("tests/lab/bench/laws.sh", "--publish"), ("material",)),
    "speed": Page("speed", ("tests/lab/bench/run.sh", "--publish"), ALL),
}


def load(name):
    """The `Study` of that name, of its module or of `study` in its folder."""
    module = importlib.import_module(f"slideline_tools.studies.{STUDIES[name]}")
    return getattr(module, "STUDY", None) or importlib.import_module(f"{module.__name__}.study").STUDY


ORIGIN = re.compile(r"^Made from source `(?P<source>\S+)` on (?P<processor>.+); digest of what it speaks of "
                    r"`(?P<digest>[0-9a-f]{12})`\.$", re.MULTILINE)


def code_of(path):
    """The code of a Fortran file without comments and blank lines, which no page depends on."""
    kept = []
    for line in path.read_text(encoding="utf-8").splitlines():
        bare = line.strip()
        if bare and (not bare.startswith("!") or bare.startswith(("!$", "!GCC$"))):
            kept.append(bare)
    return "\n".join(kept)


def digest(folders, root=ROOT):
    """Of the sources in these folders of src, 12 hexadecimal digits."""
    found = hashlib.sha256()
    for folder in sorted(folders):
        for path in sorted((root / "src" / folder).rglob("*.f90")):
            found.update(f"{path.relative_to(root).as_posix()}\n{code_of(path)}\n".encode())
    return found.hexdigest()[:12]


def program_source(program=None):
    """The source that a program was built from, as it says itself; 'unknown' where there is none."""
    program = program or os.environ.get("SLIDELINE") or ROOT / "build" / "release" / "slideline"
    try:
        done = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    reported = re.search(r"\(source (\S+)\)", done.stdout)
    return reported[1] if reported else "unknown"


def with_origin(name, text, source=None, processors=None):
    """The text of a page with the line of its origin below its title.

    Without `source` and `processors`: the program of the release build, or what $SLIDELINE names, and this machine.
    """
    title, _, rest = text.partition("\n")
    return (f"{title}\n\nMade from source `{source or program_source()}` on {processors or processor()}; "
            f"digest of what it speaks of `{digest(PAGES[name].sources)}`.\n\n{rest.lstrip()}")
