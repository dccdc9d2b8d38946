#!/usr/bin/env bash
# Builds the release preset and runs every test; installs what is missing first.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
# Two tests ask other programs to read and to draw what withy writes; without them they are left out.
need_packages "${build_packages[@]}" hdf5-tools librsvg2-bin
build release
ctest --preset release --parallel "$(nproc)" --progress "$@"
