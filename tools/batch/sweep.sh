#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/sweep.sh [-j N] [--fresh] [--part K/N] [--collect] -o OUT DECK NAME=A,B,C [NAME=...]
# Runs a deck with every combination of values of what may be changed on the command line (ctype, pen, dt, tssfac,
# p:NAME for a parameter of the deck ...), each into OUT/<values>/, and prints a table of how the runs have ended.
# What has ended well is passed over the next time; run_list.sh explains the options and the exit status. Example:
#   tools/batch/sweep.sh -j 4 -o results/sweep input/collision/collision.k ctype=1,2,5 p:v0=-40.0,-80.0
set -eu

here=$(cd "$(dirname "$0")" && pwd)
. "$here/../help.sh"
help_or_go_on "$@"
out=
deck=
count=$#
while [ "$count" -gt 0 ]; do
  word=$1
  shift
  count=$((count - 1))
  case $word in
  -o)
    out=$1
    shift
    count=$((count - 1))
    ;;
  -j | --part)
    set -- "$@" "$word" "$1"
    shift
    count=$((count - 1))
    ;;
  -*) set -- "$@" "$word" ;;
  *)
    deck=$word
    break
    ;;
  esac
done
if [ -z "$out" ] || [ ! -f "$deck" ] || [ "$count" -eq 0 ]; then
  echo "usage: sweep.sh [-j N] [--fresh] [--part K/N] [--collect] -o OUT DECK NAME=A,B,C [NAME=...]" >&2
  exit 2
fi
mkdir -p "$out"

# Each name multiplies the lines so far by its values. The name of a run is made of the values.
list=$out/list.$$
printf '\t%s\n' "$deck" >"$list"
while [ "$count" -gt 0 ]; do
  case $1 in
  ?*=?*) ;;
  *) echo "sweep.sh: '$1': expected NAME=A,B,C" >&2 && rm -f "$list" && exit 2 ;;
  esac
  SPEC=$1 awk -F '\t' 'BEGIN { spec = ENVIRON["SPEC"]; at = index(spec, "="); name = substr(spec, 1, at - 1)
      n = split(substr(spec, at + 1), values, ",")
      short = name; sub(/^[pP]:/, "", short) }
    { rest = substr($0, length($1) + 1)
      for (i = 1; i <= n; i++) {
        word = short "_" values[i]; gsub(/[^A-Za-z0-9_.+-]/, "_", word)
        print ($1 == "" ? "" : $1 "_") word rest "\t" name "=" values[i] } }' "$list" >"$list.next"
  mv "$list.next" "$list"
  shift
  count=$((count - 1))
done
mv "$list" "$out/list.txt"
exec "$here/run_list.sh" "$@" "$out/list.txt" "$out"
