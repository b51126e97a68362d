#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/package/sdist.sh
# Stages a source distribution and makes build/package/sdist/slideline-VERSION.tar.gz of it, which pip builds where gfortran,
# HDF5 and LAPACK are installed.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../setup.sh"
help_or_go_on "$@"
. "$root/tools/package/common.sh"

lock
install_packages
python_with build
stage=$packages/stage
rm -rf "$stage" "$packages/sdist"
mkdir -p "$stage/tools" "$stage/doc"
cp -R "$root/CMakeLists.txt" "$root/README.md" "$root/src" "$root/input" "$stage" &&
  cp -R "$root/tools/slideline_tools" "$root/tools/package" "$root/tools/docs" "$stage/tools" &&
  cp "$root/doc/LICENSE.md" "$root/doc/CITATION.cff" "$stage/doc" &&
  find "$stage" -name __pycache__ -prune -exec rm -rf {} + || exit 1
# The same project with its folders one level up.
sed -e 's|^cmake.source-dir = ".."|cmake.source-dir = "."|' -e 's|"slideline_tools"\]|"tools/slideline_tools"]|' \
  -e 's|^input = "|&tools/|' -e 's|^license = .*|&\nreadme = "README.md"|' \
  "$root/tools/pyproject.toml" >"$stage/pyproject.toml"
"$venv/bin/python" -m build --sdist --outdir "$packages/sdist" "$stage" >"$packages/sdist.log" 2>&1 || fail sdist
say "the source distribution is build/package/sdist/slideline-$version.tar.gz"
