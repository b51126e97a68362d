#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: DEBFULLNAME=NAME DEBEMAIL=ADDRESS tools/package/release.sh
# Gathers a release of the present commit in build/package/release: the source tree with the site of all pages
# (`build/site`, made by tools/docs.sh after tools/test.sh -L verification), the made tables of the studies (`results/doc`, by
# --publish), source distribution, wheel, archive and Debian package, their SHA-256 sums, and NOTES.md, the changelog of this
# version. Says the command that tags the commit with it.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../setup.sh"
help_or_go_on "$@"
. "$root/tools/package/common.sh"

release=$packages/release
tree=$release/slideline-$version-source
made=slideline-$version-studies
commit=$(git -C "$root" rev-parse HEAD) || exit 1
if [ -n "$(git -C "$root" status --porcelain)" ]; then
  complain "the tree has changes that no commit has: a release is of a commit"
  exit 1
fi
if [ -z "${DEBFULLNAME:-}" ] || [ -z "${DEBEMAIL:-}" ]; then
  complain "DEBFULLNAME and DEBEMAIL are to name the maintainer of the Debian package"
  exit 1
fi
if [ ! -f "$root/build/site/index.html" ]; then
  complain "there is no build/site: tools/test.sh -L verification, then tools/docs.sh make it"
  exit 1
fi
if [ ! -d "$root/results/doc/studies" ]; then
  complain "there is no results/doc: tools/study.sh all --publish makes the tables of the studies (some hours)"
  exit 1
fi
"$root/tools/package/wheel.sh" && "$root/tools/package/deb.sh" || exit 1
if [ -n "$(git -C "$root" status --porcelain)" ] || [ "$(git -C "$root" rev-parse HEAD)" != "$commit" ]; then
  complain "the tree has changed while the packages were built: run this again"
  exit 1
fi
rm -rf "$release"
mkdir -p "$tree"
{ git -C "$root" archive "$commit" | tar -x -C "$tree" && cp -R "$root/build/site" "$tree/doc/site" &&
  tar -C "$release" -czf "$tree.tar.gz" "$(basename "$tree")" && rm -rf "$tree" &&
  tar -C "$root/results" --transform "s,^doc,$made," -czf "$release/$made.tar.gz" doc &&
  cp "$packages"/sdist/*.tar.gz "$packages"/*.whl "$packages/slideline_$version"-1_*.deb "$release" &&
  cp "$packages/slideline-$version.tar.gz" "$release/slideline-$version-linux-x86_64.tar.gz" &&
  awk -v head="## [$version]" '/^## /{on = index($0, head) == 1} on' "$root/doc/changelog.md" >"$release/NOTES.md" &&
  cd "$release" && sha256sum -- * >SHA256SUMS; } || exit 1
say "the release is in build/package/release; its tag:"
say "git tag -a v$version --cleanup=whitespace -F build/package/release/NOTES.md $commit"
