// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <span>

#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// A box of any orientation: centre and axes in `T_world_box`, lengths of its edges along x, y, z of the box.
struct OrientedBox {
  Pose T_world_box;                   ///< Its translation is the middle of the box.
  Vector3 extents = Vector3::Zero();  ///< Metres, descending.

  /// Cubic metres.
  [[nodiscard]] double volume() const { return extents.prod(); }
};

/// The box of a cloud by principal axes, as the paper takes it from Open3D: the axes are the eigenvectors of
/// the covariance of the **vertices of the convex hull**, so that the box depends on the shape of the cloud
/// and not on how densely each wall was sampled; the extents are the ranges of the points along them.
/// `points` in the frame "world", in any order and number, duplicates allowed; points that are not finite are
/// ignored. Planar and collinear clouds give boxes with one or two extents of (nearly) zero. Equal input
/// gives equal bytes. Error: no point is finite. Source: the paper, section 2.3; Zhou, Park, Koltun,
/// "Open3D", 2018.
[[nodiscard]] Result<OrientedBox> oriented_box(std::span<const Eigen::Vector3f> points);

}  // namespace adit
