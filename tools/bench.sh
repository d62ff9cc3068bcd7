#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Builds and runs the benchmarks beside the peers that Debian ships, and prints the table.
#   tools/bench.sh [FILTER...]        only the cases whose names hold one of these
#   ADIT_BENCH_PEERS=FOLDER           further peers, see bench/README.md
#   ADIT_BENCH_BASE=COMMIT            an older version of adit runs in turns with this one, as side "previous"
#   ADIT_BENCH_ROUNDS=N               timed runs of each side (9); 1 to see that all cases run
#   ADIT_BENCH_RECORD=1               the figures become the recorded ones, docs/performance.md and README.md are written
#                                     from them: on an idle machine, and from a tree without uncommitted changes only
set -euo pipefail
cd "$(dirname "$0")/.."
record=${ADIT_BENCH_RECORD:-}
if [ -n "$record" ] && [ -n "$(git status --porcelain)" ]; then
  echo "bench: uncommitted changes; commit them first: only a committed version is recorded" >&2
  exit 1
fi
tools/setup.sh bench
build() {  # SOURCE BUILD
  cmake -S "$1" -B "$2" -G Ninja -DCMAKE_BUILD_TYPE=Release -DADIT_BUILD_BENCH=ON -DADIT_BUILD_TESTS=OFF -DADIT_UNITY_BUILD=ON >/dev/null
  cmake --build "$2" --target adit_bench adit_program
}
build . build/bench
arguments=(--rounds "${ADIT_BENCH_ROUNDS:-9}")
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
idle() { awk '{ exit !($1 < 0.5) }' /proc/loadavg; }
if [ -n "$record" ]; then
  for _ in $(seq 30); do idle && break; sleep 10; done  # the build itself was load
  idle || { echo "bench: the machine is not idle (load $(cut -d' ' -f1 /proc/loadavg)); nothing recorded" >&2; exit 1; }
fi
results=build/bench/results.json
"$bench" run "$@" --version-name "$(git describe --always --dirty)" --results "$results" --recorded bench/recorded.json \
  "${arguments[@]}"
if [ -n "$record" ]; then
  "$bench" record --results "$results" --recorded bench/recorded.json
  "$bench" plot --results bench/recorded.json --out docs/figures
  tools/performance_page
fi
