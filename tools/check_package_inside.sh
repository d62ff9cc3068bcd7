#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# What tools/check_package.sh runs in the clean root: the packages with nothing but what they depend on, then a compiler
# for the project outside.
set -euo pipefail
cd /tmp
adit --version
if ldd /usr/bin/adit | grep 'not found'; then exit 1; fi
adit study --quick --out study >study.txt
grep -q 'report:' study.txt
test -s study/report.html
python3 - <<'PYTHON'
import numpy
import adit
robots = adit.simulate({"simulation.lidars": "vlp-16"})
run = adit.odometry(robots[0][:50])
error = adit.ate(run.trajectory, robots[0].truth)
assert error.max < 0.3, error.max
print(f"python: {len(run.trajectory)} scans, error at most {error.max:.3f} m")
PYTHON
apt-get install -y -qq --no-install-recommends cmake g++ ninja-build >apt.log 2>&1 || { tail apt.log >&2; exit 1; }
cmake -G Ninja -S consumer -B consumer/build -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build consumer/build >/dev/null
consumer/build/consumer
