// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "adit/core/pose.hpp"

namespace adit {

/// How well a surface pins the translation of a scan against it: eigenvalues and axes of the normalised
/// translational information of point-to-plane registration, mean(n n^T) over the unit normals n. The
/// eigenvalues sum to 1; a room with equal area to all sides has 1/3 each, a straight smooth tube has 0 along
/// its axis. No threshold of site or sensor. Source: LAMP 2.0 (Chang et al. 2022) with its running maximum
/// replaced by the absolute scale.
struct Alignability {
  Vector3 eigenvalues = Vector3::Zero();  ///< Ascending, in [0, 1], sum 1.
  Matrix3 axes = Matrix3::Identity();     ///< Column i belongs to eigenvalue i.

  [[nodiscard]] double weakest() const { return eigenvalues.x(); }  ///< In [0, 1/3].
  [[nodiscard]] Vector3 weak_axis() const { return axes.col(0); }   ///< Unit length; its sign means nothing.
};

/// Of given unit normals; zero and non-finite ones (no surface there) are left out. Nothing when none
/// remains.
[[nodiscard]] std::optional<Alignability> alignability(std::span<const Eigen::Vector3f> normals);

/// Of a cloud seen from the origin of its frame: thinned to one point a voxel so that near walls do not
/// outvote far ones, normals from the neighbours within `2.5 * voxel`. Nothing when no point has a normal.
[[nodiscard]] std::optional<Alignability> alignability_of_points(std::span<const Eigen::Vector3f> points,
                                                                 double voxel = 0.5);

}  // namespace adit
