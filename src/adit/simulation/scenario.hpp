// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/simulation/imu_model.hpp"
#include "adit/simulation/lidar_model.hpp"
#include "adit/simulation/trajectory.hpp"
#include "adit/simulation/wheel_model.hpp"
#include "adit/simulation/world.hpp"

namespace adit {

struct ScenarioConfig {
  LidarConfig lidar;
  WheelConfig wheels;
  ImuConfig imu;
  DriveConfig drive;
  std::uint64_t seed = 1;
};

inline Fields fields_of(ScenarioConfig& c) {
  Fields fields{{"seed", &c.seed, "", 0, 1e15, "seed of all noise of sensors and wheels"}};
  append(fields, "lidar", fields_of(c.lidar));
  append(fields, "wheels", fields_of(c.wheels));
  append(fields, "imu", fields_of(c.imu));
  append(fields, "drive", fields_of(c.drive));
  return fields;
}

/// Drives every route of the world at the same time, each robot on a clock that starts at 0. One recording
/// per route, in their order. No scan is cast or stored now: `read_scan(i)` casts scan i on demand, always
/// the same one, on any thread. Wheels and IMU cover every sweep from its start, their faults apart; `truth`
/// has a pose at every scan stamp and between them. Each sensor draws its errors apart from the others.
///
/// Fails on a mesh that `check_mesh` refuses, a field out of range, no route at all, two routes of one name,
/// and routes that `drive` refuses. One phase of progress; may throw `Cancelled` (core/progress.hpp).
[[nodiscard]] Result<std::vector<Recording>> simulate(const World& world, const ScenarioConfig& config);

}  // namespace adit
