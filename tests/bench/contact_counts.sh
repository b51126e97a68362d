#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/bench/contact_counts.sh
# Counts the instructions of contact by callgrind, of all types on shifted and matching meshes and with friction: the table
# results/contact_counts/contact_counts.csv and the page contact_cost.md beside it. Then whole steps of the sliding deck with
# friction over without: sliding_counts.csv. A few minutes each; the machine may be busy.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
out=$results/contact_counts
"$root/tools/build.sh" counted
cmake -S "$root" -B "$root/build/counted" -DSLIDELINE_BENCH=ON >/dev/null
cmake --build "$root/build/counted" --target bench_contact
PYTHONPATH=$root/tools "$root/build/venv/bin/python" "$root/tests/bench/contact_counts.py" \
  "$root/build/counted/tests/bench/bench_contact" "$out"
PYTHONPATH=$root/tools "$root/build/venv/bin/python" "$root/tests/bench/sliding_counts.py" "$root/build/counted/slideline" "$out"
