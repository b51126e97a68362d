#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/lab/bench/many_cores.sh [--cores N ...] [--elements N] [--cycles N] [--jobs N]
# One table for a machine with many cores (1 2 4 8 16): how many times faster the cycles of yielding quads (100,000) and of
# a collision of 96,000 elements (types 1, 5, 7) are on so many threads and processes than on one, and how many small
# decks end in a second with so many at once. Times are worth nothing where others have the cores.
set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
"$root/tools/build.sh" release
"$root/tools/build.sh" mpi
PYTHONPATH=$root/tools exec "$root/build/venv/bin/python" "$root/tests/lab/bench/many_cores.py" \
  --build "$root/build" --out "$results/many_cores" "$@"
