// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/core/json_text.hpp"
#include "adit/evaluation/shared_stretch.hpp"
#include "adit/io/mesh_files.hpp"
#include "adit/io/routes_yaml.hpp"
#include "adit/simulation/route_plan.hpp"
#include "command_line.hpp"

namespace adit::app {
namespace {

struct RoutesOptions {
  std::string mesh;
  std::string out;
  std::optional<std::uint64_t> robots;
  std::string length;
  std::string seed;
};

/// The configuration from --config and --set (keys `routes.*`), then the command's own options.
Result<RouteConfig> config_of(const RoutesOptions& options, const Common& common) {
  Result<RunConfig> run_config = configured(common);
  if (!run_config) return tl::unexpected(run_config.error());
  for (const auto& [key, value] : {std::pair("length_m", options.length), std::pair("seed", options.seed)}) {
    if (value.empty()) continue;
    const Result<> set = set_field(fields_of(run_config->routes), key, value);
    if (!set) usage_error(set.error().message);
  }
  return run_config->routes;
}

/// The mesh as routes.yaml names it: relative to that file where it lies beside or below it, so that both can
/// be moved together.
std::filesystem::path world_of(const RoutesOptions& options) {
  const std::filesystem::path mesh = std::filesystem::absolute(options.mesh).lexically_normal();
  const std::filesystem::path folder =
      std::filesystem::absolute(options.out).lexically_normal().parent_path();
  const std::filesystem::path relative = mesh.lexically_relative(folder);
  return relative.empty() || *relative.begin() == ".." ? mesh : relative;
}

Trajectory path_of(const Route& route) {
  Trajectory path;
  for (std::size_t i = 0; i < route.waypoints.size(); ++i)
    path.push_back(
        {Stamp{static_cast<std::int64_t>(i)},
         Pose::translation_of(route.waypoints[i].x(), route.waypoints[i].y(), route.waypoints[i].z())});
  return path;
}

struct SharedPath {
  std::string a;
  std::string b;
  double metres = 0.0;
};

std::vector<SharedPath> shared_paths(const RoutePlan& plan) {
  std::vector<SharedPath> shared;
  for (std::size_t a = 0; a < plan.robots.size(); ++a) {
    for (std::size_t b = a + 1; b < plan.robots.size(); ++b) {
      const Route& first = plan.robots[a].route;
      const Route& second = plan.robots[b].route;
      shared.push_back({first.name, second.name, shared_stretch_m(path_of(first), path_of(second))});
    }
  }
  return shared;
}

void print_plan(const RoutePlan& plan, const std::string& mesh) {
  std::printf("%s: %.0f m² of floor for the robot, the routes lead along %.0f %% of it\n", mesh.c_str(),
              plan.floor_m2, 100.0 * plan.covered);
  for (const PlannedRoute& robot : plan.robots)
    std::printf("%s: %.1f m, %.2f m or more from walls, slope up to %.0f degrees\n", robot.route.name.c_str(),
                length_of(robot.route), robot.clearance_m, robot.slope_deg);
  for (const SharedPath& pair : shared_paths(plan))
    std::printf("%s and %s share %.0f m\n", pair.a.c_str(), pair.b.c_str(), pair.metres);
}

void print_json(const RoutePlan& plan) {
  nlohmann::ordered_json report = {{"floor_m2", plan.floor_m2}, {"covered_pct", 100.0 * plan.covered}};
  report["robots"] = nlohmann::ordered_json::array();
  for (const PlannedRoute& robot : plan.robots)
    report["robots"].push_back({{"name", robot.route.name},
                                {"length_m", length_of(robot.route)},
                                {"clearance_m", robot.clearance_m},
                                {"slope_deg", robot.slope_deg}});
  report["pairs"] = nlohmann::ordered_json::array();
  for (const SharedPath& pair : shared_paths(plan))
    report["pairs"].push_back({{"robots", {pair.a, pair.b}}, {"shared_m", pair.metres}});
  report["notes"] = plan.notes;
  std::printf("%s\n", json_text(report).c_str());
}

Result<> routes_command(const RoutesOptions& options, const Common& common) {
  const Result<RouteConfig> config = config_of(options, common);
  if (!config) return tl::unexpected(config.error());
  const Result<TriangleMesh> mesh = read_mesh(options.mesh);
  if (!mesh) return tl::unexpected(mesh.error());
  const Result<RoutePlan> plan = plan_routes(*mesh, options.robots.value_or(4), *config);
  if (!plan) return fail(options.mesh, plan.error());
  RoutesFile file{world_of(options), {}};
  for (const PlannedRoute& robot : plan->robots) file.routes.push_back(robot.route);
  if (const Result<> written = write_routes(options.out, file); !written) return written;
  print_notes("routes", plan->notes);
  common.json ? print_json(*plan) : print_plan(*plan, options.mesh);
  return {};
}

}  // namespace

void add_routes(Program& program) {
  const auto options = std::make_shared<RoutesOptions>();
  const Command command = program.add_command(
      "routes", "Plan routes that robots can drive through a mesh, for simulate, slam and study",
      [options](const Common& common) { return routes_command(*options, common); });
  command
      .add_option("mesh", options->mesh,
                  "Mesh: PLY, OBJ, STL (z up), DAE, GLB (which say what is up); metres, closed")
      .required();
  command.add_option("--robots", options->robots, "How many robots, 1 to 256 (default 4)").in_range(1, 256);
  command.add_option("--out", options->out, "routes.yaml to write").required();
  command.add_option("--length", options->length, "Longest route, metres (default 400)");
  command.add_option("--seed", options->seed, "Each seed plans other routes through the mesh (default 1)");
  command.footer("The robot's size, clearance and slope are the fields routes.* of the configuration.");
}

}  // namespace adit::app
