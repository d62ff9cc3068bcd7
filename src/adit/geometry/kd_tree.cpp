// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/kd_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <tuple>

namespace adit {
namespace {

constexpr std::uint32_t kLeafSize = 12;

/// Near first, then small index: a total order, so that every answer is unique.
bool closer(const Neighbor& a, const Neighbor& b) {
  return std::tie(a.squared_distance, a.index) < std::tie(b.squared_distance, b.index);
}

/// Always summed in the order x, y, z: a float sum of smaller terms is then never larger, so pruning is
/// exact.
float sum_of_squares(const Eigen::Vector3f& d) { return d.x() * d.x() + d.y() * d.y() + d.z() * d.z(); }

struct NearestVisitor {
  float bound;
  std::optional<Neighbor> best;
  void found(const Neighbor& n) {
    if (best && !closer(n, *best)) return;
    best = n;
    bound = n.squared_distance;
  }
};

struct KNearestVisitor {
  std::size_t k;
  float bound = std::numeric_limits<float>::infinity();
  std::vector<Neighbor> heap;  ///< The farthest on top.
  void found(const Neighbor& n) {
    if (heap.size() == k) {
      if (!closer(n, heap.front())) return;
      std::pop_heap(heap.begin(), heap.end(), closer);
      heap.pop_back();
    }
    heap.push_back(n);
    std::push_heap(heap.begin(), heap.end(), closer);
    if (heap.size() == k) bound = heap.front().squared_distance;
  }
};

struct RadiusVisitor {
  float bound;
  std::vector<Neighbor> all;
  void found(const Neighbor& n) { all.push_back(n); }
};

}  // namespace

KdTree::KdTree(const std::vector<Eigen::Vector3f>& points) {
  indices_.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite()) indices_.push_back(static_cast<std::uint32_t>(i));
  }
  if (indices_.empty()) return;
  nodes_.reserve(4 * indices_.size() / kLeafSize + 1);
  build(0, static_cast<std::uint32_t>(indices_.size()), points);
  points_.reserve(indices_.size());
  for (const std::uint32_t index : indices_) points_.push_back(points[index]);
}

void KdTree::build(std::uint32_t begin, std::uint32_t end, const std::vector<Eigen::Vector3f>& points) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({0.0F, -1, begin, end});
  if (end - begin <= kLeafSize) return;
  Eigen::AlignedBox3f box;
  for (std::uint32_t i = begin; i < end; ++i) box.extend(points[indices_[i]]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(indices_.begin() + begin, indices_.begin() + middle, indices_.begin() + end,
                   [&](std::uint32_t i, std::uint32_t j) { return points[i][axis] < points[j][axis]; });
  nodes_[node].split = points[indices_[middle]][axis];
  nodes_[node].axis = static_cast<std::int32_t>(axis);
  build(begin, middle, points);
  nodes_[node].begin = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end, points);
}

/// `outside` is the vector from the query to the cell of `node`: zero along axes on which the query lies
/// within.
template <class Visitor>
void KdTree::visit(std::uint32_t node, const Eigen::Vector3f& query, const Eigen::Vector3f& outside,
                   Visitor& visitor) const {
  const Node& n = nodes_[node];
  if (n.axis < 0) {
    for (std::uint32_t i = n.begin; i < n.end; ++i) {
      const float squared_distance = sum_of_squares(points_[i] - query);
      if (squared_distance <= visitor.bound) visitor.found({indices_[i], squared_distance});
    }
    return;
  }
  const float to_split = n.split - query[n.axis];
  Eigen::Vector3f outside_far = outside;
  outside_far[n.axis] = to_split;
  const bool left_first = to_split > 0.0F;
  visit(left_first ? node + 1 : n.begin, query, outside, visitor);
  if (sum_of_squares(outside_far) <= visitor.bound) {
    visit(left_first ? n.begin : node + 1, query, outside_far, visitor);
  }
}

template <class Visitor>
void KdTree::search(const Eigen::Vector3f& query, Visitor& visitor) const {
  if (!nodes_.empty() && query.allFinite()) visit(0, query, Eigen::Vector3f::Zero(), visitor);
}

std::optional<Neighbor> KdTree::nearest(const Eigen::Vector3f& query, float max_distance) const {
  NearestVisitor visitor{max_distance * max_distance, std::nullopt};
  search(query, visitor);
  return visitor.best;
}

std::vector<Neighbor> KdTree::k_nearest(const Eigen::Vector3f& query, std::size_t k) const {
  if (k == 0) return {};
  KNearestVisitor visitor{.k = k, .heap = {}};
  visitor.heap.reserve(std::min(k, size()) + 1);
  search(query, visitor);
  std::sort_heap(visitor.heap.begin(), visitor.heap.end(), closer);
  return std::move(visitor.heap);
}

std::vector<Neighbor> KdTree::within(const Eigen::Vector3f& query, float radius) const {
  RadiusVisitor visitor{radius * radius, {}};
  search(query, visitor);
  std::sort(visitor.all.begin(), visitor.all.end(), closer);
  return std::move(visitor.all);
}

}  // namespace adit
