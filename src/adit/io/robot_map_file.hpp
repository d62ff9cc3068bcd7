// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A robot's own map in one file, bit for bit, so that work on what comes after the odometry need not drive
/// again. Sessions keep one per robot. The layout has a number, which its first line ends with, and a
/// checksum; adit reads every layout from 7 up to its own (tests/conformance).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "adit/core/result.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// The bytes of the file, in adit's own layout.
[[nodiscard]] std::string robot_map_bytes(const RobotMap& map);
/// Fails on bytes of a layout that it does not know, that end early or are damaged.
[[nodiscard]] Result<RobotMap> parse_robot_map(std::string_view bytes);

/// The file appears whole or not at all.
Result<> write_robot_map(const std::filesystem::path& path, const RobotMap& map);
/// Fails like parse_robot_map. Errors name the file.
Result<RobotMap> read_robot_map(const std::filesystem::path& path);

}  // namespace adit
