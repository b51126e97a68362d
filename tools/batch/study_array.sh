#!/bin/sh
# SPDX-License-Identifier: MIT
#SBATCH --ntasks=1 --cpus-per-task=1 --job-name=slideline-study --output=results/study_%A_%a.txt
# usage, from the top of the tree, on a file system that all machines share:
#   tools/build.sh release
#   job=$(sbatch --parsable --array=0-15 tools/batch/study_array.sh NAME [options of tools/study.sh])
#   sbatch --dependency=afterany:"$job" tools/batch/study_array.sh NAME [the same options] --collect
# Each task of the array (numbered from 0) runs its part of the list; runs that are compared in time stay in
# one part. The last call makes the table and the charts. A task that was cut short goes on where it was
# when the array is submitted again. For timing studies add --exclusive to the first call. The
# program is built for the processor it is built on: build on a machine of the kind that runs it.
set -eu

# Slurm runs a copy of this file from elsewhere.
root=${SLURM_SUBMIT_DIR:-$(dirname "$0")/../..}
. "$root/tools/help.sh"
help_or_go_on "$@"
part=
if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then
  part="--part $SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
fi
# shellcheck disable=SC2086  # two words or none
MPLBACKEND=Agg exec "${PYTHON:-$root/build/venv/bin/python}" -m slideline_tools.studies "$@" $part
