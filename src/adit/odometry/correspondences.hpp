// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/odometry/local_map.hpp"

namespace adit {

/// The nearest neighbours of a scan's points in the map (LocalMap::nearest), from one pose to the next. Each
/// point keeps the candidates of its last search, when all others were at least c away. While it has moved by
/// m since and a candidate is nearer than c - m, no other point can be the nearest, by the triangle
/// inequality, and no search is needed. The answers are exact, and in the later iterations of ICP most points
/// hardly move.
class Correspondences {
 public:
  /// Points handled together.
  static constexpr std::size_t kBlock = 256;

  /// Up to kBlock source points p and their residuals r = R^T (T p - q), both in the base frame, so that a
  /// right perturbation of T has the Jacobian [I, -hat(p)] whatever T is, and no lever arm to the map's
  /// origin spoils the conditioning. Places behind the last point hold zeros.
  struct Block {
    /// The points, metres.
    ///@{
    std::array<double, kBlock> px, py, pz;
    ///@}
    /// The residuals, metres.
    ///@{
    std::array<double, kBlock> rx, ry, rz;
    ///@}
    std::array<double, kBlock> found;  ///< 1; 0 where there is no neighbour, and then r is 0.
  };

  /// `source` in the base frame; the map must stay as it is while this is used.
  Correspondences(std::span<const Eigen::Vector3f> source, const LocalMap& map, double max_distance);

  /// Of the whole source; the last one may be filled in part.
  [[nodiscard]] std::size_t num_blocks() const { return blocks_.size(); }
  /// Block `index` of the source at this pose. Several blocks may be asked for at the same time.
  void residuals(std::size_t index, const Pose& T_map_base, Block& block);

  /// Coordinates of a block's points.
  struct Points {
    /// Metres.
    ///@{
    std::array<float, kBlock> x, y, z;
    ///@}
  };
  /// What is kept of a block. Lanes behind the last point never need a search.
  struct Followed {
    Points source;     ///< Base frame; all others map frame.
    Points at;         ///< The same at the last pose.
    Points neighbour;  ///< The nearest candidate to that.
    Points searched;   ///< Where the last search for each was made,
    std::array<Points, LocalMap::Candidates::kNumber> candidates;  ///< its answer,
    /// and the squares of its bounds.
    ///@{
    std::array<float, kBlock> clearance2, room2;
    ///@}
  };

 private:
  void search(Followed& block, std::size_t i) const;

  const LocalMap* map_;
  float max_distance_;
  std::vector<Followed> blocks_;
};

}  // namespace adit
