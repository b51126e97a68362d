#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/claims.sh [REPEATS]
# Answers the claims of Kang, Lee & Shin (2023) from runs: writes doc/studies/claims.md. Wants the
# results of block.sh, sliding.sh and collision.sh; runs sliding and collision again without output
# to time them on one thread: REPEATS rounds (default 3) of all variants in turn, the short runs of
# the collision three times in each. About 15 minutes; keep the machine quiet.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
repeats=${1:-3}
out=$root/results/batch/claims
types="1 2 3 4 5 6 7"

# timed SCENE DECK LEVEL NAME: all contact types once; keeps the timing tables by that name.
timed() {
  for type in $types; do
    run=$out/$1/level_${3}_type_$type
    mkdir -p "$run"
    "$root/build/release/slideline" i="$2" d="$run" jobid="$1" ctype="$type" ncpu=1 \
      p:dtplot=1 p:dthist=1 p:dtforc=1 >"$run/progress.txt"
    cp "$run/$1.timing.csv" "$run/timing_$4.csv"
  done
}

"$root/tools/build.sh" release
rm -f "$out"/*/level_*/timing_*.csv
for level in 1 2 3; do
  "$root/build/venv/bin/slideline-tools" make-deck sliding --level "$level" \
    --output "$out/sliding_$level.k"
done
repeat=1
while [ "$repeat" -le "$repeats" ]; do
  echo "== timing, round $repeat of $repeats"
  for turn in 1 2 3; do
    for level in 1 2 3 4; do
      suffix=
      [ "$level" = 1 ] || suffix=_$level
      timed collision "$root/input/collision/collision$suffix.k" "$level" "${repeat}_$turn"
    done
  done
  for level in 1 2 3; do
    timed sliding "$out/sliding_$level.k" "$level" "$repeat"
  done
  repeat=$((repeat + 1))
done

# Sliding with slave and master exchanged: how many points does type 5 add when the master is finer?
run=$out/exchanged
"$root/build/venv/bin/slideline-tools" make-deck sliding --exchanged --output "$run/sliding.k"
"$root/build/release/slideline" i="$run/sliding.k" d="$run" jobid=sliding ctype=5 \
  >"$run/progress.txt"

"$root/build/venv/bin/python" -m slideline_tools.studies.claims "$root/results/batch" "$root/doc"
