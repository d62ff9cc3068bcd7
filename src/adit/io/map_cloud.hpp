// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Clouds of maps, which hold more of a point than those of scans.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "adit/core/point_cloud.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// A cloud with, for each point, who saw it and how the surface lies. Times of points are not part of it.
struct MapCloud {
  PointCloud cloud;                      ///< Intensities as sensors give them; 0 of robots without.
  std::vector<std::uint16_t> robots;     ///< Numbers from 1 on, one per point.
  std::vector<Eigen::Vector3f> normals;  ///< Unit length, to the free side, zero where unknown; or empty.
};

/// Binary .ply (x, y, z, intensity, nx, ny, nz, robot) or .pcd (the same with normal_x, normal_y, normal_z),
/// without fields that the cloud does not have. `comment`: a line for people in the header. The file appears
/// whole or not at all. Fails on an empty cloud and on other endings.
Result<> write_map_cloud(const std::filesystem::path& path, const MapCloud& map,
                         const std::string& comment = "");

}  // namespace adit
