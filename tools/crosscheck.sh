#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Lets programs that others wrote read what adit reads and writes (from npm, so node, npm and chromium have to be there):
# - bags, message by message: @mcap/core, @foxglove/rosbag, @foxglove/rosmsg2-serialization and sqlite. What adit wrote is
#   decoded by the definitions in the file and encoded again, to the same bytes;
# - one map as LAS, PCD and PLY: copc and loaders.gl;
# - a session with its layout: Foxglove Studio, whose picture is then results/studio.png.
#   tools/crosscheck.sh [BAG...]    besides the files of tests/conformance, what adit writes, and the shared data where present
set -euo pipefail
cd "$(dirname "$0")/.."
command -v npm >/dev/null || { echo "crosscheck: npm is missing: install the Debian packages nodejs and npm" >&2; exit 1; }
command -v chromium >/dev/null || { echo "crosscheck: chromium is missing: install the Debian package chromium" >&2; exit 1; }
tools/build.sh release adit_program adit_dump_bag
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp tests/crosscheck/package.json tests/crosscheck/{dump.mjs,clouds.mjs,studio.mjs,studio.html} "$work"
npm --prefix "$work" install --no-package-lock --no-audit --no-fund --silent
failed=0
same() {  # BAG [--written]
  if [[ $1 == *.db3 ]]; then
    python3 tests/crosscheck/dump_db3.py "$1" >"$work/theirs"
  else
    node "$work/dump.mjs" "${@:2}" "$1" >"$work/theirs"
  fi
  build/release/tests/adit_dump_bag "$1" >"$work/ours"
  if [ -s "$work/ours" ] && cmp -s "$work/ours" "$work/theirs"; then
    echo "crosscheck: $1: $(wc -l <"$work/ours") messages are the same"
  else
    echo "crosscheck: $1: adit and the other reader differ:" >&2
    diff "$work/ours" "$work/theirs" | head -6 >&2 || true
    failed=1
  fi
}
adit=build/release/adit
"$adit" world --preset mine --seed 1 --out "$work/mine" >/dev/null
for robot in robot_0 robot_1; do
  "$adit" simulate --routes "$work/mine/routes.yaml" --lidar vlp-16 --robot $robot --out "$work/mine" >/dev/null
done
"$adit" slam "$work"/mine/robot_[01].mcap --out "$work/session" >/dev/null
"$adit" convert "$work/session" "$work/session.mcap"
for bag in "$work/mine/robot_0.mcap" "$work/session.mcap"; do same "$bag" --written; done
for bag in tests/conformance/*.{mcap,bag,db3} ../shared/data/recordings/{*.bag,*.db3,*/*.mcap} "$@"; do
  [ ! -f "$bag" ] || same "$bag"
done
for format in las pcd ply; do "$adit" convert "$work/session" "$work/map.$format"; done
node "$work/clouds.mjs" "$work"/map.{las,pcd,ply} || failed=1
node "$work/studio.mjs" "$work/session.mcap" "$work/studio.png" || failed=1
mkdir -p results
[ ! -f "$work/studio.png" ] || cp "$work/studio.png" results/studio.png
exit "$failed"
