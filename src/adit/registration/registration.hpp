// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Global registration of two clouds without a first guess: KISS-Matcher (Lim et al., arXiv 2409.15615), then
/// optionally a point-to-plane refinement, then a verdict. The same answer on every run and with any number
/// of threads.
#pragma once

#include <optional>
#include <string>

#include "adit/core/point_cloud.hpp"
#include "adit/core/pose.hpp"
#include "adit/core/records.hpp"
#include "adit/registration/features.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// The relative pose of two clouds with its evidence. `accepted` implies that `T_a_b` is there. A rejected
/// registration may still carry its best guess, for display and diagnosis only.
struct Registration {
  std::optional<Pose> T_a_b;    ///< p_a = T_a_b * p_b.
  int num_correspondences = 0;  ///< After matching.
  int num_pruned = 0;           ///< Left after the consistency graph was pruned.
  int num_inliers = 0;          ///< Of those, agreeing with the global solution.
  double overlap =
      0.0;  ///< Share of points with a neighbour in the other cloud, the smaller of both directions.
  /// Inverse covariance of T_a_b (right perturbation, [translation; rotation]), from the residuals between
  /// points and planes. Along directions that the geometry leaves open it says no more than that both scans
  /// are of one place: some 3 m, 0.5 rad. Zero as a whole where there is no transform or too few inliers.
  Matrix6 information = Matrix6::Zero();
  /// Share of the smallest eigenvalue of the translational part of the point-to-plane Hessian in its trace: 0
  /// when the clouds can slide along an axis (smooth tunnel), 1/3 when all directions are held alike.
  double weak_axis = 0.0;
  Vector3 weak_direction = Vector3::Zero();     ///< That axis in frame a, unit length; zero when unknown.
  LoopVerdict verdict = LoopVerdict::rejected;  ///< Whether T_a_b can be relied on.
  std::string reason;                           ///< One sentence: why.
};

/// The pose of b in the frame of a, without a guess. Both clouds in metres, each in the frame of its sensor
/// or of its robot's base; a cloud without usable points is rejected with a reason, never an error.
[[nodiscard]] Registration register_features(const Features& a, const Features& b,
                                             const RegistrationConfig& config);
/// The same of clouds, whose features are computed first.
[[nodiscard]] Registration register_clouds(const PointCloud& a, const PointCloud& b,
                                           const RegistrationConfig& config);

/// The pose near `T_a_b` at which the surfaces of the clouds fit best: point-to-plane from this one guess,
/// without features and without a verdict. For guesses that are good to `refine_distance_voxels`, such as
/// those of odometry.
[[nodiscard]] Pose align_clouds(const PointCloud& a, const PointCloud& b, const Pose& T_a_b,
                                const RegistrationConfig& config);

}  // namespace adit
