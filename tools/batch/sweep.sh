#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/sweep.sh [-j N] [--fresh] [--part K/N] [--collect] -o OUT DECK NAME=A,B,C [NAME=...]
# Runs a deck with every combination of values of what may be changed on the command line (ctype, pen, dt, tssfac,
# p:NAME for a parameter of the deck ...), each into OUT/<values>/, and prints a table of how the runs have ended.
# In names of folders what is no letter, digit or one of . + - becomes _; names that are then the same up to case get a
# number. A name or a value that is given twice is refused, and so is an OUT that holds the runs of another deck.
# What has ended well is passed over the next time; run_list.sh explains the options and the exit status. Example:
#   tools/batch/sweep.sh -j 4 -o results/sweep input/collision/collision.k ctype=1,2,5 p:v0=-40.0,-80.0
set -eu

here=$(CDPATH='' cd "$(dirname "$0")" && pwd)
. "$here/../help.sh"
. "$here/lists.sh"
help_or_go_on "$@"

# usage: how it is called; the end.
usage() {
  echo "usage: sweep.sh [-j N] [--fresh] [--part K/N] [--collect] -o OUT DECK NAME=A,B,C [NAME=...]" >&2
  exit 2
}

out=
deck=
count=$#
while [ "$count" -gt 0 ]; do
  word=$1
  shift
  count=$((count - 1))
  case $word in
  -o | -j | --part)
    [ "$count" -gt 0 ] || usage
    if [ "$word" = -o ]; then
      out=$1
    else
      set -- "$@" "$word" "$1"
    fi
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
[ -n "$out" ] && [ -f "$deck" ] && [ "$count" -gt 0 ] || usage
case $out in -*) out=./$out ;; esac
check_words "$deck" "$out"

# Each name multiplies the lines so far by its values. The name of a run is made of the values.
lines=$(printf '\t\t%s' "$deck")
names=' '
while [ "$count" -gt 0 ]; do
  check_words "$1"
  case $1 in
  ?*=?*) ;;
  *) echo "sweep.sh: '$1': expected NAME=A,B,C" >&2 && exit 2 ;;
  esac
  name=$(printf '%s' "${1%%=*}" | LC_ALL=C tr '[:lower:]' '[:upper:]')
  case $names in
  *" $name "*) echo "sweep.sh: '$1': ${1%%=*} is given twice" >&2 && exit 2 ;;
  esac
  names="$names$name "
  lines=$(printf '%s\n' "$lines" | SPEC=$1 LC_ALL=C awk -F '\t' '
    BEGIN { spec = ENVIRON["SPEC"]; at = index(spec, "="); name = substr(spec, 1, at - 1)
      n = split(substr(spec, at + 1), values, ",")
      short = name; sub(/^[pP]:/, "", short)
      for (i = 1; i <= n; i++) {
        wrong = values[i] ~ /^ *$/ ? "a value is missing" : values[i] in given ? values[i] " is given twice" : ""
        if (wrong != "") { print "sweep.sh: \047" spec "\047: " wrong | "cat 1>&2"; close("cat 1>&2"); exit 2 }
        given[values[i]] = 1 } }
    { for (i = 1; i <= n; i++) {
        word = short "_" values[i]; gsub(/[^A-Za-z0-9_.+-]/, "_", word)
        word = ($1 == "" ? "" : $1 "_") word
        print word "\t" word substr($0, 2*length($1) + 2) "\t" name "=" values[i] } }') || exit 2
  shift
  count=$((count - 1))
done
longest=$(printf '%s\n' "$lines" | LC_ALL=C awk -F '\t' 'length($1) > n { n = length($1) } END { print n }')
if [ "$longest" -gt 220 ]; then
  echo "sweep.sh: the name of a run would have $longest characters, for which a file system has no room: sweep fewer at once" >&2
  exit 2
fi
own "$out" "$deck"
list=$(mktemp "$out/list.XXXXXX") || exit 2
printf '%s\n' "$lines" | distinct >"$list"
mv "$list" "$out/list.txt"
exec "$here/run_list.sh" "$@" "$out/list.txt" "$out"
