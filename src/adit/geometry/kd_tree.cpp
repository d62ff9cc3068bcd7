// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/kd_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <tuple>

namespace adit {
namespace {

/// Near first, then small index: a total order, so that every answer is unique.
bool closer(const Neighbor& a, const Neighbor& b) {
  return std::tie(a.squared_distance, a.index) < std::tie(b.squared_distance, b.index);
}

struct NearestVisitor {
  float bound;
  std::optional<Neighbor> best;
  void found(const Neighbor& n) {
    if (best && !closer(n, *best)) return;
    best = n;
    bound = n.squared_distance;
  }
};

struct NearestAloneVisitor {
  float bound;
  bool found_any = false;
  NearestAlone best{};
  void found(const Neighbor& n) {
    if (!found_any || closer(n, {best.index, best.squared_distance})) {
      if (found_any) bound = best.squared_distance;
      best.index = n.index;
      best.squared_distance = n.squared_distance;
      found_any = true;
    } else {
      bound = n.squared_distance;
    }
  }
};

/// Always summed in the order x, y, z: a float sum of smaller terms is then never larger, so pruning is
/// exact.
template <class T>
T sum_of_squares(const T& x, const T& y, const T& z) {
  return x * x + y * y + z * z;
}

/// A subtree still to be searched: leaves [first, last), its topmost node, and the vector from the query to
/// its cell, zero along axes on which the query lies within.
struct Subtree {
  std::uint32_t node;
  std::uint32_t first;
  std::uint32_t last;
  std::array<float, 3> outside;
};

}  // namespace

KdTree::KdTree(const std::vector<Eigen::Vector3f>& points) {
  std::vector<Item> items;
  items.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i];
    if (p.allFinite()) items.push_back({{p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(i)});
  }
  size_ = items.size();
  if (items.empty()) return;
  leaves_.resize((items.size() + kLeafSize - 1) / kLeafSize);
  nodes_.reserve(leaves_.size());
  build(items, 0, static_cast<std::uint32_t>(leaves_.size()));
}

void KdTree::build(std::span<Item> items, std::uint32_t first_leaf, std::uint32_t last_leaf) {
  if (last_leaf - first_leaf == 1) {
    Leaf& leaf = leaves_[first_leaf];
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    for (std::uint32_t k = 0; k < kLeafSize; ++k) {
      const Item item = k < items.size() ? items[k] : Item{{kNan, kNan, kNan}, 0};
      leaf.x[k / 4][k % 4] = item.coordinates[0];
      leaf.y[k / 4][k % 4] = item.coordinates[1];
      leaf.z[k / 4][k % 4] = item.coordinates[2];
      leaf.index[k] = item.index;
    }
    return;
  }
  Eigen::AlignedBox3f box;
  for (const Item& item : items) box.extend(Eigen::Vector3f::Map(item.coordinates));
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle_leaf = first_leaf + (last_leaf - first_leaf) / 2;
  const std::size_t middle = std::size_t{middle_leaf - first_leaf} * kLeafSize;
  std::nth_element(
      items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
      [axis](const Item& a, const Item& b) { return a.coordinates[axis] < b.coordinates[axis]; });
  nodes_.push_back({items[middle].coordinates[axis], static_cast<std::uint32_t>(axis)});
  build(items.first(middle), first_leaf, middle_leaf);
  build(items.subspan(middle), middle_leaf, last_leaf);
}

template <class Visitor>
void KdTree::visit(const Leaf& leaf, const Eigen::Vector3f& query, Visitor& visitor) const {
  simd::Float4 squared_distances[2];
  for (int half = 0; half < 2; ++half) {
    squared_distances[half] = sum_of_squares<simd::Float4>(leaf.x[half] - query.x(), leaf.y[half] - query.y(),
                                                           leaf.z[half] - query.z());
  }
  if (!simd::any((squared_distances[0] <= visitor.bound) | (squared_distances[1] <= visitor.bound))) return;
  float distances[kLeafSize];
  std::memcpy(distances, squared_distances, sizeof(distances));
  for (std::uint32_t k = 0; k < kLeafSize; ++k) {
    if (distances[k] <= visitor.bound) visitor.found({leaf.index[k], distances[k]});
  }
}

template <class Visitor>
void KdTree::search(const Eigen::Vector3f& query, Visitor& visitor) const {
  if (leaves_.empty() || !query.allFinite()) return;
  std::array<Subtree, 32> waiting;  // halved 32 times, four billion points are one leaf
  std::size_t num_waiting = 0;
  Subtree now{0, 0, static_cast<std::uint32_t>(leaves_.size()), {}};
  while (true) {
    while (now.last - now.first > 1) {
      const Node& node = nodes_[now.node];
      const std::uint32_t middle = now.first + (now.last - now.first) / 2;
      const std::uint32_t right = now.node + middle - now.first;
      const float to_split = node.split - query[node.axis];
      Subtree& far = waiting[num_waiting];
      far = now;
      far.outside[node.axis] = to_split;
      if (to_split > 0.0F) {
        far.node = right;
        far.first = middle;
        now.last = middle;
        ++now.node;
      } else {
        ++far.node;
        far.last = middle;
        now.node = right;
        now.first = middle;
      }
      if (sum_of_squares(far.outside[0], far.outside[1], far.outside[2]) <= visitor.bound) ++num_waiting;
    }
    visit(leaves_[now.first], query, visitor);
    do {
      if (num_waiting == 0) return;
      now = waiting[--num_waiting];
    } while (sum_of_squares(now.outside[0], now.outside[1], now.outside[2]) > visitor.bound);
  }
}

std::optional<Neighbor> KdTree::nearest(const Eigen::Vector3f& query, float max_distance) const {
  NearestVisitor visitor{max_distance * max_distance, std::nullopt};
  search(query, visitor);
  return visitor.best;
}

std::optional<NearestAlone> KdTree::nearest_alone(const Eigen::Vector3f& query, float bound) const {
  NearestAloneVisitor visitor{.bound = bound};
  search(query, visitor);
  if (!visitor.found_any) return std::nullopt;
  visitor.best.others_squared_distance = visitor.bound;
  return visitor.best;
}

}  // namespace adit
