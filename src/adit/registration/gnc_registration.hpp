// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Robust rigid registration of given correspondences, rotation and translation apart (TEASER: Yang, Shi,
/// Carlone, T-RO 2020; GNC: Yang, Antonante, Tzoumas, Carlone, RA-L 2020; as combined by KISS-Matcher,
/// section III-E).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// The rotation that best turns b_k into a_k, k = 1 .. n, although many pairs are wrong: graduated
/// non-convexity with the truncated least-squares cost, sum of min(|a_k - R b_k|^2, bound^2), R from a
/// singular value decomposition in each iteration (Yang et al., RA-L 2020, eqs. 12 to 14).
struct GncRotation {
  Matrix3 R_a_b = Matrix3::Identity();  ///< Turns b_k into a_k.
  std::vector<double> weights;          ///< One per pair, 0 to 1; 1/2 and more is an inlier.
  int iterations = 0;  ///< At most `gnc_max_iterations`; 0 where all pairs were inliers at once.
};
/// None with fewer than 2 pairs, or when all inliers point in one direction, which leaves the rotation about
/// it open. `bound` in the unit of the vectors.
[[nodiscard]] std::optional<GncRotation> gnc_rotation(std::span<const Vector3> a, std::span<const Vector3> b,
                                                      double bound, const RegistrationConfig& config);

/// The scalar t that minimises sum of min((t - values_k)^2, bound^2), exactly: by a sweep over the 2 n ends
/// of the intervals values_k +- bound (TEASER, algorithm 1). `values` must not be empty.
[[nodiscard]] double truncated_mean(std::span<const double> values, double bound);

/// The result of the global stage.
struct GlobalSolution {
  Pose T_a_b;  ///< p_a = T_a_b * p_b, to the noise of single points: not refined.
  std::vector<std::uint32_t>
      inliers;  ///< Of the correspondences, ascending: those that agree in all three axes.
};
/// Registers points_a[k] with points_b[k]. The rotation is found from the differences of points that are
/// apart in the list by its golden section (translation cancels), the translation axis by axis from the
/// rotated points. `bound` is the noise of a point, metres; that of a difference is twice it. None with fewer
/// than 3 correspondences, or where the rotation is open.
[[nodiscard]] std::optional<GlobalSolution> align_robustly(std::span<const Eigen::Vector3f> points_a,
                                                           std::span<const Eigen::Vector3f> points_b,
                                                           double bound, const RegistrationConfig& config);

}  // namespace adit
