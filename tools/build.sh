#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/build.sh [release|debug|counted|mpi|package]
# Installs what is missing and builds build/release/slideline or build/debug/slideline.
# counted: build/counted/slideline, for x86-64-v3, whose instructions callgrind can count.
# mpi: build/mpi/slideline, whose explicit runs `mpirun -n N` shares among N processes.
# package: builds for x86-64-v2, v3 and v4 and a launcher that picks the fastest, as
# build/package/slideline-VERSION and that as .tar.gz, for other machines with Linux.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
help_or_go_on "$@"

# make_package: programs of three levels that need nothing but the C library, and what `cmake --install` puts beside them.
make_package() {
  local name build="$root/build/package/build" log="$root/build/package/build.log"
  name="slideline-$(sed -n 's/^project(slideline VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")"
  say "building for x86-64-v2, v3 and v4"
  mkdir -p "$root/build/package"
  rm -rf "$root/build/package/$name"
  if ! { cmake -S "$root" -B "$build" -G Ninja -DSLIDELINE_TESTS=OFF -DSLIDELINE_PORTABLE=ON \
           "-DSLIDELINE_LEVELS=x86-64-v2;x86-64-v3;x86-64-v4" -DCMAKE_INSTALL_PREFIX="$root/build/package/$name" &&
         cmake --build "$build" && cmake --install "$build" --strip; } >"$log" 2>&1; then
    tail -n 60 "$log" >&2
    complain "the build failed; its output is in build/package/build.log"
    exit 1
  fi
  tar -C "$root/build/package" -czf "$root/build/package/$name.tar.gz" "$name" || exit 1
  "$root/build/package/$name/bin/slideline" --version || exit 1
  say "the package is build/package/$name.tar.gz"
}

type=${1:-release}
case $type in
  release | debug | counted | mpi | package) ;;
  *) complain "usage: tools/build.sh [release|debug|counted|mpi|package]"; exit 1 ;;
esac
lock
if [ "$type" = mpi ]; then
  install_packages mpi
else
  install_packages
fi
if [ "$type" = package ]; then
  make_package
  exit 0
fi
build "$type"
install_tools || :
unlock
say "the program is build/$type/slideline"
