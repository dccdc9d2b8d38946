#!/usr/bin/env bash
# sanitize.sh [CTEST OPTION...]: builds the asan preset (address and undefined-behaviour sanitizers) and runs its tests.
# sanitize.sh --threads [MODELS]: the tests of hosts, 1,000 models made, stepped and destroyed on four threads among them,
# under the leak sanitizer, which needs no other build than the release; under the thread sanitizer with assertions; and
# under the address and undefined-behaviour sanitizers with clang. The last two build what hosts need alone.
# sanitize.sh --fuzz [SECONDS [TARGET...]]: libFuzzer under the latter two, so long (600) for each target of tests/fuzz.
# What it finds stands in build/fuzz/found.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}"
case ${1:-} in
--threads)
  need_packages clang
  build release test-host
  build tsan test-host
  build fuzz test-host
  export WITHY_MODELS=${2:-1000} TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1
  LD_PRELOAD=$(gcc -print-file-name=liblsan.so) build/release/bin/test-host --gtest_brief=1
  build/tsan/bin/test-host --gtest_brief=1
  build/fuzz/bin/test-host --gtest_brief=1
  ;;
--fuzz)
  need_packages clang
  build fuzz withy-fuzz
  seconds=${2:-600}
  targets=("${@:3}")
  [ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls tests/fuzz/corpus)
  for target in "${targets[@]}"; do
    corpora=("build/fuzz/found/$target" "tests/fuzz/corpus/$target")
    [ "$target" != scene ] || corpora+=(scenes)
    mkdir -p "${corpora[0]}"
    echo "$target, $seconds s"
    WITHY_FUZZ=$target build/fuzz/bin/withy-fuzz -max_total_time="$seconds" -timeout=60 -rss_limit_mb=4096 \
      -print_final_stats=1 -artifact_prefix="build/fuzz/found/$target-" "${corpora[@]}" \
      >"build/fuzz/found/$target.log" 2>&1 || {
      tail -n 40 "build/fuzz/found/$target.log"
      exit 1
    }
    grep -E "number_of_executed_units|DONE" "build/fuzz/found/$target.log"
  done
  ;;
*)
  build asan
  ctest --preset asan --parallel "$(nproc)" "$@"
  ;;
esac
