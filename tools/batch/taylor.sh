#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/taylor.sh
# Runs input/taylor/taylor.k into results/batch/taylor and draws results/doc/pictures/taylor.png: the final shape beside
# the radius and length of converged codes, and both over time. A few seconds after the build.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
. "$root/tools/batch/lists.sh"
out=$results/batch/taylor
"$root/tools/build.sh" release
mkdir -p "$out"
"$root/build/release/slideline" i="$root/input/taylor/taylor.k" d="$out" jobid=taylor >"$out/progress.txt"
# shellcheck disable=SC2154  # lists.sh sets it
"$root/build/venv/bin/python" -m slideline_tools.studies.taylor "$out" "$pages"
