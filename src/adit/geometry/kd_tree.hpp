// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Exact nearest-neighbour search among 3-D points.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace adit {

/// A point that a search found: its index in the cloud that the index was built from.
struct Neighbor {
  std::uint32_t index = 0;
  float squared_distance = 0.0F;  ///< Square metres.
  bool operator==(const Neighbor&) const = default;
};

/// A balanced tree over a copy of the points, stored flat (Bentley, "Multidimensional binary search trees",
/// 1975). Answers are exact and unique: among equally near points the smaller index comes first. Points with
/// a NaN or infinite coordinate are never found, and a query with one finds nothing. Immutable; searches are
/// thread-safe.
class KdTree {
 public:
  KdTree() = default;
  explicit KdTree(const std::vector<Eigen::Vector3f>& points);

  /// The nearest point no farther than `max_distance` metres; none when there is none.
  [[nodiscard]] std::optional<Neighbor> nearest(
      const Eigen::Vector3f& query, float max_distance = std::numeric_limits<float>::infinity()) const;
  /// The `k` nearest points (fewer in a smaller cloud), nearest first.
  [[nodiscard]] std::vector<Neighbor> k_nearest(const Eigen::Vector3f& query, std::size_t k) const;
  /// All points no farther than `radius` metres, nearest first.
  [[nodiscard]] std::vector<Neighbor> within(const Eigen::Vector3f& query, float radius) const;

  [[nodiscard]] std::size_t size() const { return points_.size(); }  ///< Finite points only.

 private:
  struct Node {
    float split = 0.0F;
    std::int32_t axis = -1;  ///< -1: a leaf.
    std::uint32_t begin =
        0;  ///< Leaf: its range in points_. Inner node: `begin` is the right child; left is next.
    std::uint32_t end = 0;
  };
  void build(std::uint32_t begin, std::uint32_t end, const std::vector<Eigen::Vector3f>& points);
  template <class Visitor>
  void visit(std::uint32_t node, const Eigen::Vector3f& query, const Eigen::Vector3f& outside,
             Visitor& visitor) const;
  template <class Visitor>
  void search(const Eigen::Vector3f& query, Visitor& visitor) const;

  std::vector<Node> nodes_;
  std::vector<Eigen::Vector3f> points_;  ///< In the order of the leaves.
  std::vector<std::uint32_t> indices_;   ///< Of points_ in the caller's cloud.
};

}  // namespace adit
