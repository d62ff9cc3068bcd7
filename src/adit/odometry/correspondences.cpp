// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/correspondences.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/simd.hpp"

namespace adit {
namespace {

// Share of a voxel by which searches look farther than they must, so that their candidates suffice for
// longer.
constexpr float kMargin = 0.1F;
// Share of the squared clearance that is left after roundings.
constexpr float kCertain = 0.9999F;
// Coordinate of placeholders for missing points, and value of missing bounds.
constexpr float kNowhere = LocalMap::Candidates::kNowhere;

constexpr std::size_t kBlock = Correspondences::kBlock;
using Points = Correspondences::Points;
using Followed = Correspondences::Followed;

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

ADIT_WIDE_VECTORS void transform(const Constants& constants, const Points& p, Points& out) {
  const Constants T = constants;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const auto x = static_cast<double>(p.x[i]);
    const auto y = static_cast<double>(p.y[i]);
    const auto z = static_cast<double>(p.z[i]);
    out.x[i] = static_cast<float>(T.r00 * x + T.r01 * y + T.r02 * z + T.tx);
    out.y[i] = static_cast<float>(T.r10 * x + T.r11 * y + T.r12 * z + T.ty);
    out.z[i] = static_cast<float>(T.r20 * x + T.r21 * y + T.r22 * z + T.tz);
  }
}

[[gnu::always_inline]] inline float squared_distance(const Points& a, const Points& b, std::size_t i) {
  const float x = a.x[i] - b.x[i];
  const float y = a.y[i] - b.y[i];
  const float z = a.z[i] - b.z[i];
  return x * x + y * y + z * z;
}

// Picks the nearest candidate of each point.
ADIT_WIDE_VECTORS void choose(Followed& block) {
  static_assert(LocalMap::Candidates::kNumber == 8);
  const std::array<Points, 8>& candidates = block.candidates;
  for (std::size_t i = 0; i < kBlock; ++i) {
    float best2 = squared_distance(block.at, candidates[0], i);
    float x = candidates[0].x[i];
    float y = candidates[0].y[i];
    float z = candidates[0].z[i];
    // Written out, for a loop in here would keep the outer one from vectors.
    const auto consider = [&](const Points& candidate) __attribute__((always_inline)) {
      const float d2 = squared_distance(block.at, candidate, i);
      x = d2 < best2 ? candidate.x[i] : x;
      y = d2 < best2 ? candidate.y[i] : y;
      z = d2 < best2 ? candidate.z[i] : z;
      best2 = d2 < best2 ? d2 : best2;
    };
    consider(candidates[1]);
    consider(candidates[2]);
    consider(candidates[3]);
    consider(candidates[4]);
    consider(candidates[5]);
    consider(candidates[6]);
    consider(candidates[7]);
    block.neighbour.x[i] = x;
    block.neighbour.y[i] = y;
    block.neighbour.z[i] = z;
  }
}

// Marks points that need a search. With m the distance from the last one, d the distance to the nearest
// candidate (or the farthest that counts) and c the clearance, they do not if d + m < c; here in squares.
ADIT_WIDE_VECTORS void mark_stale(const Followed& block, float max_distance,
                                  std::array<std::uint32_t, kBlock>& stale) {
  for (std::size_t i = 0; i < kBlock; ++i) {
    const float m2 = squared_distance(block.at, block.searched, i);
    const float d2 = std::min(squared_distance(block.at, block.neighbour, i), max_distance * max_distance);
    const float rest = kCertain * block.clearance2[i] - d2 - m2;
    stale[i] = static_cast<std::uint32_t>(!(m2 < block.room2[i])) |
               static_cast<std::uint32_t>(!(rest > 0.0F)) |
               static_cast<std::uint32_t>(!(rest * rest > 4.0F * d2 * m2));
  }
}

ADIT_WIDE_VECTORS void make_residuals(const Constants& constants, float max_distance, const Followed& from,
                                      Correspondences::Block& block) {
  const Constants T = constants;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const float d2 = squared_distance(from.at, from.neighbour, i);
    block.found[i] = d2 < max_distance * max_distance ? 1.0 : 0.0;
  }
  for (std::size_t i = 0; i < kBlock; ++i) {
    const auto x = static_cast<double>(from.source.x[i]);
    const auto y = static_cast<double>(from.source.y[i]);
    const auto z = static_cast<double>(from.source.z[i]);
    const double ex = T.r00 * x + T.r01 * y + T.r02 * z + T.tx - static_cast<double>(from.neighbour.x[i]);
    const double ey = T.r10 * x + T.r11 * y + T.r12 * z + T.ty - static_cast<double>(from.neighbour.y[i]);
    const double ez = T.r20 * x + T.r21 * y + T.r22 * z + T.tz - static_cast<double>(from.neighbour.z[i]);
    block.px[i] = x;
    block.py[i] = y;
    block.pz[i] = z;
    block.rx[i] = block.found[i] * (T.r00 * ex + T.r10 * ey + T.r20 * ez);
    block.ry[i] = block.found[i] * (T.r01 * ex + T.r11 * ey + T.r21 * ez);
    block.rz[i] = block.found[i] * (T.r02 * ex + T.r12 * ey + T.r22 * ez);
  }
}

void set(Points& points, std::size_t i, const Eigen::Vector3f& p) {
  points.x[i] = p.x();
  points.y[i] = p.y();
  points.z[i] = p.z();
}

}  // namespace

Correspondences::Correspondences(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                 double max_distance)
    : map_(&map),
      max_distance_(static_cast<float>(max_distance)),
      blocks_((source.size() + kBlock - 1) / kBlock) {
  for (std::size_t i = 0; i < blocks_.size() * kBlock; ++i) {
    Followed& block = blocks_[i / kBlock];
    const bool real = i < source.size();
    set(block.source, i % kBlock, real ? source[i] : Eigen::Vector3f::Zero());
    block.clearance2[i % kBlock] = real ? 0.0F : kNowhere * kNowhere;
    block.room2[i % kBlock] = kNowhere * kNowhere;
    if (real) continue;
    for (Points& candidate : block.candidates)
      set(candidate, i % kBlock, Eigen::Vector3f::Constant(kNowhere));
  }
}

void Correspondences::residuals(std::size_t index, const Pose& T_map_base, Block& block) {
  const Constants T(T_map_base);
  Followed& followed = blocks_[index];
  transform(T, followed.source, followed.at);
  choose(followed);
  std::array<std::uint32_t, kBlock> stale;
  mark_stale(followed, max_distance_, stale);
  bool any = false;
  for (std::size_t i = 0; i < kBlock; ++i)
    if (stale[i] != 0) {
      search(followed, i);
      any = true;
    }
  if (any) choose(followed);
  make_residuals(T, max_distance_, followed, block);
}

void Correspondences::search(Followed& block, std::size_t i) const {
  const Eigen::Vector3f query(block.at.x[i], block.at.y[i], block.at.z[i]);
  const LocalMap::Candidates found =
      map_->search(query, max_distance_, kMargin * static_cast<float>(map_->voxel_size()));
  set(block.searched, i, query);
  for (std::size_t k = 0; k < found.points.size(); ++k) set(block.candidates[k], i, found.points[k]);
  const auto squared = [](float bound) {
    const float b = std::clamp(bound, 0.0F, kNowhere);
    return b * b;
  };
  block.clearance2[i] = squared(found.clearance);
  block.room2[i] = squared(found.room);
}

}  // namespace adit
