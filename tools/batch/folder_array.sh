#!/bin/sh
# SPDX-License-Identifier: MIT
#SBATCH --ntasks=1 --cpus-per-task=1 --job-name=slideline-folder --output=slideline_%A_%a.txt
# usage, from the top of the tree, on a file system that all machines share:
#   tools/build.sh release
#   job=$(sbatch --parsable --array=0-15 tools/batch/folder_array.sh FOLDER [options of the program])
#   sbatch --dependency=afterany:"$job" tools/batch/folder_array.sh --collect FOLDER [the same options]
# Each task of the array (numbered from 0) runs its part of the decks of a folder, as run_folder.sh does; the last call prints
# the table. A sweep of one deck: SCRIPT=sweep.sh before both calls, and the arguments of sweep.sh. What a task has not finished when its
# time is over runs when the array is submitted again. For a restart file of every run before that:
#   scancel --signal=USR1 --full "$job"
# The program is built for the processor it is built on: build on a machine of the kind that runs it.
set -eu

# Slurm runs a copy of this file from elsewhere.
root=${SLURM_SUBMIT_DIR:-$(dirname "$0")/../..}
. "$root/tools/help.sh"
help_or_go_on "$@"
script=${SCRIPT:-run_folder.sh}
if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then
  set -- --part "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" "$@"
fi
exec "$root/tools/batch/$script" "$@"
