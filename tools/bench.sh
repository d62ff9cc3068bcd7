#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Builds and runs the benchmarks beside the peers that Debian ships, and writes docs/performance.md.
#   tools/bench.sh [FILTER...]        only the cases whose names hold one of these (the page keeps the others' rows)
#   ADIT_BENCH_PEERS=FOLDER           further peers, see bench/README.md
#   ADIT_BENCH_BASE=COMMIT            an older version of adit runs in turns with this one, as side "previous"
#   ADIT_BENCH_RECORD=1               these figures become the recorded ones that later runs show beside theirs
set -euo pipefail
cd "$(dirname "$0")/.."
tools/setup.sh bench
build() {  # SOURCE BUILD
  cmake -S "$1" -B "$2" -G Ninja -DCMAKE_BUILD_TYPE=Release -DADIT_BUILD_BENCH=ON -DADIT_BUILD_TESTS=OFF >/dev/null
  cmake --build "$2" --target adit_bench adit_program
}
build . build/bench
arguments=()
if [ -n "${ADIT_BENCH_BASE:-}" ]; then
  [ -d build/base ] || git worktree add --detach build/base "$ADIT_BENCH_BASE"
  git -C build/base checkout -q --detach "$ADIT_BENCH_BASE"
  build build/base build/base/build/bench
  arguments+=(--base build/base/build/bench/bench/adit_bench)
fi
bench=build/bench/bench/adit_bench
if [ -n "${ADIT_BENCH_PEERS:-}" ]; then
  "$bench" export build/bench/inputs
  arguments+=(--peers "$ADIT_BENCH_PEERS" --inputs build/bench/inputs)
fi
# Debian's OpenBLAS and CHOLMOD start threads of their own and mistake new processors for old ones: with these settings
# Ceres is twice as fast. Ours does not read them.
export OMP_THREAD_LIMIT=1 OPENBLAS_NUM_THREADS=1 OPENBLAS_CORETYPE=${OPENBLAS_CORETYPE:-Haswell}
results=build/bench/results.json
[ -f "$results" ] || cp bench/recorded.json "$results" 2>/dev/null || true
"$bench" run "$@" --version-name "$(git describe --always --dirty)" --results "$results" --recorded bench/recorded.json \
  "${arguments[@]}"
"$bench" page --results "$results" --recorded bench/recorded.json --frame bench/performance.in.md \
  --out docs/performance.md
[ -z "${ADIT_BENCH_RECORD:-}" ] || cp "$results" bench/recorded.json
