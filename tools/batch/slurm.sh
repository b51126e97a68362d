#!/bin/sh
# SPDX-License-Identifier: MIT
#SBATCH --ntasks=1 --cpus-per-task=1 --job-name=slideline --output=slideline_%A_%a.txt --signal=TERM@300
# usage, from the top of the tree, on a file system that all machines share:
#   tools/build.sh release
#   job=$(sbatch --parsable --array=0-15 tools/batch/slurm.sh run_folder.sh FOLDER [options of the program])
#   sbatch --dependency=afterany:"$job" tools/batch/slurm.sh run_folder.sh --collect FOLDER [the same options]
# Each task of the array (numbered from 0) runs its part of the decks of a folder, or of a sweep: sweep.sh and its arguments
# in place of run_folder.sh and its. The last call prints the table. What a task has not finished when its time is over runs
# when the array is submitted again. For a restart file of every run before that: scancel --signal=USR1 --full "$job"
#   tools/build.sh mpi
#   sbatch --ntasks=128 --time=8:00:00 --output=slideline_%j.txt tools/batch/slurm.sh ranks i=DECK d=FOLDER [options of the program]
# One explicit run on many processes, with as many threads each as --cpus-per-task says. Five minutes before its time is
# over (--signal above) it stops, with a restart file where the deck has *DATABASE_BINARY_D3DUMP; it goes on from that, on
# any number of processes, by
#   sbatch --ntasks=256 tools/batch/slurm.sh ranks r=FOLDER/JOB.dump01.h5
# LAUNCH is what starts the processes (srun --mpi=pmix; such as LAUNCH=mpirun where Slurm has no PMIx).
# The program is built for the processor it is built on: build on a machine of the kind that runs it.
set -eu

# Slurm runs a copy of this file from elsewhere.
root=${SLURM_SUBMIT_DIR:-$(dirname "$0")/../..}
. "$root/tools/help.sh"
help_or_go_on "$@"
what=${1:-}
case $what in
run_folder.sh | sweep.sh)
  shift
  [ -z "${SLURM_ARRAY_TASK_ID:-}" ] || set -- --part "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" "$@"
  exec "$root/tools/batch/$what" "$@"
  ;;
ranks) shift ;;
*) echo "usage: slurm.sh run_folder.sh|sweep.sh|ranks ARGUMENTS" >&2 && exit 2 ;;
esac
program=${SLIDELINE:-$root/build/mpi/slideline}
if [ ! -x "$program" ]; then
  echo "$program: no such program: tools/build.sh mpi makes it (nothing has run)" >&2
  exit 2
fi
# shellcheck disable=SC2086  # a command and its options
exec ${LAUNCH:-srun --mpi=pmix} "$program" "$@" ncpu="${SLURM_CPUS_PER_TASK:-1}"
