# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# A thin front: each target installs what it needs (tools/setup.sh does nothing where all is there) and builds.
.DEFAULT_GOAL := build
.PHONY: build demo test bench bench-merge lint docs clean

build/%/build.ninja: CMakeLists.txt CMakePresets.json
	@tools/setup.sh
	cmake --preset $*

build: build/release/build.ninja
	@tools/setup.sh
	cmake --build --preset release

demo: build
	tools/demo.sh

test: build
	ctest --preset release -j 2

bench:
	tools/bench.sh $(BENCH)

bench-merge:
	tools/bench_merge.sh $(BENCH)

lint: build
	tools/lint.sh

docs: build
	tools/docs.sh

clean:
	rm -rf build
