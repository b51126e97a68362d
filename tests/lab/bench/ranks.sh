#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/lab/bench/ranks.sh [--rounds N] [--cycles N]
# Two processes against two threads on two cores, of the build with MPI: seconds of the cycles on the wall (those of the
# phases of the first process), and of a processor from start to exit, of the collision and of a block without contact at
# about 100,000 elements; medians of interleaved rounds (5). Then the memory of the second of four processes for a square
# of a million elements. Times are worth nothing where others have the cores: each row says what share of two the runs had.
set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
"$root/tools/build.sh" mpi
PYTHONPATH=$root/tools exec "$root/build/venv/bin/python" "$root/tests/lab/bench/ranks.py" \
  --program "${SLIDELINE:-$root/build/mpi/slideline}" --out "$results/ranks" "$@"
