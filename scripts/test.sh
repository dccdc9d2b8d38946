#!/usr/bin/env bash
# Builds the release preset and runs every test; installs what is missing first.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}"
build release
ctest --preset release --parallel "$(nproc)" --progress "$@"
