// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/plane_aligner.hpp"

#include <cmath>
#include <limits>

#include "adit/core/parallel.hpp"
#include "adit/core/robust_kernel.hpp"

namespace adit {
namespace {

/// A search looks this many times farther than pairs may be apart, so that a point without a partner need not
/// be searched again at once.
constexpr float kReach = 1.25F;
constexpr std::size_t kBlocksPerPart = 64;  ///< Blocks per part of the parallel sum.
constexpr std::size_t kTriangle = 21;       ///< Entries of the upper triangle of H, row by row.

}  // namespace

/// p_a = R p_b + t.
struct PlaneAligner::Motion {
  explicit Motion(const Pose& T_a_b) {
    const Matrix3 rotation = T_a_b.rotation_matrix();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) R[i][j] = static_cast<float>(rotation(i, j));
      t[i] = static_cast<float>(T_a_b.translation()[i]);
    }
  }
  void apply(const Row (&p)[3], Row (&q)[3]) const {
    for (std::size_t k = 0; k < kWidth; ++k) {
      for (int d = 0; d < 3; ++d) q[d][k] = R[d][0] * p[0][k] + R[d][1] * p[1][k] + R[d][2] * p[2][k] + t[d];
    }
  }
  float R[3][3];
  float t[3];
};

/// What eight pairs contribute, as `plane_residual` defines it: residual and Jacobian by the plane of a, and
/// by that of b ("own"), both in the frame of b. Weights are 0 where there is no pair.
struct PlaneAligner::Terms {
  Row J[6];
  Row J_own[6];
  Row r;
  Row r_own;
  Row weight;
  Row weight_own;
  Row fit;
  Row is_pair;
};

/// Lane by lane, until the end of a part.
struct PlaneAligner::Sums {
  void add(const Terms& terms);

  Row H[kTriangle] = {};
  Row g[6] = {};
  Row fit = {};
  Row num_pairs = {};

  [[nodiscard]] PlaneEquations total() const {
    const auto over_lanes = [](const Row& row) {
      double sum = 0.0;
      for (const float value : row) sum += static_cast<double>(value);
      return sum;
    };
    PlaneEquations out;
    std::size_t entry = 0;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) out.H(i, j) = out.H(j, i) = over_lanes(H[entry++]);
      out.g[i] = over_lanes(g[i]);
    }
    out.fit = over_lanes(fit);
    out.num_pairs = over_lanes(num_pairs);
    return out;
  }
};

PlaneEquations& PlaneEquations::operator+=(const PlaneEquations& other) {
  H += other.H;
  g += other.g;
  fit += other.fit;
  num_pairs += other.num_pairs;
  return *this;
}

PlaneAligner::PlaneAligner(const OrientedPoints& a, const PointGrid& grid_a, const OrientedPoints& b,
                           std::size_t stride, double max_distance)
    : a_(a),
      grid_a_(grid_a),
      max_distance_(static_cast<float>(max_distance)),
      sample_size_((b.size() + stride - 1) / stride),
      blocks_((sample_size_ + kWidth - 1) / kWidth) {
  for (std::size_t i = 0; i < blocks_.size() * kWidth; ++i) {
    Block& block = blocks_[i / kWidth];
    const std::size_t k = i % kWidth;
    const bool is_point = i < sample_size_;
    for (int d = 0; d < 3; ++d) {
      block.p[d][k] = is_point ? b.points[i * stride][d] : 0.0F;
      block.n[d][k] = is_point ? b.normals[i * stride][d] : 0.0F;
      block.a[d][k] = block.n_a[d][k] = block.seen[d][k] = 0.0F;
    }
    block.others[k] = is_point ? 0.0F : std::numeric_limits<float>::infinity();  // search now; never
  }
}

/// Searches for the partner of point k. Where nothing lies within reach, nothing will lie within
/// `max_distance_` before the point has moved by the difference.
void PlaneAligner::search(Block& block, const Row (&q)[3], std::size_t k) const {
  constexpr float kRounding = 0.9999F;
  const float reach = kReach * max_distance_;
  const auto found = grid_a_.nearest_alone({q[0][k], q[1][k], q[2][k]}, reach * reach);
  block.others[k] =
      kRounding * (found ? std::sqrt(found->others_squared_distance) : 2.0F * (reach - max_distance_));
  for (int d = 0; d < 3; ++d) {
    block.seen[d][k] = q[d][k];
    block.a[d][k] = found ? a_.points[found->index][d] : q[d][k];
    block.n_a[d][k] = found ? a_.normals[found->index][d] : 0.0F;
  }
}

