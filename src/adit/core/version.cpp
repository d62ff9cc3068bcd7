// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/version.hpp"

namespace adit {
std::string_view version() { return ADIT_VERSION; }
}  // namespace adit
