// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A robot's own map in one file, bit for bit, so that work on what comes after the odometry need not drive
/// again. A cache of this version of adit on this machine, not a format to exchange: it changes whenever
/// RobotMap does, and older files are then refused.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "adit/core/result.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

[[nodiscard]] std::string robot_map_bytes(const RobotMap& map);
/// Fails on bytes of another version, that end early or are damaged.
[[nodiscard]] Result<RobotMap> parse_robot_map(std::string_view bytes);

/// The file appears whole or not at all.
Result<> write_robot_map(const std::filesystem::path& path, const RobotMap& map);
Result<RobotMap> read_robot_map(const std::filesystem::path& path);

}  // namespace adit
