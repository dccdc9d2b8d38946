# Sourced by the other scripts: from a fresh clone to a configured build.
# shellcheck shell=bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build_packages=(g++ cmake ninja-build libeigen3-dev libspectra-dev libboost-dev libboost-context-dev libfmt-dev libspdlog-dev libyaml-cpp-dev libminizip-dev zlib1g-dev libexpat1-dev
  nlohmann-json3-dev libcli11-dev libsundials-dev libhdf5-dev libgtest-dev libgmock-dev libbenchmark-dev
  python3-dev python3-numpy python3-pytest python3-mypy pybind11-dev pkg-config)

# need_packages NAME...: installs those that are missing (Debian); silent where there is nothing to do.
need_packages() {
  local missing=() package
  if ! command -v dpkg-query >/dev/null; then
    echo "This is no Debian system; these packages, or their like, are assumed to be installed: $*" >&2
    return
  fi
  for package in "$@"; do
    [ "$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] ||
      missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  local root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || {
      echo "Missing: ${missing[*]}. As root: apt-get install --no-install-recommends ${missing[*]}" >&2
      exit 3
    }
    root=(sudo)
  fi
  echo "Installing ${missing[*]}"
  local log
  log=$(mktemp)
  local apt=("${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq)
  if ! { "${apt[@]}" update &&
    "${apt[@]}" install --yes --no-remove --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    exit 3
  fi
  rm -f "$log"
}

# build PRESET [TARGET...]: configures and builds, with ccache where it is installed. Progress goes to a terminal only.
build() {
  local preset=$1 launcher=() targets=() quiet=(--quiet)
  shift
  ! command -v ccache >/dev/null || launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  [ $# -eq 0 ] || targets=(--target "$@")
  cmake --preset "$preset" --log-level=WARNING "${launcher[@]}" >/dev/null
  [ ! -t 1 ] || quiet=()
  cmake --build --preset "$preset" --parallel "$(nproc)" "${targets[@]}" -- "${quiet[@]}"
}
