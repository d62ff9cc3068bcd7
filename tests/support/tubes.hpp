// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Clouds of plain tubes, for tests alone.
#pragma once

#include "adit/core/point_cloud.hpp"

namespace adit {

/// Walls and ceiling of a tube of rectangular section along x, one point every half metre.
inline void add_tube(PointCloud& cloud, double length, double width, double height, const Pose& T_base_tube) {
  const auto add = [&](double x, double y, double z) {
    cloud.points.emplace_back((T_base_tube * Vector3(x, y, z)).cast<float>());
  };
  for (double x = -0.5 * length; x <= 0.5 * length; x += 0.5) {
    for (double z = 0.0; z <= height; z += 0.5) {
      add(x, -0.5 * width, z);
      add(x, 0.5 * width, z);
    }
    for (double y = -0.5 * width; y <= 0.5 * width; y += 0.5) {
      add(x, y, 0.0);
      add(x, y, height);
    }
  }
}

inline PointCloud straight_tube() {
  PointCloud cloud;
  add_tube(cloud, 100.0, 10.0, 7.0, Pose::planar(0, 0, 0.3));
  return cloud;
}

inline PointCloud junction() {
  PointCloud cloud = straight_tube();
  add_tube(cloud, 60.0, 6.0, 5.0, Pose::planar(0, 0, 0.3 + 1.5));
  return cloud;
}

}  // namespace adit
