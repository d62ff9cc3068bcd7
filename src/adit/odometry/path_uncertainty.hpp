// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How well an odometry's path is known, by what its steps say of themselves.
#pragma once

#include <deque>
#include <optional>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"

namespace adit {

/// The error of a path has two parts. *Drift* stays: the map grows by scans that are off, and what follows is
/// off with them. *Pose noise* is a pose's own: the next pose is registered with the same map and does not
/// share it.
struct PathNoise {
  /// Variance that a metre adds, in covariances of one registration. The walls that a scan is registered with
  /// are replaced by new ones every few metres; those were placed by scans that were off by that covariance.
  double drift_per_metre = 0.5;
  /// Of roll and pitch beside that, a random walk, degrees after one metre: LiDARs whose ranges err with the
  /// angle at which they meet a wall, or from ring to ring, bend a map evenly, with no scan that says so.
  /// Measured on simulated drives: docs/decisions/0091-roll-and-pitch-drift.md.
  double roll_pitch_deg = 0.03;
  /// Of methods that do not state how well they predict: sigma after one metre, metres and degrees. They move
  /// in fewer directions than a scan could fix, so that its information says too much.
  double translation = 0.05;
  double rotation_deg = 0.15;
  double guessed = 5.0;  ///< Factor on both where odometry had no prediction to rely on.
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(PathNoise& noise);

/// Covariance of the relative pose over `distance_m` metres of such a method: a random walk (right
/// perturbation, [translation; rotation]). Distances below 1 cm count as 1 cm.
[[nodiscard]] Matrix6 random_walk(const PathNoise& noise, double distance_m);

/// Adds up the uncertainty of a path, step by step. All covariances are of right perturbations, [translation;
/// rotation], metres and radians.
///
/// Where the method states how well it predicts, a registration's covariance is the inverse of its
/// information; along directions that the scan leaves open the covariance is that of the prediction. Else the
/// drift is a random walk. The noise of a pose is estimated from the corrections of the last scans. Without
/// an IMU, a sweep is taken while the robot rocks and bumps, and the cloud is deskewed as if it moved evenly,
/// so that a pose at one instant is known no better than the motion can be foretold. With one, each scan
/// corrects a part of the same error, as successive scans hit the same surfaces: corrections of half a second
/// are added up.
class PathUncertainty {
 public:
  /// The first edge begins at the first step that enters the map.
  explicit PathUncertainty(const PathNoise& noise) : config_(noise) {}

  /// The next step; those that did not enter the map add nothing until one does.
  void add(const OdometryStep& step);
  /// From here on, `drift` counts anew.
  void begin_edge();

  /// Of the motion from where the edge began to the last step that entered the map; at least a tenth of a
  /// millimetre, so that it is a covariance even where the robot stood still.
  [[nodiscard]] Matrix6 drift() const;
  /// Of the noise of the last pose that entered the map.
  [[nodiscard]] Matrix6 pose_noise() const { return corrections_ + registration_; }

 private:
  [[nodiscard]] Matrix6 drift_of(const OdometryStep& step, double metres);
  void learn(const OdometryStep& step);

  PathNoise config_;
  std::optional<Pose> T_odom_last_;         ///< The last step that entered the map.
  Pose T_odom_begin_;                       ///< Where the edge began.
  bool is_stated_ = true;                   ///< All steps of the edge stated how well they were predicted.
  bool is_guessed_ = false;                 ///< A step of the edge was a guess.
  Matrix6 drift_ = Matrix6::Zero();         ///< What the steps that stated it add up to.
  Matrix6 registration_ = Matrix6::Zero();  ///< Of the last registration, along directions that it fixed.
  std::deque<Vector6> recent_;              ///< Corrections, carried to the last pose.
  Matrix6 corrections_ = Matrix6::Zero();   ///< Mean square of the last ones.
  int num_corrections_ = 0;
};

}  // namespace adit
