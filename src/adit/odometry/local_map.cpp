// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/local_map.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace adit {
namespace {

constexpr float kNowhere = std::numeric_limits<float>::infinity();

// The 27 voxels around one, itself first, then those that share a face, an edge, a corner: near ones first,
// so that the search radius shrinks early and most of the others are never looked up.
constexpr auto kNeighbourhood = [] {
  std::array<std::array<int, 3>, 27> offsets{};
  std::size_t next = 0;
  for (int ring = 0; ring <= 3; ++ring)
    for (int i = 0; i < 27; ++i) {
      const std::array<int, 3> o = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
      if (o[0] * o[0] + o[1] * o[1] + o[2] * o[2] == ring) offsets[next++] = o;
    }
  return offsets;
}();

// Smallest squared distance from `q` to the first `num_points` points of a block (and padding), four at a
// time.
float nearest_in_block(const float* x, std::size_t stride, std::size_t num_points, const Eigen::Vector3f& q) {
  using Four = Eigen::Map<const Eigen::Array4f>;
  Eigen::Array4f best = Eigen::Array4f::Constant(kNowhere);
  for (std::size_t k = 0; k < num_points; k += 4) {
    const Eigen::Array4f d2 = (Four(x + k) - q.x()).square() + (Four(x + stride + k) - q.y()).square() +
                              (Four(x + 2 * stride + k) - q.z()).square();
    best = best.min(d2);
  }
  return best.minCoeff();
}

Eigen::Vector3f nearest_point_of_block(const float* x, std::size_t stride, std::size_t num_points,
                                       const Eigen::Vector3f& q) {
  Eigen::Vector3f nearest(x[0], x[stride], x[2 * stride]);
  for (std::size_t k = 1; k < num_points; ++k) {
    const Eigen::Vector3f p(x[k], x[stride + k], x[2 * stride + k]);
    if ((p - q).squaredNorm() < (nearest - q).squaredNorm()) nearest = p;
  }
  return nearest;
}

}  // namespace

LocalMap::LocalMap(double voxel_size, int max_points_per_voxel)
    : grid_(voxel_size),
      max_points_per_voxel_(static_cast<std::uint32_t>(max_points_per_voxel)),
      min_squared_spacing_(static_cast<float>(voxel_size * voxel_size / max_points_per_voxel)),
      stride_((max_points_per_voxel_ + 3U) / 4U * 4U) {
  ADIT_CHECK(max_points_per_voxel > 0, "a map voxel holds at least one point");
}

std::size_t LocalMap::num_points() const {
  std::size_t sum = 0;
  for (const Voxel& voxel : voxels_) sum += voxel.num_points;
  return sum;
}

std::vector<Eigen::Vector3f> LocalMap::points() const {
  std::vector<Eigen::Vector3f> out;
  for (std::size_t i = 0; i < voxels_.size(); ++i)
    for (std::size_t k = 0; k < voxels_[i].num_points; ++k)
      out.emplace_back(block(i)[k], block(i)[stride_ + k], block(i)[2 * stride_ + k]);
  return out;
}

void LocalMap::add(std::span<const Eigen::Vector3f> points_base, const Pose& T_map_base) {
  const Matrix3 R = T_map_base.rotation_matrix();
  for (const Eigen::Vector3f& p : points_base)
    add_point((R * p.cast<double>() + T_map_base.translation()).cast<float>());
}

void LocalMap::add_point(const Eigen::Vector3f& point) {
  const auto key = grid_.key_of(point);
  if (!key) return;
  const std::uint32_t index = voxel_for(*key);
  Voxel& voxel = voxels_[index];
  float* x = block(index);
  if (voxel.num_points >= max_points_per_voxel_ ||
      nearest_in_block(x, stride_, voxel.num_points, point) < min_squared_spacing_)
    return;
  for (int axis = 0; axis < 3; ++axis)
    x[static_cast<std::size_t>(axis) * stride_ + voxel.num_points] = point[axis];
  ++voxel.num_points;
}

std::uint32_t LocalMap::voxel_for(VoxelKey key) {
  const auto next = free_.empty() ? static_cast<std::uint32_t>(voxels_.size()) : free_.back();
  if (const auto known = table_.find_or_insert(key, next)) return *known;
  if (free_.empty()) {
    voxels_.emplace_back();
    coordinates_.resize(coordinates_.size() + 3 * stride_, kNowhere);
  } else {
    free_.pop_back();
  }
  voxels_[next] = {key, 0};
  return next;
}

void LocalMap::remove_beyond(const Eigen::Vector3f& centre, double max_distance) {
  const auto max2 = static_cast<float>(max_distance * max_distance);
  for (std::uint32_t i = 0; i < voxels_.size(); ++i) {
    float* x = block(i);
    if (voxels_[i].num_points == 0) continue;
    if ((Eigen::Vector3f(x[0], x[stride_], x[2 * stride_]) - centre).squaredNorm() <= max2) continue;
    table_.erase(voxels_[i].key);
    std::fill_n(x, 3 * stride_, kNowhere);
    voxels_[i].num_points = 0;
    free_.push_back(i);
  }
}

std::optional<LocalMap::Neighbour> LocalMap::nearest(const Eigen::Vector3f& query, float max_distance) const {
  const auto key = grid_.key_of(query);
  if (!key) return {};
  // gap2(axis, 1 + d): squared distance from the query to the slab of voxels d further along the axis.
  const Eigen::Array3f to_lower = (query - key->indices().cast<float>() * grid_.voxel_size()).array();
  Eigen::Array33f gap2 = Eigen::Array33f::Zero();
  gap2.col(0) = to_lower.square();
  gap2.col(2) = (grid_.voxel_size() - to_lower).square();

  float best2 = max_distance * max_distance;
  std::optional<std::uint32_t> best_voxel;
  for (const auto& [dx, dy, dz] : kNeighbourhood) {
    if (gap2(0, dx + 1) + gap2(1, dy + 1) + gap2(2, dz + 1) >= best2) continue;
    const auto voxel = table_.find(key->shifted(dx, dy, dz));
    if (!voxel) continue;
    const float d2 = nearest_in_block(block(*voxel), stride_, voxels_[*voxel].num_points, query);
    if (d2 >= best2) continue;
    best2 = d2;
    best_voxel = voxel;
  }
  if (!best_voxel) return {};
  return Neighbour{
      nearest_point_of_block(block(*best_voxel), stride_, voxels_[*best_voxel].num_points, query), best2};
}

}  // namespace adit
