#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/run_list.sh [-j N] [--fresh] [--part K/N] [--collect] LIST OUT
# Runs every line of LIST, which run_folder.sh and sweep.sh write: fields between tabs, first the name of
# the run, then its deck, then what else the program is to be known. Each run gets the folder OUT/NAME; what it says goes
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

here=$(CDPATH='' cd "$(dirname "$0")" && pwd)
. "$here/../help.sh"
. "$here/lists.sh"
help_or_go_on "$@"
program=${SLIDELINE:-$here/../../build/release/slideline}

# run_line OUT LINE INPUTS: one run.
run_line() {
  out=$1 now=$3
  set -f
  IFS=$tab
  # shellcheck disable=SC2086  # the fields between tabs
  set -- $2
  set +f
  unset IFS
  name=$1 deck=$2
  shift 2
  folder=$out/$name
  [ -d "$folder" ] || return 1
  # A batch that is called while another one is at this run leaves it alone.
  if [ "$locks" = yes ]; then
    exec 9>"$folder/run.lock"
    if ! flock -n 9; then
      echo "== $name: another batch is running it"
      return 0
    fi
  fi
  if [ "$fresh" = no ] && [ -e "$folder/run.status" ] && [ "$(first_line "$folder/run.status")" = 0 ] \
    && [ "$(first_line "$folder/run.inputs")" = "$now" ]; then
    echo "== $name: has run already"
    return 0
  fi
  echo "== $name"
  [ ! -e "$folder/run.status" ] || rm -f "$folder/run.status" || return 1
  printf '%s\n' "$now" >"$folder/run.inputs" || return 1
  status=0
  "$program" i="$deck" d="$folder" jobid="$name" "$@" >"$folder/said.txt" 2>&1 </dev/null || status=$?
  echo "$status" >"$folder/run.status"
}

# first_line FILE: its first line, nothing where there is none.
first_line() {
  [ -r "$1" ] || return 0
  IFS= read -r line <"$1" || :
  printf '%s' "$line"
}

# with_inputs IDENTITY LINE...: each line, and behind it on a line of its own all that its run depends on: program, files
# with their checksums, options.
with_inputs() {
  identity=$1
  shift
  held=$(printf '%s\n' "$@" | cut -f 2 | while IFS= read -r path; do
    [ -f "$path" ] || path=/dev/null # a pipe would be waited for; the program says what is wrong
    printf '%s\n' "$path"
  done | files_of)
  {
    printf '%s\n' "$held" | cut -c 2- | LC_ALL=C sort -u | tr '\n' '\0' | xargs -0 cksum -- || :
    printf '\n%s\n\n' "$held"
    printf '%s\n' "$@"
  } | IDENTITY=$identity LC_ALL=C awk '
    /^$/ { part++; next }
    !part { match($0, /^[0-9]+ [0-9]+ /); sum[substr($0, RLENGTH + 1)] = substr($0, 1, RLENGTH); next }
    part == 1 { if (/^=/) k++; path = substr($0, 2); inputs[k] = inputs[k] "\t" sum[path] path; next }
    { print; sub(/^[^\t]*\t[^\t]*/, ""); print ENVIRON["IDENTITY"] inputs[++r] "\t" $0 }'
}

# run_lines OUT IDENTITY LINE...: some runs, one after the other. Most of what goes before a run is done once for all of
# them: beside a small run every process counts.
run_lines() {
  out=$1 identity=$2 tab=$(printf '\t')
  shift 2
  locks=no
  if command -v flock >/dev/null; then locks=yes; fi
  printf '%s\n' "$@" | cut -f 1 | { cd "$out" && tr '\n' '\0' | xargs -0 mkdir -p --; } || :
  set -f
  IFS='
'
  # shellcheck disable=SC2046  # lines become words
  set -- $(with_inputs "$identity" "$@")
  unset IFS
  set +f
  while [ $# -gt 1 ]; do
    (run_line "$out" "$1" "$2") || :
    shift 2
  done
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
    function add_row(row,   i) {
      n_row++
      for (i = 1; i <= n; i++) {
        cell[n_row, i] = row[i]; csv_line[n_row] = csv_line[n_row] (i > 1 ? "," : "") quoted(row[i])
        if (i < n && length(row[i]) > width[i]) width[i] = length(row[i]) } }
    # Whether the file holds the lines: no awk tells of a full disk as another does.
    function is_whole(path,   r, line, same) {
      same = 1
      for (r = 1; r <= n_row; r++) if ((getline line <path) <= 0 || line != csv_line[r]) same = 0
      close(path); return same }
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
      for (r = 1; r <= n_row; r++) {
        line = ""
        for (i = 1; i <= n; i++) line = line sprintf("%-*s  ", width[i], cell[r, i])
        sub(/ +$/, "", line)
        print line }
      if (bad) { print bad " of the runs have not ended well: see said.txt in their folders" | "cat 1>&2"; close("cat 1>&2") }
      fflush()
      for (r = 1; r <= n_row; r++) print csv_line[r] >csv
      close(csv)
      exit !is_whole(csv) ? 2 : bad ? 1 : 0 }' <"$1" && status=0 || status=$?
  if [ "$status" -lt 2 ] && mv "$2/summary.csv.new" "$2/summary.csv"; then return "$status"; fi
  rm -f "$2/summary.csv.new"
  echo "$2/summary.csv: can not be written (is the disk full?); one that was there stays" >&2
  return 1
}

if [ "${1:-}" = --some ]; then
  [ $# -gt 4 ] || exit 0
  fresh=$2
  shift 2
  run_lines "$@"
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
  mkdir -p -- "$2" || exit 2
  if ! command -v "$program" >/dev/null; then
    echo "$program: no such program; build it with tools/build.sh, or say SLIDELINE=..." >&2
    exit 2
  fi
  identity=$({ "$program" --version; cksum <"$(command -v "$program")"; } | cksum)
  # One to sixteen lines a call, and at least eight calls for each of the runs at a time, so that they end together.
  some=$(LC_ALL=C awk -v k="$k" -v n="$n" -v jobs="$jobs" '(NR - 1) % n == k && NF { lines++ }
    END { some = int(lines/(8*jobs)); print(some < 1 ? 1 : some > 16 ? 16 : some) }' <"$1")
  # Lines become arguments by null bytes, so that blanks and quotes in them mean nothing. A run that can not even
  # begin is no reason to leave the others out.
  LC_ALL=C awk -v k="$k" -v n="$n" '(NR - 1) % n == k && NF' <"$1" | tr '\n' '\0' \
    | xargs -0 -n "$some" -P "$jobs" "$here/run_list.sh" --some "$fresh" "$2" "$identity" || :
  [ "$part" = 0/1 ] || exit 0
fi
collect "$1" "$2"
