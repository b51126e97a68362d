#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/exchange.sh [TYPES]
# Runs the patch test, block-to-block, sliding and collision (N_r = 1) and the oblique impact as they
# are and with slave and master exchanged, for every contact type (default: all), into
# results/batch/exchange and writes doc/studies/exchange.md; with arguments, the page goes to
# results/batch/exchange/doc instead. About two minutes.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
. "$root/tools/batch/lists.sh"
out=$results/batch/exchange
doc=$pages
[ $# -eq 0 ] || doc=$out/doc

"$root/tools/build.sh" release
types=${1:-$(all_types)}
python=$root/build/venv/bin/python
mkdir -p "$out"
"$python" -m slideline_tools.studies.exchange decks "$out" >"$out/list.txt"
while read -r name scene penalty penalty_3; do
  for type in $types; do
    run=$out/${name}_type_$type
    echo "== $name, contact type $type"
    mkdir -p "$run"
    pen=$penalty
    [ "$type" != 3 ] || pen=$penalty_3
    "$root/build/release/slideline" i="$out/$name.k" d="$run" jobid="$scene" ctype="$type" \
      p:pen="$pen" >"$run/progress.txt" </dev/null
  done
done <"$out/list.txt"

# shellcheck disable=SC2086  # the types are words
"$python" -m slideline_tools.studies.exchange page "$out" "$doc" --types $types
