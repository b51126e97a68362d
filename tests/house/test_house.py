# SPDX-License-Identifier: MIT
"""The rules of the house (doc/architecture.md), as tests."""
import ast
import graphlib
import re
import statistics
import subprocess

import pytest

from fortran_source import ROOT, read_source, without_strings

#: layer -> layers it may use
LAYERS = {
    "base": set(),
    "linear": {"base"},
    "parallel": {"base"},
    "model": {"base"},
    "deck_schema": {"base"}, "deck_text": {"base", "model", "deck_schema"},
    "deck_cards": {"base", "model", "deck_text", "deck_schema"},
    "deck_effective": {"base", "model", "deck_text"},
    "deck": {"base", "model", "deck_text", "deck_schema", "deck_cards", "deck_effective"},
    "state": {"base", "model"},
    "material": {"base", "model"},
    "element": {"base", "linear", "model", "state", "material"},
    "contact_geometry": {"base", "model", "state"},
    "contact_search": {"base", "model", "state", "contact_geometry"},
    "contact_overlap": {"base", "model", "state", "contact_geometry", "contact_search"},
    "contact_points": {"base", "model", "state", "contact_geometry", "contact_search", "contact_overlap"},
    "contact_law": {"base", "model", "state", "contact_geometry"},
    "contact_tangent": {"base", "linear", "model", "state", "contact_geometry", "contact_overlap", "contact_points", "contact_law"},
    "contact": {"base", "linear", "model", "state", "contact_geometry", "contact_search", "contact_overlap",
                "contact_points", "contact_law", "contact_tangent"},
    "loads": {"base", "model"},
    "output": {"base", "model", "state"},
    "run": {"base", "parallel", "model", "state", "element", "contact", "loads", "output"},
    "solve_start": {"base", "model", "state", "element", "contact", "contact_law", "loads"},
    "solve_explicit": {"base", "parallel", "model", "state", "element", "contact", "contact_law", "loads", "output", "run",
                       "solve_start"},
    "solve_implicit": {"base", "linear", "model", "state", "element", "contact", "contact_law", "loads", "output",
                       "run"},
    "solve": {"base", "parallel", "model", "state", "output", "run", "solve_start", "solve_explicit", "solve_implicit"},
}
#: modules from outside -> layers that may use them
OUTSIDE = {"hdf5": {"output"}, "mpi": {"parallel"}, "omp_lib": {"base"}}
#: what decides between kinds -> the one file that may ask for it
DISPATCHERS = {
    "contact_type": "contact_dispatch.f90",
    "law": "material_dispatch.f90",
    "contact_law": "contact_law.f90",
    "element_form": "element_dispatch.f90",
}
MOST_FILE_LINES, MOST_PROCEDURE_LINES, MOST_ARGUMENTS, MOST_COLUMNS = 500, 80, 8, 100
MOST_TEST_COLUMNS = 132
#: procedures that have more arguments, and how many; none may be added
MORE_ARGUMENTS = {"grow_with_rate": 10}
MORE_ARGUMENTS_IN_CONTACT = 10
MOST_MEDIAN_LINES = 25
AIM_FILE_LINES, AIM_PROCEDURE_LINES, AIM_ARGUMENTS = 300, 60, 8
TOP_LEVEL = {"CMakeLists.txt", "README.md", "src", "input", "tests", "tools", "doc"}

SOURCES = [read_source(path) for path in sorted((ROOT / "src").rglob("*.f90"))]
OWNER = {module: source for source in SOURCES for module in source.modules}
OWNER |= dict.fromkeys(("build_info_m", "dual_m", "short_dual_m"))  # made by CMake, in base
OUTSIDE["source_version_m"] = {""}  # made at every build, for the program alone


def folder_of(layer):
    """The folder of a layer below src/: contact_geometry is contact/geometry."""
    return layer.replace("_", "/", 1)


def layer_of(source):
    """The layer that a file is in; empty for src/ itself."""
    parts = source.path.relative_to(ROOT / "src").parts[:-1]
    inner = "_".join(parts[:2])
    return inner if inner in LAYERS else parts[0] if parts else ""


def tracked_files():
    """The files of the repository; all that are there where there is no git to ask."""
    try:
        done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True,
                              check=True)
        names = done.stdout.split("\0")
    except (OSError, subprocess.CalledProcessError):
        made = {".git", "build", "results", "__pycache__", ".pytest_cache"}
        paths = [path.relative_to(ROOT) for path in ROOT.rglob("*") if path.is_file()]
        names = [str(path) for path in paths
                 if not made & set(path.parts) and ".egg-info" not in str(path)]
    return [name for name in names if name and (ROOT / name).exists()]


