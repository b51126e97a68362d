#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/study.sh NAME [--levels N...] [--types N...] [--quick] [-j N] [--repeats N] ...
# Installs what is missing, builds Release (for scale and all: mpi too) and runs a study: a sweep of runs that ends in a table
# and charts in results/study-NAME (after tools/build.sh, --help lists the studies and explains all
# options). Killed, it goes on with the same command.
set -uo pipefail
root=$(CDPATH='' cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
. "$root/tools/help.sh"
python="$root/build/venv/bin/python"
[ -x "$python" ] || help_or_go_on "$@"
case " $* " in
  *" -h "* | *" --help "*) export PYTHONDONTWRITEBYTECODE=1 ;;  # the study's own help says more
  *" --program "* | *" --program="*) ;;  # a program of one's own
  *) builds=release
     [ "${1:-}" != scale ] || builds=mpi
     [ "${1:-}" != all ] || builds="release mpi"
     for build in $builds; do
       "$root/tools/build.sh" "$build" >&2 || exit 1
     done ;;
esac
MPLBACKEND=Agg exec "$python" -m slideline_tools.studies "$@"
