#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/patch_static.sh [TYPES]
# Runs the static contact patch test on several meshes and with penalties from 1e3 to 1e10 N/m for every
# contact type (default "1 2 3 4 5 6 7") into results/batch/patch_static and writes
# doc/studies/patch_test_static.md with its pictures; with arguments, the page goes to
# results/batch/patch_static/doc instead. Less than a minute.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
types=${1:-1 2 3 4 5 6 7}
out=$root/results/batch/patch_static
doc=$root/doc
[ $# -eq 0 ] || doc=$out/doc

"$root/tools/build.sh" release
python=$root/build/venv/bin/python
mkdir -p "$out"
"$python" -m slideline_tools.studies.patch_static decks "$out" >"$out/list.txt"
while read -r name; do
  echo "== static patch test, $name"
  for type in $types; do
    run=$out/${name}_type_$type
    mkdir -p "$run"
    "$root/build/release/slideline" i="$out/$name.k" d="$run" jobid=patch ctype="$type" \
      >"$run/progress.txt" </dev/null
  done
done <"$out/list.txt"

# shellcheck disable=SC2086  # the types are words
"$python" -m slideline_tools.studies.patch_static page "$out" "$doc" --types $types