def report(capsys, text):
    """Print a figure past pytest's capture."""
    with capsys.disabled():
        print(f"\n{text}")


def test_there_are_sources():
    assert SOURCES


def test_folders_of_src_are_the_layers():
    folders = {layer_of(source) for source in SOURCES} - {""}
    assert folders <= set(LAYERS)


def interfaces_of(path):
    """Procedure -> its arguments and their declarations; and the type."""
    text = path.read_text()
    found = {name: (arguments, [line.split("!!")[0].strip() for line in body.splitlines() if "intent(" in line])
             for name, arguments, body in re.findall(r"^  subroutine (\w+)\((.*?)\)\n(.*?)^  end subroutine", text, re.M | re.S)}
    found["ranks_t"] = re.search(r"type :: ranks_t.*?end type", text, re.S).group()
    return found


def test_both_modules_of_processes_are_called_alike():
    """What is compiled with the one of a single process is linked with the one of MPI (slideline_mpi)."""
    serial, several = (interfaces_of(ROOT / "src/parallel" / kind / "ranks.f90") for kind in ("serial", "mpi"))
    assert len(serial) > 5 and serial == {name: several[name] for name in serial}


def test_build_gives_each_layer_what_the_table_gives_it():
    text = (ROOT / "CMakeLists.txt").read_text()
    built = {words[0].replace("/", "_"): set(words[1:])
             for words in (call.split() for call in re.findall(r"^add_layer\(([^)]*)\)", text, re.M))}
    assert built == LAYERS


def test_file_holds_the_one_module_named_after_it():
    wrong = [source.name for source in SOURCES
             if source.path.name != "main.f90" and source.modules != [source.path.stem + "_m"]]
    assert not wrong


def test_use_names_what_it_takes():
    wrong = [f"{source.name}:{use.line}: use {use.module}" for source in SOURCES
             for use in source.uses if not use.only]
    assert not wrong


def test_no_use_upward_or_sideways():
    wrong = []
    for source in SOURCES:
        layer = layer_of(source)
        allowed = LAYERS.get(layer, set(LAYERS)) | {layer}
        for use in source.uses:
            if use.intrinsic:
                continue
            if use.module in OUTSIDE:
                fine = layer in OUTSIDE[use.module]
            elif use.module in OWNER:
                owner = OWNER[use.module]
                fine = (layer_of(owner) if owner else "base") in allowed
            else:
                fine = False
            if not fine:
                wrong.append(f"{source.name}:{use.line}: use {use.module}")
    assert not wrong


@pytest.mark.parametrize("word, dispatcher", DISPATCHERS.items())
def test_only_the_dispatcher_asks_for_the_kind(word, dispatcher):
    asks = re.compile(rf"^(?:\w+\s*:\s*)?select\s+case\s*\(.*\b{word}\b|"
                      rf"\b{word}\b(?:\([^)]*\))?\s*(?:==|/=|\.eq\.|\.ne\.)", re.I)
    wrong = [f"{source.name}:{line}: {statement}" for source in SOURCES
             for line, statement in source.statements
             if source.path.name != dispatcher and asks.search(without_strings(statement))]
    assert not wrong


def most_arguments(procedure, source):
    if "contact" in source.path.relative_to(ROOT / "src").parts:
        return MORE_ARGUMENTS_IN_CONTACT
    return MORE_ARGUMENTS.get(procedure.name, MOST_ARGUMENTS)


def test_sizes(capsys):
    procedures = [(procedure, source) for source in SOURCES for procedure in source.procedures]
    wrong = [f"{source.name}: {len(source.lines)} lines" for source in SOURCES
             if len(source.lines) > MOST_FILE_LINES]
    wrong += [f"{source.name}: {procedure.name} has {procedure.lines} lines"
              for procedure, source in procedures if procedure.lines > MOST_PROCEDURE_LINES]
    wrong += [f"{source.name}: {procedure.name} has {procedure.arguments} arguments"
              for procedure, source in procedures
              if procedure.arguments > most_arguments(procedure, source)]
    median = statistics.median(procedure.lines for procedure, _ in procedures)
    beyond = [source.name for source in SOURCES if len(source.lines) > AIM_FILE_LINES]
    beyond += [f"{source.name}:{procedure.name}" for procedure, source in procedures
               if procedure.lines > AIM_PROCEDURE_LINES or procedure.arguments > AIM_ARGUMENTS]
    report(capsys, f"{len(SOURCES)} files, {sum(len(source.lines) for source in SOURCES)} lines, "
                   f"{len(procedures)} procedures of {median:g} lines in the median; "
                   f"beyond the aim: {', '.join(beyond) or 'nothing'}")
    assert not wrong
    assert median <= MOST_MEDIAN_LINES


