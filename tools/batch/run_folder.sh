#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/run_folder.sh [-j N] [--fresh] [--part K/N] [--collect] [-o OUT] FOLDER [options of the program]
# Runs all decks of a folder (*.k, *.key, *.dyn in any case; not hidden ones, nor those that another deck there
# includes, which are named), each into OUT/<name of the deck>/ (OUT: FOLDER/results), and prints a table of how they
# have ended. Decks that share a name up to case (a.k, a.key, A.dyn) get OUT/a_k, OUT/a_key, OUT/A_dyn. What has ended
# well is passed over the next time; run_list.sh explains the other options and the exit status. Example:
#   tools/batch/run_folder.sh -j 4 "my decks" ctype=5 p:v0=-80.0
set -eu

here=$(CDPATH='' cd "$(dirname "$0")" && pwd)
. "$here/../help.sh"
. "$here/lists.sh"
help_or_go_on "$@"

# usage: how it is called; the end.
usage() {
  echo "usage: run_folder.sh [-j N] [--fresh] [--part K/N] [--collect] [-o OUT] FOLDER [options of the program]" >&2
  exit 2
}

# What run_list.sh is to be known goes round to the end of the list of arguments.
out=
count=$#
folder=
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
    folder=$word
    break
    ;;
  esac
done
[ -n "$folder" ] && [ -d "$folder" ] || usage
case $out in -*) out=./$out ;; esac
check_words "$folder" "$out"
tab=$(printf '\t')
options=
while [ "$count" -gt 0 ]; do
  check_words "$1"
  options=$options$tab$1
  shift
  count=$((count - 1))
done

out=${out:-$folder/results}
[ "$out" = "$folder/results" ] || own "$out" "$folder"
mkdir -p "$out" || exit 2

list=$(mktemp "$out/list.XXXXXX") || exit 2
trap 'rm -f "$list" "$list".*' EXIT
trap 'exit 130' INT TERM HUP
for deck in "$folder"/*; do
  case ${deck##*/} in
  *.[kK] | *.[kK][eE][yY] | *.[dD][yY][nN]) ;;
  *) continue ;;
  esac
  [ -f "$deck" ] || continue
  check_words "$deck"
  printf '%s\n' "$deck" || exit 2
done >"$list.all"
# A deck that another one includes is no run of its own.
files_of <"$list.all" | sed -n 's/^+//p' | LC_ALL=C sort -u | while IFS= read -r path; do
  base=$folder/${path##*/}
  if [ "$path" -ef "$base" ]; then printf '%s\n' "$base"; fi
done | LC_ALL=C sort -u >"$list.included"
LC_ALL=C sort "$list.all" | LC_ALL=C comm -23 - "$list.included" | while IFS= read -r deck; do
  base=${deck##*/}
  suffix=${base##*.}
  name=${base%.*}
  # The program leaves blanks at the end of a name out.
  while [ "$name" != "${name% }" ]; do name=${name% }; done
  printf '%s\t%s\t%s%s\n' "$name" "${name}_$suffix" "$deck" "$options"
done >"$list.wanted"
distinct <"$list.wanted" >"$list"
sed 's/.*/== &: no run of its own, another deck includes it/' "$list.included"
if [ ! -s "$list" ]; then
  echo "$folder: no decks (*.k, *.key, *.dyn)" >&2
  exit 2
fi
mv "$list" "$out/list.txt"
rm -f "$list".*
trap - EXIT INT TERM HUP
exec "$here/run_list.sh" "$@" "$out/list.txt" "$out"
