// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "tunnel_inputs.hpp"

#include "adit/simulation/scenario.hpp"
#include "harness/bench_case.hpp"

namespace adit::bench {
namespace {

template <class T>
T needed(Result<T> result) {
  if (!result) throw Skipped{result.error().message};
  return *std::move(result);
}

}  // namespace

Tunnel::Tunnel(const std::string& preset, std::uint64_t seed, const std::string& lidar)
    : Tunnel(needed(make_world({.preset = preset, .seed = seed})), needed(lidar_preset(lidar))) {}

Tunnel::Tunnel(const World& world, const LidarConfig& lidar)
    : lidar_(lidar), raycaster_(needed(Raycaster::build(world.mesh))) {
  for (const Route& route : world.routes) paths_.push_back(needed(drive(raycaster_, route, {}, Stamp{})));
}

PointCloud Tunnel::seen_from(const Pose& T_world_base, std::uint64_t noise_seed) const {
  const Pose T_base_sensor = T_base_lidar(lidar_);
  const Pose T_world_sensor = T_world_base * T_base_sensor;
  return transformed(
      T_base_sensor,
      cast_scan(raycaster_, lidar_, {T_world_sensor, T_world_sensor, Stamp{}, noise_seed}).cloud);
}

std::vector<Pose> poses_along(const Trajectory& path, double spacing) {
  std::vector<Pose> out;
  double to_next = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Pose& T = path[i].T_world_body;
    if (i > 0) to_next -= (T.translation() - path[i - 1].T_world_body.translation()).norm();
    if (to_next > 0.0) continue;
    out.push_back(T);
    to_next += spacing;
  }
  return out;
}

}  // namespace adit::bench
