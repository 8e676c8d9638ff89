#!/usr/bin/env bash
# The numerical tests with several kernels of the libraries, each on one and on two threads.
#   tests/kernels.sh BUILD [ROW...]      runs the rows with these names, by default all
#   tests/kernels.sh --known [ROW...]    fails if a name is not in the table
set -euo pipefail

say() { printf '%s\n' "isoline: $*" >&2; }

# name | required processor features, as in /proc/cpuinfo | environment | filter for the tests of
# networks, empty for all. For vectors smaller than those of this build, oneDNN has only its reference
# convolution, about a hundred times slower. One test of the U-net then represents all.
one_unet='Unet.CurvatureAlong*:Perceptron*:MeanMatched*:Truncated*:Fourier*:Registry*-*unet*'
avx512=-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ,-AVX512CD
kernels=(
  "prescott|pni|OPENBLAS_CORETYPE=Prescott"
  "haswell|avx2 fma|OPENBLAS_CORETYPE=Haswell"
  "zen|avx2 fma|OPENBLAS_CORETYPE=Zen"
  "skylakex|avx512f avx512bw avx512dq avx512vl|OPENBLAS_CORETYPE=SkylakeX"
  "libc-without-avx512|avx512f|GLIBC_TUNABLES=glibc.cpu.hwcaps=$avx512"
  "libc-without-avx2|avx2|GLIBC_TUNABLES=glibc.cpu.hwcaps=$avx512,-AVX2,-FMA"
  "onednn-sse41|sse4_1|ONEDNN_MAX_CPU_ISA=SSE41|$one_unet"
  "onednn-avx2|avx2|ONEDNN_MAX_CPU_ISA=AVX2|$one_unet"
  "onednn-avx512|avx512f avx512bw avx512dq avx512vl|ONEDNN_MAX_CPU_ISA=AVX512_CORE"
)

# lacking FEATURES: the features that this processor does not have.
lacking() {
  local feature lacks=()
  for feature in $1; do grep -qw -m 1 -- "$feature" /proc/cpuinfo || lacks+=("$feature"); done
  printf '%s' "${lacks[*]}"
}

# test_module MODULE: its tests with the kernels and the threads that test_kernels sets.
test_module() {
  local filter='*'
  [[ $1 != networks || -z $networks ]] || filter=$networks
  env "$setting" ISOLINE_TEST_THREADS="$threads" "$build/tests/$1_tests" \
    --gtest_brief=1 --gtest_filter="$filter" >"$log.$1" 2>&1
}

# test_kernels ROW...: the rows with these names, by default all, each on one and on two threads.
test_kernels() {
  local row name needs setting networks lacks threads log passed=0 failed=0 skipped=0
  local modules=(core networks problems optimizers)
  export -f test_module
  export build setting networks threads log
  for row in "${kernels[@]}"; do
    IFS='|' read -r name needs setting networks <<<"$row"
    [[ $# -eq 0 || " $* " == *" $name "* ]] || continue
    lacks=$(lacking "$needs")
    if [[ -n $lacks ]]; then
      say "skipping $name: this processor has no $lacks"
      skipped=$((skipped + 2))
      continue
    fi
    for threads in 1 2; do
      log=$build/kernels-$name-$threads.log
      local result=passed
      printf '%s\n' "${modules[@]}" |
        xargs -P "$(nproc)" -I% bash -c 'test_module %' || result=failed
      cat "${modules[@]/#/$log.}" >"$log"
      rm -f "${modules[@]/#/$log.}"
      printf '%-22s %d thread(s): %s\n' "$name" "$threads" "$result"
      if [[ $result == passed ]]; then
        passed=$((passed + 1))
      else
        failed=$((failed + 1))
        grep -E '^\[  FAILED  \]|Failure|error' "$log" | sort -u | head -n 20 || tail -n 5 "$log"
        say "the complete log is $log"
      fi
    done
  done
  echo "$passed passed, $failed failed, $skipped skipped"
  [[ $failed -eq 0 && $((passed + skipped)) -gt 0 ]]
}

if [[ $1 == --known ]]; then
  shift
  for name in "$@"; do
    [[ " ${kernels[*]%%|*} " == *" $name "* ]] ||
      { say "no row '$name'; the rows are: ${kernels[*]%%|*}"; exit 1; }
  done
  exit
fi
build=$1
shift
test_kernels "$@"
