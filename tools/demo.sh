#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# The paper's whole study on the built-in tunnels with a thinned sensor (os2-32: 32 beams, 512 columns).
# The full sensor: build/release/adit study --out results/zab
set -euo pipefail
cd "$(dirname "$0")/.."
build/release/adit study --lidar os2-32 --out demo
echo "Open demo/report.html; figures are in demo/figures."
