// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// LAS 1.4 (ASPRS, "LAS Specification 1.4 - R15", 2019), the point clouds of surveyors: what CloudCompare,
/// PDAL, QGIS and mine planning programs open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// What adit writes of a point.
struct LasPoint {
  Vector3 position;             ///< Metres, in the frame of `crs_wkt`.
  std::uint16_t intensity = 0;  ///< Scaled to 16 bits.
  std::uint16_t source = 0;  ///< Point source ID: which robot saw it, from 1 on; 0 is for what was made up.
};

/// Coordinates in metres about no known place on Earth.
inline constexpr const char* kLocalCrs = "LOCAL_CS[\"adit map\",UNIT[\"metre\",1]]";

/// Point format 6, to millimetres, with `crs_wkt` (OGC WKT 1) as its coordinate system. Fails where
/// coordinates span 2,000 km, or are not finite.
Result<> write_las(const std::filesystem::path& path, const std::vector<LasPoint>& points,
                   const std::string& crs_wkt = kLocalCrs);

}  // namespace adit
