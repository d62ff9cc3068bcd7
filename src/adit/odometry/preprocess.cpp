// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/preprocess.hpp"

#include <algorithm>
#include <array>

#include "adit/core/parallel.hpp"
#include "adit/core/simd.hpp"

namespace adit {
namespace {

// Points per part of the parallel loop, and points whose ranges are tested together.
constexpr std::size_t kGrain = 8192;
constexpr std::size_t kBlock = 256;

struct SquaredLimits {
  float min;
  float max;
};

// For each point 1 if it is in range, 0 if not; and how many are. NaN fails both comparisons.
ADIT_WIDE_VECTORS std::uint32_t flag_in_range(const float* xyz, std::size_t n, float min2, float max2,
                                              std::uint32_t* flags) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const float range2 =
        xyz[3 * i] * xyz[3 * i] + xyz[3 * i + 1] * xyz[3 * i + 1] + xyz[3 * i + 2] * xyz[3 * i + 2];
    flags[i] = static_cast<std::uint32_t>(range2 > min2) & static_cast<std::uint32_t>(range2 < max2);
    sum += flags[i];
  }
  return sum;
}

// The front of `cloud`'s part [begin, end) becomes those of its points whose raw points are in range; how
// many they are.
std::size_t crop(std::span<const Eigen::Vector3f> raw, const SquaredLimits& limits, std::size_t begin,
                 std::size_t end, PointCloud& cloud) {
  Eigen::Vector3f* points = cloud.points.data();
  float* intensities = cloud.intensities.empty() ? nullptr : cloud.intensities.data();
  std::array<std::uint32_t, kBlock> flags;
  std::size_t to = begin;
  for (std::size_t block = begin; block < end; block += kBlock) {
    const std::size_t n = std::min(kBlock, end - block);
    if (flag_in_range(raw[block].data(), n, limits.min, limits.max, flags.data()) < n) {
      for (std::size_t i = 0; i < n; ++i) {
        points[to] = points[block + i];
        if (intensities != nullptr) intensities[to] = intensities[block + i];
        to += flags[i];
      }
      continue;
    }
    if (to != block) {
      std::copy_n(points + block, n, points + to);
      if (intensities != nullptr) std::copy_n(intensities + block, n, intensities + to);
    }
    to += n;
  }
  return to - begin;
}

// Moves the fronts of all parts together.
template <class T>
void join(std::vector<T>& values, const std::vector<std::size_t>& kept) {
  if (values.empty()) return;
  auto to = values.begin();
  for (std::size_t part = 0; part < kept.size(); ++part) {
    const auto from = values.begin() + static_cast<std::ptrdiff_t>(part * kGrain);
    const auto n = static_cast<std::ptrdiff_t>(kept[part]);
    if (from != to) std::copy_n(from, n, to);
    to += n;
  }
  values.erase(to, values.end());
}

}  // namespace

void preprocess(const PointCloud& cloud_lidar, const RangeLimits& limits, const Pose& T_base_lidar,
                const std::optional<SweepMotion>& motion, PointCloud& cloud_base) {
  cloud_lidar.check();
  const std::span<const Eigen::Vector3f> raw = cloud_lidar.points;
  const SquaredLimits squared = {static_cast<float>(limits.min_range * limits.min_range),
                                 static_cast<float>(limits.max_range * limits.max_range)};
  std::optional<SweepTransform> sweep;
  if (motion && cloud_lidar.has_times()) sweep.emplace(*motion, T_base_lidar, cloud_lidar.time_offsets_ns);
  const SweepTransform::Matrix34 T = T_base_lidar.matrix().topRows<3>().cast<float>();
  cloud_base.points.resize(cloud_lidar.size());
  cloud_base.intensities.resize(cloud_lidar.intensities.size());
  std::vector<std::size_t> kept((raw.size() + kGrain - 1) / kGrain);
  parallel_for(raw.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    const std::size_t n = end - begin;
    const std::span<Eigen::Vector3f> moved = std::span(cloud_base.points).subspan(begin, n);
    if (sweep)
      sweep->apply(std::span(cloud_lidar.time_offsets_ns).subspan(begin, n), raw.subspan(begin, n), moved);
    else
      transform_points(T, raw.subspan(begin, n), moved);
    if (!cloud_lidar.intensities.empty())
      std::copy_n(cloud_lidar.intensities.data() + begin, n, cloud_base.intensities.data() + begin);
    kept[begin / kGrain] = crop(raw, squared, begin, end, cloud_base);
  });
  join(cloud_base.points, kept);
  join(cloud_base.intensities, kept);
}

}  // namespace adit
