#!/usr/bin/env bash
# memcheck.sh [I/N]: runs the tests of the release build in valgrind, all of them or the I-th part of N, and fails where
# memory is used that is not there or has no value. No second build, so that CI affords a part with each commit. What
# the tests themselves find is not asked: valgrind computes long double in 64 bits, and denormal numbers as they are;
# and it takes operator new in tests that count allocations for one that does not belong to its delete.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages valgrind
part=${1:-0/1}
# Rooms that run in this process and in seconds; valgrind takes forty times as long.
rooms=(bodies dynamics fem formulations integrators loads scene simulation validity)
logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT
grep -q "^WITHY_ANY_PROCESSOR:BOOL=ON" build/release/CMakeCache.txt || {
  echo "memcheck: build/release has no sweeps for any processor: cmake --preset release -DWITHY_ANY_PROCESSOR=ON, and build" >&2
  exit 3
}
for room in "${rooms[@]}"; do
  [ -x "build/release/bin/test-$room" ] || {
    echo "memcheck: there is no build/release/bin/test-$room" >&2
    exit 3
  }
done
# AVX2 off, which takes the sweeps of any processor: valgrind does not know all of it.
export GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2 GTEST_SHARD_INDEX=$((${part%/*} % ${part#*/})) GTEST_TOTAL_SHARDS=${part#*/} \
  GTEST_FILTER='-Fuzz.*'

check() {
  local status=0
  valgrind -q --error-exitcode=99 --show-mismatched-frees=no --log-file="$2/$1.%p" \
    "build/release/bin/test-$1" --gtest_brief=1 >/dev/null 2>&1 ||
    status=$?
  [ "$status" -lt 99 ] && return
  echo "memcheck: test-$1, part $GTEST_SHARD_INDEX of $GTEST_TOTAL_SHARDS (status $status):"
  cat "$2/$1".* | head -n 100
  return 1
}
export -f check
printf '%s\n' "${rooms[@]}" | xargs -P "$(nproc)" -I{} bash -c 'check {} '"$logs" && echo "memcheck: part $part is clean"
