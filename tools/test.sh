#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/test.sh [ctest arguments...]
# Installs what is missing, then runs the tests of the Release build, then the quick ones of the
# Debug build with its run-time checks and sanitisers.  Every test runs in one of the two; some program
# and unit tests in one alone (tests/CMakeLists.txt, tests/unit/CMakeLists.txt), unless SLIDELINE_FULL is 1.
# With arguments (such as -L unit, or -R contact) only the Release tests so chosen.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
help_or_go_on "$@"

# Without bytecode each of some hundred starts of Python would compile the tools anew.
unset PYTHONDONTWRITEBYTECODE
lock
install_packages test
failed=0

# run_tests TYPE [ctest arguments...]
run_tests() {
  local type=$1
  shift
  say "testing build/$type"
  # One more than there are processors: some tests wait for the disk, or sleep.
  ctest --test-dir "$root/build/$type" --output-on-failure --no-tests=error \
    --parallel "$(($(nproc) + 1))" "$@" || failed=1
}

# Labels of tests that the build leaves to the other one; in full none.
left_to_debug='^debug$'
left_to_release='^release$'
units=()
if [ "${SLIDELINE_FULL:-0}" = 1 ]; then
  left_to_debug='^$'
  left_to_release='^$'
fi
if [ "${SLIDELINE_FULL:-0}" = 1 ] || [ $# -gt 0 ]; then
  units=(all_unit_tests)
fi

# What comes over the network comes while the compiler works. Where there is no environment the second attempt says why.
make_environment || install_tools test || exit 1
install_tools test &
tools=$!
build release all "${units[@]}"
wait "$tools" || exit 1
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
