// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world.hpp"

#include <algorithm>
#include <array>

#include "adit/core/check.hpp"
#include "adit/simulation/world_plan.hpp"
#include "adit/simulation/world_surface.hpp"

namespace adit {
namespace {

struct Preset {
  const char* name;
  WorldPlan (*plan)(const WorldConfig&);
};
constexpr std::array kPresets{Preset{"zab", plan_zab}, Preset{"mine", plan_mine},
                              Preset{"metro", plan_metro}};

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

}  // namespace

std::vector<std::string> world_presets() {
  std::vector<std::string> names;
  for (const Preset& preset : kPresets) names.emplace_back(preset.name);
  return names;
}

Result<World> make_world(const WorldConfig& config) {
  WorldConfig checked = config;
  if (const Result<> ok = check_fields(fields_of(checked)); !ok) return fail("world", ok.error());
  const WorldPlan plan = plan_of(config);
  World world{config.preset, mesh_of(plan), {}, plan.tunnel_length};
  for (const Drive& drive : plan.drives) {
    Route route = route_of(drive);
    for (Vector3& waypoint : route.waypoints) waypoint = on_floor(plan.relief, waypoint);
    world.routes.push_back(std::move(route));
  }
  return world;
}

}  // namespace adit
