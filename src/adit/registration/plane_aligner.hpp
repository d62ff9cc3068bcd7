// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/geometry/point_grid.hpp"
#include "adit/registration/oriented_points.hpp"

namespace adit {

/// Least cosine between the normals of a pair that counts: 37 degrees.
inline constexpr float kAgreeingNormals = 0.8F;

/// Gauss-Newton's normal equations H step = -g of the plane residuals at one pose, weighted by the
/// Geman-McClure kernel, for a right perturbation [translation; rotation].
struct PlaneEquations {
  Matrix6 H = Matrix6::Zero();  ///< Sum of J^T w J, J being the derivative of a residual.
  Vector6 g = Vector6::Zero();  ///< Sum of J^T w r.
  double fit = 0.0;  ///< Sum over pairs of k^2 / (k^2 + r^2), r from the plane of a: at best 1 per pair.
  double num_pairs = 0.0;  ///< Points of b with a partner within the largest distance.
  /// Adds those of other pairs at the same pose.
  PlaneEquations& operator+=(const PlaneEquations& other);
};

/// Pairs a sample of cloud b with the nearest points of cloud a, pose after pose. A pair is kept from one
/// pose to the next as long as its point has moved too little for any other point of a to become the nearest:
/// pairs are always exact, and near convergence nothing is searched.
class PlaneAligner {
 public:
  /// Takes every `stride`-th point of b. Pairs lie within `max_distance` metres. `a` and `grid_a` must
  /// outlive the aligner.
  PlaneAligner(const OrientedPoints& a, const PointGrid& grid_a, const OrientedPoints& b, std::size_t stride,
               double max_distance);

  /// The planes of both clouds count (Rusinkiewicz, "A symmetric objective function for ICP", 2019), and only
  /// where they agree: far out, a spinning sensor sees the ground as the line of one ring, whose normal is
  /// noise. `kernel`: scale k of the Geman-McClure kernel, metres.
  [[nodiscard]] PlaneEquations linearize(const Pose& T_a_b, double kernel);

  /// Points of b that take part, with a partner or without.
  [[nodiscard]] std::size_t sample_size() const { return sample_size_; }

 private:
  static constexpr std::size_t kWidth = 8;
  using Row = float[kWidth];
  /// Eight points side by side, for vector registers.
  struct alignas(32) Block {
    Row p[3];  ///< Of b, in the frame of b.
    Row n[3];  ///< Its normal; zero: padding.
    Row a[3];  ///< The nearest point of a; a zero normal: none was found.
    Row n_a[3];
    Row seen[3];  ///< Where p was, in the frame of a, when it was searched.
    Row others;   ///< No other point of a was nearer to `seen` than this.
  };
  struct Motion;
  struct Terms;
  struct Sums;
  void search(Block& block, const Row (&q)[3], std::size_t k) const;
  void search_stale(Block& block, const Row (&q)[3]) const;
  void evaluate(const Block& block, const Motion& motion, const Row (&q)[3], float squared_kernel,
                Terms& out) const;

  const OrientedPoints& a_;
  const PointGrid& grid_a_;
  float max_distance_;
  std::size_t sample_size_;
  std::vector<Block> blocks_;
};

}  // namespace adit
