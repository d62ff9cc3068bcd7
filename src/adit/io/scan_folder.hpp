// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A folder of clouds as the recording of one robot.
///
/// Scans are all .pcd, .ply or .bin files of the folder (of one kind), or of its folder `velodyne`, as in a
/// sequence of KITTI, ordered by the last number in their names. Beside them, or in the sequence, each where
/// it is known:
///  - `stamps.txt`, or KITTI's `times.txt`: one decimal stamp in seconds per line, one line per scan. Without
///    either, the number in the name counts as seconds (0017.pcd: 17 s);
///  - `recording.toml`: `robot` and `lidar`, their names, and `mount`, the pose of the LiDAR on the robot
///    (see mount.hpp) when the clouds are in the LiDAR's frame;
///  - `odometry.tum` (T_wheelodom_base) and `groundtruth.tum` (T_world_base), on the clock of the stamps.
///    Without the latter, the ground truth of a sequence of KITTI is that of its camera (`poses.txt`, or
///    `poses/07.txt` of the whole set) by way of `calib.txt`; where they do not fit it is left out, and the
///    recording's `assumptions` say why;
///  - `NNNNNN.offsets` beside a .bin, which has no room for them: the points' times, int32 nanoseconds from
///    the scan's stamp, little-endian.
///
/// What the first cloud that can be read shows of the times of points holds for all, and all .bin have as
/// many columns, as stated or found (kitti.hpp). `assumptions` say where the first has no times.
///
/// The mount comes from, in this order: the caller; recording.toml; the VIEWPOINT that all .pcd files share;
/// the clouds themselves, when they show clearly where the sensor stood (geometry/sensor_origin.hpp: then the
/// clouds' frame is the base frame); else the clouds' origin is assumed to be the sensor, the recording's
/// `assumptions` say so, and with wheels, whose frame could then be anywhere, it is an error.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/cloud_files.hpp"

namespace adit {

/// Which scans of the folder to take: first, first + step, first + 2 step ...
struct ScanSelection {
  std::size_t first = 0;  ///< Counted from 0, in the order of the scans.
  std::size_t step = 1;   ///< 1 or more.
};

/// What is known of the clouds of a folder.
struct FolderReading {
  std::optional<Pose> T_base_lidar = {};  ///< Overrides what the folder says of the mount.
  CloudReading clouds = {};               ///< What is stated of them (stated_reading).
};

/// Scans are read when asked for, from any thread. Errors: no clouds, clouds of several kinds, two scans of
/// one number, a single scan, stamps not ascending or not as many as scans, an odometry that covers none of
/// the scans, wheels without a mount, clouds that are not as stated.
Result<Recording> read_scan_folder(const std::filesystem::path& folder, ScanSelection selection = {},
                                   const FolderReading& reading = {});

/// Writes NNNNNN.pcd (.ply, .bin) in the LiDAR's frame, stamps.txt, recording.toml, and odometry.tum and
/// groundtruth.tum where the recording has them: all that `read_scan_folder` takes, so that nothing is lost.
/// The folder appears whole or not at all. Returns how many scans have no points and are left out, as formats
/// of clouds have no empty ones; fails where no scan has any.
Result<std::size_t> write_scan_folder(const std::filesystem::path& folder, const Recording& recording,
                                      CloudFormat clouds = CloudFormat::pcd);

}  // namespace adit
