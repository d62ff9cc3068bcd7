// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/simulation/lidar_model.hpp"
#include "adit/simulation/raycaster.hpp"
#include "adit/simulation/world.hpp"

namespace adit::bench {

/// A simulated tunnel network and the path of each of its robots through it.
class Tunnel {
 public:
  /// The world `preset` with `seed`, seen by the sensor of that name.
  Tunnel(const std::string& preset, std::uint64_t seed, const std::string& lidar);

  [[nodiscard]] const std::vector<Trajectory>& paths() const { return paths_; }
  /// What the sensor sees from a robot that stands at T_world_base, in the base frame.
  [[nodiscard]] PointCloud seen_from(const Pose& T_world_base, std::uint64_t noise_seed) const;

 private:
  Tunnel(const World& world, const LidarConfig& lidar);

  LidarConfig lidar_;
  Raycaster raycaster_;
  std::vector<Trajectory> paths_;
};

/// Poses every `spacing` metres along a path.
[[nodiscard]] std::vector<Pose> poses_along(const Trajectory& path, double spacing);

}  // namespace adit::bench
