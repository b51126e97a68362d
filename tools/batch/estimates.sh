#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/estimates.sh [TYPES]
# Runs the contact of a cylinder with a block on three meshes, that of spheres on two, sliding and ironing with every
# contact type (default: all), some minutes, into results/batch/estimates, and writes results/doc/studies/estimates.md
# with its picture: what the runs say of themselves beside their errors. With types, the page goes to doc/ in the
# folder of the results instead.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
. "$root/tools/batch/lists.sh"
out=$results/batch/estimates
doc=$pages
[ $# -eq 0 ] || doc=$out/doc

"$root/tools/build.sh" release
types=${1:-$(all_types)}
python=$root/build/venv/bin/python
mkdir -p "$out"
"$python" -m slideline_tools.studies.estimates decks "$out" >"$out/list.txt"
while read -r name; do
  echo "== $name"
  for type in $types; do
    run=$out/${name}_type_$type
    mkdir -p "$run"
    "$root/build/release/slideline" i="$out/$name.k" d="$run" jobid="${name%_*}" ctype="$type" \
      >"$run/progress.txt" </dev/null
  done
done <"$out/list.txt"

# shellcheck disable=SC2086  # the types are words
"$python" -m slideline_tools.studies.estimates page "$out" "$doc" --types $types
