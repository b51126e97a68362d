#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/build.sh [release|debug|counted|package]
# Installs what is missing and builds build/release/slideline or build/debug/slideline.
# counted: build/counted/slideline, for x86-64-v3, whose instructions callgrind can count.
# package: builds for x86-64-v2, v3 and v4 and a launcher that picks the fastest, as
# build/package/slideline-VERSION and that as .tar.gz, for machines with the same distribution.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
help_or_go_on "$@"

# package_level LEVEL FOLDER: build for a level of the x86-64 psABI and install below FOLDER.
package_level() {
  local build="$root/build/package/$1" log="$root/build/package/$1.log"
  say "building for $1"
  mkdir -p "$root/build/package"
  if ! { cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSLIDELINE_TESTS=OFF \
           -DSLIDELINE_ARCH="$1" &&
         cmake --build "$build" --target slideline --parallel "$(nproc)"; } >"$log" 2>&1; then
    tail -n 60 "$log" >&2
    complain "the build failed; its output is in build/package/$1.log"
    exit 1
  fi
  install -D -s "$build/slideline" "$2/lib/slideline/$1/slideline" || exit 1
}

# make_package: all levels, the launcher and what a user reads; says what it made.
make_package() {
  local name folder level
  name="slideline-$(sed -n 's/^project(slideline VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")"
  folder="$root/build/package/$name"
  rm -rf "$folder"
  for level in x86-64-v2 x86-64-v3 x86-64-v4; do
    package_level "$level" "$folder"
  done
  install -D "$root/tools/package/slideline" "$folder/bin/slideline" || exit 1
  cp -R "$root/README.md" "$root/doc" "$root/input" "$folder" || exit 1
  tar -C "$root/build/package" -czf "$root/build/package/$name.tar.gz" "$name" || exit 1
  "$folder/bin/slideline" --version || exit 1
  say "the package is build/package/$name.tar.gz"
}

type=${1:-release}
case $type in
  release | debug | counted | package) ;;
  *) complain "usage: tools/build.sh [release|debug|counted|package]"; exit 1 ;;
esac
lock
install_packages
if [ "$type" = package ]; then
  make_package
  exit 0
fi
build "$type"
install_tools || :
unlock
say "the program is build/$type/slideline"
