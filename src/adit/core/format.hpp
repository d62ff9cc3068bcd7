// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The one place that includes fmt: GCC 12 has no std::format yet. Include it from .cpp files only.
#pragma once

#include <fmt/format.h>

namespace adit {
using fmt::format;
}  // namespace adit
