// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "adit/core/check.hpp"
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
                              Preset{"tiles", plan_tiles}};

WorldPlan plan_of(const WorldConfig& config) {
  const auto preset = std::ranges::find_if(
      kPresets, [&](const Preset& candidate) { return config.preset == candidate.name; });
  ADIT_CHECK(preset != kPresets.end(), "check_fields lets known presets pass only");
  return preset->plan(config);
}

TriangleMesh mesh_of(const WorldPlan& plan) {
  const Surfacing surfacing{plan.max_edge, plan.flat_floor,
                            [&](const Vector3& p) { return displaced(plan.relief, p); }};
  TriangleMesh mesh = surface_mesh(boundary_of_union(plan.spaces), surfacing);
  for (const Solid& obstacle : plan.obstacles) append(mesh, surface_mesh(obstacle.faces, surfacing));
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
  const Phase phase("building the world");
  World network = network_of(config);
  if (config.arrangement == "single") return network;
  World neighbour = neighbour_of(network, config);
  World world = side_by_side(std::move(network), std::move(neighbour));
  world.name += "-" + config.arrangement;
  return world;
}

}  // namespace adit
