#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/claims.sh
# Answers the claims of Kang, Lee & Shin (2023) from runs: writes results/doc/studies/claims.md. Wants the
# results of block.sh, sliding.sh and of tools/study.sh paper-tables. A few seconds.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
out=$results/batch/claims

missing=
for scene in block sliding; do
  [ -d "$results/batch/$scene" ] || missing="$missing
  tools/batch/$scene.sh"
done
[ -f "$results/study-paper-tables/paper-tables.csv" ] || missing="$missing
  tools/study.sh paper-tables"
if [ -n "$missing" ]; then
  echo "claims.sh: results are missing; run these first (from the top of the tree):$missing" >&2
  exit 2
fi

"$root/tools/build.sh" release
# Sliding with slave and master exchanged: how many points does type 5 add when the master is finer?
run=$out/exchanged
mkdir -p "$run"
"$root/build/venv/bin/slideline-tools" make-deck sliding --exchanged --output "$run/sliding.k"
"$root/build/release/slideline" i="$run/sliding.k" d="$run" jobid=sliding ctype=5 \
  >"$run/progress.txt"

"$root/build/venv/bin/python" -m slideline_tools.studies.claims "$results/batch" \
  "$results/study-paper-tables/paper-tables.csv" "$pages"
