#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/lab/bench/run.sh [--quick | --publish] [--rounds N] [--parts ...] [--sizes ...]
# Builds the Release program and its benchmarks and runs them on this machine: results/bench/bench.csv, and the
# page with its chart in results/bench/doc (--publish: results/doc/studies/speed.md). Five rounds take a quarter of an hour
# (--quick: a minute, into results/bench-quick). Keep the machine quiet: what counts are the ratios to the
# yardstick (yardstick/run.sh) and to the memory's bandwidth, measured in the same minute. Where valgrind is installed the instructions
# of a step are counted too, once for a program.
set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
out=$results/bench
doc=$out/doc
case ${1:-} in
  --quick) out=$results/bench-quick doc=$out/doc ;;
  --publish) doc=$pages; shift ;;
esac

"$root/tools/build.sh" release
cmake -S "$root" -B "$root/build/release" -DSLIDELINE_BENCH=ON >/dev/null
cmake --build "$root/build/release" --target bench_kernel bench_contact
counted=
if command -v valgrind >/dev/null; then
  counted=$root/build/counted
  "$root/tools/build.sh" counted
  cmake -S "$root" -B "$counted" -DSLIDELINE_BENCH=ON >/dev/null
  cmake --build "$counted" --target bench_kernel
fi
"$root/build/venv/bin/python" "$root/tests/lab/bench/bench.py" --build "$root/build/release" --out "$out" \
  ${counted:+--counted "$counted"} "$@"
MPLBACKEND=Agg "$root/build/venv/bin/python" "$root/tests/lab/bench/speed_page.py" "$out" "$doc"
