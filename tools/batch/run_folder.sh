#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/run_folder.sh [-j N] [--fresh] [--part K/N] [--collect] [-o OUT] FOLDER [options of the program]
# Runs all decks of a folder (*.k, *.key, *.dyn; not those that another deck there includes), each into
# OUT/<name of the deck>/ (OUT: FOLDER/results), and prints a table of how they have ended. What has ended well is
# passed over the next time; run_list.sh explains the other options and the exit status. Example:
#   tools/batch/run_folder.sh -j 4 "my decks" ctype=5 p:v0=-80.0
set -eu

here=$(cd "$(dirname "$0")" && pwd)
. "$here/../help.sh"
help_or_go_on "$@"
out=
# What run_list.sh is to be told goes round to the end of the list of arguments.
count=$#
folder=
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
    folder=$word
    break
    ;;
  esac
done
if [ -z "$folder" ] || [ ! -d "$folder" ]; then
  echo "usage: run_folder.sh [-j N] [--fresh] [--part K/N] [--collect] [-o OUT] FOLDER [options of the program]" >&2
  exit 2
fi
out=${out:-$folder/results}
mkdir -p "$out"
tab=$(printf '\t')
options=
while [ "$count" -gt 0 ]; do
  options=$options$tab$1
  shift
  count=$((count - 1))
done

list=$out/list.$$
find "$folder" -maxdepth 1 -type f \( -name '*.k' -o -name '*.key' -o -name '*.dyn' \) | LC_ALL=C sort >"$list.all"
# The last parts of the names that decks include.
while IFS= read -r deck; do
  awk 'on && !/^\$/ { sub(/^ +/, ""); sub(/[ \r]+$/, ""); sub(/.*\//, ""); print; on = 0 }
    /^\*/ { on = toupper($1) == "*INCLUDE" }' "$deck"
done <"$list.all" >"$list.included"
while IFS= read -r deck; do
  base=${deck##*/}
  grep -qxF -e "$base" "$list.included" || printf '%s\t%s%s\n' "${base%.*}" "$deck" "$options"
done <"$list.all" >"$list"
rm -f "$list.all" "$list.included"
mv "$list" "$out/list.txt"
if [ ! -s "$out/list.txt" ]; then
  echo "$folder: no decks (*.k, *.key, *.dyn)" >&2
  exit 2
fi
exec "$here/run_list.sh" "$@" "$out/list.txt" "$out"
