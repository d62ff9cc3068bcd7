#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Makes the reference of the C++ interface, build/api/html, and fails where a header that tools/api_headers.txt lists has a
# public symbol without a description.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v doxygen >/dev/null || { echo "api: install the Debian package doxygen" >&2; exit 1; }
mkdir -p build
log=build/api.log
doxygen docs/Doxyfile 2>"$log" || { tail "$log" >&2; exit 1; }
mapfile -t headers < <(grep -v '^#' tools/api_headers.txt)
found=0
for header in "${headers[@]}"; do
  [ -f "src/adit/$header" ] || { echo "api: tools/api_headers.txt lists $header, which does not exist" >&2; exit 1; }
  if grep "/src/adit/$header:.*is not documented" "$log"; then found=1; fi
done
echo "api: build/api/html/index.html; ${#headers[@]} headers are described in full; elsewhere $(grep -c 'is not documented' "$log") symbols have no sentence of their own"
exit "$found"
