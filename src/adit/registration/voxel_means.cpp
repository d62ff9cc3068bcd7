// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/voxel_means.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "adit/core/check.hpp"

namespace adit {
namespace {

using Keyed = std::pair<std::uint64_t, std::uint32_t>;  // voxel, point

/// Each coordinate as 19 bits of block and 2 bits of place within it; the blocks' bits come first.
std::uint64_t block_key(const Eigen::Array3f& voxel) {
  std::uint64_t blocks = 0;
  std::uint64_t within = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto v =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(voxel[axis]) + (std::int64_t{1} << 20U));
    blocks = (blocks << 19U) | (v >> 2U);
    within = (within << 2U) | (v & 3U);
  }
  return (blocks << 6U) | within;
}

std::vector<Keyed> sorted_by_voxel(const std::vector<Eigen::Vector3f>& points, float voxel_size) {
  constexpr float kMaxVoxel = 1.0e6F;
  std::vector<Keyed> keyed;
  keyed.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Array3f voxel = (points[i] / voxel_size).array().floor();
    if ((voxel.abs() < kMaxVoxel).all()) keyed.emplace_back(block_key(voxel), static_cast<std::uint32_t>(i));
  }
  std::sort(keyed.begin(), keyed.end());
  return keyed;
}

}  // namespace

std::vector<Eigen::Vector3f> voxel_means(const std::vector<Eigen::Vector3f>& points, float voxel_size) {
  ADIT_CHECK(voxel_size > 0.0F, "a voxel has a positive edge");
  const std::vector<Keyed> keyed = sorted_by_voxel(points, voxel_size);
  std::vector<Eigen::Vector3f> means;
  for (std::size_t begin = 0; begin < keyed.size();) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t end = begin;
    for (; end < keyed.size() && keyed[end].first == keyed[begin].first; ++end) {
      sum += points[keyed[end].second].cast<double>();
    }
    means.emplace_back((sum / static_cast<double>(end - begin)).cast<float>());
    begin = end;
  }
  return means;
}

}  // namespace adit
