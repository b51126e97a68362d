#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/collision.sh [LEVELS [TYPES]]
# Runs the collision scene for every refinement level and contact type (default "1 2 3 4" and
# all) into results/batch/collision and writes results/doc/studies/collision.md with its
# pictures; with arguments, the page goes to results/batch/collision/doc instead. Then prints a
# table and compares it with the reference. RENEW=1 makes the table the new reference.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
. "$root/tools/batch/lists.sh"
levels=${1:-1 2 3 4}
out=$results/batch/collision
doc=$pages
[ $# -eq 0 ] || doc=$out/doc

"$root/tools/build.sh" release
types=${2:-$(all_types)}
runs=
for level in $levels; do
  suffix=
  [ "$level" = 1 ] || suffix=_$level
  for type in $types; do
    run=level_${level}_type_${type}
    runs="$runs $run"
    echo "== collision, level $level, contact type $type"
    mkdir -p "$out/$run"
    "$root/build/release/slideline" i="$root/input/collision/collision$suffix.k" \
      d="$out/$run" jobid=collision ctype="$type" >"$out/$run/progress.txt"
  done
done

# shellcheck disable=SC2086  # levels and types are words
"$root/build/venv/bin/python" -m slideline_tools.studies.collision "$out" "$doc" \
  --levels $levels --types $types

# shellcheck disable=SC2086  # the names of the runs are words
"$root/build/venv/bin/python" "$root/tools/batch/table.py" collision "$out" \
  "$root/input/collision/reference.csv" $runs ${RENEW:+--renew}
