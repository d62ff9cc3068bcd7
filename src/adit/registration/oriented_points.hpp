// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "adit/core/point_cloud.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// Points with the normals of the surface that they lie on.
struct OrientedPoints {
  std::vector<Eigen::Vector3f> points;   ///< Metres, in the frame of the cloud.
  std::vector<Eigen::Vector3f> normals;  ///< One each: unit length, pointing to the origin of that frame.
  /// One each, in the unit of the sensor, the mean of a voxel; or empty: not known, or not needed.
  std::vector<float> intensities = {};

  /// Of the points, and so of the normals.
  ///@{
  [[nodiscard]] std::size_t size() const { return points.size(); }
  [[nodiscard]] bool empty() const { return points.empty(); }
  ///@}
};

}  // namespace adit
