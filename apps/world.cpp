// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/mesh_files.hpp"
#include "adit/io/routes_yaml.hpp"
#include "adit/simulation/world.hpp"
#include "command_line.hpp"

namespace adit::app {
namespace {

struct WorldOptions {
  std::string preset;
  std::string seed;
  std::string arrangement;
  std::string routes;
  std::string out;
};

/// The configuration from --config and --set (keys `world.*`), then the command's own options.
Result<WorldConfig> config_of(const WorldOptions& options, const Common& common) {
  Result<RunConfig> run_config = configured(common);
  if (!run_config) return tl::unexpected(run_config.error());
  WorldConfig& config = run_config->world;
  if (!options.preset.empty()) config.preset = options.preset;
  if (!std::ranges::count(world_presets(), config.preset))
    usage_error(format("--preset {}: the presets are {}", config.preset, fmt::join(world_presets(), ", ")));
  for (const auto& [key, value] :
       {std::pair("seed", options.seed), std::pair("arrangement", options.arrangement),
        std::pair("routes", options.routes)}) {
    if (value.empty()) continue;
    if (const Result<> set = set_field(fields_of(config), key, value); !set) usage_error(set.error().message);
  }
  return config;
}

/// Both files appear in their folder together or not at all.
Result<> save(const std::string& out, const World& world) {
  Result<OutputDir> directory = OutputDir::create(out, "world");
  if (!directory) return tl::unexpected(directory.error());
  const std::filesystem::path folder = directory->path();
  if (Result<> saved = write_mesh(folder / "world.ply", world.mesh); !saved) return saved;
  if (Result<> saved = write_routes(folder / "routes.yaml", {"world.ply", world.routes}); !saved)
    return saved;
  return directory->commit();
}

void print_text(const World& world) {
  const Eigen::Vector3f size = bounding_box(world.mesh).sizes();
  std::string routes;
  for (const Route& route : world.routes)
    routes += format("{}{} {:.1f} m", routes.empty() ? "" : ", ", route.name, length_of(route));
  std::puts(format("{}: {} triangles, {:.0f} x {:.0f} x {:.1f} m, {:.2f} km of tunnel; {}", world.name,
                   world.mesh.triangles.size(), size.x(), size.y(), size.z(), world.tunnel_length / 1000.0,
                   routes)
                .c_str());
}

void print_json(const World& world) {
  const Eigen::Vector3f size = bounding_box(world.mesh).sizes();
  nlohmann::ordered_json routes = nlohmann::ordered_json::array();
  for (const Route& route : world.routes)
    routes.push_back({{"name", route.name}, {"length_m", length_of(route)}, {"speed_mps", route.speed_mps}});
  const nlohmann::ordered_json all{{"preset", world.name},
                                   {"triangles", world.mesh.triangles.size()},
                                   {"size_m", {size.x(), size.y(), size.z()}},
                                   {"tunnel_m", world.tunnel_length},
                                   {"routes", routes}};
  std::puts(all.dump().c_str());
}

Result<> run(const WorldOptions& options, const Common& common) {
  const Result<WorldConfig> config = config_of(options, common);
  if (!config) return tl::unexpected(config.error());
  const Result<World> world = make_world(*config);
  if (!world) return tl::unexpected(world.error());
  if (Result<> saved = save(options.out, *world); !saved) return saved;
  common.json ? print_json(*world) : print_text(*world);
  return {};
}

}  // namespace

void add_world(Program& program) {
  const auto options = std::make_shared<WorldOptions>();
  const Command command =
      program.add_command("world", "Make a procedural tunnel network with the routes of several robots",
                          [options](const Common& common) { return run(*options, common); });
  command.add_option("--preset", options->preset,
                     format("{} (default zab)", fmt::join(world_presets(), ", ")));
  command.add_option("--seed", options->seed,
                     "Seed of the network (default 1); each seed gives another one of the same kind");
  command.add_option("--arrangement", options->arrangement,
                     "single (default), or two networks with two robots each: different, mirrored (one is "
                     "the other's mirror image), copies (the same tunnels with other furniture), twins");
  command.add_option(
      "--routes", options->routes,
      "meeting (default: every pair shares a stretch; network: some do) or apart (robots keep to their "
      "tunnels)");
  command.add_option("--out", options->out, "Folder for world.ply and routes.yaml").required();
}

}  // namespace adit::app
