#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/docs.sh [--serve] [--no-fortran]
# Installs MkDocs and FORD into an environment of their own, build/docs-venv, and builds the
# documentation as build/site (start at index.html).  --serve: shows it at http://127.0.0.1:8000
# until Ctrl-C, with search, which browsers do not allow in files.  --no-fortran leaves out the pages
# of the Fortran interface, which take the longest.
set -euo pipefail
root=$(CDPATH='' cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
build="$root/build"
venv="$build/docs-venv"
serve=no
fortran=yes
for argument in "$@"; do
  case $argument in
    --serve) serve=yes ;;
    --no-fortran) fortran=no ;;
    *) echo "usage: tools/docs.sh [--serve] [--no-fortran]" >&2; exit 1 ;;
  esac
done

# run LOG COMMAND...: quietly; the log is shown where the command fails.
run() {
  local log="$build/$1"
  shift
  if ! "$@" >"$log" 2>&1; then
    tail -n 30 "$log" >&2
    echo "$1 failed; its output is in ${log#"$root"/}" >&2
    exit 1
  fi
}

mkdir -p "$build"
want="$root $(cksum <"$root/tools/docs/requirements.txt")"
if [ "$(cat "$venv/installed" 2>/dev/null)" != "$want" ] || ! "$venv/bin/python" -c '' 2>/dev/null; then
  echo "== installing MkDocs and FORD into build/docs-venv"
  rm -rf "$venv"
  run docs-pip.log python3 -m venv "$venv"
  run docs-pip.log "$venv/bin/python" -m pip install --disable-pip-version-check --no-compile \
    -r "$root/tools/docs/requirements.txt"
  echo "$want" >"$venv/installed"
fi

echo "== building the pages"
"$venv/bin/python" "$root/tools/docs/site_source.py" "$build/docs"
run docs-mkdocs.log env NO_MKDOCS_2_WARNING=1 "$venv/bin/mkdocs" build --strict --quiet --config-file "$build/docs/mkdocs.yml"
if [ $fortran = yes ]; then
  echo "== building the pages of the Fortran interface"
  run docs-ford.log "$venv/bin/ford" --output_dir "$build/site/fortran" "$root/doc/ford.md"
  # Nothing on the site is fetched from elsewhere.
  find "$build/site/fortran" -name '*.html' -exec \
    sed -i -E 's#<script[^>]* src="(https?:)?//[^"]*"[^>]*></script>##g' {} +
fi
echo "== the site is build/site/index.html"
if [ $serve = yes ]; then
  exec "$venv/bin/python" -m http.server --bind 127.0.0.1 --directory "$build/site" 8000
fi
