// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "adit/core/records.hpp"

namespace adit {

/// Why no scan of the recording could be used, one sentence: what its first scan shows, and what that needs.
/// A cloud from within a narrow cone is that of a depth camera.
[[nodiscard]] std::string why_nothing_mapped(const Recording& recording);

}  // namespace adit
