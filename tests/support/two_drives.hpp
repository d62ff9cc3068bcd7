// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "adit/io/mesh_files.hpp"
#include "adit/io/routes_yaml.hpp"
#include "adit/simulation/world.hpp"

namespace adit::test {

/// A robot that drives the waypoints `begin` to `end` of a route.
struct RoutePart {
  std::ptrdiff_t begin;
  std::ptrdiff_t end;
  std::string name;
};

/// world.ply and routes.yaml: a mine, and robots along one route through it.
inline void put_drives(const std::filesystem::path& folder, const std::vector<RoutePart>& drives) {
  WorldConfig config;
  config.preset = "mine";
  config.facet_factor = 4.0;
  const Result<World> world = make_world(config);
  ASSERT_TRUE(world);
  ASSERT_TRUE(write_mesh(folder / "world.ply", world->mesh));
  const Route& route = world->routes[0];
  std::vector<Route> routes;
  for (const RoutePart& drive : drives) {
    ASSERT_LE(drive.end, std::ssize(route.waypoints));
    routes.push_back({drive.name,
                      route.speed_mps,
                      {route.waypoints.begin() + drive.begin, route.waypoints.begin() + drive.end}});
  }
  ASSERT_TRUE(write_routes(folder / "routes.yaml", {"world.ply", routes}));
}

/// Robot `behind` follows `ahead` through the same tunnel, around a corner.
inline void put_two_drives(const std::filesystem::path& folder) {
  put_drives(folder, {{0, 50, "ahead"}, {10, 60, "behind"}});
}

}  // namespace adit::test
