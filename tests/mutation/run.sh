#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/mutation/run.sh --number 100 --seed 3 --out build/mutants.csv [--jobs 2] [contact|material ...]
# Mutation testing by hand: builds what is needed under build/, then hands its words to mutate.py.
# The unit tests are built with the run-time checks of Debug (no sanitisers: they are slow to link), the
# program as Release. A Python with numpy, h5py and pytest is taken from
# PYTHON, or from build/venv, which tools/build.sh makes.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
python=${PYTHON:-$root/build/venv/bin/python}
units=$root/build/mutation-units
program=$root/build/mutation-program
cmake -S "$root" -B "$units" -G Ninja -DCMAKE_BUILD_TYPE=Mutation \
  -DCMAKE_Fortran_FLAGS_MUTATION="-O1 -fcheck=all -finit-real=snan -ffpe-trap=invalid,zero,overflow" \
  -DPython3_EXECUTABLE="$python" >/dev/null
cmake --build "$units"
cmake -S "$root" -B "$program" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DSLIDELINE_TESTS=OFF -DPython3_EXECUTABLE="$python" >/dev/null
cmake --build "$program"
exec "$python" "$root/tests/mutation/mutate.py" try --build "$units" --program-build "$program" "$@"
