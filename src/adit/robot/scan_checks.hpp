// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a recording's scans show of the LiDAR and of its mount, measured on a sample of the scans before a
/// map is made of them. Numbers alone: slam/doctor.hpp judges them.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// When scans came.
struct ScanTiming {
  double interval_s = 0.0;        ///< The usual one, by the median; 0 with fewer than two scans.
  std::size_t num_missing = 0;    ///< As many as gaps of more than 1.5 intervals have room for.
  double longest_gap_s = 0.0;     ///< Between two scans that follow one another.
  double longest_gap_at_s = 0.0;  ///< Seconds from the first scan.
};
/// `scan_stamps` ascend.
[[nodiscard]] ScanTiming timing_of(const std::vector<Stamp>& scan_stamps);

/// The floor in the base frame, where z should be 0 and upwards.
struct FloorSeen {
  Vector3 up = Vector3::UnitZ();  ///< Its normal.
  double height_m = 0.0;          ///< Of the floor at the base's origin.
  double spread_deg = 0.0;        ///< Of the normal from scan to scan, half of the scans within it.
};

/// Where returns stay although the robot moves: parts of the robot.
struct SelfHits {
  double share = 0.0;        ///< Of all returns.
  double nearest_m = 0.0;    ///< From the LiDAR, to 10 cm.
  double farthest_m = 0.0;   ///< From the LiDAR, to 10 cm; at most some 1.2 m are looked at.
  double azimuth_deg = 0.0;  ///< Of their middle, from the LiDAR, in the axes of the base.
};

/// What a sample of the scans shows.
struct ScansSeen {
  std::size_t num_scans = 0;  ///< Looked at, spread over the recording.
  double points = 0.0;        ///< Of a scan, the median.
  bool has_times = false;     ///< All these scans have times of their points.
  double sweep_s = 0.0;       ///< From the first to the last point, by their times; the median.
  double nearest_m = 0.0;     ///< One return in a hundred is nearer,
  double median_m = 0.0;      ///< half of them are,
  double farthest_m = 0.0;    ///< and none is farther.
  /// Share of all returns within the last 3 % before `farthest_m`: large where something cuts them off.
  double share_at_the_end = 0.0;
  double cone_deg = 180.0;         ///< Half the opening of the cone in which 99 of 100 returns lie.
  double field_of_view_deg = 0.0;  ///< Azimuths in which at least one scan in ten has a return.
  std::vector<std::pair<double, double>>
      blind_deg;  ///< Sectors without, from and to, anticlockwise in the axes of the base: 0 is ahead.
  std::optional<FloorSeen> floor;      ///< None where too few scans show one.
  std::optional<SelfHits> self_hits;   ///< None where there are none; not looked for while the robot stands.
  bool has_moved = false;              ///< By the wheels, 5 m or more between the scans.
  std::optional<std::string> damaged;  ///< How many scans cannot be read, and why the first cannot.
};
/// Reads up to `num` scans. Fails where none can be read and where all are empty.
[[nodiscard]] Result<ScansSeen> look_at_scans(const Recording& recording, std::size_t num = 40);

}  // namespace adit
