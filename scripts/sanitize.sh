#!/usr/bin/env bash
# sanitize.sh [CTEST OPTION...]: builds the asan preset (address and undefined-behaviour sanitizers) and runs its tests.
# sanitize.sh --threads [MODELS]: the tests of hosts, 1,000 models made, stepped and destroyed on four threads among them,
# under the leak sanitizer, which needs no other build than the release; under the thread sanitizer with assertions; and
# under the address and undefined-behaviour sanitizers with clang. The last two build what hosts need alone.
# sanitize.sh --fuzz [SECONDS [TARGET...]]: libFuzzer under the latter two, so long (600) for each target of tests/fuzz.
# What it finds stands in build/fuzz/found; the targets that found nothing, in docs/measured/fuzz.txt.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}"
case ${1:-} in
--threads)
  need_packages clang libclang-rt-dev lld
  build release test-host
  build tsan test-host
  build fuzz test-host
  export WITHY_MODELS=${2:-1000} TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1
  LD_PRELOAD=$(gcc -print-file-name=liblsan.so) build/release/bin/test-host --gtest_brief=1
  build/tsan/bin/test-host --gtest_brief=1
  build/fuzz/bin/test-host --gtest_brief=1
  ;;
--fuzz)
  need_packages clang libclang-rt-dev lld
  build fuzz withy-fuzz
  seconds=${2:-600}
  targets=("${@:3}")
  [ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls tests/fuzz/corpus)
  mkdir -p build/fuzz/found/rows
  fuzz() {
    local target=$1 log=build/fuzz/found/$1.log
    local corpora=("build/fuzz/found/$target" "tests/fuzz/corpus/$target")
    [ "$target" != scene ] || corpora+=(scenes)
    mkdir -p "${corpora[0]}"
    rm -f "build/fuzz/found/rows/$target"
    # Entropic: its bookkeeping of 85,000 features takes more than half of the time of such calls.
    WITHY_FUZZ=$target build/fuzz/bin/withy-fuzz -max_total_time="$seconds" -timeout=60 -rss_limit_mb=4096 \
      -entropic=0 -print_final_stats=1 -artifact_prefix="build/fuzz/found/$target-" "${corpora[@]}" >"$log" 2>&1 || {
      echo "$target:"
      tail -n 40 "$log"
      return 1
    }
    printf '%s\t%s\t%s\n' "$target" "$seconds" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" |
      tee "build/fuzz/found/rows/$target"
  }
  # As many side by side as there are cores.
  for target in "${targets[@]}"; do
    while [ "$(jobs -pr | wc -l)" -ge "$(nproc)" ]; do wait -n || true; done
    fuzz "$target" &
  done
  wait
  for target in "${targets[@]}"; do [ -e "build/fuzz/found/rows/$target" ] || exit 1; done
  source scripts/measured.sh
  { printf 'target\tseconds\texecutions\n' && cat build/fuzz/found/rows/*; } |
    record_table fuzz "scripts/sanitize.sh --fuzz"
  ;;
*)
  build asan
  ctest --preset asan --parallel "$(nproc)" "$@"
  ;;
esac
