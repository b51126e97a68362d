#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/symmetric_plate.sh [MESHES]
# Runs the symmetric plate, elastic and elastoplastic, with both forms of hourglass control on each
# mesh (default "8x4 16x8 32x16 64x32") into results/batch/symmetric_plate, prints a table
# and compares it with the reference. RENEW=1 makes the table the new reference.
set -eu

root=$(CDPATH='' cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
meshes=${1:-8x4 16x8 32x16 64x32}
out=$root/results/batch/symmetric_plate
runs=

# run NAME DECK IHQ QH: one run of the program.
run() {
  echo "== symmetric plate, $1"
  runs="$runs $1"
  mkdir -p "$out/$1"
  "$root/build/release/slideline" i="$2" d="$out/$1" jobid=symmetric_plate \
    p:ihq="$3" p:qh="$4" >"$out/$1/progress.txt"
}

"$root/tools/build.sh" release
for mesh in $meshes; do
  for law in elastic elastoplastic; do
    deck=$root/input/symmetric_plate/plate_${mesh}_$law.k
    if [ ! -f "$deck" ]; then
      deck=$root/results/batch/plate_${mesh}_$law.k
      options=
      [ "$law" = elastic ] || options=--elastoplastic
      "$root/build/venv/bin/slideline-tools" make-deck symmetric_plate \
        --nx "${mesh%x*}" --ny "${mesh#*x}" $options --output "$deck"
    fi
    run "${mesh}_${law}_viscous" "$deck" 1 0.1
    run "${mesh}_${law}_stiffness" "$deck" 4 0.05
  done
done

# shellcheck disable=SC2086  # the names of the runs are words
"$root/build/venv/bin/python" "$root/tools/batch/table.py" symmetric_plate "$out" \
  "$root/input/symmetric_plate/reference.csv" $runs ${RENEW:+--renew}
