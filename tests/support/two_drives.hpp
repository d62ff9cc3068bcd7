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

/// The waypoints `begin` to `end` of a route, for a robot of another name.
inline Route part_of(const Route& route, std::ptrdiff_t begin, std::ptrdiff_t end, const std::string& name) {
  return {name, route.speed_mps,
          std::vector<Vector3>(route.waypoints.begin() + begin, route.waypoints.begin() + end)};
}

/// world.ply and routes.yaml: robot `behind` follows `ahead` through the same tunnel, around a corner.
inline void put_two_drives(const std::filesystem::path& folder) {
  WorldConfig config;
  config.preset = "mine";
  config.facet_factor = 4.0;
  const Result<World> world = make_world(config);
  ASSERT_TRUE(world);
  ASSERT_TRUE(write_mesh(folder / "world.ply", world->mesh));
  const Route& route = world->routes[0];
  ASSERT_TRUE(
      write_routes(folder / "routes.yaml",
                   {"world.ply", {part_of(route, 0, 50, "ahead"), part_of(route, 10, 60, "behind")}}));
}

}  // namespace adit::test
