#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tests/lab/watch/coverage.sh [FOLDER] [ctest arguments...]
# Builds the program and the unit tests with --coverage in FOLDER (build/coverage), runs all tests but those of the
# documents' commands, or the ones that the ctest arguments choose, and says which lines of src/ they have run
# (FOLDER/coverage.txt). PYTHON names the Python with the tools' packages (build/venv/bin/python), JOBS how many
# tests run side by side. A test that fails here is only reported: a few judge times or the last bits of Release.
set -euo pipefail
here=$(CDPATH='' cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
folder=${1:-$root/build/coverage}
[ $# -eq 0 ] || shift
python=${PYTHON:-$root/build/venv/bin/python}
jobs=${JOBS:-$(nproc)}

# -O1: lines stay apart, and the tests end. Atomic, since threads count the same lines.
cmake -S "$root" -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Coverage -DPython3_EXECUTABLE="$python" \
  -DCMAKE_Fortran_FLAGS_COVERAGE="-O1 -g --coverage -fprofile-update=atomic" -DSLIDELINE_TEST_SECONDS=3600
cmake --build "$folder" --parallel "$jobs"
find "$folder" -name '*.gcda' -delete
if [ $# -eq 0 ]; then
  set -- -LE house -E docs.commands
fi
ctest --test-dir "$folder" --output-on-failure --parallel "$jobs" "$@" >"$folder/tests.log" 2>&1 ||
  sed -n '/The following tests FAILED/,$p' "$folder/tests.log"
exec "$python" "$here/line_coverage.py" "$folder" --jobs "$jobs"
