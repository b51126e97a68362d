#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: [DEBFULLNAME=NAME] [DEBEMAIL=ADDRESS] tools/package/deb.sh
# Makes build/package/slideline_VERSION-1_ARCHITECTURE.deb for this distribution, with its libraries: programs for
# x86-64-v2, v3 and v4, a launcher, the Python tools, man pages and completion. The maintainer is who builds it.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../setup.sh"
help_or_go_on "$@"
. "$root/tools/package/common.sh"

lock
install_packages
build=$packages/deb
stage=$build/stage
rm -rf "$stage"
mkdir -p "$stage/DEBIAN" "$build/debian"
say "building for ${levels//;/, } (some minutes; how far it is stands in build/package/deb.log)"
{ cmake -S "$root" -B "$build" -G Ninja -DSLIDELINE_TESTS=OFF -DCMAKE_INSTALL_PREFIX=/usr \
    "-DSLIDELINE_LEVELS=$levels" &&
  cmake --build "$build" && DESTDIR=$stage cmake --install "$build" --strip; } >"$packages/deb.log" 2>&1 || fail deb

# What Debian asks of a package: pages and changelog packed, the control file, sums.
documents=$stage/usr/share/doc/slideline
gzip -9n "$stage"/usr/share/man/man1/*.1
gzip -9nc "$root/doc/changelog.md" >"$documents/changelog.gz"
maintainer="${DEBFULLNAME:-$(id -un)} <${DEBEMAIL:-$(id -un)@$(hostname -f)}>"
printf 'slideline (%s-1) unstable; urgency=medium\n\n  * Release %s.\n\n -- %s  %s\n' "$version" "$version" \
  "$maintainer" "$(date -R)" | gzip -9nc >"$documents/changelog.Debian.gz"
chmod -R u=rwX,go=rX "$stage"
: >"$build/debian/control"
needs=$(cd "$build" && dpkg-shlibdeps -O "$stage"/usr/lib/slideline/*/slideline 2>>"$packages/deb.log") || fail deb
cat >"$stage/DEBIAN/control" <<EOF
Package: slideline
Version: $version-1
Architecture: $(dpkg --print-architecture)
Maintainer: $maintainer
Installed-Size: $(du -sk --exclude=DEBIAN "$stage" | cut -f1)
Depends: ${needs#shlibs:Depends=}
Recommends: python3-numpy, python3-h5py, python3-matplotlib, python3-pandas, python3-jinja2, python3-shtab
Section: science
Priority: optional
Description: 2D explicit and implicit contact dynamics in seven formulations
 Reads LS-DYNA keyword decks and runs explicit and, for small problems,
 implicit dynamics of plane and axisymmetric bodies in contact. Seven
 formulations, from node-to-segment to mortar, are chosen by one number.
EOF
# What Python has compiled goes with the package.
printf '#!/bin/sh\nset -e\nfind /usr/share/slideline/python -name __pycache__ -prune -exec rm -rf {} +\n' >"$stage/DEBIAN/prerm"
chmod 755 "$stage/DEBIAN/prerm"
(cd "$stage" && find usr -type f -print0 | sort -z | xargs -0 md5sum >DEBIAN/md5sums) || exit 1
dpkg-deb --root-owner-group --build "$stage" "$packages" >>"$packages/deb.log" 2>&1 || fail deb
say "the package is build/package/$(basename "$packages"/slideline_"$version"-1_*.deb)"
if command -v lintian >/dev/null; then
  lintian --fail-on error "$packages"/slideline_"$version"-1_*.deb || { complain "lintian finds errors in the package"; exit 1; }
fi
