#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Format, layers, length of functions, paper map, descriptions of public symbols, and clang-tidy on the library, the program
# and the examples as far as they changed since the last release: the newest tag v*, or the commit that .ci/last-release
# names. Where the clone holds neither, clang-tidy reads every file.
#   tools/lint.sh [FILE...]     clang-tidy on those files only, tests too
#   ADIT_LINT_ANALYZER=0        without clang's path-sensitive analyzer, which doubles the time
set -euo pipefail
cd "$(dirname "$0")/.."
tools/setup.sh
mapfile -t sources < <(git ls-files '*.hpp' '*.cpp')
clang-format --dry-run --Werror "${sources[@]}"
tools/check_layers
tools/check_functions
tools/check_paper_map
tools/api.sh

last_release() {
  local name
  name=$(git describe --tags --abbrev=0 --match 'v*' 2>/dev/null) || name=$(sed '/^#/d' .ci/last-release)
  git rev-parse --quiet --verify "$name^{commit}" || true
}

# The first .cpp file that includes a header; nothing where none does.
including() { git grep -lF "\"$1\"" -- 'src/*.cpp' 'apps/*.cpp' 'examples/*.cpp' ':!*_test.cpp' | head -1 || true; }

code_of() { sed -E '/NOLINT/!s,(^|[[:space:]])//.*,,' | tr -d '[:space:]'; }
# Whether more than comments of a file changed.
has_new_code() { [ "$(git show "$1:$2" 2>/dev/null | code_of)" != "$(code_of <"$2")" ]; }

# The .cpp files whose compilation shows clang-tidy all that changed: those that changed, and for a header the file of its
# own name, or the first that includes it.
files_to_tidy() {
  local base=$1 file own
  { git diff --name-only --diff-filter=d "$base" -- '*.cpp' '*.hpp'; git ls-files -o --exclude-standard '*.cpp' '*.hpp'; } |
    grep '^src/\|^apps/\|^examples/' | grep -v '_test\.cpp$' | sort -u | while read -r file; do
      has_new_code "$base" "$file" || continue
      case $file in
        *.cpp) echo "$file" ;;
        *)
          own=${file%.hpp}.cpp
          if [ -f "$own" ]; then echo "$own"; else including "${file#src/}"; fi ;;
      esac
    done | sort -u
}

base=$(last_release)
if [ $# -gt 0 ]; then
  files=("$@")
elif [ -n "$base" ]; then
  mapfile -t files < <(files_to_tidy "$base")
else
  mapfile -t files < <(git ls-files 'src/*.cpp' 'apps/*.cpp' 'examples/*.cpp' ':!*_test.cpp')
fi
[ ${#files[@]} -gt 0 ] || { echo "lint: no C++ file changed since ${base:0:7}"; exit 0; }

# clang-tidy reads the precompiled headers of a build by clang: without them it reads Eigen for each file again.
tools/build.sh lint adit_precompiled adit_precompiled_kernels adit_precompiled_test
checks=()
[ "${ADIT_LINT_ANALYZER:-1}" != 0 ] || checks=(--checks=-clang-analyzer-*)
echo "lint: clang-tidy on ${#files[@]} files${base:+ changed since ${base:0:7}}"
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy -p build/lint --quiet "${checks[@]}" \
  2> >(grep -v 'warnings\? generated\.$\|^Suppressed' >&2 || true)
