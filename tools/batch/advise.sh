#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/advise.sh [ROUNDS]
# Runs a collision with several needless things, and without each of them in turn (default 9
# rounds), into results/batch/advise and writes doc/studies/advise.md: what `slideline-tools advise`
# predicts beside what was saved. With an argument, the page goes to results/batch/advise/doc.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
out=$results/batch/advise
doc=$pages
[ $# -eq 0 ] || doc=$out/doc

"$root/tools/build.sh" release
"$root/build/venv/bin/python" -m slideline_tools.advise.study "$root/build/release/slideline" \
  "$out" "$doc" --rounds "${1:-9}"
