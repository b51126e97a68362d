#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/test.sh [ctest arguments...]
# Installs what is missing, then runs every test of the Release build, then the quick ones of the
# Debug build with its run-time checks and sanitisers.  With arguments (such as -L unit, or
# -R contact) only the Release tests so chosen.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
help_or_go_on "$@"

lock
install_packages test
install_tools test
failed=0

# run_tests TYPE [ctest arguments...]
run_tests() {
  local type=$1
  shift
  say "testing build/$type"
  ctest --test-dir "$root/build/$type" --output-on-failure --no-tests=error \
    --parallel "$(nproc)" "$@" || failed=1
}

build release all
unlock
run_tests release "$@"
if [ $# -eq 0 ]; then
  lock
  build debug all
  unlock
  run_tests debug -L 'unit|rejected|program|quick'
fi
if [ $failed -ne 0 ]; then
  complain "tests failed"
fi
exit $failed
