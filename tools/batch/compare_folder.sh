#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tools/batch/compare_folder.sh [options of slideline-tools compare] RESULTS REFERENCES
# Compares every history (*.csv) below REFERENCES with the one of the same place and name below RESULTS and prints a table;
# what `slideline-tools compare` says of each goes to RESULTS/compared/. Tables of timing and summaries are left out.
# TOOLS names the command (build/venv/bin/slideline-tools). Exit status: 0 all agree, 1 some do not,
# 2 some are missing or can not be compared, or there is nothing to compare.
set -eu

here=$(CDPATH='' cd "$(dirname "$0")" && pwd)
. "$here/../help.sh"
. "$here/lists.sh"
help_or_go_on "$@"
tools=${TOOLS:-$here/../../build/venv/bin/slideline-tools}
count=$#
if [ "$count" -lt 2 ]; then
  echo "usage: compare_folder.sh [options of slideline-tools compare] RESULTS REFERENCES" >&2
  exit 2
fi
# The options go round to the end of the list of arguments.
while [ "$count" -gt 2 ]; do
  set -- "$@" "$1"
  shift
  count=$((count - 1))
done
results=$1 references=$2
shift 2
for folder in "$results" "$references"; do
  [ -d "$folder" ] || { echo "$folder: no such folder" >&2 && exit 2; }
done

# find takes names such as - and ! for words of its own.
case $results in -* | '!'* | '('* | ')'*) results=./$results ;; esac
case $references in -* | '!'* | '('* | ')'*) references=./$references ;; esac
odd=$(find "$references" -type f -name '*.csv' | LC_ALL=C grep -v '\.csv$' || :)
check_words "$results" "$references" ${odd:+"$odd
"}
compared=$results/compared
mkdir -p "$compared"
find "$references" -type f -name '*.csv' ! -name '*.timing.csv' ! -name summary.csv \
  | LC_ALL=C sort >"$compared/list.txt"
agreed=0 failed=0 unusable=0
printf '%-9s  %s\n' verdict history
while IFS= read -r path; do
  name=${path#"$references"/}
  said=$compared/$name.txt
  mkdir -p "${said%/*}"
  status=0
  if [ -f "$results/$name" ]; then
    "$tools" compare "$results/$name" "$path" "$@" >"$said" 2>&1 </dev/null || status=$?
  else
    status=3
    echo "no such result" >"$said"
  fi
  case $status in
  0)
    agreed=$((agreed + 1))
    printf '%-9s  %s\n' agreed "$name"
    ;;
  1)
    failed=$((failed + 1))
    printf '%-9s  %s  (%s)\n' failed "$name" "$(tail -n 1 "$said")"
    ;;
  *)
    unusable=$((unusable + 1))
    printf '%-9s  %s  (%s)\n' unusable "$name" "$(tail -n 1 "$said")"
    ;;
  esac
done <"$compared/list.txt"
echo "$agreed agreed, $failed failed, $unusable missing or not comparable"
[ "$unusable" = 0 ] && [ $((agreed + failed)) -gt 0 ] || exit 2
[ "$failed" = 0 ]
