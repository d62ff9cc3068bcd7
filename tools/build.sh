#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Configures and builds: tools/build.sh PRESET [TARGET...]. One line of progress on a terminal, none elsewhere; what
# compilers say is shown in full. CMAKE_ARGS holds further arguments of the configuration.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=$1
shift
tools/setup.sh
folder=build/$preset
started=$SECONDS
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# Ninja configures again by itself, but not where the presets have changed.
if ! cmp -s CMakePresets.json "$folder/CMakePresets.json" || [ -n "${CMAKE_ARGS:-}" ]; then
  # shellcheck disable=SC2086  # several arguments in one variable
  cmake --preset "$preset" ${CMAKE_ARGS:-} >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
  cp CMakePresets.json "$folder"
fi
if [ -t 1 ]; then
  NINJA_STATUS='build: %f of %t, %es  ' ninja -C "$folder" "$@"
else
  ninja -C "$folder" --quiet "$@"
fi
took=$((SECONDS - started))
[ "$took" -lt 2 ] || echo "build: $folder is ready after $took s"
