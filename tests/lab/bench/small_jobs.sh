#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/lab/bench/small_jobs.sh [--jobs N] [--repeats N]
# What a small job costs from start to exit, and how many a second two processors take, of the Release program: one
# element, 306 elements for 1,000 cycles without plot states and with them, and the first 1,000 cycles of the collision
# (median of the repeats, 50); then N (1000) copies of the second in a folder, through tools/batch/run_folder.sh -j 2 and
# through xargs -P 2. Says the share of a processor that the jobs had: others on the machine make the times worthless.
set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
"$root/tools/build.sh" release
exec "$root/build/venv/bin/python" "$root/tests/lab/bench/small_jobs.py" --build "$root/build/release" \
  --out "$results/small-jobs" "$@"
