// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

#include "adit/core/records.hpp"

namespace adit {

/// Whether not one scan was registered, only predicted, though there was something to register: nothing comes
/// of a map of these. `counts`: of the scans, by their status.
[[nodiscard]] bool is_nothing_mapped(const std::map<StepStatus, int>& counts);

/// Why no scan of the recording could be used, one sentence: what its first scan shows, and what that needs.
/// A cloud from within a narrow cone is that of a depth camera.
[[nodiscard]] std::string why_nothing_mapped(const Recording& recording);

}  // namespace adit
