// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace adit::bench {

/// One side of a case (or a growth curve at one size, where `side` is the size) as a process: prepares, says
/// `ready` or `skip REASON`, then answers each line `run` with one of JSON: {"seconds": s, "figures": {...}}.
/// It uses as many threads as the case has (ADIT_BENCH_THREADS, where the driver sets that). Programs outside
/// this repository take part by speaking the same (bench/README.md). Returns the exit status.
int serve(const std::string& name, const std::string& side);

}  // namespace adit::bench
