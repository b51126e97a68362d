#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/load_test.sh [JOBS] [SEED]
# Runs small jobs (default 1000, seed 1) of all types and scenes in batches, 4 and 8 at a time and as an array, that are killed run by run
# and as a whole and taken up again, and compares every result with that of its deck run alone. A quarter of an hour.
# Needs what the tests need: tools/test.sh, run once before, installs it.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
"$root/tools/build.sh" release
SLIDELINE=$root/build/release/slideline SLIDELINE_JOBS=${1:-1000} SLIDELINE_SEED=${2:-1} \
  PYTHONPATH=$root/tools "$root/build/venv/bin/python" -m pytest -q -s -p no:cacheprovider \
  "$root/tests/program/test_load.py" -k lose_no_result
