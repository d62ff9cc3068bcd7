// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "command_line.hpp"

namespace adit::app {

/// What --keyframes takes.
inline std::vector<std::string> policy_names() {
  std::vector<std::string> names;
  for (const KeyframeSelection policy : kKeyframeSelections) names.emplace_back(to_string(policy));
  return names;
}

/// The keyframe policies of those names, which the option has checked; none is wrong usage.
inline std::vector<KeyframeSelection> policies_of(const std::vector<std::string>& names) {
  if (names.empty()) usage_error("--keyframes: name at least one policy");
  std::vector<KeyframeSelection> policies;
  for (const std::string& name : names) policies.push_back(*keyframe_selection(name));
  return policies;
}

}  // namespace adit::app
