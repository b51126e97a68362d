#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/bench/run.sh [--quick]
# Builds the Release program and its benchmarks and runs them on this machine; tables as CSV in
# results/bench/. A quarter of an hour (--quick: one minute). Keep the machine quiet: what counts are the
# ratios to the element kernel and to the memory's bandwidth, measured in the same minute.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
out=$root/results/bench
sizes="300 4000 100000 1000000 4000000"
large=1000000
chains="20 1000 100000"
repeats=3
if [ "${1:-}" = --quick ]; then
  sizes="300 4000"
  large=100000
  chains="20"
  repeats=1
fi

"$root/tools/build.sh" release
cmake -S "$root" -B "$root/build/release" -DSLIDELINE_BENCH=ON >/dev/null
cmake --build "$root/build/release" --target bench_kernel bench_contact
# shellcheck disable=SC2086 # a list of sizes
"$root/build/venv/bin/python" "$root/tests/bench/elements.py" --sizes $sizes --repeats "$repeats" \
  --program "$root/build/release/slideline" \
  --kernel "$root/build/release/tests/bench/bench_kernel" --out "$out"
"$root/build/venv/bin/python" "$root/tests/bench/input_output.py" --elements "$large" \
  --repeats "$repeats" --program "$root/build/release/slideline" --out "$out"

mkdir -p "$out"
for nodes in $chains; do
  "$root/build/release/tests/bench/bench_contact" "$nodes" >"$out/contact_$nodes.csv"
  cat "$out/contact_$nodes.csv"
done
