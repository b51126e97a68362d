#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: tools/build.sh [release|debug]
# Installs what is missing and builds build/release/slideline or build/debug/slideline.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

type=${1:-release}
case $type in
  release | debug) ;;
  *) complain "usage: tools/build.sh [release|debug]"; exit 1 ;;
esac
lock
install_packages
install_tools
build "$type"
unlock
say "the program is build/$type/slideline"
