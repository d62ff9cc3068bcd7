#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# tools/bench.sh must not record figures from a tree with uncommitted changes, and must go on from a clean one.
#   refuses_uncommitted.sh SOURCE_DIR
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/tools"
cp "$1/tools/bench.sh" "$folder/tools/"
printf '#!/bin/sh\necho "set-up reached"\nexit 7\n' > "$folder/tools/setup.sh"  # ends a run that gets so far
chmod +x "$folder/tools/setup.sh"
cd "$folder"
git init -q
git add -A
git -c user.name=test -c user.email=test@example.org commit -qm "all of it"
fail() { echo "refuses_uncommitted: $1: '$said' (exit $status)" >&2; exit 1; }
run() { status=0; said=$(ADIT_BENCH_RECORD=1 tools/bench.sh 2>&1) || status=$?; }

run
[ "$status" = 7 ] && [ "$said" = "set-up reached" ] || fail "a clean tree may be recorded"
echo changed >> tools/setup.sh
run
[ "$status" = 1 ] && [[ "$said" == *"uncommitted changes"* ]] || fail "a changed file must be refused"
git checkout -q tools/setup.sh
touch a_new_file
run
[ "$status" = 1 ] && [[ "$said" == *"uncommitted changes"* ]] || fail "a new file must be refused"
