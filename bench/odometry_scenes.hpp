// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Drives that odometry is timed on: one easy to describe, three simulated networks, one real recording.
#pragma once

#include <string>
#include <vector>

#include "adit/core/records.hpp"
#include "support/synthetic_scan.hpp"

namespace adit::bench {

/// The first scans of one robot, all in memory.
struct RecordedDrive {
  Pose T_base_lidar;
  std::vector<Scan> scans;         ///< In the lidar frame.
  std::vector<WheelDelta> wheels;  ///< Motion of the base since the scan before; empty without wheels.
  std::vector<Vector3> truth;      ///< Position of the base, in the frame of the base at the first scan.
};

struct OdometryScene {
  std::string name;
  std::string what;  ///< For the page.
  int num_scans;
  bool has_wheels;
  RecordedDrive (*load)();  ///< Throws Skipped when the data are absent.
};
[[nodiscard]] const std::vector<OdometryScene>& odometry_scenes();
[[nodiscard]] const OdometryScene& odometry_scene(const std::string& name);

/// A smooth tube with boxes, and a robot that drives through it from rest to 1.87 m/s. Its LiDAR spins: rings
/// of fixed elevation, columns of equal azimuth steps, the same in every turn.
struct TubeDrive {
  test::Scene scene;
  test::Lidar lidar;
  test::Drive drive;

  TubeDrive(int rings, int columns);
  [[nodiscard]] Scan scan(int i) const;
  [[nodiscard]] WheelDelta wheels(int i) const;
  [[nodiscard]] Pose truth(int i) const;
};

}  // namespace adit::bench
