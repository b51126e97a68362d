# SPDX-License-Identifier: MIT
# Sourced by the scripts that make packages, behind tools/setup.sh.
# shellcheck disable=SC2154,SC2034  # root and venv are those of setup.sh, the others are for the scripts

packages=$root/build/package
version=$(sed -n 's/^project(slideline VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")
# SLIDELINE_LEVELS in the environment: other programs than these, such as "x86-64-v3" alone.
levels=${SLIDELINE_LEVELS:-x86-64-v2;x86-64-v3;x86-64-v4}
mkdir -p "$packages"

# python_with MODULE...: build/venv with these packages of pip.
python_with() {
  if ! { make_environment &&
         "$venv/bin/python" -m pip install --disable-pip-version-check --quiet "$@"; } >"$packages/pip.log" 2>&1; then
    fail pip
  fi
}

# fail LOG: the end of a log, and the end of the script.
fail() {
  tail -n 30 "$packages/$1.log" >&2
  complain "this failed; its output is in build/package/$1.log"
  exit 1
}
