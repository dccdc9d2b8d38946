#!/usr/bin/env bash
# test.sh [OPTION...]: builds the release preset and runs every test, by ctest with these options; installs what is
# missing first.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
# Three tests ask other programs to read, to draw and to run what withy writes; without them they are left out.
need_packages "${build_packages[@]}" hdf5-tools librsvg2-bin zsh
build release
# One more than there are processors: some tests wait, for a browser, a clock or a process that is to be killed.
ctest --preset release --parallel $(($(nproc) + 1)) --progress "$@" || status=$?
# A suite that passes may have left out a test.
awk '/: Skipped$/ { getline; print "left out: " $0 }' build/release/Testing/Temporary/LastTest.log | sort -u
exit "${status:-0}"
