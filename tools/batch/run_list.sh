#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/run_list.sh [-j N] [--fresh] [--part K/N] [--collect] LIST OUT
# Runs every line of LIST, which run_folder.sh and sweep.sh write: fields between tabs, first the name of
# the run, then its deck, then what else the program is to be told. Each run gets the folder OUT/NAME; what it says goes
# to said.txt there, beside run.status, run.inputs and run.lock, which are the batch's own. A run that has ended well
# (status 0) with the same files, options and program is passed over, and one that another batch is at (flock) is left to it:
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
. "$here/lists.sh"
help_or_go_on "$@"
program=${SLIDELINE:-$here/../../build/release/slideline}

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
  mkdir -p "$folder" || return 1
  # A batch that is called while another one is at this run leaves it alone.
  if command -v flock >/dev/null; then
    exec 9>"$folder/run.lock"
    if ! flock -n 9; then
      echo "== $name: another batch is running it"
      return 0
    fi
  fi
  now=$({ printf '%s\n' "$deck" | files_of | cut -c 2- | tr '\n' '\0' | xargs -0 cksum --; printf '%s\n' "$@"; "$program" --version
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

# collect LIST OUT: the table of all runs, on the screen and in OUT/summary.csv; false when one has not ended well. Names
# and reasons stand in quotes there where they hold a comma, a quote or a line feed (RFC 4180).
collect() {
  OUT=$2 awk -F '\t' '
    # The last value behind TEXT and an equals sign of a log.
    function logged(path, text,   line, at, value) {
      while ((getline line <path) > 0) { at = index(line, "=")
        if (at && line ~ "^ *" text " *=") { value = substr(line, at + 1); gsub(/^ +| +$/, "", value) } }
      close(path); return value }
    # What the status file says of a run.
    function take_state(path,   line, name, found) {
      split("", state)
      while ((getline line <path) > 0) {
        found = 1
        sub(/^ /, "", line)
        if (!match(line, /  +/)) continue
        name = substr(line, 1, RSTART - 1)
        line = substr(line, RSTART + RLENGTH); sub(/ +$/, "", line)
        state[name] = line }
      close(path); return found }
    # The first line that the program wrote for an error: its other lines begin with a blank.
    function first_error(path,   line, found) {
      while ((getline line <path) > 0) {
        sub(/\r$/, "", line)
        if (line == "" || line ~ /^ / || line ~ /^warning: /) continue
        found = line; break }
      close(path); return found }
    function quoted(text) {
      if (text !~ /[",\r\n]/) return text
      gsub(/"/, "\"\"", text); return "\"" text "\"" }
    function add_row(row,   i, line) {
      n_row++
      for (i = 1; i <= n; i++) {
        cell[n_row, i] = row[i]; line = line (i > 1 ? "," : "") quoted(row[i])
        if (i < n && length(row[i]) > width[i]) width[i] = length(row[i]) }
      print line >csv }
    BEGIN {
      out = ENVIRON["OUT"]; csv = out "/summary.csv.new"
      n = split("run,status,meaning,time,cycles,seconds,warnings,energy_ratio,reason", row, ",")
      split("refused,error termination,files,stopped on request", meaning, ",")
      add_row(row) }
    $1 == "" { next }
    {
      folder = out "/" $1
      status = "-"; path = folder "/run.status"
      if ((getline line <path) > 0 && line != "") status = line
      close(path)
      row[1] = $1; row[2] = status
      row[3] = status == "-" ? "not run" : status == 0 ? "normal" : status in meaning ? meaning[status] : "crashed"
      if (status "" != "0") bad++
      if (!take_state(folder "/" $1 ".status.out")) take_state(folder "/status.out")
      row[4] = state["time"]; row[5] = state["cycle no."]; row[8] = state["energy ratio"]
      row[6] = logged(folder "/" $1 ".log", "Elapsed time"); sub(/ seconds$/, "", row[6])
      row[7] = logged(folder "/" $1 ".log", "Warnings")
      row[9] = status == "-" || status == 0 ? "" : first_error(folder "/said.txt")
      add_row(row) }
    END {
      close(csv)
      for (r = 1; r <= n_row; r++) {
        line = ""
        for (i = 1; i <= n; i++) line = line sprintf("%-*s  ", width[i], cell[r, i])
        sub(/ +$/, "", line)
        print line }
      if (!bad) exit 0
      print bad " of the runs have not ended well: see said.txt in their folders" | "cat 1>&2"; close("cat 1>&2")
      exit 1 }' "$1" && status=0 || status=1
  mv "$2/summary.csv.new" "$2/summary.csv" || return 1
  return "$status"
}

if [ "${1:-}" = --one ]; then
  [ $# -gt 3 ] || exit 0
  fresh=$2
  run_line "$3" "$4"
  exit 0
fi

# wrong TEXT: what is wrong with the call; the end.
wrong() {
  echo "run_list.sh: $1" >&2
  exit 2
}

jobs=1 fresh=no part=0/1 runs=yes
while [ $# -gt 0 ]; do
  case $1 in
  -j) jobs=${2:-} && shift ;;
  --fresh) fresh=yes ;;
  --part) part=${2:-} && shift ;;
  --collect) runs=no ;;
  -*) wrong "unknown option $1" ;;
  *) break ;;
  esac
  shift
done
if [ $# -ne 2 ] || [ ! -f "$1" ]; then
  echo "usage: run_list.sh [-j N] [--fresh] [--part K/N] [--collect] LIST OUT" >&2
  exit 2
fi
case $jobs in
'' | *[!0-9]* | 0*) wrong "-j '$jobs': expected how many runs at a time, 1 or more" ;;
esac
k=${part%/*} n=${part#*/}
case $k:$n in
*[!0-9]*:* | :* | *:*[!0-9]* | *:) k=0 n=0 ;;
esac
[ "$k" -lt "$n" ] || wrong "--part '$part': expected K/N with K from 0 to N - 1 (number an array from 0 without gaps)"
case $2 in -*) set -- "$1" "./$2" ;; esac
if [ "$runs" = yes ]; then
  if ! command -v "$program" >/dev/null; then
    echo "$program: no such program; build it with tools/build.sh, or say SLIDELINE=..." >&2
    exit 2
  fi
  # Lines become arguments by null bytes, so that blanks and quotes in them mean nothing. A run that can not even
  # begin is no reason to leave the others out.
  LC_ALL=C awk -v k="$k" -v n="$n" '(NR - 1) % n == k && NF' "$1" | tr '\n' '\0' \
    | xargs -0 -n 1 -P "$jobs" "$here/run_list.sh" --one "$fresh" "$2" || :
  [ "$part" = 0/1 ] || exit 0
fi
collect "$1" "$2"
