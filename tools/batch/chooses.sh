#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/chooses.sh
# Runs the scenes of speed-accuracy on their coarsest meshes with every contact type and with CTYPE 0, whole and cut
# short and counted, some minutes, into results/batch/chooses, and writes results/doc/studies/chooses.md: what leaving the type to
# the program costs.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
. "$root/tools/batch/lists.sh"

"$root/tools/build.sh" release
"$root/build/venv/bin/python" -m slideline_tools.studies.chooses "$results/batch/chooses" "$pages" "$root/build/release/slideline"
