// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/odometry/local_map.hpp"

namespace adit {

/// A scan's nearest neighbours in the map (LocalMap::nearest), from one pose to the next. A point whose
/// neighbour was d away, with all others at least c away, keeps it without a search as long as the triangle
/// inequality says that no other can have come nearer: after a motion by m while the new distance to the
/// neighbour is below c - m. That is exact, and most points hardly move in the later iterations of ICP.
class Correspondences {
 public:
  /// Points handled together.
  static constexpr std::size_t kBlock = 256;

  /// Up to kBlock source points p and their residuals r = R^T (T p - q), both in the base frame, so that a
  /// right perturbation of T has the Jacobian [I, -hat(p)] whatever T is, and no lever arm to the map's
  /// origin spoils the conditioning. Places behind the last point hold zeros.
  struct Block {
    std::array<double, kBlock> px, py, pz;
    std::array<double, kBlock> rx, ry, rz;
    std::array<double, kBlock> found;  ///< 1; 0 where there is no neighbour, and then r is 0.
  };

  /// `source` in the base frame; the map must stay as it is while this is used.
  Correspondences(std::span<const Eigen::Vector3f> source, const LocalMap& map, double max_distance);

  [[nodiscard]] std::size_t num_blocks() const { return stride_ / kBlock; }
  /// Block `index` of the source at this pose. Several blocks may be asked for at the same time.
  void residuals(std::size_t index, const Pose& T_map_base, Block& block);

 private:
  /// x of all points, then y, then z: `stride_` floats each.
  using Points = std::vector<float>;

  void search(std::size_t i);

  const LocalMap* map_;
  float max_distance_;
  std::size_t stride_;  ///< Number of points rounded up to whole blocks; what is behind them never counts.
  Points source_;       ///< Base frame.
  Points at_;           ///< The same in the map frame at the last pose.
  Points searched_;     ///< Where the last search for each was made,
  Points neighbour_;    ///< its answer,
  std::vector<float> clearance2_;  ///< and the squares of the bounds of LocalMap::Found.
  std::vector<float> room2_;
};

}  // namespace adit
