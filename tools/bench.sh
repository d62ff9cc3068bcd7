#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Runs every benchmark; medians of five repetitions.
set -euo pipefail
cd "$(dirname "$0")/.."
for bench in build/bench/bench/*_bench; do
  "$bench" --benchmark_repetitions=5 --benchmark_report_aggregates_only=true
done
