// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The pages of a session: metrics.json for programs, report.html for people.
#pragma once

#include <string>
#include <vector>

#include "adit/slam/slam.hpp"

namespace adit {

/// metrics.json of a session: robots, pairs and maps. It holds nothing that needs ground truth; `adit
/// evaluate` adds the key `evaluation`.
[[nodiscard]] std::string session_metrics(const SlamRun& run);

/// report.html of a session: what was merged, by which loops, and why or why not.
[[nodiscard]] std::string session_page(const Session& session);

/// What ran, one line per fact: how each robot was mapped, under which keyframe policy, from what.
[[nodiscard]] std::vector<std::string> what_ran(const Provenance& provenance);

}  // namespace adit