def test_no_line_is_too_long():
    files = [path for folder in ("src", "tests") for pattern in ("*.f90", "*.pf")
             for path in sorted((ROOT / folder).rglob(pattern))]
    wrong = [f"{path.relative_to(ROOT)}:{number}" for path in files
             for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
             if len(line) > (MOST_COLUMNS if path.is_relative_to(ROOT / "src")
                             else MOST_TEST_COLUMNS)]
    assert not wrong


def test_modules_are_private_and_typed():
    wrong = []
    for source in SOURCES:
        texts = [statement.lower() for _, statement in source.statements]
        if "implicit none" not in texts:
            wrong.append(f"{source.name}: no implicit none")
        if source.modules and "private" not in texts:
            wrong.append(f"{source.name}: not private")
    assert not wrong


@pytest.mark.parametrize("what, pattern", [
    ("goto", r"\bgo\s*to\b"),
    ("common", r"^common\s*/"),
    ("include", r"^include\b"),
    ("preprocessor", r"^#"),
    ("pointer", r"^(?:type|class|real|integer|logical|character)\b.*,\s*pointer\b.*::"),
])
def test_what_the_house_does_without(what, pattern):
    wrong = [f"{source.name}:{line}: {what}" for source in SOURCES
             for line, statement in source.statements
             if re.search(pattern, without_strings(statement), re.I)]
    assert not wrong


#: A unit right behind a number (' m', ' J per radian', no text in spread letters), or a quotient ('N/m^2').
UNIT = re.compile(r"^ (?:[kM]?N|k?J|[MG]?Pa|kg|[cm]?m|m?s)(?=[,;:)/]|$| (?!\w ))|\b(?:N|J|kg|[cm]?m|m?s)/m?[ms]\b")


def test_messages_name_no_unit_of_their_own():
    """The deck's units are not known; `units_m` has their names where *CONTROL_UNITS tells them."""
    wrong = [f"{source.name}:{line}: {text}" for source in SOURCES if source.path.name != "units.f90"
             for line, statement in source.statements for text in re.findall(r"'((?:[^']|'')*)'", statement) if UNIT.search(text)]
    assert not wrong


def test_only_main_stops():
    wrong = [f"{source.name}:{line}" for source in SOURCES if source.path.name != "main.f90"
             for line, statement in source.statements
             if re.search(r"(?:^|\)\s*)stop\b", without_strings(statement), re.I)
             and not re.search(r"\berror\s+stop\b", statement, re.I)]
    assert not wrong


def test_sources_name_their_licence():
    files = [name for name in tracked_files()
             if re.search(r"^(src|tools|tests)/.*\.(f90|f90\.in|pf|py|sh)$", name)]
    wrong = [name for name in files
             if "SPDX-License-Identifier: MIT" not in "".join((ROOT / name).read_text(
                 encoding="utf-8").splitlines(keepends=True)[:2])]
    assert not wrong


def test_top_level_holds_what_it_should():
    names = {name.split("/")[0] for name in tracked_files()}
    assert {name for name in names if not name.startswith(".")} <= TOP_LEVEL


def texts(names):
    """(name, text) of the files that are text."""
    for name in names:
        try:
            yield name, (ROOT / name).read_text(encoding="utf-8")
        except (UnicodeDecodeError, IsADirectoryError):
            continue


def test_no_paths_of_one_machine():
    path = re.compile(r"(?<![\w./}])/(?:work|root|home|tmp)/")
    wrong = [f"{name}:{number}" for name, text in texts(tracked_files())
             for number, line in enumerate(text.splitlines(), 1) if path.search(line)]
    assert not wrong


def test_nothing_is_left_for_later():
    word = re.compile(r"\b(?:TODO|FIXME|XXX)\b|\bstubs?\b|\bnot implemented\b")
    wrong = [f"{name}:{number}" for name, text in texts(tracked_files())
             if name.startswith(("src/", "tools/"))
             for number, line in enumerate(text.splitlines(), 1) if word.search(line)]
    assert not wrong


def test_modules_of_the_tools_import_each_other_without_circles():
    """Lazy imports count too; the package itself alone hands out names of its modules."""
    top = ROOT / "tools"
    paths = {".".join(path.relative_to(top).with_suffix("").parts).removesuffix(".__init__"): path
             for path in (top / "slideline_tools").rglob("*.py")}
    graph = {name: set() for name in paths}
    for name, path in paths.items():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("slideline_tools"):
                graph[name] |= {f"{node.module}.{one.name}" if f"{node.module}.{one.name}" in paths else node.module
                                for one in node.names} - {name, "slideline_tools"}
    assert len(graph) > 50
    graphlib.TopologicalSorter(graph).prepare()
