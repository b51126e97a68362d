#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/test.sh [ctest arguments...]
# Installs what is missing, then runs the tests of the Release build, then the quick ones of the
# Debug build with its run-time checks and sanitisers.  Every test runs in one of the two; some program
# tests in one alone (tests/CMakeLists.txt), unless SLIDELINE_FULL is 1.  With arguments (such as -L unit,
# or -R contact) only the Release tests so chosen.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
help_or_go_on "$@"

lock
install_packages test
failed=0

# run_tests TYPE [ctest arguments...]
run_tests() {
  local type=$1
  shift
  say "testing build/$type"
  ctest --test-dir "$root/build/$type" --output-on-failure --no-tests=error \
    --parallel "$(nproc)" "$@" || failed=1
}

# Labels of tests that the build leaves to the other one; in full none.
left_to_debug='^debug$'
left_to_release='^release$'
if [ "${SLIDELINE_FULL:-0}" = 1 ]; then
  left_to_debug='^$'
  left_to_release='^$'
fi

build release all
install_tools test || exit 1
unlock
if [ $# -gt 0 ]; then
  run_tests release "$@"
else
  run_tests release -LE "$left_to_debug"
  lock
  build debug all
  unlock
  run_tests debug -L 'unit|rejected|program|quick' -LE "$left_to_release"
fi
if [ $failed -ne 0 ]; then
  complain "tests failed"
fi
exit $failed
