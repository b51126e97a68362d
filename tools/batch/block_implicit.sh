#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/block_implicit.sh [TYPES]
# Runs the block-to-block scene implicitly and explicitly for every contact type (default
# all) into results/batch/block_implicit and writes results/doc/studies/block_to_block_implicit.md
# with its picture; with arguments, the page goes to results/batch/block_implicit/doc instead. Some seconds, and some
# minutes for the retired instructions, which are counted where the machine can (tools/slideline_tools/counting.py).
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
. "$root/tools/batch/lists.sh"
out=$results/batch/block_implicit
doc=$pages
[ $# -eq 0 ] || doc=$out/doc

"$root/tools/build.sh" release
types=${1:-$(all_types)}
tools=$root/build/venv/bin/slideline-tools
python=$root/build/venv/bin/python
counted=$("$python" -m slideline_tools.counting) || echo "instructions are not counted" >&2
mkdir -p "$out"
"$tools" make-deck block --output "$out/explicit.k"
"$tools" make-deck block --implicit --output "$out/implicit.k"
for type in $types; do
  for method in implicit explicit; do
    run=$out/${method}_$type
    echo "== block-to-block, $method, contact type $type"
    mkdir -p "$run"
    "$root/build/release/slideline" i="$out/$method.k" d="$run" jobid=block ctype="$type" \
      >"$run/progress.txt"
    rm -rf "$run/counted"
    # The option stands on the page too (studies/block_implicit.py).
    [ -z "$counted" ] || "$python" -m slideline_tools.counting "$run/counted" "$counted" i="$out/$method.k" \
      d="$run/counted" jobid=block ctype="$type" ncpu=1 endtim=0.02
  done
done

# shellcheck disable=SC2086  # the types are words
"$python" -m slideline_tools.studies.block_implicit "$out" "$doc" --types $types
