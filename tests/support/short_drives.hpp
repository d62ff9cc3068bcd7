// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Drives of a few seconds with a small sensor, for tests of studies.
#pragma once

#include "adit/io/routes_yaml.hpp"
#include "adit/slam/run_config.hpp"
#include "adit/study/merge_worlds.hpp"
#include "support/hall.hpp"

namespace adit::test {

inline constexpr double kShortDriveMetres = 5.0;

/// Sixteen beams of 180 columns, five scans per second.
inline RunConfig quick_config() {
  RunConfig config;
  config.simulation.lidar = lidar_preset("vlp-16").value();
  config.simulation.lidar.columns = 180;
  config.simulation.lidar.rate_hz = 5.0;
  return config;
}

/// `folder`/routes.yaml: robots that follow one another through `folder`/hall.ply, three metres apart.
inline ListedWorld put_short_drives(const std::filesystem::path& folder,
                                    const std::vector<std::string>& names = {"ahead", "behind"}) {
  put_hall(folder);
  RoutesFile routes{"hall.ply", {}};
  double begin = 16.0;
  for (const std::string& name : names) {
    Route& route = routes.routes.emplace_back(Route{.name = name, .speed_mps = 1.8, .waypoints = {}});
    for (double metres = 0.0; metres <= kShortDriveMetres; metres += 1.0)
      route.waypoints.emplace_back(begin + metres, 0.0, 0.0);
    begin -= 3.0;
  }
  const Result<> written = write_routes(folder / "routes.yaml", routes);
  EXPECT_TRUE(written) << written.error().message;
  ListedWorld world;
  world.name = "hall";
  world.routes_file = (folder / "routes.yaml").string();
  return world;
}

}  // namespace adit::test
