#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/run_list.sh [-j N] [--fresh] [--part K/N] [--collect] LIST OUT
# Runs every line of LIST, which run_folder.sh and sweep.sh write: fields between tabs, first the name of
# the run, then its deck, then what else the program is to be told. Each run gets the folder OUT/NAME; what it says goes
# to said.txt there. A run that has ended well (status 0) with the same files, options and program is passed over:
# a batch that was cut short goes on with the same command. The table of all runs is printed and goes to OUT/summary.csv.
#   -j N       N runs at a time (1)
#   --fresh    run everything anew
#   --part K/N only the lines K, K + N, K + 2 N ... counted from 0, for arrays of jobs
#   --collect  no runs, the table alone
# SLIDELINE names the program (build/release/slideline). Exit status: 0 all runs have ended well, 1 some
# have not, 2 the call is wrong.
set -eu

# These signals are for the runs (restart file, end): a scheduler sends them to all processes of a job, and the shells and
# xargs must outlive them. The program sets its own handlers.
trap '' USR1 USR2

here=$(cd "$(dirname "$0")" && pwd)
. "$here/../help.sh"
help_or_go_on "$@"
program=${SLIDELINE:-$here/../../build/release/slideline}

# files_of DECK: the deck and what it includes, as far as it lies where it is named or beside the deck.
files_of() {
  awk 'function read(file, folder, line, on, name) {
      if (file in seen || (getline line <file) < 0) return file in seen
      seen[file] = 1
      print file
      do {
        sub(/[ \r]+$/, "", line)
        if (on && line !~ /^\$/) {
          sub(/^ +/, "", line)
          if (!read(line, folder)) read(folder line, folder)
          on = 0
        }
        if (line ~ /^\*/) on = toupper(line) ~ /^\*INCLUDE *$/
      } while ((getline line <file) > 0)
      return 1
    }
    BEGIN { folder = ARGV[1]; sub(/[^\/]*$/, "", folder); read(ARGV[1], folder) }' "$1"
}

# run_line OUT LINE: one run.
run_line() {
  out=$1
  tab=$(printf '\t')
  set -f
  IFS=$tab
  # shellcheck disable=SC2086  # the fields between tabs
  set -- $2
  set +f
  unset IFS
  name=$1 deck=$2
  shift 2
  folder=$out/$name
  mkdir -p "$folder"
  now=$({ files_of "$deck" | tr '\n' '\0' | xargs -0 cksum; printf '%s\n' "$@"; "$program" --version
    cksum <"$(command -v "$program")"; } | cksum)
  if [ "$fresh" = no ] && [ "$(cat "$folder/run.status" 2>/dev/null)" = 0 ] \
    && [ "$(cat "$folder/run.inputs" 2>/dev/null)" = "$now" ]; then
    echo "== $name: has run already"
    return 0
  fi
  echo "== $name"
  rm -f "$folder/run.status"
  printf '%s\n' "$now" >"$folder/run.inputs"
  status=0
  "$program" i="$deck" d="$folder" jobid="$name" "$@" >"$folder/said.txt" 2>&1 </dev/null || status=$?
  echo "$status" >"$folder/run.status"
}

# value FILE TEXT: what follows TEXT and an equals sign in a log, the last time.
value() {
  sed -n "s/^ *$2 *= *//p" "$1" 2>/dev/null | tail -n 1
}

# state FOLDER TEXT: what follows TEXT in the status file.
state() {
  cat "$1"/*status.out 2>/dev/null | sed -n "s/^ $2   *//p" | tail -n 1
}

# collect LIST OUT: the table of all runs, on the screen and in OUT/summary.csv; false when one has not ended well.
collect() {
  bad=0
  echo 'run,status,meaning,time,cycles,seconds,warnings,energy_ratio' >"$2/summary.csv"
  while IFS=$(printf '\t') read -r name rest; do
    [ -n "$name" ] || continue
    folder=$2/$name
    status=$(cat "$folder/run.status" 2>/dev/null || echo -)
    case $status in
    0) meaning=normal ;;
    1) meaning=refused ;;
    2) meaning='error termination' ;;
    3) meaning=files ;;
    4) meaning='stopped on request' ;;
    -) meaning='not run' ;;
    *) meaning=crashed ;;
    esac
    [ "$status" = 0 ] || bad=$((bad + 1))
    seconds=$(value "$folder/$name.log" 'Elapsed time')
    printf '%s,%s,%s,%s,%s,%s,%s,%s\n' "$name" "$status" "$meaning" \
      "$(state "$folder" time)" "$(state "$folder" 'cycle no\.')" "${seconds% seconds}" \
      "$(value "$folder/$name.log" Warnings)" "$(state "$folder" 'energy ratio')" >>"$2/summary.csv"
  done <"$1"
  awk -F, '{ for (i = 1; i <= NF; i++) { cell[NR, i] = $i; if (length($i) > width[i]) width[i] = length($i) } n = NF }
    END { for (r = 1; r <= NR; r++) { line = ""
      for (i = 1; i <= n; i++) line = line sprintf("%-*s  ", width[i], cell[r, i])
      sub(/ +$/, "", line); print line } }' "$2/summary.csv"
  [ "$bad" = 0 ] || echo "$bad of the runs have not ended well: see said.txt in their folders" >&2
  [ "$bad" = 0 ]
}

if [ "${1:-}" = --one ]; then
  fresh=$2
  run_line "$3" "$4"
  exit 0
fi

jobs=1 fresh=no part=0/1 runs=yes
while [ $# -gt 0 ]; do
  case $1 in
  -j) jobs=${2:-} && shift ;;
  --fresh) fresh=yes ;;
  --part) part=${2:-} && shift ;;
  --collect) runs=no ;;
  -*) echo "run_list.sh: unknown option $1" >&2 && exit 2 ;;
  *) break ;;
  esac
  shift
done
if [ $# -ne 2 ] || [ ! -f "$1" ]; then
  echo "usage: run_list.sh [-j N] [--fresh] [--part K/N] [--collect] LIST OUT" >&2
  exit 2
fi
if [ "$runs" = yes ]; then
  if ! command -v "$program" >/dev/null; then
    echo "$program: no such program; build it with tools/build.sh, or say SLIDELINE=..." >&2
    exit 2
  fi
  # Lines become arguments by null bytes, so that blanks and quotes in them mean nothing.
  awk -v k="${part%/*}" -v n="${part#*/}" '(NR - 1) % n == k && NF' "$1" | tr '\n' '\0' \
    | xargs -0 -P "$jobs" -I'{}' "$here/run_list.sh" --one "$fresh" "$2" '{}'
  [ "$part" = 0/1 ] || exit 0
fi
collect "$1" "$2"
