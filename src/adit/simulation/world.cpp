// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/simulation/world_plan.hpp"
#include "adit/simulation/world_surface.hpp"

namespace adit {
namespace {

struct Preset {
  const char* name;
  WorldPlan (*plan)(const WorldConfig&);
};
constexpr std::array kPresets{Preset{"zab", plan_zab}, Preset{"mine", plan_mine}, Preset{"metro", plan_metro},
                              Preset{"tiles", plan_tiles}, Preset{"network", plan_network}};

WorldPlan plan_of(const WorldConfig& config) {
  const auto preset = std::ranges::find_if(
      kPresets, [&](const Preset& candidate) { return config.preset == candidate.name; });
  ADIT_CHECK(preset != kPresets.end(), "check_fields lets known presets pass only");
  return preset->plan(config);
}

TriangleMesh mesh_of(std::span<const Solid> spaces, std::span<const Solid> obstacles,
                     const Surfacing& surfacing) {
  TriangleMesh mesh = surface_mesh(boundary_of_union(spaces), surfacing);
  for (const Solid& obstacle : obstacles) append(mesh, surface_mesh(obstacle.faces, surfacing));
  return mesh;
}

/// Storeys meet in corners that are the same to the last bit; each becomes one vertex.
void join_equal_vertices(TriangleMesh& mesh) {
  const std::vector<Eigen::Vector3f> all = std::move(mesh.vertices);
  const auto key = [&](int i) {
    const Eigen::Vector3f& v = all[static_cast<std::size_t>(i)];
    return std::array{v.x(), v.y(), v.z()};
  };
  std::vector<int> sorted(all.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  std::ranges::stable_sort(sorted, {}, key);
  std::vector<int> first_of(all.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool repeats = i > 0 && key(sorted[i]) == key(sorted[i - 1]);
    first_of[static_cast<std::size_t>(sorted[i])] =
        repeats ? first_of[static_cast<std::size_t>(sorted[i - 1])] : sorted[i];
  }
  std::vector<int> index(all.size());
  mesh.vertices.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto first = static_cast<std::size_t>(first_of[i]);
    index[i] = first == i ? static_cast<int>(mesh.vertices.size()) : index[first];
    if (first == i) mesh.vertices.push_back(all[i]);
  }
  for (Eigen::Vector3i& corners : mesh.triangles)
    for (int k = 0; k < 3; ++k) corners[k] = index[static_cast<std::size_t>(corners[k])];
}

TriangleMesh mesh_of(const WorldPlan& plan) {
  const Surfacing level{plan.max_edge, plan.flat_floor,
                        [&](const Vector3& p) { return displaced(plan.relief, p); }};
  TriangleMesh mesh = mesh_of(plan.spaces, plan.obstacles, level);
  for (const Storey& storey : plan.storeys) {
    const Surfacing lifted{plan.max_edge, plan.flat_floor, [&](const Vector3& p) {
                             return displaced(plan.relief, p, storey.floors.height(p));
                           }};
    append(mesh, mesh_of(storey.spaces, storey.obstacles, lifted));
  }
  if (plan.storeys.size() > 1) join_equal_vertices(mesh);
  return mesh;
}

World network_of(const WorldConfig& config) {
  const WorldPlan plan = plan_of(config);
  World world{config.preset, mesh_of(plan), {}, plan.tunnel_length};
  for (const Drive& drive : plan.drives) {
    Route route = route_of(drive);
    for (Vector3& waypoint : route.waypoints) waypoint = on_floor(plan.relief, waypoint);
    world.routes.push_back(std::move(route));
  }
  world.routes.insert(world.routes.end(), plan.routes.begin(), plan.routes.end());
  return world;
}

/// The mirror image in the x-z plane. The corners of each triangle change their order, so that it still faces
/// the free space.
World mirrored(World world) {
  for (Eigen::Vector3f& vertex : world.mesh.vertices) vertex.y() = -vertex.y();
  for (Eigen::Vector3i& corners : world.mesh.triangles) std::swap(corners[1], corners[2]);
  for (Route& route : world.routes)
    for (Vector3& waypoint : route.waypoints) waypoint.y() = -waypoint.y();
  return world;
}

void move(World& world, const Vector3& by) {
  for (Eigen::Vector3f& vertex : world.mesh.vertices) vertex += by.cast<float>();
  for (Route& route : world.routes)
    for (Vector3& waypoint : route.waypoints) waypoint += by;
}

/// The second network of an arrangement of two.
World neighbour_of(const World& network, WorldConfig config) {
  if (config.arrangement == "mirrored") return mirrored(network);
  if (config.arrangement == "twins") return network;
  constexpr std::uint64_t kOther = 1'000'003;  // Added to a seed: far from those that people choose.
  if (config.arrangement == "copies")
    config.furniture_seed = furniture_seed(config) + kOther;
  else
    config.seed += kOther;
  return network_of(config);
}

/// Two robots drive in each of the two networks; those of the second take over the names of the two that
/// the first one loses.
World side_by_side(World first, World second) {
  constexpr float kRockBetween =
      40.0F;  // Metres: a ray that leaves one network by a portal misses the other.
  constexpr std::size_t kRobotsEach = 2;
  const float gap = bounding_box(first.mesh).max().y() - bounding_box(second.mesh).min().y();
  move(second, Vector3(0.0, static_cast<double>(gap + kRockBetween), 0.0));
  append(first.mesh, second.mesh);
  first.tunnel_length += second.tunnel_length;
  for (std::size_t i = 0; i < kRobotsEach; ++i) {
    Route& route = first.routes[kRobotsEach + i];
    route = {route.name, second.routes[i].speed_mps, std::move(second.routes[i].waypoints)};
  }
  return first;
}

}  // namespace

std::vector<std::string> world_presets() {
  std::vector<std::string> names;
  for (const Preset& preset : kPresets) names.emplace_back(preset.name);
  return names;
}

Result<World> make_world(const WorldConfig& config) {
  WorldConfig checked = config;
  if (const Result<> ok = check_fields(fields_of(checked)); !ok) return fail("world", ok.error());
  if (config.preset == "network" && config.arrangement != "single")
    return fail(
        format("world: preset network has no arrangement '{}', as it repeats and mirrors parts of "
               "itself; use arrangement single, or another preset",
               config.arrangement));
  const Phase phase("building the world");
  World network = network_of(config);
  if (config.arrangement == "single") return network;
  World neighbour = neighbour_of(network, config);
  World world = side_by_side(std::move(network), std::move(neighbour));
  world.name += "-" + config.arrangement;
  return world;
}

}  // namespace adit
