#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Runs the tests of a build: tools/test.sh PRESET [ctest arguments...]. One line of progress on a terminal; what failed or
# was skipped, with its output, and ctest's summary.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=$1
shift
arguments=(--preset "$preset" -j "$(nproc)" --no-tests=error "$@")
# ctest ignores an expression that it cannot read, and runs every test.
if ctest "${arguments[@]}" -N 2>&1 | grep '^RegularExpression::compile'; then
  echo "test: ctest cannot read one of the expressions (it knows nine groups in one): $*" >&2
  exit 2
fi
if [ -t 1 ]; then exec ctest --progress "${arguments[@]}"; fi
# Elsewhere than on a terminal ctest prints two lines for each test: those of tests that passed are left out.
ctest "${arguments[@]}" | sed -uE '/^ *Start +[0-9]+: /d; /^ *[0-9]+\/[0-9]+ Test +#[0-9]+: .* Passed +[0-9.]+ sec$/d'
