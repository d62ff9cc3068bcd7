// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "command_line.hpp"

namespace adit::app {

/// The keyframe policies of those names; an unknown one, or none, is wrong usage.
inline std::vector<KeyframeSelection> policies_of(const std::vector<std::string>& names) {
  if (names.empty()) usage_error("--keyframes: name at least one policy");
  std::vector<KeyframeSelection> policies;
  for (const std::string& name : names) {
    const Result<KeyframeSelection> policy = keyframe_selection(name);
    if (!policy) usage_error(policy.error().message);
    policies.push_back(*policy);
  }
  return policies;
}

}  // namespace adit::app