/// Searches for those points that may have another partner at `q` than the one they have.
void PlaneAligner::search_stale(Block& block, const Row (&q)[3]) const {
  Row slack;  // metres
  for (std::size_t k = 0; k < kWidth; ++k) {
    float to_partner = 0.0F;
    float moved = 0.0F;
    for (int d = 0; d < 3; ++d) {
      to_partner += (q[d][k] - block.a[d][k]) * (q[d][k] - block.a[d][k]);
      moved += (q[d][k] - block.seen[d][k]) * (q[d][k] - block.seen[d][k]);
    }
    slack[k] = block.others[k] - std::sqrt(to_partner) - std::sqrt(moved);
  }
  for (std::size_t k = 0; k < kWidth; ++k) {
    if (slack[k] <= 0.0F) search(block, q, k);
  }
}

/// `squared_kernel`: the kernel's scale k^2, square metres.
void PlaneAligner::evaluate(const Block& block, const Motion& motion, const Row (&q)[3], float squared_kernel,
                            Terms& out) const {
  const auto& R = motion.R;
  const auto& p = block.p;
  const auto& n = block.n;
  const auto& n_a = block.n_a;
  for (std::size_t k = 0; k < kWidth; ++k) {
    const float dx = q[0][k] - block.a[0][k];
    const float dy = q[1][k] - block.a[1][k];
    const float dz = q[2][k] - block.a[2][k];
    float m[3];  // a's normal in the frame of b
    for (int d = 0; d < 3; ++d) m[d] = R[0][d] * n_a[0][k] + R[1][d] * n_a[1][k] + R[2][d] * n_a[2][k];
    float n_own[3];  // b's normal in the frame of a
    for (int d = 0; d < 3; ++d) n_own[d] = R[d][0] * n[0][k] + R[d][1] * n[1][k] + R[d][2] * n[2][k];
    const float r = n_a[0][k] * dx + n_a[1][k] * dy + n_a[2][k] * dz;
    const float r_own = n_own[0] * dx + n_own[1] * dy + n_own[2] * dz;
    const float cosine = m[0] * n[0][k] + m[1] * n[1][k] + m[2] * n[2][k];
    const float is_real = n_a[0][k] * n_a[0][k] + n_a[1][k] * n_a[1][k] + n_a[2][k] * n_a[2][k];
    const bool is_pair = dx * dx + dy * dy + dz * dz <= max_distance_ * max_distance_ && is_real > 0.0F;
    const bool agree = std::abs(cosine) >= kAgreeingNormals;
    const float root = geman_mcclure_root(squared_kernel, r * r);
    const float root_own = geman_mcclure_root(squared_kernel, r_own * r_own);
    out.r[k] = r;
    out.r_own[k] = r_own;
    out.weight[k] = is_pair && agree ? root * root : 0.0F;
    out.weight_own[k] = is_pair && agree ? root_own * root_own : 0.0F;
    out.fit[k] = is_pair ? root : 0.0F;
    out.is_pair[k] = is_pair ? 1.0F : 0.0F;
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3;
      const int f = (d + 2) % 3;
      out.J[d][k] = m[d];
      out.J[3 + d][k] = p[e][k] * m[f] - p[f][k] * m[e];
      out.J_own[d][k] = n[d][k];
      out.J_own[3 + d][k] = p[e][k] * n[f][k] - p[f][k] * n[e][k];
    }
  }
}

void PlaneAligner::Sums::add(const Terms& terms) {
  for (std::size_t k = 0; k < kWidth; ++k) {
    fit[k] += terms.fit[k];
    num_pairs[k] += terms.is_pair[k];
  }
  std::size_t entry = 0;
  for (int i = 0; i < 6; ++i) {
    Row w;
    Row w_own;
    for (std::size_t k = 0; k < kWidth; ++k) {
      w[k] = terms.weight[k] * terms.J[i][k];
      w_own[k] = terms.weight_own[k] * terms.J_own[i][k];
      g[i][k] += w[k] * terms.r[k] + w_own[k] * terms.r_own[k];
    }
    for (int j = i; j < 6; ++j, ++entry) {
      for (std::size_t k = 0; k < kWidth; ++k)
        H[entry][k] += w[k] * terms.J[j][k] + w_own[k] * terms.J_own[j][k];
    }
  }
}

PlaneEquations PlaneAligner::linearize(const Pose& T_a_b, double kernel) {
  const Motion motion(T_a_b);
  const auto squared_kernel = static_cast<float>(kernel) * static_cast<float>(kernel);
  return parallel_sum(blocks_.size(), kBlocksPerPart, PlaneEquations{},
                      [&](std::size_t begin, std::size_t end) {
                        Sums sums;
                        Row q[3];
                        Terms terms;
                        for (std::size_t i = begin; i < end; ++i) {
                          motion.apply(blocks_[i].p, q);
                          search_stale(blocks_[i], q);
                          evaluate(blocks_[i], motion, q, squared_kernel, terms);
                          sums.add(terms);
                        }
                        return sums.total();
                      });
}

}  // namespace adit
