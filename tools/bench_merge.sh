#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Measures which robots' maps are merged, refused or merged wrongly over the worlds of bench/merge/worlds.toml, and writes
# the section "Merging" of docs/results.md; then how false loops are found in the pose graphs of bench/merge/graphs.toml, for
# the section "False loops". Arguments go to `adit merge-study`, and to the last two below where these are asked for; for example
#   tools/bench_merge.sh --keyframes all,tunnel_filter --groups tuning
#   tools/bench_merge.sh --only zab-1,tiles-1 --threads 1 --set back_end.min_loops=3
# build/merge keeps the robots' maps, so that a second run starts behind the odometry, and the results of all runs: worlds
# and policies that a run leaves out keep theirs.
#   ADIT_MERGE_FRESH=1    drives all worlds anew: needed after a change of simulation, odometry, keyframes or descriptors
#   ADIT_MERGE_PAGE=FILE  writes the tables into that page instead
#   ADIT_MERGE_LOOPS=0    leaves the pose graphs out
#   ADIT_MERGE_CURVES=1   first measures the effects of bench/merge/effects.toml one by one, into the section "merge-curves"
#   ADIT_MERGE_CALIBRATION=1  first compares the stated rate of wrong merges with the observed one; into the section
#                             "merge-calibration" where ADIT_MERGE_PAGE is given, as docs/results.md has none, with the
#                             figure merge_calibration.svg in figures/ beside that page
set -euo pipefail
cd "$(dirname "$0")/.."
tools/setup.sh
cmake --preset release >/dev/null
cmake --build --preset release --target adit_program
[ -z "${ADIT_MERGE_FRESH:-}" ] || rm -rf build/merge/maps
page="${ADIT_MERGE_PAGE:-docs/results.md}"
# Before the study: an option that one of these does not know ends the run at once, and not after days.
if [ "${ADIT_MERGE_CURVES:-0}" = 1 ]; then
  build/release/adit merge-curves --worlds bench/merge/worlds.toml --effects bench/merge/effects.toml --out build/merge/curves --page "$page" "$@"
fi
if [ "${ADIT_MERGE_CALIBRATION:-0}" = 1 ]; then
  build/release/adit merge-calibration --worlds bench/merge/worlds.toml --out build/merge ${ADIT_MERGE_PAGE:+--page "$ADIT_MERGE_PAGE"} "$@"
fi
build/release/adit merge-study --worlds bench/merge/worlds.toml --out build/merge --page "$page" "$@"
[ "${ADIT_MERGE_LOOPS:-1}" = 0 ] || build/release/adit loop-study --graphs bench/merge/graphs.toml --out build/merge --page "$page"
