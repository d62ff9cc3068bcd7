#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Takes the pictures of README.md and docs/results.md from a study: tools/figures.sh results/zab
set -euo pipefail
study=${1:?usage: tools/figures.sh STUDY_DIRECTORY}
cd "$(dirname "$0")/.."
mkdir -p docs/figures
take() { cp "$study/figures/$1.png" "docs/figures/$2.png"; }
take routes routes
take odometry_ate odometry_ate
take merged_map merged_map
take graph_robot_0_robot_1_all_initial graph_initial
take graph_robot_0_robot_1_all_optimized graph_optimized
take ate_robot_1_robot_3_tunnel_filter ate_pair
