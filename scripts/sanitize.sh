#!/usr/bin/env bash
# sanitize.sh [CTEST OPTION...]: builds the asan preset (address and undefined-behaviour sanitizers) and runs its tests.
# sanitize.sh --threads [MODELS]: the tests of hosts, 1,000 models made, stepped and destroyed on four threads among them,
# under the leak sanitizer, which needs no other build than the release, and under the thread sanitizer with assertions,
# which builds what hosts need alone.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}"
if [ "${1:-}" != --threads ]; then
  build asan
  ctest --preset asan --parallel "$(nproc)" "$@"
  exit
fi
build release test-host
build tsan test-host
export WITHY_MODELS=${2:-1000} TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1
LD_PRELOAD=$(gcc -print-file-name=liblsan.so) build/release/bin/test-host --gtest_brief=1
build/tsan/bin/test-host --gtest_brief=1
