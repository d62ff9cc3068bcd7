#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Measures whether stated covariances are those of the errors, over worlds of bench/merge/worlds.toml, and writes the section
# "Uncertainty" of docs/results.md. Arguments go to `adit uncertainty-study`. Robots' maps are those of `make bench-merge`:
# build/merge keeps them, ADIT_MERGE_FRESH=1 drives anew.
#   ADIT_UNCERTAINTY_PAGE=FILE  writes the table into that page instead
set -euo pipefail
cd "$(dirname "$0")/.."
tools/setup.sh
cmake --preset release >/dev/null
cmake --build --preset release --target adit_program
[ -z "${ADIT_MERGE_FRESH:-}" ] || rm -rf build/merge/maps
page="${ADIT_UNCERTAINTY_PAGE:-docs/results.md}"
if [ $# -eq 0 ]; then
  set -- --only zab-1,mine-1,metro-1,tiles-1 --lidar os2-32,vlp-16,livox-mid-360 --imu icm-20948,none
fi
build/release/adit uncertainty-study --worlds bench/merge/worlds.toml --out build/merge --page "$page" "$@"
