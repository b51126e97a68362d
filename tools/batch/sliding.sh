#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/sliding.sh [LEVELS [TYPES]]
# Runs the sliding scene for every refinement level and contact type (default "1 2 3" and
# all) into results/batch/sliding and writes results/doc/studies/sliding.md with its pictures;
# with arguments, the page goes to results/batch/sliding/doc instead.
# The contact force is written every tenth step. About five minutes.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
. "$root/tools/batch/lists.sh"
levels=${1:-1 2 3}
out=$results/batch/sliding
doc=$pages
[ $# -eq 0 ] || doc=$out/doc

"$root/tools/build.sh" release
types=${2:-$(all_types)}
for level in $levels; do
  deck=$out/sliding_$level.k
  interval=$(awk "BEGIN { printf \"%.17g\", 4.0e-7 / $level }")
  "$root/build/venv/bin/slideline-tools" make-deck sliding --level "$level" --output "$deck"
  for type in $types; do
    run=$out/level_${level}_type_${type}
    echo "== sliding, level $level, contact type $type"
    mkdir -p "$run"
    "$root/build/release/slideline" i="$deck" d="$run" jobid=sliding ctype="$type" \
      p:dtforc="$interval" >"$run/progress.txt"
  done
done

# shellcheck disable=SC2086  # levels and types are words
"$root/build/venv/bin/python" -m slideline_tools.studies.sliding "$out" "$doc" \
  --levels $levels --types $types
