#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/patch.sh [TYPES]
# Runs the contact patch test on several meshes and with penalties from 1e3 to 1e10 N/m for every
# contact type (default: all), explicitly damped to rest (about two minutes), into results/batch/patch, and writes
# results/doc/studies/patch_test.md with its picture; with types, the page goes to results/batch/patch/doc instead.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
. "$root/tools/batch/lists.sh"
out=$results/batch/patch
doc=$pages
[ $# -eq 0 ] || doc=$out/doc

"$root/tools/build.sh" release
types=${1:-$(all_types)}
python=$root/build/venv/bin/python
mkdir -p "$out"
"$python" -m slideline_tools.studies.patch decks "$out" >"$out/list.txt"
while read -r name; do
  echo "== patch, $name"
  for type in $types; do
    run=$out/${name}_type_$type
    mkdir -p "$run"
    "$root/build/release/slideline" i="$out/$name.k" d="$run" jobid=patch ctype="$type" \
      >"$run/progress.txt" </dev/null
  done
done <"$out/list.txt"

# shellcheck disable=SC2086  # the types are words
"$python" -m slideline_tools.studies.patch page "$out" "$doc" --types $types
