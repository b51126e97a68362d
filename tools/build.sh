#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/build.sh [release|debug|counted|mpi|package]
# Installs what is missing and builds build/release/slideline or build/debug/slideline.
# counted: build/counted/slideline, for x86-64-v3, whose instructions callgrind can count.
# mpi: build/mpi/slideline, whose explicit runs `mpirun -n N` shares among N processes.
# package: builds for x86-64-v2, v3 and v4 (or those of SLIDELINE_LEVELS) and a launcher that picks the fastest, as
# build/package/slideline-VERSION and that as .tar.gz, for other machines with Linux.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
help_or_go_on "$@"

# make_package: programs of three levels that need nothing but the C library, and what `cmake --install` puts beside them.
make_package() {
  local build name
  . "$root/tools/package/common.sh"
  build=$packages/build
  name=slideline-$version
  say "building for ${levels//;/, } (some minutes; how far it is stands in build/package/build.log)"
  rm -rf "${packages:?}/$name"
  { cmake -S "$root" -B "$build" -G Ninja -DSLIDELINE_TESTS=OFF -DSLIDELINE_PORTABLE=ON "-DSLIDELINE_LEVELS=$levels" \
      -DCMAKE_INSTALL_PREFIX="$packages/$name" && cmake --build "$build" && cmake --install "$build" --strip
  } >"$packages/build.log" 2>&1 || fail build
  tar -C "$packages" -czf "$packages/$name.tar.gz" "$name" || exit 1
  "$packages/$name/bin/slideline" --version || exit 1
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
