// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/agreement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace adit {
namespace {

// A view in directions of three degrees: some points of a thinned cloud fall into each that sees a surface.
constexpr int kColumns = 120;
constexpr int kRows = 60;
// A point is before or behind the surface when it is by more than this many voxels and this share of the
// range.
constexpr float kMarginVoxels = 2.0F;
constexpr float kMarginShare = 0.02F;

class View {
 public:
  struct Ranges {
    float nearest = std::numeric_limits<float>::infinity();
    float farthest = 0.0F;
    [[nodiscard]] bool empty() const { return farthest == 0.0F; }
    void add(const Ranges& other) {
      nearest = std::min(nearest, other.nearest);
      farthest = std::max(farthest, other.farthest);
    }
  };

  explicit View(const std::vector<Eigen::Vector3f>& points) {
    std::vector<Ranges> own(ranges_.size());
    for (const Eigen::Vector3f& p : points) {
      const float range = p.norm();
      own[place(row_of(p), column_of(p))].add({range, range});
    }
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        Ranges& around = ranges_[place(row, column)];
        if (own[place(row, column)].empty()) continue;
        for (int i = std::max(row - 1, 0); i <= std::min(row + 1, kRows - 1); ++i) {
          for (int j = -1; j <= 1; ++j) around.add(own[place(i, (column + j + kColumns) % kColumns)]);
        }
      }
    }
  }

  /// Of the surfaces in the direction of `p` and around it; empty where nothing was seen.
  [[nodiscard]] const Ranges& towards(const Eigen::Vector3f& p) const {
    return ranges_[place(row_of(p), column_of(p))];
  }

 private:
  static int row_of(const Eigen::Vector3f& p) {
    const float elevation = std::atan2(p.z(), p.head<2>().norm()) / std::numbers::pi_v<float> + 0.5F;
    return std::clamp(static_cast<int>(elevation * kRows), 0, kRows - 1);
  }
  static int column_of(const Eigen::Vector3f& p) {
    const float azimuth = std::atan2(p.y(), p.x()) / (2.0F * std::numbers::pi_v<float>)+0.5F;
    return std::clamp(static_cast<int>(azimuth * kColumns), 0, kColumns - 1);
  }
  static std::size_t place(int row, int column) { return static_cast<std::size_t>(row * kColumns + column); }

  std::vector<Ranges> ranges_ = std::vector<Ranges>(std::size_t{kRows} * kColumns);
};

struct Counts {
  double visible = 0.0;
  double confirmed = 0.0;
  double contradicting = 0.0;
};

// The points of b as a saw the same space.
Counts seen_by(const OrientedPoints& a, const KdTree& tree_a, const OrientedPoints& b, const Pose& T_a_b,
               const RegistrationConfig& config) {
  const View view(a.points);
  const Eigen::Matrix3f R = T_a_b.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_a_b.translation().cast<float>();
  const auto reach = static_cast<float>(config.overlap_distance_voxels * config.voxel_size);
  const auto voxel = static_cast<float>(config.voxel_size);
  const auto thickness = static_cast<float>(config.refine_kernel_voxels * config.voxel_size);
  Counts counts;
  for (const Eigen::Vector3f& point : b.points) {
    const Eigen::Vector3f p = R * point + t;
    const View::Ranges& seen = view.towards(p);
    if (seen.empty()) continue;
    const float range = p.norm();
    const float margin = kMarginVoxels * voxel + kMarginShare * range;
    if (range > seen.farthest + margin) continue;
    counts.visible += 1.0;
    if (range < seen.nearest - margin) {
      counts.contradicting += 1.0;
    } else if (const auto near = tree_a.nearest(p, reach)) {
      const float off = a.normals[near->index].dot(p - a.points[near->index]);
      counts.confirmed += std::abs(off) < thickness ? 1.0 : 0.0;
    }
  }
  return counts;
}

}  // namespace

Agreement agreement(const OrientedPoints& a, const KdTree& tree_a, const OrientedPoints& b,
                    const KdTree& tree_b, const Pose& T_a_b, const RegistrationConfig& config) {
  const std::array<Counts, 2> both = {seen_by(a, tree_a, b, T_a_b, config),
                                      seen_by(b, tree_b, a, T_a_b.inverse(), config)};
  Agreement out{1.0, 0.0};
  for (const Counts& counts : both) {
    if (counts.visible == 0.0) return {};
    out.confirmed = std::min(out.confirmed, counts.confirmed / counts.visible);
    out.contradicted = std::max(out.contradicted, counts.contradicting / counts.visible);
  }
  return out;
}

}  // namespace adit
