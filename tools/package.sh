#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Builds the Debian packages libadit, libadit-dev, adit and python3-adit into build/package/packages.
set -euo pipefail
cd "$(dirname "$0")/.."
tools/build.sh package
rm -rf build/package/packages
log=$(mktemp)
trap 'rm -f "$log"' EXIT
cpack --config build/package/CPackConfig.cmake >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
ls build/package/packages/*.deb
