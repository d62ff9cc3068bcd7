// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The smallest world that robots can be driven through, as files.
#pragma once

#include <filesystem>
#include <vector>

#include "adit/io/mesh_files.hpp"
#include "adit/io/routes_yaml.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"

namespace adit::test {

/// A hall of 40 x 8 x 4 m with its floor at z = 0 around y = 0: `folder`/hall.ply.
inline void put_hall(const std::filesystem::path& folder) {
  const Result<> written = write_mesh(folder / "hall.ply", room({0, -4, 0}, {40, 4, 4}));
  EXPECT_TRUE(written) << written.error().message;
}

/// Robot "alpha" drives straight along y = 0 from x = `begin` to x = `end`.
inline void put_route(const std::filesystem::path& path, double begin, double end) {
  Route route{.name = "alpha", .speed_mps = 1.8, .waypoints = {}};
  for (double x = begin; x <= end; x += 1.0) route.waypoints.emplace_back(x, 0.0, 0.0);
  const Result<> written = write_routes(path, {"hall.ply", {route}});
  EXPECT_TRUE(written) << written.error().message;
}

}  // namespace adit::test
