#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/hertz.sh [LEVELS [TYPES]]
# Runs the Hertz scene for every refinement level and contact type (default "1 2 4" and
# all), with the cylinder and with the block as slave, into results/batch/hertz and
# writes doc/studies/hertz.md with its picture; with arguments, the page goes to
# results/batch/hertz/doc instead. About two minutes.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
. "$root/tools/batch/lists.sh"
levels=${1:-1 2 4}
out=$results/batch/hertz
doc=$pages
[ $# -eq 0 ] || doc=$out/doc

# run NAME DECK OPTION...: one run of the program.
run() {
  echo "== Hertz line contact, $1"
  name=$1 deck=$2
  shift 2
  mkdir -p "$out/$name"
  "$root/build/release/slideline" i="$deck" d="$out/$name" jobid=hertz "$@" \
    >"$out/$name/progress.txt"
}

"$root/tools/build.sh" release
types=${2:-$(all_types)}
for level in $levels; do
  for suffix in "" _exchanged; do
    deck=$out/hertz_$level$suffix.k
    "$root/build/venv/bin/slideline-tools" make-deck hertz --level "$level" \
      ${suffix:+--exchanged} --output "$deck"
    for type in $types; do
      run "level_${level}_type_$type$suffix" "$deck" ctype="$type"
    done
  done
done
deck=$out/hertz_penalty.k
"$root/build/venv/bin/slideline-tools" make-deck hertz --level 2 --ctype 7 --output "$deck"
run penalty_0.25_type_7 "$deck" p:pen=75.0e9
run penalty_1_type_7 "$deck"
run penalty_4_type_7 "$deck" p:pen=1.2e12 p:dt=2.0e-9

# shellcheck disable=SC2086  # levels and types are words
"$root/build/venv/bin/python" -m slideline_tools.studies.hertz "$out" "$doc" \
  --levels $levels --types $types
