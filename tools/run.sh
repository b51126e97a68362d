#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/run.sh DECK [program arguments...]
# Installs what is missing, builds Release, runs the deck and draws a picture of the result.  All
# files go to results/<deck's name> of this tree, or to d=DIR where it is among the arguments.
# The exit status is the program's.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
help_or_go_on "${1:-}"

if [ $# -lt 1 ]; then
  complain "usage: tools/run.sh DECK [program arguments...]"
  exit 1
fi
deck=${1#[iI]=}
shift
if [ ! -f "$deck" ]; then
  complain "no such deck: $deck"
  exit 1
fi

case_name=$(basename "$deck")
case_name=${case_name%.*}
folder="$root/results/$case_name"
place=("d=$folder")
job=$case_name
for argument in "$@"; do
  case $argument in
    [dD]=[nN][oO][dD][uU][mM][pP]) ;;
    [dD]=*)
      folder=${argument#*=}
      place=()
      ;;
    [jJ][oO][bB][iI][dD]=*) job=${argument#*=} ;;
  esac
done

lock
install_packages
build release
install_tools || :
unlock
say "running $case_name"
"$root/build/release/slideline" "i=$deck" "${place[@]}" "$@"
status=$?

result="$folder/$job.vtkhdf"
if [ $status -ne 1 ] && [ -f "$result" ]; then
  if [ ! -x "$venv/bin/slideline-tools" ]; then
    complain "no picture without the Python tools; the results are complete"
  elif say "drawing $job.png" && ! MPLBACKEND=Agg "$venv/bin/slideline-tools" plot "$result" --output "$folder/$job.png"; then
    complain "the picture could not be drawn; the results are complete"
  fi
  say "results are in $folder"
fi
exit $status
