// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Pruning of correspondences by mutual consistency: a rigid motion keeps distances, so two correct
/// correspondences (i, j) have | |a_i - a_j| - |b_i - b_j| | within the noise (ROBIN: Shi, Yang, Carlone,
/// ICRA 2021; used by KISS-Matcher, section III-D).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "adit/geometry/bit_graph.hpp"

namespace adit {

/// Vertex k is the correspondence of points_a[k] and points_b[k]; an edge joins two whose distances in the
/// two clouds differ by at most `noise_bound` metres. Two correspondences of one point with two distant
/// points are thereby not joined. Throws ContractViolation when the spans differ in length.
[[nodiscard]] BitGraph consistency_graph(std::span<const Eigen::Vector3f> points_a,
                                         std::span<const Eigen::Vector3f> points_b, float noise_bound);

/// The vertices of the innermost k-core, ascending: the largest k such that vertices with k neighbours among
/// themselves exist (Batagelj and Zaversnik, 2003). It holds every clique of more than k vertices. Empty for
/// an empty graph.
[[nodiscard]] std::vector<std::uint32_t> max_core(const BitGraph& graph);

}  // namespace adit
