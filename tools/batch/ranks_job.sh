#!/bin/sh
# SPDX-License-Identifier: MIT
#SBATCH --ntasks=64 --cpus-per-task=1 --job-name=slideline-ranks --output=slideline_%j.txt --signal=TERM@300
# usage, from the top of the tree, on a file system that all machines share:
#   tools/build.sh mpi
#   sbatch --ntasks=128 --time=8:00:00 tools/batch/ranks_job.sh i=DECK d=FOLDER [options of the program]
# One explicit run on many processes, with as many threads each as --cpus-per-task says. Five minutes before its time is over
# (--signal above) the run stops, with a restart file where the deck has *DATABASE_BINARY_D3DUMP; it goes on from that, on any
# number of processes, by
#   sbatch --ntasks=256 tools/batch/ranks_job.sh r=FOLDER/JOB.dump01.h5
# A restart file meanwhile: scancel --signal=USR1 JOB. LAUNCH is what starts the processes (srun --mpi=pmix; such as
# LAUNCH=mpirun where Slurm has no PMIx). The program is built for the processor it is built on: build on a machine of
# the kind that runs it.
set -eu

# Slurm runs a copy of this file from elsewhere.
root=${SLURM_SUBMIT_DIR:-$(dirname "$0")/../..}
. "$root/tools/help.sh"
help_or_go_on "$@"
program=${SLIDELINE:-$root/build/mpi/slideline}
if [ ! -x "$program" ]; then
  echo "$program: no such program: tools/build.sh mpi makes it (nothing has run)" >&2
  exit 2
fi
# shellcheck disable=SC2086  # a command and its options
exec ${LAUNCH:-srun --mpi=pmix} "$program" "$@" ncpu="${SLURM_CPUS_PER_TASK:-1}"
