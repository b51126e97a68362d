# SPDX-License-Identifier: MIT
"""The build itself keeps the layers apart: a `use` outside the table does not compile.

A tree of one small module per layer is built with the project's own CMakeLists.txt; then each layer is
given a `use` of every other one and compiled with the command that the build has for that layer.  The
other way round, a changed module must reach the layers that use it.
"""
import json
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
    shutil.copy(ROOT / "src/base/build_info.f90.in", tree / "src/base")
    build = tree / "build"
    for command in (["cmake", "-S", tree, "-B", build, "-G", "Ninja", "-DSLIDELINE_TESTS=OFF",
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


@pytest.mark.parametrize("layer", LAYERS)
def test_layer_sees_what_it_may_use_and_nothing_else(commands, layer, tmp_path):
    """What it may use in one source, of the others each in its own: the compiler goes on to the next one after an error."""
    words, folder = commands[layer]
    hidden = {other: tmp_path / f"try_{other}.f90" for other in LAYERS.keys() - LAYERS[layer] - {layer}}
    for other, source in hidden.items():
        source.write_text(f"module try_m\n{USE.format(layer=other)}  implicit none\nend module\n")
    seen = tmp_path / "seen.f90"
    seen.write_text("module try_m\n" + "".join(USE.format(layer=other) for other in LAYERS[layer]) + "  implicit none\nend module\n")
    done = subprocess.run([*words, "-fsyntax-only", seen, *hidden.values()], cwd=folder, capture_output=True,
                          text=True, check=False)
    assert f"{seen}:" not in done.stderr, done.stderr
    assert {other for other, source in hidden.items() if f"{source}:2:" in done.stderr} == hidden.keys()
    assert done.stderr.count("Cannot open module file") == len(hidden)
    assert (done.returncode != 0) == bool(hidden)


def test_changed_module_reaches_the_layers_above(commands, tree):
    """`commands` comes first because this leaves the tree changed."""
    assert commands
    base = tree / "src/base/probe_base.f90"
    base.write_text(base.read_text().replace("base_value", "other_value"))
    done = subprocess.run(["cmake", "--build", tree / "build", "--", "-k", "0"], capture_output=True,
                          text=True, check=False)
    assert done.returncode != 0
    assert "src/model/probe_model.f90" in done.stdout
