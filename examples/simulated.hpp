// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The recordings of the examples: robots in the procedural tunnels `zab`, with a thinned sensor.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "adit/simulation/scenario.hpp"
#include "adit/simulation/world.hpp"

namespace example {

/// Every `step`-th scan of [first, last) of a recording; scans are cast when they are asked for.
inline adit::Recording part_of(adit::Recording recording, std::size_t first, std::size_t last,
                               std::size_t step = 1) {
  std::vector<adit::Stamp> stamps;
  std::vector<std::size_t> chosen;
  for (std::size_t i = first; i < std::min(last, recording.num_scans()); i += step) {
    stamps.push_back(recording.scan_stamps[i]);
    chosen.push_back(i);
  }
  recording.scan_stamps = std::move(stamps);
  recording.read_scan = [read = std::move(recording.read_scan), chosen](std::size_t i) {
    return read(chosen.at(i));
  };
  return recording;
}

/// The four robots of `zab`, each on its whole route.
inline adit::Result<std::vector<adit::Recording>> zab_robots() {
  adit::ScenarioConfig config;
  return adit::lidar_preset("os2-32")
      .and_then([&](const adit::LidarConfig& lidar) {
        config.lidar = lidar;
        return adit::make_world({});
      })
      .and_then([&](const adit::World& world) { return adit::simulate(world, config); });
}

/// Two of them on the stretch of about 70 m that both drive along, each from a start of its own.
inline adit::Result<std::vector<adit::Recording>> two_robots_of_zab(std::size_t step = 2) {
  return zab_robots().map([&](const std::vector<adit::Recording>& robots) {
    return std::vector{part_of(robots[1], 1050, 1450, step), part_of(robots[3], 1130, 1530, step)};
  });
}

}  // namespace example
