#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/bench/laws.sh [--rounds N] [--out FILE]
# Builds the counted program (x86-64-v3) with its element routine and prints what each material law costs: instructions by
# callgrind (valgrind must be there), and times in turn with the yardstick (none with --rounds 0).
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"

counted=$root/build/counted
"$root/tools/build.sh" counted
cmake -S "$root" -B "$counted" -DSLIDELINE_BENCH=ON >/dev/null
cmake --build "$counted" --target bench_kernel
PYTHONPATH=$root/tools "$root/build/venv/bin/python" "$root/tests/bench/laws.py" --build "$counted" "$@"
