// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What makes two sensors see one wall at different distances: a constant error of range, an error that grows
/// with the angle of incidence, and one per ring. All move a patch of wall along the ray, so a robust fit
/// over many patches tells them from relief, which belongs to a place (decision 0035).
#pragma once

#include <Eigen/Core>
#include <span>

#include "adit/core/pose.hpp"

namespace adit {

/// How a sensor sees a patch of wall.
struct PatchView {
  float cosine = 1.0F;     ///< Of the angle between ray and normal.
  float elevation = 0.0F;  ///< Of the ray, radians, in the frame of the robot.
};

/// How far a patch of b's wall is in front of a's, metres, and how both saw it.
struct SeenOffset {
  double metres = 0.0;
  PatchView by_a;
  PatchView by_b;
};

/// Errors of range by sensor, standard deviations in metres: what data sheets allow.
struct SensorPrior {
  double bias_m = 0.03;
  double walk_m = 0.03;  ///< At grazing incidence.
  double ring_m = 0.01;
};

/// Errors of range of both sensors. Only what tells them apart is well known; the rest is the prior's.
class SensorDifference {
 public:
  /// None.
  SensorDifference();
  /// Robust (Huber), with the prior; `offsets` may be few or none.
  SensorDifference(std::span<const SeenOffset> offsets, const SensorPrior& prior);

  /// The part of the offset that the sensors explain.
  [[nodiscard]] double explains(const SeenOffset& offset) const;
  /// Range error of b minus that of a for a surface met head-on at the horizon.
  [[nodiscard]] double bias_m() const;

 private:
  Eigen::VectorXd errors_;
};

}  // namespace adit
