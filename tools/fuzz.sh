#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Gives the readers of files arbitrary bytes for SECONDS of processor time each, under the address and undefined-behaviour sanitizers, from
# the small files of tests/conformance and tests/fuzz/seeds and what earlier runs found new:  tools/fuzz.sh SECONDS [EXTENSION...]
# Ends with 1 where a reader failed; the bytes that did it are then in build/fuzz/faults. What was run is in tests/fuzz/README.md.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || { sed -n '4,7s/^# //p' "$0" >&2; exit 2; }
seconds=$1
[[ $seconds =~ ^[1-9][0-9]*$ ]] || { echo "fuzz: SECONDS is a whole number from 1 on, not '$seconds'" >&2; exit 2; }
shift
kinds=("$@")
[ ${#kinds[@]} -gt 0 ] || kinds=(mcap bag db3 pcd ply bin tum csv g2o jrl cbor yaml adit loops control config session metadata georeference beside wire)
tools/build.sh fuzz adit_fuzz_readers
export TMPDIR=${TMPDIR:-/dev/shm} # each input is a file
faults=build/fuzz/faults
mkdir -p "$faults"
failed=()
for kind in "${kinds[@]}"; do
  corpus=build/fuzz/corpus/$kind
  mkdir -p "$corpus"
  for seed in tests/conformance/*."$kind" tests/fuzz/seeds/*."$kind"; do
    [ ! -f "$seed" ] || cp "$seed" "$corpus/"
  done
  [ -n "$(ls -A "$corpus")" ] || { echo "fuzz: no file to begin with: put one into tests/fuzz/seeds/*.$kind" >&2; exit 1; }
  log=build/fuzz/$kind.log
  inputs=0
  used=0
  while [ "$used" -lt "$seconds" ]; do # the fuzzer counts the time on the wall, of which it may get a part only
    # Inputs of up to 64 kB; a compressed one may hold 1 GiB.
    if ! slice=$({ TIMEFORMAT='%U %S'; time ADIT_FUZZ_AS=$kind build/fuzz/tests/adit_fuzz_readers "$corpus" \
        -max_total_time=$((seconds - used)) -max_len=65536 -timeout=10 -rss_limit_mb=4096 -malloc_limit_mb=1100 \
        -artifact_prefix="$faults/$kind-" -print_final_stats=1 >"$log" 2>&1; } 2>&1); then
      failed+=("$kind")
      echo "fuzz: $kind: failed after $inputs inputs; see $log" >&2
      continue 2
    fi
    used=$((used + $(awk '{ ran = $1 + $2; printf "%.0f", ran < 1 ? 1 : ran }' <<<"$slice")))
    ran=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    inputs=$((inputs + ${ran:-0}))
  done
  echo "fuzz: $kind: $inputs inputs in $used s of processor time," \
    "$(sed -n 's/.*DONE *cov: \([0-9]*\) .*/\1/p' "$log") edges reached; none failed"
done
[ ${#failed[@]} -eq 0 ]
