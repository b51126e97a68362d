#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/lab/bench/yardstick/run.sh [ARCH [ROUNDS]]
# Prints K, the unit of all times, as `yardstick_ns,<ns per element>`: the arithmetic of one step of a plastic one-point
# quad alone (yardstick_kernel.f90), on this machine, now. Its flags are its own, whatever the program is built with;
# ARCH (default: native) is the processor that it is compiled for. About 0.3 s; the first time it is compiled.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../../../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
arch=${1:-native}
folder=$root/build/yardstick/$arch
program=$folder/yardstick
fresh=1
for source in "$here"/*; do
  [ "$program" -nt "$source" ] || fresh=0
done
if [ $fresh -eq 0 ]; then
  # Made aside and renamed: others may measure meanwhile.
  mkdir -p "$folder"
  aside=$(mktemp -d "$folder/new.XXXXXX")
  "${FC:-gfortran}" -std=f2008 -O2 -march="$arch" -mprefer-vector-width=512 -fno-math-errno -fno-trapping-math \
    -fopenmp-simd -J "$aside" -o "$aside/yardstick" "$here/yardstick_kernel.f90" "$here/yardstick.f90"
  mv "$aside/yardstick" "$program"
  rm -r "$aside"
fi
exec "$program" ${2:+"$2"}
