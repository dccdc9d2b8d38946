#!/usr/bin/env bash
# tidy.sh [FILE...]: clang-tidy on these sources, or on all but the tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -gt 0 ] || mapfile -t files < <(git ls-files --cached --others --exclude-standard '*.cpp' ':!tests')
# A configuration of its own, not built: clang does not read what g++ precompiles.
cmake --preset release -B build/tidy -DWITHY_PRECOMPILE_HEADERS=OFF --log-level=WARNING >/dev/null
# One flag of g++ it refuses to read (core/CMakeLists.txt).
sed -i 's/ -flive-range-shrinkage//' build/tidy/compile_commands.json
# The build's flags are those of g++: clang need not know all of its warnings. What it counts in system headers is noise.
printf '%s\0' "${files[@]:-$@}" |
  xargs -0 -n 2 -P "$(nproc)" clang-tidy -p build/tidy --quiet --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-unused-command-line-argument \
    2> >(grep -vE '^[0-9]+ warnings? generated\.$' >&2)
