# SPDX-License-Identifier: MIT
# Shared by build.sh, run.sh and test.sh, which source it: installs what is missing and builds. The program comes
# first; the Python tools, which come over the network, follow.
# Needs bash; sets `root`, the top of the source tree.

root=$(CDPATH='' cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv="$root/build/venv"
. "$root/tools/help.sh"

say() {
  printf '== %s\n' "$*"
}

complain() {
  printf '%s\n' "$*" >&2
}

# One set-up or build at a time: a sweep may start many runs at once.
lock() {
  mkdir -p "$root/build" || exit 1
  if command -v flock >/dev/null; then
    exec 9>>"$root/build/lock"
    if ! flock -n 9; then
      complain "waiting for another set-up or build in $root ($(holder))"
      flock 9
    fi
    printf '%s since %s, process %s\n' "${0##*/}" "$(date +%H:%M:%S)" "$$" >"$root/build/lock.holder"
  fi
}

# holder: who holds the lock, as far as it is reported.
holder() {
  cat "$root/build/lock.holder" 2>/dev/null || echo "it does not say which"
}

unlock() {
  exec 9>&-
}

# lacking [mpi]: one line "package: what it is for" for each thing that is not on this machine.
lacking() {
  if ! command -v gfortran >/dev/null || ! echo end | gfortran -x f95 - -o /dev/null 2>/dev/null; then
    echo "gfortran: Fortran compiler"
    echo "libc6-dev: what it links with"
    echo "liblapack-dev: LAPACK"
  elif ! echo end | gfortran -x f95 - -llapack -lblas -o /dev/null 2>/dev/null; then
    echo "liblapack-dev: LAPACK"
  fi
  command -v g++ >/dev/null || echo "g++: C++ compiler"
  if ! command -v cmake >/dev/null; then
    echo "cmake: CMake, 3.22 or newer"
  elif ! cmake_is_new; then
    echo "cmake: CMake, 3.22 or newer (found: $(cmake --version | head -n 1))"
  fi
  command -v ninja >/dev/null || echo "ninja-build: Ninja"
  command -v h5fc >/dev/null || echo "libhdf5-dev: HDF5 with its Fortran interface"
  if ! command -v python3 >/dev/null; then
    echo "python3: Python, 3.10 or newer"
    echo "python3-venv: Python's virtual environments"
  elif ! python3 -c 'import venv, ensurepip' 2>/dev/null; then
    echo "python3-venv: Python's virtual environments"
  fi
  [ "${1:-}" != mpi ] || mpi_packages
}

# What several processes take, where it is not there.
mpi_packages() {
  command -v mpif90 >/dev/null || echo "libopenmpi-dev: Open MPI"
  command -v mpirun >/dev/null || echo "openmpi-bin: what starts its processes"
}

# useful [test]: as `lacking`, for what the program, or its tests, are better with but do without.
useful() {
  if ! command -v gfortran >/dev/null || ! echo end | gfortran -x f95 - -lumfpack -o /dev/null 2>/dev/null; then
    echo "libsuitesparse-dev: UMFPACK, for large implicit systems"
  fi
  if [ "${1:-}" = test ] && ! command -v ccx >/dev/null; then
    echo "calculix-ccx: CalculiX, which friction is compared with"
  fi
  [ "${1:-}" != test ] || mpi_packages
}

cmake_is_new() {
  local version major minor
  version=$(cmake --version | sed -n 's/^cmake version \([0-9]*\.[0-9]*\).*/\1/p')
  major=${version%%.*}
  minor=${version#*.}
  [ "$((major * 1000 + minor))" -ge 3022 ]
}

# give_up REASON LINES: say what to install by hand and stop.
give_up() {
  complain "$1"
  complain "Please install these, then run this script again:"
  printf '%s\n' "$2" | sed 's/^\([^:]*\): \(.*\)$/  \1  (\2)/' >&2
  complain "On Debian or Ubuntu, with what the program is better with:"
  complain "  sudo apt-get update && sudo apt-get install -y $(package_names "$2
$(useful)")"
  exit 1
}

package_names() {
  printf '%s\n' "$1" | sed 's/:.*//; /^$/d' | tr '\n' ' ' | sed 's/ $//'
}

# install_packages [test|mpi]: the system packages that are missing, then those that are only useful.
install_packages() {
  local missing as_root
  missing=$(lacking "$@")
  if [ -z "$missing" ]; then
    install_useful "$@"
    return 0
  fi
  command -v apt-get >/dev/null || give_up "Something is missing and there is no apt-get here." "$missing"
  as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || give_up "Something is missing and this is not root (and has no sudo)." "$missing"
    # Without a terminal nobody can type a password.
    if [ ! -t 0 ] && ! sudo -n true 2>/dev/null; then
      give_up "Something is missing and sudo asks for a password." "$missing"
    fi
    as_root=(sudo)
  fi
  if ! apt_install packages.log "$missing"; then
    tail -n 5 "$root/build/packages.log" >&2
    give_up "apt-get failed; its output is in build/packages.log." "$missing"
  fi
  missing=$(lacking "$@")
  [ -z "$missing" ] || give_up "Still missing after apt-get:" "$missing"
  install_useful "$@"
}

# Install what is done without: once, where that needs no questions; a failure is no error.
install_useful() {
  local extra as_root log=useful${1:+-$1}.log
  [ ! -e "$root/build/$log" ] || return 0
  extra=$(useful "$@")
  [ -n "$extra" ] && command -v apt-get >/dev/null || return 0
  as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null && sudo -n true 2>/dev/null || return 0
    as_root=(sudo)
  fi
  apt_install "$log" "$extra" ||
    complain "apt-get failed (build/$log); going on without $(package_names "$extra")"
}

# apt_install LOG LINES: install the packages of these lines, as the words of `as_root` say.
apt_install() {
  local packages
  packages=$(package_names "$2")
  say "installing system packages: $packages"
  mkdir -p "$root/build"
  # shellcheck disable=SC2086  # package names are words
  { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y \
      --no-install-recommends $packages; } >"$root/build/$1" 2>&1
}

# make_environment: the private Python environment, empty. It holds absolute paths, so it is made anew when the tree has
# moved. Needs no network.
make_environment() {
  if [ -x "$venv/bin/python" ] && "$venv/bin/python" -c '' 2>/dev/null &&
     { grep -qsxF "$root" "$venv/made" || grep -qsF "$root " "$venv"/installed*; }; then
    return 0
  fi
  say "making the Python environment build/venv"
  rm -rf "$venv"
  python3 -m venv "$venv" >"$root/build/venv.log" 2>&1 && printf '%s\n' "$root" >"$venv/made"
}

# install_tools [EXTRA]: the Python package of tools/ in the private environment, with an extra. False, and says what is
# missing then, where that fails: the program needs none of it.
install_tools() {
  local extra=${1:-} stamp want
  stamp="$venv/installed${extra:+-$extra}"
  want="$root $(cksum <"$root/tools/pyproject.toml")"
  if [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$want" ] && "$venv/bin/python" -c '' 2>/dev/null; then
    return 0
  fi
  if ! make_environment; then
    tail -n 5 "$root/build/venv.log" >&2
    without_tools "python3 -m venv failed; its output is in build/venv.log."
    return 1
  fi
  say "installing the Python tools${extra:+ and what the tests need}"
  # Python compiles what is used when it is first used; of all that comes along that is little.
  if ! (cd "$root" && "$venv/bin/python" -m pip install --disable-pip-version-check --no-compile \
        -e "./tools${extra:+[$extra]}") >"$root/build/pip.log" 2>&1; then
    tail -n 15 "$root/build/pip.log" >&2
    without_tools "pip failed; its output is in build/pip.log."
    return 1
  fi
  printf '%s\n' "$want" >"$stamp"
}

# without_tools REASON: what is missing without the Python tools.
without_tools() {
  complain "$1"
  complain "The program works without the Python tools. Missing are slideline-tools (plots, reports, decks of the"
  complain "scenes), the picture of tools/run.sh, the studies and the tests. Run this script again to install them."
}

# build TYPE [TARGET...]: release, debug, counted or mpi; the program, or the target `all` for the tests too.
build() {
  local type=$1 folder name log python
  local -a more=() targets=("${@:2}")
  [ $# -gt 1 ] || targets=(slideline)
  folder="$root/build/$type"
  case $type in
    release) name=Release more=(-DSLIDELINE_TWO_BUILDS=ON) ;;
    debug) name=Debug ;;
    counted) name=Release more=(-DSLIDELINE_ARCH=x86-64-v3 -DSLIDELINE_TESTS=OFF) ;;
    mpi) name=Release more=(-DSLIDELINE_MPI=ON -DSLIDELINE_TESTS=OFF) ;;
    *) complain "no such build: $type (release, debug, counted or mpi)"; exit 1 ;;
  esac
  mkdir -p "$root/build"
  log="$root/build/$type.log"
  python=$venv/bin/python
  make_environment || python=$(command -v python3)
  if ! grep -qsF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$folder/CMakeCache.txt"; then
    say "configuring build/$type"
    rm -rf "$folder"
    if ! cmake -S "$root" -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=$name "${more[@]}" \
         -DPython3_EXECUTABLE="$python" >"$log" 2>&1; then
      cat "$log" >&2
      rm -f "$folder/CMakeCache.txt"
      exit 1
    fi
  elif ! grep -qs "^Python3_EXECUTABLE:.*=$python\$" "$folder/CMakeCache.txt"; then
    cmake "$folder" -DPython3_EXECUTABLE="$python" >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
  fi
  say "building build/$type${2:+ with its tests}"
  [ -t 1 ] || say "the first build takes 3 to 8 minutes; build/$type.log shows its progress"
  if [ -t 1 ]; then
    cmake --build "$folder" --target "${targets[@]}" --parallel "$(nproc)" || exit 1
  elif ! cmake --build "$folder" --target "${targets[@]}" --parallel "$(nproc)" >"$log" 2>&1; then
    tail -n 60 "$log" >&2
    complain "the build failed; its output is in build/$type.log"
    exit 1
  fi
}
