# SPDX-License-Identifier: MIT
"""The build itself keeps the layers apart: a `use` outside the table does not compile.

A tree of one small module per layer is built with the project's own CMakeLists.txt. The compiler looks for modules in
the folders that the command of a layer names: those of the layers it may use and no others, where each folder
holds the modules of its own layer alone. That this is what decides is seen by compiling with that command a `use` of all
that a layer may use, and one of a layer that it may not. The other way round, a changed module must reach the layers that use it.
"""
import json
import pathlib
import shlex
import shutil
import subprocess

import pytest

from fortran_source import ROOT
from test_house import LAYERS, folder_of

GOOD = "module probe_{layer}_m\n{uses}  implicit none\n  integer :: {layer}_value = 1\nend module\n"
USE = "  use probe_{layer}_m, only: {layer}_value\n"


@pytest.fixture(scope="module", name="tree")
def build_small_tree(tmp_path_factory):
    """The folder of a small tree of layers that has been built in its folder `build`."""
    tree = tmp_path_factory.mktemp("layers")
    shutil.copy(ROOT / "CMakeLists.txt", tree)
    for layer, allowed in LAYERS.items():
        folder = tree / "src" / folder_of(layer)
        folder.mkdir(parents=True, exist_ok=True)
        uses = "".join(USE.format(layer=name) for name in sorted(allowed))
        (folder / f"probe_{layer}.f90").write_text(GOOD.format(layer=layer, uses=uses))
    for name in ("build_info.f90.in", "dual.f90.in", "kinds.f90"):
        shutil.copy(ROOT / "src/base" / name, tree / "src/base")
    build = tree / "build"
    for command in (["cmake", "-S", tree, "-B", build, "-G", "Ninja", "-DSLIDELINE_TESTS=OFF", "-DSLIDELINE_INSTALL=OFF",
                     "-DSLIDELINE_SANITIZE=OFF", "-DSLIDELINE_STATIC_HDF5=OFF", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"],
                    ["cmake", "--build", build]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return tree


@pytest.fixture(scope="module", name="commands")
def read_commands(tree):
    """layer -> (compile command without its file, folder to run it in)"""
    commands = {}
    for entry in json.loads((tree / "build/compile_commands.json").read_text()):
        for layer in LAYERS:
            if entry["file"].endswith(f"src/{folder_of(layer)}/probe_{layer}.f90"):
                words = shlex.split(entry["command"])
                words = [word for word in words[:words.index("-c")] if word != "-fpreprocessed"]
                commands[layer] = (words, entry["directory"])
    return commands


def test_every_layer_has_a_command(commands):
    assert set(commands) == set(LAYERS)


def folders_searched(words):
    """Where a command lets the compiler look for modules of layers: its -I options."""
    return {pathlib.Path(word[2:]) for word in words if word.startswith("-I") and "/modules/" in word}


def test_every_folder_of_modules_is_that_of_one_layer(tree, commands):
    """Nothing but a folder that is searched shows a module; the folder that a compilation stands in is one of them."""
    for layer in LAYERS:
        found = {path.name for path in (tree / "build/modules" / layer).iterdir()}
        assert f"probe_{layer}_m.mod" in found
        assert not {f"probe_{other}_m.mod" for other in LAYERS.keys() - {layer}} & found
        assert not list(pathlib.Path(commands[layer][1]).glob("*.mod"))


@pytest.mark.parametrize("layer", LAYERS)
def test_layer_sees_what_it_may_use_and_nothing_else(commands, layer, tmp_path):
    words, folder = commands[layer]
    assert {path.name for path in folders_searched(words)} == LAYERS[layer]
    seen, hidden = tmp_path / "seen.f90", tmp_path / "hidden.f90"
    seen.write_text("module try_m\n" + "".join(USE.format(layer=other) for other in LAYERS[layer]) + "  implicit none\nend module\n")
    done = subprocess.run([*words, "-fsyntax-only", seen], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    others = sorted(LAYERS.keys() - LAYERS[layer] - {layer})
    if not others:
        return
    other = others[list(LAYERS).index(layer) % len(others)]  # one, in turn
    hidden.write_text(f"module try_m\n{USE.format(layer=other)}  implicit none\nend module\n")
    done = subprocess.run([*words, "-fsyntax-only", hidden], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode != 0 and "Cannot open module file" in done.stderr and f"{hidden}:2:" in done.stderr, done.stderr


def test_changed_module_reaches_the_layers_above(commands, tree):
    """`commands` comes first because this leaves the tree changed."""
    assert commands
    base = tree / "src/base/probe_base.f90"
    base.write_text(base.read_text().replace("base_value", "other_value"))
    done = subprocess.run(["cmake", "--build", tree / "build", "--", "-k", "0"], capture_output=True,
                          text=True, check=False)
    assert done.returncode != 0
    assert "src/model/probe_model.f90" in done.stdout
