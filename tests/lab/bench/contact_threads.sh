#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/lab/bench/contact_threads.sh [--threads N ...] [--types N ...] [--nodes N] [--cycles N] [--rounds N]
# How much faster contact is with so many threads (1 2) than with the first number of them: a step of a long interface (of
# 20,000 slave nodes) alone, and with --cycles so many cycles in contact of a collision of 96,000 elements. Medians of
# interleaved rounds (3). Times are worth nothing where others have the cores.
set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
"$root/tools/build.sh" release
cmake -S "$root" -B "$root/build/release" -DSLIDELINE_BENCH=ON >/dev/null
cmake --build "$root/build/release" --target bench_contact
PYTHONPATH=$root/tools exec "$root/build/venv/bin/python" "$root/tests/lab/bench/contact_threads.py" \
  --build "$root/build/release" --out "$results/contact_threads" "$@"
