#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/block.sh [TYPES]
# Runs the block-to-block scene for every contact type (default: all) into
# results/batch/block and writes results/doc/studies/block_to_block.md with its picture; with arguments, the
# page goes to results/batch/block/doc instead. A few seconds.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
. "$root/tools/batch/lists.sh"
out=$results/batch/block
doc=$pages
[ $# -eq 0 ] || doc=$out/doc

"$root/tools/build.sh" release
types=${1:-$(all_types)}
python=$root/build/venv/bin/python
deck=$out/block.k
"$root/build/venv/bin/slideline-tools" make-deck block --output "$deck"
# 1 MN/m times 51 slave segments, 52 slave nodes, and both passes, over 10 m.
"$python" "$root/tests/verification/block_to_block/chain.py" 5.1e6 5.2e6 1.01e7 >"$out/chain.csv"
for type in $types; do
  run=$out/type_$type
  echo "== block-to-block, contact type $type"
  mkdir -p "$run"
  "$root/build/release/slideline" i="$deck" d="$run" jobid=block ctype="$type" >"$run/progress.txt"
done

# shellcheck disable=SC2086  # the types are words
"$python" -m slideline_tools.studies.block "$out" "$doc" --types $types
