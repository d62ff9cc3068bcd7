// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/correspondences.hpp"

#include <algorithm>

#include "adit/core/vectors.hpp"

namespace adit {
namespace {

// Share of a voxel by which searches look farther than they must, so that more points keep their neighbours.
constexpr float kMargin = 0.05F;
// Share of the squared clearance that roundings cannot spoil.
constexpr float kCertain = 0.9999F;
// Stands for no neighbour.
constexpr float kNowhere = 1e9F;

constexpr std::size_t kBlock = Correspondences::kBlock;

// The numbers of a pose.
struct Constants {
  double r00, r01, r02, tx;
  double r10, r11, r12, ty;
  double r20, r21, r22, tz;

  explicit Constants(const Pose& T) {
    const Matrix3 R = T.rotation_matrix();
    const Vector3& t = T.translation();
    r00 = R(0, 0), r01 = R(0, 1), r02 = R(0, 2), tx = t.x();
    r10 = R(1, 0), r11 = R(1, 1), r12 = R(1, 2), ty = t.y();
    r20 = R(2, 0), r21 = R(2, 1), r22 = R(2, 2), tz = t.z();
  }
};

// The functions below work on a block of points that lie as in Correspondences::Points.

// out = T p
ADIT_WIDE_VECTORS void transform(std::size_t stride, const Constants& constants, const float* __restrict p,
                                 float* __restrict out) {
  const Constants T = constants;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const auto x = static_cast<double>(p[i]);
    const auto y = static_cast<double>(p[i + stride]);
    const auto z = static_cast<double>(p[i + 2 * stride]);
    out[i] = static_cast<float>(T.r00 * x + T.r01 * y + T.r02 * z + T.tx);
    out[i + stride] = static_cast<float>(T.r10 * x + T.r11 * y + T.r12 * z + T.ty);
    out[i + 2 * stride] = static_cast<float>(T.r20 * x + T.r21 * y + T.r22 * z + T.tz);
  }
}

// Marks points whose neighbour may be another by now. With m the way from the last search, d the distance to
// its answer (or the farthest that counts) and c the clearance, d + m < c must hold, in squares.
ADIT_WIDE_VECTORS void flag_stale(std::size_t stride, float max_distance, const float* __restrict at,
                                  const float* __restrict searched, const float* __restrict neighbour,
                                  const float* __restrict clearance2, const float* __restrict room2,
                                  std::uint32_t* __restrict flags) {
  const auto squared_distance = [&](std::size_t i, const float* to) {
    const float x = at[i] - to[i];
    const float y = at[i + stride] - to[i + stride];
    const float z = at[i + 2 * stride] - to[i + 2 * stride];
    return x * x + y * y + z * z;
  };
  for (std::size_t i = 0; i < kBlock; ++i) {
    const float m2 = squared_distance(i, searched);
    const float d2 = std::min(squared_distance(i, neighbour), max_distance * max_distance);
    const float rest = kCertain * clearance2[i] - d2 - m2;
    flags[i] = static_cast<std::uint32_t>(!(m2 < room2[i])) | static_cast<std::uint32_t>(!(rest > 0.0F)) |
               static_cast<std::uint32_t>(!(rest * rest > 4.0F * d2 * m2));
  }
}

ADIT_WIDE_VECTORS void make_residuals(std::size_t stride, const Constants& constants, float max_distance,
                                      const float* __restrict p, const float* __restrict at,
                                      const float* __restrict neighbour, Correspondences::Block& block) {
  const Constants T = constants;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const float dx = at[i] - neighbour[i];
    const float dy = at[i + stride] - neighbour[i + stride];
    const float dz = at[i + 2 * stride] - neighbour[i + 2 * stride];
    const float d2 = dx * dx + dy * dy + dz * dz;
    block.found[i] = d2 < max_distance * max_distance ? 1.0 : 0.0;
  }
  for (std::size_t i = 0; i < kBlock; ++i) {
    const auto x = static_cast<double>(p[i]);
    const auto y = static_cast<double>(p[i + stride]);
    const auto z = static_cast<double>(p[i + 2 * stride]);
    const double ex = T.r00 * x + T.r01 * y + T.r02 * z + T.tx - static_cast<double>(neighbour[i]);
    const double ey = T.r10 * x + T.r11 * y + T.r12 * z + T.ty - static_cast<double>(neighbour[i + stride]);
    const double ez =
        T.r20 * x + T.r21 * y + T.r22 * z + T.tz - static_cast<double>(neighbour[i + 2 * stride]);
    block.px[i] = x;
    block.py[i] = y;
    block.pz[i] = z;
    block.rx[i] = block.found[i] * (T.r00 * ex + T.r10 * ey + T.r20 * ez);
    block.ry[i] = block.found[i] * (T.r01 * ex + T.r11 * ey + T.r21 * ez);
    block.rz[i] = block.found[i] * (T.r02 * ex + T.r12 * ey + T.r22 * ez);
  }
}

}  // namespace

Correspondences::Correspondences(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                 double max_distance)
    : map_(&map),
      max_distance_(static_cast<float>(max_distance)),
      stride_((source.size() + kBlock - 1) / kBlock * kBlock),
      source_(3 * stride_),
      at_(3 * stride_),
      searched_(3 * stride_),
      neighbour_(3 * stride_, kNowhere),
      clearance2_(stride_, kNowhere * kNowhere),
      room2_(stride_, kNowhere * kNowhere) {
  for (std::size_t i = 0; i < source.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      source_[i + axis * stride_] = source[i][static_cast<Eigen::Index>(axis)];
    clearance2_[i] = 0.0F;
  }
}

void Correspondences::residuals(std::size_t index, const Pose& T_map_base, Block& block) {
  const std::size_t begin = index * kBlock;
  const Constants T(T_map_base);
  transform(stride_, T, &source_[begin], &at_[begin]);
  std::array<std::uint32_t, kBlock> stale;
  flag_stale(stride_, max_distance_, &at_[begin], &searched_[begin], &neighbour_[begin], &clearance2_[begin],
             &room2_[begin], stale.data());
  for (std::size_t i = 0; i < kBlock; ++i)
    if (stale[i] != 0) search(begin + i);
  make_residuals(stride_, T, max_distance_, &source_[begin], &at_[begin], &neighbour_[begin], block);
}

void Correspondences::search(std::size_t i) {
  const Eigen::Vector3f query(at_[i], at_[i + stride_], at_[i + 2 * stride_]);
  const float margin = kMargin * static_cast<float>(map_->voxel_size());
  const LocalMap::Found found = map_->search(query, max_distance_, margin);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    searched_[i + axis * stride_] = query[static_cast<Eigen::Index>(axis)];
    neighbour_[i + axis * stride_] =
        found.nearest ? found.nearest->point[static_cast<Eigen::Index>(axis)] : kNowhere;
  }
  const auto squared = [](float bound) {
    const float b = std::clamp(bound, 0.0F, kNowhere);
    return b * b;
  };
  clearance2_[i] = squared(found.clearance);
  room2_[i] = squared(found.room);
}

}  // namespace adit
