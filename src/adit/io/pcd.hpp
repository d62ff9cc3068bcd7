// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// PCD, the point cloud format of the Point Cloud Library, versions 0.5 to 0.7: ascii, binary and
/// binary_compressed.
#pragma once

#include <string>
#include <string_view>

#include "adit/io/cloud_files.hpp"

namespace adit {

/// Reads the bytes of a PCD file. Fields taken:
///  - x, y, z (F4 or F8), needed;
///  - intensity, intensities or i (any numeric type);
///  - t, time, time_offset, offset_time, timestamp or time_stamp, or the one that is `known`; in the unit
///    that is `known` or else found (packed_cloud.hpp). Times further than 2.1 s from 0 (absolute clocks) are
///    made relative to the earliest point.
/// All other fields are skipped. VIEWPOINT (tx ty tz qw qx qy qz) becomes CloudFile::viewpoint. Errors name
/// the header line or the byte offset.
Result<CloudFile> read_pcd(std::string_view bytes, const KnownTimes& known = {});

/// How points are written, by the words of the header line DATA.
enum class PcdData { ascii, binary, binary_compressed };

/// The bytes of a PCD 0.7 file with fields x y z F4, and where the cloud has them intensity F4 and t I4
/// (nanoseconds). `viewpoint` is the pose of the sensor: p_world = viewpoint * p. `comment`: one line for the
/// header.
[[nodiscard]] std::string write_pcd(const PointCloud& cloud, PcdData data = PcdData::binary,
                                    const Pose& viewpoint = {}, const std::string& comment = "");

}  // namespace adit
