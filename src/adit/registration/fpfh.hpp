// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Fast point feature histograms (Rusu, Blodow, Beetz, "Fast Point Feature Histograms for 3D Registration",
/// ICRA 2009).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "adit/geometry/normals.hpp"
#include "adit/geometry/radius_search.hpp"
#include "adit/registration/features.hpp"

namespace adit {

/// The bins (0 to 10) that one pair of oriented points falls into: of the angle theta of the normals about
/// the line, of alpha and of phi. Symmetric: the point whose normal is closer to the line is the source (Rusu
/// 2009, section II). None when a normal lies along the line, or both points are the same.
[[nodiscard]] std::optional<std::array<int, 3>> pair_feature_bins(const Eigen::Vector3f& point_i,
                                                                  const Eigen::Vector3f& normal_i,
                                                                  const Eigen::Vector3f& point_j,
                                                                  const Eigen::Vector3f& normal_j);

/// The descriptors of all points, and which of them are usable (at least 3 pair features). The pairs are
/// those within the feature radius; points whose surface is not `valid` take no part.
struct FpfhResult {
  std::vector<Descriptor> descriptors;  ///< One per point; zero where there is no pair feature.
  std::vector<bool> usable;             ///< One per point.
};
/// `surface`: of each point. `pairs`: of these points. Throws ContractViolation where sizes differ.
[[nodiscard]] FpfhResult compute_fpfh(const std::vector<Eigen::Vector3f>& points,
                                      const std::vector<SurfacePoint>& surface, const NeighborPairs& pairs);

}  // namespace adit
