#!/usr/bin/env bash
# tidy.sh [FILE...]: clang-tidy on these sources, or on all but the tests; needs a configured release build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -gt 0 ] || mapfile -t files < <(git ls-files --cached --others --exclude-standard '*.cpp' ':!tests')
# The build's flags are those of g++: clang need not know all of its warnings. What it counts in system headers is noise.
printf '%s\0' "${files[@]:-$@}" |
  xargs -0 -n 2 -P "$(nproc)" clang-tidy -p build/release --quiet --extra-arg=-Wno-unknown-warning-option \
    2> >(grep -vE '^[0-9]+ warnings? generated\.$' >&2)
