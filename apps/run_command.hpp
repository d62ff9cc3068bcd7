// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

#include "adit/core/result.hpp"

namespace adit::app {

/// Runs the body of a command with progress on the terminal and signals that cancel it; prints why it failed
/// in one line on stderr.
/// @returns the exit code: 0 done, 1 failed, 128 + the number of the signal that cancelled it (130 after
/// Ctrl-C, 143 after SIGTERM). Complaints about the usage pass through as CLI11's exceptions.
[[nodiscard]] int run_command(const std::string& name, const std::function<Result<>()>& body);

}  // namespace adit::app
