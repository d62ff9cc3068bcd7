// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

/// Multi-robot LiDAR SLAM for tunnels, mines and caves.
namespace adit {
/// "0.1.0", from the build.
[[nodiscard]] std::string_view version();
}  // namespace adit
