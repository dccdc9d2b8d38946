#!/usr/bin/env bash
# tidy.sh [FILE...]: clang-tidy on these sources, or on all of the project's; needs a configured release build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if [ $# -gt 0 ]; then
  printf '%s\0' "$@"
else
  # Sources the release build does not compile (out-of-tree examples, plugins made to be bad) have no flags to check with.
  git ls-files -z --cached --others --exclude-standard '*.cpp' |
    grep -zxFf <(grep -o "\"file\": \"$PWD/[^\"]*" build/release/compile_commands.json | sed "s|.*\"$PWD/||" | sort -u)
fi | xargs -0 -r -n 4 -P "$(nproc)" clang-tidy -p build/release --quiet 2> >(grep -vE '^[0-9]+ warnings? generated\.$' >&2)
