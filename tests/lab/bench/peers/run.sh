#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/lab/bench/peers/run.sh [--quick | --publish] [--rounds N]
# slideline beside Akantu and Kratos (wheels from PyPI, into build/venv-peers, about 200 MB) and CalculiX
# (the Debian package calculix-ccx, which has to be installed: apt-get install calculix-ccx), all on this machine and in one run: tables in
# results/peers and the page in results/peers/doc (--publish: results/doc/studies/peers.md). About ten minutes, and as long again
# where callgrind counts the retired instructions (tools/slideline_tools/counting.py). SLIDELINE_MEASURED: another
# program than that of the release. OpenRadioss comes as source alone; whoever has built it sets OPENRADIOSS_STARTER and
# OPENRADIOSS_ENGINE (its two programs), what these need, and OPENRADIOSS_BUILT: which source and how, in words for the page.
set -eu

root=$(cd "$(dirname "$0")/../../../.." && pwd)
. "$root/tools/help.sh"
help_or_go_on "$@"
out=$results/peers
doc=$out/doc
venv=$root/build/venv-peers
case ${1:-} in
  --quick) out=$results/peers-quick doc=$out/doc ;;
  --publish) doc=$pages; shift ;;
esac

program=${SLIDELINE_MEASURED:-$root/build/release/slideline}
[ -n "${SLIDELINE_MEASURED:-}" ] || "$root/tools/build.sh" release
command -v ccx >/dev/null || { echo "ccx is missing: apt-get install calculix-ccx" >&2; exit 1; }
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
"$venv/bin/pip" install --quiet akantu KratosMultiphysics KratosStructuralMechanicsApplication \
  KratosContactStructuralMechanicsApplication
mkdir -p "$out"
"$venv/bin/pip" list --format=freeze >"$out/versions.txt"
"$program" --version >>"$out/versions.txt"
ccx -v >>"$out/versions.txt" || true  # its exit status is 201
[ -z "${OPENRADIOSS_ENGINE:-}" ] || printf 'OpenRadioss==%s\n' "${OPENRADIOSS_BUILT:?says how it was built}" >>"$out/versions.txt"
python=$root/build/venv/bin/python
counted=$("$python" -m slideline_tools.counting) || echo "instructions are not counted" >&2
"$python" "$root/tests/lab/bench/peers/run.py" ${counted:+--counted "$counted"} --program "$program" \
  --peers "$venv/bin/python" --out "$out" "$@"
MPLBACKEND=Agg "$python" "$root/tests/lab/bench/peers/peers_page.py" "$out" "$doc"
