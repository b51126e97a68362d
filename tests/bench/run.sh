#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/bench/run.sh [--quick | --publish] [--rounds N] [--parts ...] [--sizes ...]
# Builds the Release program and its benchmarks and runs them on this machine: results/bench/bench.csv, and the
# page with its chart in results/bench/doc (--publish: doc/studies/speed.md). Five rounds take a quarter of an hour
# (--quick: a minute, into results/bench-quick). Keep the machine quiet: what counts are the ratios to the element kernel and to the memory's
# bandwidth, measured in the same minute.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
out=$root/results/bench
doc=$out/doc
case ${1:-} in
  --quick) out=$root/results/bench-quick doc=$out/doc ;;
  --publish) doc=$root/doc; shift ;;
esac

"$root/tools/build.sh" release
cmake -S "$root" -B "$root/build/release" -DSLIDELINE_BENCH=ON >/dev/null
cmake --build "$root/build/release" --target bench_kernel bench_contact
"$root/build/venv/bin/python" "$root/tests/bench/bench.py" --build "$root/build/release" --out "$out" "$@"
MPLBACKEND=Agg "$root/build/venv/bin/python" -m slideline_tools.studies.speed "$out" "$doc"
