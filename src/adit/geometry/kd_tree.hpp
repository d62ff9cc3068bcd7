// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Exact nearest-neighbour search among 3-D points.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "adit/core/simd.hpp"

namespace adit {

/// A point that a search found: its index in the cloud that the index was built from.
struct Neighbor {
  std::uint32_t index = 0;        ///< Counts all points of that cloud, finite or not.
  float squared_distance = 0.0F;  ///< Square metres.
  bool operator==(const Neighbor&) const = default;
};

/// The nearest point, and a lower bound of the distance of all others.
struct NearestAlone {
  std::uint32_t index = 0;               ///< As in Neighbor, like the next.
  float squared_distance = 0.0F;         ///< Square metres.
  float others_squared_distance = 0.0F;  ///< The search's bound where no second point is nearer.
  bool operator==(const NearestAlone&) const = default;
};

/// A balanced tree over a copy of the points, stored flat, with eight points per leaf that are compared at
/// once (Bentley, "Multidimensional binary search trees", 1975). Answers are exact and unique: among equally
/// near points the smaller index comes first. Points with a NaN or infinite coordinate are never found, and a
/// query with one finds nothing. Immutable; searches are thread-safe.
class KdTree {
 public:
  KdTree() = default;
  /// Copies what it needs of `points`. An empty cloud makes a tree in which nothing is found.
  explicit KdTree(const std::vector<Eigen::Vector3f>& points);

  /// The nearest point no farther than `max_distance` metres; none when there is none.
  [[nodiscard]] std::optional<Neighbor> nearest(
      const Eigen::Vector3f& query, float max_distance = std::numeric_limits<float>::infinity()) const;
  /// The nearest point whose squared distance is at most `bound`, and how far the second nearest is; none
  /// when no point is so near.
  [[nodiscard]] std::optional<NearestAlone> nearest_alone(const Eigen::Vector3f& query, float bound) const;

  [[nodiscard]] std::size_t size() const { return size_; }  ///< Finite points only.

 private:
  static constexpr std::uint32_t kLeafSize = 8;
  struct Leaf {
    simd::Float4 x[2], y[2], z[2];  ///< NaN beyond the last point.
    std::uint32_t index[kLeafSize];
  };
  /// Inner nodes in preorder: the left child of a node follows it, and as each subtree has one inner node
  /// fewer than leaves, the right child follows as many places later as the left one has leaves.
  struct Node {
    float split = 0.0F;
    std::uint32_t axis = 0;
  };
  struct Item {
    float coordinates[3];
    std::uint32_t index;
  };
  void build(std::span<Item> items, std::uint32_t first_leaf, std::uint32_t last_leaf);
  template <class Visitor>
  void search(const Eigen::Vector3f& query, Visitor& visitor) const;
  template <class Visitor>
  void visit(const Leaf& leaf, const Eigen::Vector3f& query, Visitor& visitor) const;

  std::size_t size_ = 0;
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
};

}  // namespace adit
