#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/scale.sh [--publish] [--most N]
# Builds the program with MPI, runs some steps of four meshes on 1 to 64 processes (--most: fewer), which count what they
# exchange, cuts the meshes by METIS too (the wheel pymetis, into results/batch/scale), and writes the page of the study to
# results/batch/scale/doc (--publish: results/doc/studies/scale.md). Some minutes and 5 GB of memory at 64 processes.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
out=$results/batch/scale
doc=$out/doc
case ${1:-} in
  --publish) doc=$pages; shift ;;
esac

"$root/tools/build.sh" mpi
python=$root/build/venv/bin/python
mkdir -p "$out"
[ -d "$out/metis" ] || "$python" -m pip install --quiet --target "$out/metis" pymetis ||
  echo "no pymetis: METIS is not compared" >&2
SLIDELINE=$root/build/mpi/slideline
export SLIDELINE
"$python" -m slideline_tools.studies.scale.runs "$out" --program "$SLIDELINE" "$@"
PYTHONPATH=$out/metis MPLBACKEND=Agg "$python" -m slideline_tools.studies.scale.page "$out" "$doc"
