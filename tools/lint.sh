#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Format, layers, paper map and clang-tidy. With file names: clang-tidy on those only.
set -euo pipefail
cd "$(dirname "$0")/.."
mapfile -t sources < <(git ls-files '*.hpp' '*.cpp')
clang-format --dry-run --Werror "${sources[@]}"
tools/check_layers
tools/check_paper_map
mapfile -t tidied < <([ $# -gt 0 ] && printf '%s\n' "$@" || git ls-files 'src/*.cpp' 'apps/*.cpp' | grep -v _test.cpp)
printf '%s\n' "${tidied[@]}" | xargs -P "$(nproc)" -n 4 clang-tidy -p build/release --quiet
