// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

namespace adit {

/// The mean of the points of each occupied cubic voxel of that edge, metres; points that are not finite, or
/// absurdly far (beyond 10^6 voxels), are dropped. Means, unlike picked points, hardly depend on how the grid
/// lies, so two views of a surface give similar neighbourhoods. Voxels come in blocks of 4 x 4 x 4:
/// neighbours lie close in memory.
[[nodiscard]] std::vector<Eigen::Vector3f> voxel_means(const std::vector<Eigen::Vector3f>& points,
                                                       float voxel_size);

}  // namespace adit
