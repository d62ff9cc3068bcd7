// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adit/core/point_cloud.hpp"
#include "adit/registration/oriented_points.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// A fast point feature histogram (Rusu et al., ICRA 2009): three histograms of 11 bins, each summing to
/// about 100 and rounded, so one byte per bin.
inline constexpr int kDescriptorSize = 33;
/// The histograms of theta, of alpha and of phi, one after the other (fpfh.hpp).
using Descriptor = std::array<std::uint8_t, kDescriptorSize>;

/// What registration needs of a cloud; compute it once per keyframe and keep it (57 bytes per point). Points
/// without a reliable descriptor are left out, and so are all intensities.
struct Features : OrientedPoints {
  std::vector<Descriptor> descriptors;  ///< One each, of the surface around it (fpfh.hpp).
};

/// Thins the cloud to one point (the mean) per voxel and describes each. `cloud` is in the frame of the
/// sensor or of the robot's base, metres: normals are turned towards its origin. NaN points are dropped. An
/// empty result is not an error here; the registration says what was missing.
[[nodiscard]] Features compute_features(const PointCloud& cloud, const RegistrationConfig& config);

/// The same without descriptors, of all points that have a surface around them.
[[nodiscard]] OrientedPoints compute_surface(const PointCloud& cloud, const RegistrationConfig& config);

}  // namespace adit
