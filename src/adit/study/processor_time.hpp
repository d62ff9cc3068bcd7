// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <ctime>

namespace adit {

/// Processor time of all threads so far, seconds: what a decision costs, whatever else the machine does
/// meanwhile.
[[nodiscard]] inline double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace adit
