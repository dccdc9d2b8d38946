#!/usr/bin/env bash
# sanitize.sh [CTEST OPTION...]: builds the asan preset (address and undefined-behaviour sanitizers) and runs its tests.
# sanitize.sh --threads [MODELS]: makes, steps and destroys 1,000 models on four threads under the thread sanitizer, which
# builds what hosts need alone, and under the leak sanitizer, which needs no other build than the release.
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
test='HostedSimulation.*threads*'
LD_PRELOAD=$(gcc -print-file-name=liblsan.so) build/release/bin/test-host --gtest_brief=1 --gtest_filter="$test"
build/tsan/bin/test-host --gtest_brief=1 --gtest_filter="$test"
