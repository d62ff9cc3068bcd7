# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# A thin front: each target installs what it needs (tools/setup.sh does nothing where all is there) and builds.
.DEFAULT_GOAL := build
.PHONY: build demo test bench bench-merge bench-uncertainty lint docs package clean

build:
	@tools/build.sh release adit_program

demo: build
	@tools/demo.sh

test:
	@tools/build.sh release
	@tools/test.sh release

bench:
	@tools/bench.sh $(BENCH)

bench-merge:
	@tools/bench_merge.sh $(BENCH)

bench-uncertainty:
	@tools/bench_uncertainty.sh $(BENCH)

lint:
	@tools/lint.sh

docs: build
	@tools/docs.sh

package:
	@tools/package.sh

clean:
	rm -rf build
