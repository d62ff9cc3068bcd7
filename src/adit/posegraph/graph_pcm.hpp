// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "adit/posegraph/pcm.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// PCM over a whole graph: the loops between each two of its odometry paths (`odometry_paths`), and those
/// within each path, form one set, of which the largest consistent subset is kept.
struct GraphPcm {
  std::vector<double> edge_weights;  ///< One per edge: 0 for loops that are not kept, else 1.
  bool optimal = true;               ///< Every set is proven largest within `max_search_nodes`.
};
/// Time and memory grow with the square of the number of loops between two paths. Throws ContractViolation
/// when an odometry edge or a loop has a singular information matrix.
[[nodiscard]] GraphPcm graph_pcm(const PoseGraph& graph, const PcmConfig& config = {});

}  // namespace adit
