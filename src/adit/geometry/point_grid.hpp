// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Exact nearest-neighbour search among 3-D points.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "adit/core/simd.hpp"
#include "adit/geometry/neighbor.hpp"

namespace adit {

/// The nearest point, and a lower bound of the distance of all others.
struct NearestAlone {
  std::uint32_t index = 0;               ///< As in Neighbor, like the next.
  float squared_distance = 0.0F;         ///< Square metres.
  float others_squared_distance = 0.0F;  ///< The search's bound where no second point is nearer.
  bool operator==(const NearestAlone&) const = default;
};

/// Edge of the cells, in voxels, for points of one per voxel (decision 0061).
inline constexpr double kCellVoxels = 3.0;

/// A copy of the points, sorted into the cubic cells of their bounding box (Bentley, Weide, Yao, "Optimal
/// expected-time algorithms for closest point problems", 1980). Made for points about evenly spread over
/// surfaces, one per voxel, and searches not much wider than a cell; others are slower, never wrong. Answers
/// are exact and unique: among equally near points the smaller index comes first. Points with a NaN or
/// infinite coordinate are never found, and a query with one finds nothing. Immutable; searches are
/// thread-safe (docs/decisions/0061-a-grid-to-search.md).
class PointGrid {
 public:
  PointGrid() = default;  ///< Nothing is found in it.
  /// Copies what it needs of `points`. `cell_size`: edge of the cells, metres, positive; doubled until there
  /// are at most eight cells per point.
  PointGrid(const std::vector<Eigen::Vector3f>& points, double cell_size);

  /// The nearest point within `max_distance` metres; empty where no point is so near.
  [[nodiscard]] std::optional<Neighbor> nearest(
      const Eigen::Vector3f& query, float max_distance = std::numeric_limits<float>::infinity()) const;
  /// The nearest point whose squared distance is at most `bound`, square metres, and how far the second
  /// nearest is; empty where no point is so near.
  [[nodiscard]] std::optional<NearestAlone> nearest_alone(const Eigen::Vector3f& query, float bound) const;

  /// How many points have a squared distance of less than `bound`, square metres, as Eigen's `squaredNorm` of
  /// the difference rounds it.
  [[nodiscard]] std::size_t num_nearer(const Eigen::Vector3f& query, float bound) const;

  [[nodiscard]] std::size_t size() const { return index_.size(); }  ///< Finite points only.
  [[nodiscard]] std::size_t num_bytes() const;                      ///< About what this takes.

 private:
  /// From one cell to another one along each axis, both included; without cells where `to` is less than
  /// `from`.
  struct CellRange {
    simd::Int4 from = {};
    simd::Int4 to = {-1, -1, -1, 0};
  };

  [[nodiscard]] CellRange cells_around(simd::Float4 query, float bound) const;
  [[nodiscard]] simd::Float4 cells_to(simd::Float4 position) const;
  [[nodiscard]] std::size_t row_of(int y, int z) const;
  [[nodiscard]] float to_farthest(const Eigen::Vector3f& query) const;
  template <class Visitor>
  void visit(std::uint32_t begin, std::uint32_t end, const Eigen::Vector3f& query, Visitor& visitor) const;
  template <class Visitor>
  void search(const Eigen::Vector3f& query, Visitor& visitor) const;

  float cell_size_ = 1.0F;  ///< Metres.
  float cells_per_metre_ = 1.0F;
  float slack_ = 0.0F;                ///< Metres; more than rounding moves a point.
  simd::Float4 low_ = {};             ///< Corner of the box; the fourth lane is 0, as in all that follow.
  simd::Int4 num_cells_ = {};         ///< Along each axis; 1 in the fourth lane.
  std::vector<std::uint32_t> first_;  ///< Point of each cell, x fastest, then y; and the number of points.
  std::vector<float> x_, y_, z_;  ///< By cell, then index; with NaN behind the last, to be read in eights.
  std::vector<std::uint32_t> index_;  ///< Of each in the cloud.
};

}  // namespace adit
