// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/world_files.hpp"

#include "adit/io/mesh_files.hpp"
#include "adit/io/routes_yaml.hpp"

namespace adit {

Result<World> load_world(const std::filesystem::path& world_file, const std::filesystem::path& routes_file) {
  Result<RoutesFile> routes = read_routes(routes_file);
  if (!routes) return tl::unexpected(routes.error());
  const std::filesystem::path mesh_file = world_file.empty() ? routes->world : world_file;
  if (mesh_file.empty()) {
    return fail(routes_file.string() + ": names no world; add 'world: FILE' to it or give --world FILE");
  }
  Result<TriangleMesh> mesh = read_mesh(mesh_file);
  if (!mesh) return tl::unexpected(mesh.error());
  World world;
  const std::filesystem::path folder = std::filesystem::absolute(mesh_file).parent_path();
  world.name = mesh_file.stem() == "world" ? folder.filename().string() : mesh_file.stem().string();
  world.mesh = std::move(*mesh);
  world.routes = std::move(routes->routes);
  return world;
}

}  // namespace adit
