// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// routes.yaml: which world, and where each robot drives in it.
///
///     world: world.ply            # relative to this file
///     robots:
///       - name: robot_0
///         speed: 1.87             # m/s, mean
///         waypoints: [[x, y, z], ...]   # on the floor, metres, z up
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/simulation/route.hpp"

namespace adit {

/// A world and the routes in it.
struct RoutesFile {
  std::filesystem::path world;  ///< As written in the file; relative to it. Empty when the file names none.
  std::vector<Route> routes;    ///< In the order of the file.
};

/// Errors name line and column: unknown or repeated keys, a missing name, two robots of one name, a name that
/// cannot name a file, a speed that is not positive, fewer than two waypoints, a waypoint without three
/// finite numbers.
Result<RoutesFile> parse_routes(const std::string& yaml);
/// Reads the file; a relative `world` comes back resolved against the folder of `path`.
Result<RoutesFile> read_routes(const std::filesystem::path& path);

/// As YAML, with what `parse_routes` reads back.
[[nodiscard]] std::string routes_text(const RoutesFile& routes);
/// Writes the file, whole or not at all. `world` is written as given.
Result<> write_routes(const std::filesystem::path& path, const RoutesFile& routes);

}  // namespace adit
