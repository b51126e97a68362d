#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/kill_test.sh [KILLS] [SEED]
# Kills runs of all scenes at random instants (default 200, seed 1) and checks what is left of each:
# results in h5py and VTK, CSV files, restart files, the run that goes on, the rerun. A quarter of an hour.
# Needs what the tests need: tools/test.sh, run once before, installs it.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
"$root/tools/build.sh" release
SLIDELINE=$root/build/release/slideline SLIDELINE_KILLS=${1:-200} SLIDELINE_SEED=${2:-1} \
  PYTHONPATH=$root/tools "$root/build/venv/bin/python" -m pytest -q -s -p no:cacheprovider \
  "$root/tests/program/test_kill.py" -k leave_whole
