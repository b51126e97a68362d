#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/lab/bench/laws.sh [--publish] [--rounds N]
# Builds the counted program (x86-64-v3) with its element routine and prints what each material law costs: instructions by
# callgrind (valgrind must be there), and times in turn with the yardstick (none with --rounds 0). The page goes to
# results/laws/doc (--publish: results/doc/studies/speed_laws.md).
set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
doc=$results/laws/doc
case ${1:-} in
  --publish) doc=$pages; shift ;;
esac

counted=$root/build/counted
"$root/tools/build.sh" counted
cmake -S "$root" -B "$counted" -DSLIDELINE_BENCH=ON >/dev/null
cmake --build "$counted" --target bench_kernel
SLIDELINE=$counted/slideline PYTHONPATH=$root/tools MPLBACKEND=Agg "$root/build/venv/bin/python" "$root/tests/lab/bench/laws.py" \
  --build "$counted" --doc "$doc" "$@"
