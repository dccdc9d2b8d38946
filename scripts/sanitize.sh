#!/usr/bin/env bash
# sanitize.sh [CTEST OPTION...]: builds the asan preset (address and undefined-behaviour sanitizers) and runs its tests.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}"
build asan
ctest --preset asan --parallel "$(nproc)" "$@"
