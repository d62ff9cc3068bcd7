// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// Gives every recording a unique name that can be a folder (core/robot_name): a second `robot_1` becomes
/// `robot_1_2`.
/// @returns one line for each name that changed.
std::vector<std::string> name_robots(std::vector<Recording>& recordings);

}  // namespace adit
