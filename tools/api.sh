#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Makes the reference of the C++ interface, build/api/html, and fails where a public symbol of src/adit has no description.
# tools/api_filter.py adds the descriptions that configuration fields have for users.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v doxygen >/dev/null || { echo "api: install the Debian package doxygen" >&2; exit 1; }
tools/api_filter.py --self-test >/dev/null
mkdir -p build
rm -rf build/api
log=build/api.log
doxygen docs/Doxyfile 2>"$log" || { tail "$log" >&2; exit 1; }
# Of a header that the filter cannot read Doxygen sees nothing, and says nothing.
if grep -q '^Traceback' "$log"; then
  grep -A20 -m1 '^Traceback' "$log" >&2
  exit 1
fi
# Doxygen 1.9 finds no scope for specialisations in namespace std.
if other=$(grep -E '(warning|error):' "$log" | grep -v 'is not documented' | grep -v 'scope for class std::hash'); then
  echo "$other" >&2
  exit 1
fi
if undescribed=$(grep 'is not documented' "$log"); then
  sed "s|^$PWD/||; s| warning: | |" <<<"$undescribed" | sort -t: -k1,1 -k2,2n >&2
  echo "api: $(wc -l <<<"$undescribed") public symbols without a description" >&2
  exit 1
fi
echo "api: build/api/html/index.html describes every public symbol of src/adit"
